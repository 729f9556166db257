"""Moving bodies: doors, lifts, conveyors and turntables, whose pose is given per frame.

A moving body is an avatar with `moves`: a firm spring with a bounded force ties it to its given pose, so that it gives way where
it would crush something.
"""

import math
from collections.abc import Iterable, Mapping, Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

from avatarsim.errors import InvalidSample, UnknownName
from avatarsim.scene.avatar import STIFFEST, Avatar, Drive, Link
from avatarsim.scene.body import solid
from avatarsim.scene.checks import LONGEST, Quaternion, Vector, finite_array, parts, place, positive, unit_quaternion, within
from avatarsim.scene.joint import Free, Hinges, Slide, axes_of
from avatarsim.scene.shape import Piece
from avatarsim.scene.tracker import TrackerSample
from avatarsim.settings import CouplingSettings
from avatarsim.spatial import rotation

Pose = tuple[Iterable[float], Iterable[float]] | ArrayLike
"""A position [m] and an orientation (w, x, y, z), or the angles [rad] of hinges."""


def moving(
    name: str, pieces: tuple[Piece, ...], material: str, *, position: Vector = (0.0, 0.0, 0.0),
    orientation: Quaternion = rotation.IDENTITY, largest_force: float = 300.0, stiffness: float = 1e6, mass: float = 10.0,
    damping: float | None = None, joint: Free | Hinges | Slide | None = None, surface_velocity: Vector = (0.0, 0.0, 0.0),
) -> Avatar:
    """Make a body whose pose is given per frame, `advance(sample, dt, moving={name: (position, orientation)})`.

    It belongs into `Scene.avatars`. It never meets fixed bodies or other moving bodies. Raises InvalidScene for values outside
    their ranges.

    name              of the body
    pieces            in its frame
    material          a name of the scene's table of pairs
    position          [m] first place; with a `joint` of hinges that of their centre, for good
    orientation       first orientation (w, x, y, z)
    largest_force     [N] with which it presses; blocked by more, it stays behind. The default is about the
                      limit for doors of lifts on a person; a lift needs more than the weight that it carries
    stiffness         [N/m] of the spring to the given pose: unless it is blocked, it is at most the largest force by this
                      stiffness away. 0: it stays where others push it, as a door on its hinges does
    mass              [kg] that others feel in an impact, in addition to the spring
    damping           [N s/m] of the spring; critical by default, of a body without stiffness that of hands
    joint             `Hinges` for a body that turns about fixed axes, or a `Slide`, as of a drawer: its angles [rad] or its way
                      [m] are then given instead of a pose
    surface_velocity  [m/s] of its surface in its frame, as of a conveyor belt
    """
    positive(f"mass of moving body {name} [kg]", mass)
    within(f"stiffness of moving body {name} [N/m]", stiffness, 0.0, STIFFEST)
    if damping is None:
        damping = 2.0 * math.sqrt(stiffness * mass) if stiffness > 0.0 else CouplingSettings().damping
    link = Link(
        name, None, joint if joint is not None else Free(), pieces, solid(pieces, mass), material, position, orientation,
        surface_velocity,
    )
    return Avatar(
        name, (link,), size_range=(0.0, LONGEST), drive=Drive(stiffness, damping, largest_force), moves=True,
    )


def with_moving(
    avatars: Sequence[Avatar], sample: TrackerSample, given: Mapping[str, Pose], last: TrackerSample
) -> TrackerSample:
    """Complete a sample by the poses of moving bodies.

    Args:
        avatars: of the scene.
        sample: of all avatars, or only of those that do not move by themselves.
        given: pose of each moving body that goes elsewhere, by name; angles and ways are clipped to the limits of their joints.
        last: the sample of the last frame, from which moving bodies that are not given keep their poses.

    Raises:
        InvalidSample: for an invalid pose. UnknownName: for a name that is no moving body's.
    """
    if not isinstance(given, Mapping):
        raise InvalidSample("poses of moving bodies", given, "a mapping {name: (position, orientation)}")
    if isinstance(sample, TrackerSample) and np.shape(sample.positions)[:1] != (sum(len(one.links) for one in avatars),):
        sample = _spread(avatars, sample, last)
    names = [avatar.name for avatar in avatars if avatar.moves]
    for name in given:
        if name not in names:
            raise UnknownName("moving body", str(name), names)
    if not given:
        return sample
    positions, rotations = np.array(sample.positions), np.array(sample.rotations)
    angles, link, hinge = np.array(sample.angles), 0, 0
    for avatar in avatars:
        if avatar.name in given:
            pose = given[avatar.name]
            if avatar.hinge_count:
                thing, limits = f"angles [rad] or way [m] of moving body {avatar.name}", _limits(avatar)
                given_angles = finite_array(thing, parts(pose), (avatar.hinge_count,), InvalidSample)
                angles[hinge : hinge + avatar.hinge_count] = np.clip(given_angles, limits[:, 0], limits[:, 1])
            else:
                positions[link], rotations[link] = checked_pose(f"moving body {avatar.name}", pose)
        link, hinge = link + len(avatar.links), hinge + avatar.hinge_count
    return TrackerSample(sample.time, positions, rotations, angles)


def _limits(avatar: Avatar) -> NDArray[np.float64]:
    """Return the least and largest coordinate of each hinge and slide (hinges, 2) [rad, m]."""
    return np.array([(axis.lower, axis.upper) for link in avatar.links for axis in axes_of(link.joint)])


def checked_pose(name: str, pose: Pose) -> tuple[Vector, Quaternion]:
    """Return a checked position and orientation of a body. Raises InvalidSample."""
    if not isinstance(pose, tuple | list) or len(pose) != 2:
        raise InvalidSample(f"pose of {name}", pose, "a pair of position [m] and orientation (w, x, y, z)")
    return (
        place(f"position of {name}", pose[0], InvalidSample), unit_quaternion(f"orientation of {name}", pose[1], InvalidSample),
    )


def _spread(avatars: Sequence[Avatar], sample: TrackerSample, last: TrackerSample) -> TrackerSample:
    """Return a sample of the avatars that do not move by themselves as one of all, the others as in ``last``."""
    links = np.repeat([not avatar.moves for avatar in avatars], [len(avatar.links) for avatar in avatars])
    hinges = np.repeat([not avatar.moves for avatar in avatars], [avatar.hinge_count for avatar in avatars])
    count, angles = int(links.sum()), int(hinges.sum())
    whole = TrackerSample(sample.time, last.positions.copy(), last.rotations.copy(), last.angles.copy())
    whole.positions[links] = finite_array("tracker positions", parts(sample.positions), (count, 3), InvalidSample)
    whole.rotations[links] = finite_array("tracker rotations", parts(sample.rotations), (count, 4), InvalidSample)
    whole.angles[hinges] = finite_array("tracker angles", parts(sample.angles), (angles,), InvalidSample)
    return whole
