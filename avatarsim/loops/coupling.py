"""Where tracker, posture and impacts meet: eq. 6 on the offset that collisions leave between a driven body and its tracker.

In free motion there is no offset and no lag. A collision changes the velocity of the driven body's coupled mass; the
spring brings it back, by the exact solution for any frame time.
"""

import numpy as np
from numpy.typing import NDArray

from avatarsim.impact.coupling import coupled
from avatarsim.kernel import kernel
from avatarsim.posture.kinematics import forward
from avatarsim.settings import CouplingSettings
from avatarsim.spatial.tangent import Columns, columns, rotation_vector, turned
from avatarsim.spatial.vec3 import Vec3, add, norm, put_row, row, scale, sub
from avatarsim.world.dynamics import Velocities
from avatarsim.world.geometry import Poses
from avatarsim.world.skeleton import FREE, Posture, Skeleton
from avatarsim.world.world import World

Array = NDArray[np.float64]

TOP_SPEED = 30.0
"""[m/s] fastest that a driven body hits anything; a tracker that teleports would shoot objects away at any speed."""

TOP_SPIN = 60.0
"""[rad/s] the same for its rotation: ten turns a second."""

AT_REST = 1e-9
"""[m, m/s] offset and rate below this are set to zero, so that a coupling at rest costs and shows nothing."""


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


class Coupling:
    """The springs of all avatars of a world."""

    def __init__(self, world: World, settings: CouplingSettings) -> None:
        self.world, self.settings = world, settings
        links, degrees = len(world.skeleton.kind), int(world.skeleton.first_dof[-1])
        self.offset, self.rate = np.zeros((links, 3)), np.zeros((links, 3))
        self.mass = 1.0 / world.dynamics.inverse_mass[world.skeleton.first :]
        self._still, self._axes = np.zeros(degrees), np.zeros((degrees, 3))
        self._before = Poses(*(array.copy() for array in world.poses))
        self._now = Poses(*(array.copy() for array in world.poses))

    def pull(self, target: Posture, dt: float) -> None:
        """Let the springs act for dt, displace the target by their offsets and set the velocities of driven bodies."""
        world = self.world
        self._before, self._now = self._now, self._before
        forward(world.geometry, world.skeleton, target, self._still, self._now, self._axes)
        relax(world.skeleton, self.mass, self.settings, dt, self.offset, self.rate, target.root)
        tracked_velocities(world.skeleton, self._before, self._now, self.rate, dt, world.velocities)

    def receive(self, impulses: Array) -> None:
        """Take over the impulses (nb, 3) [N s] that driven bodies got in this frame."""
        give(self.world.skeleton, impulses, self.world.dynamics.inverse_mass, self.rate)
