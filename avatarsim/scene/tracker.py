"""Tracker sample, the input of a user at one instant: the posture of every avatar of the scene, not checked against anything."""

from collections.abc import Sequence
from dataclasses import dataclass
from math import isfinite

import numpy as np
from numpy.typing import ArrayLike, NDArray

from avatarsim.errors import InvalidSample
from avatarsim.scene.avatar import Avatar
from avatarsim.scene.checks import as_number, finite_array, real_array
from avatarsim.scene.joint import Ball, Free, Hinges, Slide, axes_of
from avatarsim.spatial import rotation

Array = NDArray[np.float64]

UNIT_SLACK = 1e-6
"""Largest deviation of a tracker's quaternion from length 1: single precision passes, a forgotten normalisation does not."""


@dataclass(frozen=True, eq=False)
class TrackerSample:
    """Posture of all links of all avatars, in scene order, at `time` [s].

    positions  (links, 3) [m]: root position in the world; used for `Free` roots only
    rotations  (links, 4), scalar first (w, x, y, z): orientation of a `Free` root in the world, of a `Ball` link against its
               rest orientation; `from_xyzw` converts those of scalar-last sources
    angles     (hinges,) all hinge angles [rad] and ways of slides [m], link by link

    Links, hinges and slides are those of all avatars, in the order of the scene; rows that are not used hold any numbers,
    rotations (1, 0, 0, 0). Nothing is checked here: the engine raises InvalidSample for samples that are not finite, do not fit
    the scene's avatars, or have invalid rotations.
    """

    time: float
    positions: Array
    rotations: Array
    angles: Array


def checked(sample: TrackerSample, avatars: Sequence[Avatar]) -> TrackerSample:
    """Return `sample`, as float64 arrays, if it is finite, fits the avatars and has unit rotations; or raise a typed error."""
    if not isinstance(sample, TrackerSample):
        raise InvalidSample("tracker sample", sample, "a TrackerSample")
    links = sum([len(avatar.links) for avatar in avatars])
    hinges = sum([avatar.hinge_count for avatar in avatars])
    if _sound(sample, links, hinges):
        return sample
    if not isfinite(as_number(sample.time)):
        raise InvalidSample("tracker time [s]", sample.time, "a finite number")
    positions = finite_array("tracker positions", sample.positions, (links, 3), InvalidSample)
    rotations = finite_array("tracker rotations", sample.rotations, (links, 4), InvalidSample)
    angles = finite_array("tracker angles", sample.angles, (hinges,), InvalidSample)
    lengths = np.linalg.norm(rotations, axis=1)
    if links and not (np.abs(lengths - 1.0) <= UNIT_SLACK).all():
        worst = int(np.argmax(np.abs(lengths - 1.0)))
        raise InvalidSample(f"tracker rotation of link {worst}", rotations[worst].tolist(), "a quaternion of length 1")
    given = (sample.positions, sample.rotations, sample.angles)
    if isinstance(sample.time, float) and all(type(one) is np.ndarray and one.dtype == np.float64 for one in given):
        return sample
    return TrackerSample(float(sample.time), positions, rotations, angles)


def _sound(sample: TrackerSample, links: int, hinges: int) -> bool:
    """Return True if `sample` is certainly valid; decided by plain numbers only, in a third of the time that it takes to find the
    fault of others."""
    arrays = (sample.positions, (links, 3)), (sample.rotations, (links, 4)), (sample.angles, (hinges,))
    for array, shape in arrays:
        if type(array) is not np.ndarray or array.dtype != np.float64 or array.shape != shape:
            return False
    squares = np.einsum("ij,ij->i", sample.rotations, sample.rotations)
    # well within the limit for lengths: squares differ from 1 by twice as much, and rounding may not decide
    is_unit = (np.abs(squares - 1.0) <= UNIT_SLACK).all()
    sound = is_unit and np.isfinite(sample.positions).all() and np.isfinite(sample.angles).all()
    return bool(sound) and type(sample.time) is float and isfinite(sample.time)


def from_xyzw(quaternions: ArrayLike) -> Array:
    """Return unit quaternions (..., 4) in the engine's order (w, x, y, z) from scalar-last ones (x, y, z, w).

    ROS, Unity, OpenXR, scipy's `as_quat` and PyBullet have the scalar last. Only the order changes, and the length becomes 1:
    a change of axes is a step of its own (docs/units_and_frames.md).

    Args:
        quaternions: (..., 4), any leading shape.

    Raises:
        InvalidSample: for another last axis, for numbers that are not finite, and for a quaternion of zeros.
    """
    try:
        q = real_array(quaternions)
    except (TypeError, ValueError, OverflowError):
        raise InvalidSample("quaternions", quaternions, "real numbers of shape (..., 4)") from None
    if q.shape[-1:] != (4,):
        raise InvalidSample("shape of quaternions", q.shape, "(..., 4): x, y, z, w")
    lengths = np.linalg.norm(q, axis=-1)
    is_sound = np.isfinite(lengths) & (lengths > 0.0)
    if not is_sound.all():
        at = tuple(int(k) for k in np.argwhere(~is_sound)[0])
        thing = f"quaternion {list(at)}" if at else "quaternion"
        raise InvalidSample(thing, q[at].tolist(), "four finite numbers, x, y, z, w, not all 0")
    return rotation.unit(q[..., [3, 0, 1, 2]])


def between(before: TrackerSample, after: TrackerSample, share: float) -> TrackerSample:
    """Return the posture at `share` (0 to 1) of the way from one sample to the next: rotations on the great circle, the short way
    round (slerp, Shoemake 1985), the rest and the time on straight lines. For samples that `checked` lets through."""
    shares = np.full(len(before.rotations), share)
    return TrackerSample(
        before.time + share * (after.time - before.time), before.positions + share * (after.positions - before.positions),
        rotation.normalised(rotation.slerp(before.rotations, after.rotations, shares)),
        before.angles + share * (after.angles - before.angles),
    )


def rest(avatars: Sequence[Avatar], time: float = 0.0) -> TrackerSample:
    """Return the sample at `time` [s] with all joints at zero, within the limits of hinges and slides, every root at the origin.

    Moving bodies are at their first poses.

    The default start of a scene; `dataclasses.replace(rest(avatars), positions=...)` moves the roots."""
    links = sum(len(avatar.links) for avatar in avatars)
    angles: list[float] = []
    for avatar in avatars:
        own = [min(max(0.0, axis.lower), axis.upper) for link in avatar.links for axis in axes_of(link.joint)]
        angles += avatar.with_followers(np.array(own)).tolist()
    positions, rotations, first = np.zeros((links, 3)), np.tile(rotation.IDENTITY, (links, 1)), 0
    for avatar in avatars:
        if avatar.moves and isinstance(avatar.links[0].joint, Free):
            positions[first], rotations[first] = avatar.links[0].anchor, avatar.links[0].orientation
        first += len(avatar.links)
    return TrackerSample(time, positions, rotations, np.array(angles, dtype=np.float64))


def link_poses(avatars: Sequence[Avatar], sample: TrackerSample) -> tuple[Array, Array]:
    """Return forward kinematics of the raw sample: positions (links, 3) [m] and orientations (links, 4) in the world.

    The plain twin of the posture kernel's kinematics, and used by every adapter and measure.
    """
    return poses_of_links(avatars, sample.positions, sample.rotations, sample.angles)


def link_poses_each(avatars: Sequence[Avatar], samples: Sequence[TrackerSample]) -> tuple[Array, Array]:
    """Return `link_poses` of F samples at once: (F, links, 3) [m] and (F, links, 4), the same bits as one by one."""
    links = sum(len(avatar.links) for avatar in avatars)
    return poses_of_links(
        avatars, np.array([sample.positions for sample in samples], dtype=np.float64).reshape(len(samples), links, 3),
        np.array([sample.rotations for sample in samples], dtype=np.float64).reshape(len(samples), links, 4),
        np.array([sample.angles for sample in samples], dtype=np.float64).reshape(len(samples), -1),
    )


def poses_of_links(avatars: Sequence[Avatar], roots: Array, rotations: Array, angles: Array) -> tuple[Array, Array]:
    """Return forward kinematics of postures as in `TrackerSample`: roots (..., links, 3) [m], rotations (..., links, 4), angles
    (..., hinges) [rad, m]; positions (..., links, 3) [m] and orientations (..., links, 4) in the world."""
    positions, orientations = np.empty(np.shape(roots)), np.empty(np.shape(rotations))
    first = hinge = 0
    for avatar in avatars:
        index = {link.name: first + k for k, link in enumerate(avatar.links)}
        for k, link in enumerate(avatar.links, start=first):
            if isinstance(link.joint, Free):
                positions[..., k, :] = roots[..., k, :]
                orientations[..., k, :] = rotation.normalised(rotations[..., k, :])
                continue
            origin, frame = np.zeros(3), np.array(rotation.IDENTITY)
            if link.parent is not None:
                origin, frame = positions[..., index[link.parent], :], orientations[..., index[link.parent], :]
            turned, anchor = rotation.multiply(frame, link.orientation), np.asarray(link.anchor)
            if isinstance(link.joint, Slide):
                anchor = anchor + np.multiply.outer(angles[..., hinge], rotation.rotate(link.orientation, link.joint.axis))
                hinge += 1
            elif isinstance(link.joint, Hinges):
                for axis in link.joint.hinges:
                    turned = rotation.multiply(turned, rotation.from_axis_angle(axis.axis, angles[..., hinge]))
                    hinge += 1
            elif isinstance(link.joint, Ball):
                turned = rotation.multiply(turned, rotations[..., k, :])
            positions[..., k, :] = origin + rotation.rotate(frame, anchor)
            orientations[..., k, :] = rotation.normalised(turned)
        first += len(avatar.links)
    return positions, orientations
