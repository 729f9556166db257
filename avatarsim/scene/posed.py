"""Postures by the names of joints."""

from collections.abc import Iterable, Mapping, Sequence
from typing import cast

import numpy as np
from numpy.typing import ArrayLike

from avatarsim.errors import InvalidSample, UnknownName
from avatarsim.scene.avatar import Avatar, Link
from avatarsim.scene.checks import finite_array, parts, unit_quaternion
from avatarsim.scene.joint import Ball, Free, axes_of
from avatarsim.scene.moving import Pose, checked_pose
from avatarsim.scene.tracker import TrackerSample, checked, rest


def posed(avatars: Sequence[Avatar], joints: Mapping[str, ArrayLike | Pose], start: TrackerSample | None = None) -> TrackerSample:
    """Return the sample in which the named joints have the given values, and all others those of `start`.

        sample = av.posed((hand,), {"hand": ((0.0, 0.0, 0.3), (1.0, 0.0, 0.0, 0.0)), "index0": 0.4, "thumb0": (0.2, 0.6)})

    Values are not clipped: a sample is where the user is, and the engine shows the nearest posture within limits.

    Args:
        avatars: of the scene, in its order.
        joints: values by the names of links, which are those of their joints, as in `scene.names` (`avatar/link`); a link's own
            name is enough where no other has it. A hinge has its angle [rad], several hinges as many, a slide its way [m], a ball
            a quaternion (w, x, y, z), a free root a position [m] and a quaternion.
        start: that the other joints keep; by default `rest(avatars)`.

    Raises:
        UnknownName: for a name that is no link's; it lists the names most like it.
        InvalidSample: for a value that does not fit its joint, and for a joint without a value of its own: a rigid one, and one
            that follows another.
    """
    if not isinstance(joints, Mapping):
        raise InvalidSample("values of joints", joints, "a mapping {name of a link: value}")
    base = rest(avatars) if start is None else checked(start, avatars)
    sample = TrackerSample(base.time, base.positions.copy(), base.rotations.copy(), base.angles.copy())
    links = [link for avatar in avatars for link in avatar.links]
    hinges = np.cumsum([0, *(len(axes_of(link.joint)) for link in links)])
    named, following, first = _numbers(avatars), set[int](), 0
    for avatar in avatars:
        following |= {first + one.follower for one in avatar.couplings}
        first += avatar.hinge_count
    for name, value in joints.items():
        if name not in named:
            raise UnknownName("link of the joint to pose", str(name), named)
        k = named[name]
        if following.intersection(range(hinges[k], hinges[k + 1])):
            raise InvalidSample(f"value of joint {name}", value, "none: this joint follows another")
        _put(sample, links[k], k, slice(int(hinges[k]), int(hinges[k + 1])), value)
    first = 0
    for avatar in avatars:
        own = slice(first, first + avatar.hinge_count)
        sample.angles[own] = avatar.with_followers(sample.angles[own])
        first = own.stop
    return sample


def _numbers(avatars: Sequence[Avatar]) -> dict[str, int]:
    """Return numbers of links among those of all avatars by their names in a scene, and by own names that occur once."""
    whole = [name for avatar in avatars for name in avatar.link_names]
    own = [link.name for avatar in avatars for link in avatar.links]
    return {name: k for k, name in enumerate(own) if own.count(name) == 1} | {name: k for k, name in enumerate(whole)}


def _put(sample: TrackerSample, link: Link, k: int, hinges: slice, value: ArrayLike | Pose) -> None:
    """Set the joint of link `k` in a sample, whose angles are those of `hinges`."""
    if isinstance(link.joint, Free):
        sample.positions[k], sample.rotations[k] = checked_pose(link.name, value)
    elif isinstance(link.joint, Ball):
        sample.rotations[k] = unit_quaternion(f"rotation of joint {link.name}", cast(Iterable[float], value), InvalidSample)
    elif hinges.stop > hinges.start:
        thing = f"value of joint {link.name} [rad, of a slide m]"
        sample.angles[hinges] = finite_array(thing, parts(value), (hinges.stop - hinges.start,), InvalidSample)
    else:
        raise InvalidSample(f"value of joint {link.name}", value, "none: this link is rigid on its parent")
