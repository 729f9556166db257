"""Where tracker, posture and impacts meet: eq. 6 on the offset that collisions leave between a driven body and its tracker.

In free motion there is no offset and no lag. A collision changes the velocity of the driven body's coupled mass; the
spring brings it back, by the exact solution for any frame time.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from avatarsim.impact.coupling import coupled
from avatarsim.kernel import kernel
from avatarsim.posture.kinematics import forward
from avatarsim.settings import CouplingSettings
from avatarsim.spatial.tangent import Columns, columns, rotation_vector, turned
from avatarsim.spatial.vec3 import Vec3, add, norm, put_row, row, scale, sub
from avatarsim.world.dynamics import Dynamics, Velocities
from avatarsim.world.geometry import Geometry, Poses
from avatarsim.world.skeleton import FREE, Posture, Skeleton

Array = NDArray[np.float64]
Index = NDArray[np.int64]

TOP_SPEED = 30.0
"""[m/s] fastest that a driven body hits anything; a tracker that teleports would shoot objects away at any speed."""

TOP_SPIN = 60.0
"""[rad/s] the same for its rotation: ten turns a second."""

AT_REST = 1e-9
"""[m, m/s] offset and rate below this are set to zero, so that a coupling at rest costs and shows nothing."""


class Springs(NamedTuple):
    """The springs of all avatars of a world.

    offset, rate (nl, 3) of the roots [m], [m/s]; mass (nl) [kg]; still (nd) no step, axes (nd, 3) of no further use;
    one, other: where the tracker has the links in this frame and in the last, taking turns by turn (1).
    """

    settings: CouplingSettings
    offset: Array
    rate: Array
    mass: Array
    still: Array
    axes: Array
    one: Poses
    other: Poses
    turn: Index


@kernel
def limited(v: Vec3, most: float) -> Vec3:
    """v, shortened to at most `most`."""
    length = norm(v)
    return v if length <= most else scale(v, most / length)


@kernel
def turn_of(before: Columns, now: Columns) -> Vec3:
    """Rotation vector, in world axes, that takes one orientation to another: log(now before^T)."""
    inverse = (
        (before[0][0], before[1][0], before[2][0]),
        (before[0][1], before[1][1], before[2][1]),
        (before[0][2], before[1][2], before[2][2]),
    )
    return rotation_vector((turned(now, inverse[0]), turned(now, inverse[1]), turned(now, inverse[2])))


@kernel
def tracked_velocities(skel: Skeleton, before: Poses, now: Poses, rate: Array, dt: float, velocities_out: Velocities) -> None:
    """Velocity of every link as its tracker moves it, plus that of its root against the tracker."""
    for b in range(skel.first, now.position.shape[0]):
        root = b - skel.first
        while skel.parent[root] >= 0:
            root = skel.parent[root]
        way = sub(row(now.position, b), row(before.position, b))
        put_row(velocities_out.linear, b, add(limited(scale(way, 1.0 / dt), TOP_SPEED), row(rate, root)))
        turn = turn_of(columns(before.rotation, b), columns(now.rotation, b))
        put_row(velocities_out.angular, b, limited(scale(turn, 1.0 / dt), TOP_SPIN))


@kernel
def relax(
    skel: Skeleton, mass: Array, settings: CouplingSettings, dt: float, offset_out: Array, rate_out: Array, root_out: Array
) -> None:
    """Eq. 6 over dt for the offset of every free root, which then displaces its target."""
    for link in range(skel.kind.shape[0]):
        x, v = row(offset_out, link), row(rate_out, link)
        if skel.kind[link] != FREE or (norm(x) == 0.0 and norm(v) == 0.0):
            continue
        x, v = coupled(mass[link], settings.spring, settings.damping, x, v, dt)
        if norm(x) < AT_REST and norm(v) < AT_REST:
            x, v = (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)
        put_row(offset_out, link, x)
        put_row(rate_out, link, v)
        put_row(root_out, link, add(row(root_out, link), x))


@kernel
def give(skel: Skeleton, received: Array, inverse_mass: Array, rate_out: Array) -> None:
    """Impulses on links change the velocity of their root's coupled mass."""
    for link in range(skel.kind.shape[0]):
        root = link
        while skel.parent[root] >= 0:
            root = skel.parent[root]
        b = skel.first + link
        if skel.kind[root] == FREE:
            put_row(rate_out, root, add(row(rate_out, root), scale(row(received, b), inverse_mass[b])))


@kernel
def pull(geo: Geometry, skel: Skeleton, dt: float, target_out: Posture, velocities_out: Velocities, springs_out: Springs) -> None:
    """Let the springs act for dt, displace the target by their offsets and set the velocities of driven bodies."""
    springs_out.turn[0] = 1 - springs_out.turn[0]
    if springs_out.turn[0] == 1:
        before, now = springs_out.one, springs_out.other
    else:
        before, now = springs_out.other, springs_out.one
    forward(geo, skel, target_out, springs_out.still, now, springs_out.axes)
    relax(skel, springs_out.mass, springs_out.settings, dt, springs_out.offset, springs_out.rate, target_out.root)
    tracked_velocities(skel, before, now, springs_out.rate, dt, velocities_out)


def make_springs(skel: Skeleton, dynamics: Dynamics, poses: Poses, settings: CouplingSettings) -> Springs:
    """Springs at rest, for driven bodies that stand at `poses`."""
    links, degrees = len(skel.kind), int(skel.first_dof[-1])
    one, other = (Poses(*(array.copy() for array in poses)) for _ in range(2))
    return Springs(
        settings, np.zeros((links, 3)), np.zeros((links, 3)), 1.0 / dynamics.inverse_mass[skel.first :], np.zeros(degrees),
        np.zeros((degrees, 3)), one, other, np.zeros(1, dtype=np.int64),
    )
