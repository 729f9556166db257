"""Velocities of driven bodies by their trackers, and the impulses that they receive.

Where contacts with fixed bodies block a link, its velocity is projected onto the cone of velocities that they allow.
"""

from math import ceil, log
from typing import Annotated, NamedTuple

import numpy as np
from numpy.typing import NDArray

from avatarsim.coupling.equation_6 import coupled
from avatarsim.ik.state import Contacts
from avatarsim.jit.kept import NOT_KEPT, Whole
from avatarsim.jit.kernel import kernel
from avatarsim.jit.layout import IndexLine, Line, Vectors
from avatarsim.model.dynamics import FIXED, DriveState, Dynamics, Velocities
from avatarsim.model.geometry import Geometry, Poses
from avatarsim.model.skeleton import FREE, Posture, Skeleton, carry
from avatarsim.settings import CouplingSettings
from avatarsim.spatial.tangent import columns, turn_of
from avatarsim.spatial.vec3 import add, along, dot, limited, norm, put_row, row, scale, sub
from avatarsim.tolerances import JUDGED, NOTHING

Array = NDArray[np.float64]

ROUNDS = ceil(log(JUDGED, 0.25))
"""Passes over the contacts of a link: the velocity left by one wall may lead into another. In a corner of 60 degrees each pass
leaves a quarter of it, and all of them JUDGED. Fewer: a hand in a corner keeps a velocity into it."""

TOP_SPEED = 30.0
"""[m/s] fastest that a driven body hits anything; a tracker that teleports would shoot objects away at any speed."""

TOP_SPIN = 60.0
"""[rad/s] the same for its rotation: ten turns a second."""


class TrackedMotion(NamedTuple):
    """Poses of the trackers of all links in this frame and in the last.

    one, other    poses; turn (1) is 0 or 1 for the one of this frame, and -1 in a scene without loose bodies
    still, axes   (nd), (nd, 3) working memory
    """

    one: Poses
    other: Poses
    turn: Annotated[IndexLine, Whole(-1, 1)]
    still: Annotated[Line, NOT_KEPT]
    axes: Vectors


@kernel
def is_stationary(dynamics: Dynamics, b: int) -> bool:
    """Return whether body b is fixed, or a moving one that the upper loop does not move."""
    return bool(dynamics.role[b] == FIXED or (dynamics.drive.moves[b] == 1 and dynamics.drive.coupled[b] == 0))


@kernel
def project_velocities(geo: Geometry, dynamics: Dynamics, contacts: Contacts, velocities_out: Velocities) -> None:
    """Remove from the velocity of each link the part into bodies that stood still and blocked it in the last frame.

    A hand blocked by a wall does not move, so it must not strike a ball with the velocity of its tracker. Simulated bodies do not
    change the velocity of a link, by which it pushes them.
    """
    v = velocities_out.linear
    for _ in range(ROUNDS):
        done = True
        for k in range(contacts.used[0]):
            for side in range(2):
                b, other = geo.body[contacts.pair[k, side]], geo.body[contacts.pair[k, 1 - side]]
                if not is_stationary(dynamics, other) or is_stationary(dynamics, b):
                    continue
                n = row(contacts.normal, k) if side == 0 else scale(row(contacts.normal, k), -1.0)
                into = dot(row(v, b), n)
                if into < 0.0:
                    put_row(v, b, along(row(v, b), -into, n))
                    done = False
        if done:
            break


@kernel
def tracked_velocities(skel: Skeleton, before: Poses, now: Poses, dt: float, velocities_out: Velocities) -> None:
    """Set the velocity of every link to that of its tracker, up to a largest speed."""
    for b in range(skel.first, now.position.shape[0]):
        step = sub(row(now.position, b), row(before.position, b))
        put_row(velocities_out.linear, b, limited(scale(step, 1.0 / dt), TOP_SPEED))
        turn = turn_of(columns(before.rotation, b), columns(now.rotation, b))
        put_row(velocities_out.angular, b, limited(scale(turn, 1.0 / dt), TOP_SPIN))


@kernel
def root_of(skel: Skeleton, link: int) -> int:
    """Return the root link of a link's avatar."""
    while skel.parent[link] >= 0:
        link = skel.parent[link]
    return link


@kernel
def receive(skel: Skeleton, drive: DriveState, received: Array) -> None:
    """Add impulses (nb, 3) [N s] to the velocities of links against their trackers.

    Avatars with joints are moved by the upper loop from now on, rigid hands by `relax`.
    """
    for link in range(skel.kind.shape[0]):
        b = skel.first + link
        j = row(received, b)
        if dot(j, j) > 0.0 and drive.coupled[b] == 0:
            drive.loaded[b] = max(drive.loaded[b], drive.linked[b])
            put_row(drive.lag, b, along(row(drive.lag, b), 1.0 / drive.mass[b], j))


@kernel
def relax(skel: Skeleton, drive: DriveState, dt: float, target_out: Posture, velocities_out: Velocities) -> None:
    """Move the targets of rigid hands that an impact moved over dt, exactly (eq. 6 of Schmidl and Lin 2004)."""
    for link in range(skel.kind.shape[0]):
        b = skel.first + link
        x, v = row(drive.offset, b), row(drive.lag, b)
        if drive.coupled[b] + drive.linked[b] + drive.moves[b] > 0 or (norm(x) == 0.0 and norm(v) == 0.0):
            continue
        x, v = coupled(drive.mass[b], drive.stiffness[b], drive.damping[b], x, v, dt)
        # below a visible size, so that a coupling at rest costs nothing
        if norm(x) < NOTHING and norm(v) < NOTHING:
            x, v = (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)
        put_row(drive.offset, b, x)
        put_row(drive.lag, b, v)
        put_row(target_out.root, link, add(row(target_out.root, link), x))
        put_row(velocities_out.linear, b, add(row(velocities_out.linear, b), v))


@kernel
def apply_to_roots(skel: Skeleton, received: Array, inverse_mass: Array, rate_out: Array) -> None:
    """Add impulses (nb, 3) [N s] to the velocities of the roots (method `paper`)."""
    for link in range(skel.kind.shape[0]):
        root = root_of(skel, link)
        if skel.kind[root] == FREE:
            gained = scale(row(received, skel.first + link), inverse_mass[skel.first + root])
            put_row(rate_out, root, add(row(rate_out, root), gained))


@kernel
def last_and_now(motion: TrackedMotion) -> tuple[Poses, Poses]:
    """Return tracked poses of the last frame and of this one."""
    if motion.turn[0] == 1:
        return motion.one, motion.other
    return motion.other, motion.one


@kernel
def track_velocities(skel: Skeleton, target: Posture, dt: float, velocities_out: Velocities, motion_out: TrackedMotion) -> None:
    """Compute the tracked poses of this frame, and set the velocities of all links to those of their trackers."""
    motion_out.turn[0] = 1 - motion_out.turn[0]
    before, now = last_and_now(motion_out)
    carry(skel, target, motion_out.still, now, motion_out.axes)
    tracked_velocities(skel, before, now, dt, velocities_out)


def make_tracked_motion(
    skel: Skeleton, drive: DriveState, posture: Posture, poses: Poses, settings: CouplingSettings
) -> TrackedMotion:
    """Return trackers at rest at `posture` and `poses`; avatars without a drive of their own get the constants of `settings`.

    Their heavy links are critically damped: with the damping of a hand a torso would swing.
    """
    unset = np.isnan(drive.damping)
    for constants, value in ((drive.stiffness, settings.spring), (drive.damping, settings.damping)):
        constants[np.isnan(constants)] = value
    heavy = np.flatnonzero(unset & (drive.linked == 1))
    drive.damping[heavy] = np.maximum(drive.damping[heavy], 2.0 * np.sqrt(drive.stiffness[heavy] * drive.mass[heavy]))
    still, axes = np.zeros(int(skel.first_dof[-1])), np.zeros((int(skel.first_dof[-1]), 3))
    one, other = (Poses(*(array.copy() for array in poses)) for _ in range(2))
    carry(skel, posture, still, one, axes)
    return TrackedMotion(one, other, np.zeros(1, dtype=np.int64), still, axes)


def no_tracked_motion(poses: Poses) -> TrackedMotion:
    """Return empty arrays, for a scene without loose bodies."""
    nowhere = Poses(*(array[:0].copy() for array in poses))
    return TrackedMotion(nowhere, nowhere, np.full(1, -1), np.zeros(0), np.zeros((0, 3)))
