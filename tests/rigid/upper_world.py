"""Small worlds for tests of the upper loop: build bodies, run frames, read energies and gaps."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from itertools import combinations
from typing import Any

import numpy as np
from numpy.typing import NDArray

from avatarsim.collision.conservative_advancement import UNKNOWN, time_of_impact
from avatarsim.collision.scratch import Scratch, make_scratch
from avatarsim.collision.signed_distance import signed_distance
from avatarsim.jit.kernel import kernel
from avatarsim.model.dynamics import dynamics, velocities
from avatarsim.model.geometry import Geometry, Shapes, geometry, may_meet, poses
from avatarsim.rigid.state import Switches, make_events, make_memory
from avatarsim.rigid.step import advance
from avatarsim.scene.avatar import Avatar, rigid_avatar
from avatarsim.scene.body import Body, ContactLaw, PairTable, fixed, simulated, solid
from avatarsim.scene.scene import Scene
from avatarsim.scene.shape import Box, Piece, Shape, Sphere
from avatarsim.spatial.vec3 import Vec3

Array = NDArray[np.float64]
G = 9.81
GRAVITY = (0.0, 0.0, -G)


@kernel
def least_gap(vertices: Array, shapes: Shapes, pairs: NDArray[np.int64], scratch: Scratch) -> float:
    """Return the smallest signed distance [m] of pairs of shapes; inf of none, and nan if there is one."""
    least = np.inf
    for k in range(len(pairs)):
        gap = signed_distance(vertices, shapes, pairs[k, 0], pairs[k, 1], (0.0, 0.0, 0.0), scratch)[1]
        if gap != gap:
            return gap
        least = min(least, gap)
    return least


def wanted_pairs(of: Geometry) -> NDArray[np.int64]:
    """Return pairs of pieces (n, 2) of bodies that must not overlap."""
    body, both = of.body, combinations(range(len(of.body)), 2)
    return np.array(
        [(a, b) for a, b in both if body[a] != body[b] and may_meet(of.wanted, body[a], body[b])], dtype=np.int64
    ).reshape(-1, 2)


def thing(name: str, shape: Shape, position: Iterable[float], mass: float = 1.0, **more: Any) -> Body:
    """Return a simulated body of one shape."""
    pieces, (x, y, z) = (Piece(shape),), position
    return simulated(name, pieces, more.pop("material", "m"), solid(pieces, mass), position=(x, y, z), **more)


def ball(name: str, position: Iterable[float], radius: float = 0.1, mass: float = 1.0, **more: Any) -> Body:
    """Return a simulated sphere."""
    return thing(name, Sphere(radius), position, mass, **more)


def slab(size: Vec3 = (40.0, 40.0, 1.0), **more: Any) -> Body:
    """Return a fixed box whose upper face is at z = 0 by default."""
    more.setdefault("position", (0.0, 0.0, -0.5 * size[2]))
    return fixed("slab", (Piece(Box(size)),), more.pop("material", "m"), **more)


@dataclass
class World:
    """Bodies (and one-link avatars) with one restitution and one friction for all, or a table of pairs."""

    bodies: Sequence[Body]
    restitution: float = 0.5
    friction: float = 0.0
    gravity: tuple[float, float, float] = GRAVITY
    avatars: Sequence[Avatar] = ()
    materials: PairTable | None = None
    gyroscopic: bool = True
    room: int = 64
    impacts: list[tuple[float, tuple[int, int], Array, Array, Array, Array]] = field(default_factory=list)
    """(time, pair, linear before, angular before, linear after, angular after) of every impact so far."""

    def __post_init__(self) -> None:
        table = self.materials or PairTable({("m", "m"): ContactLaw(self.restitution, self.friction)})
        self.scene = Scene("test", tuple(self.bodies), tuple(self.avatars), materials=table, gravity=self.gravity)
        self.geometry, self.dynamics = geometry(self.scene), dynamics(self.scene)
        n = len(self.scene.names)
        position, turn = np.zeros((n, 3)), np.tile([1.0, 0.0, 0.0, 0.0], (n, 1))
        for b, body in enumerate(self.bodies):
            position[b], turn[b] = body.position, body.orientation
        self.poses, self.velocities = poses(self.geometry, position, turn), velocities(self.scene)
        self.memory = make_memory(self.geometry, self.dynamics, self.poses, self.gyroscopic)
        self.events = make_events(n, self.room)
        self.time = 0.0

    def frame(self, dt: float = 1.0 / 60.0, **switches: bool) -> int:
        """Advance one frame, collect its impacts, return the status."""
        status = advance(
            self.geometry, self.dynamics, self.poses, self.velocities, dt, self.memory, self.events,
            Switches(**{"record": True, **switches}),
        )
        e = self.events
        for k in range(0, min(int(e.used[0]), self.room), 2):
            pair = (int(e.pair[k, 0]), int(e.pair[k, 1]))
            states = [x.copy() for x in (e.linear[k], e.angular[k], e.linear[k + 1], e.angular[k + 1])]
            self.impacts.append((self.time + e.time[k], pair, states[0], states[1], states[2], states[3]))
        self.time += dt
        return int(status)

    def run(self, seconds: float, dt: float = 1.0 / 60.0, **switches: bool) -> None:
        """Advance for so many seconds; every frame must succeed."""
        for _ in range(round(seconds / dt)):
            assert self.frame(dt, **switches) == 0

    def energy(self) -> float:
        """Return the kinetic and potential energy [J] of all simulated bodies."""
        total = 0.0
        for b in np.flatnonzero(self.dynamics.role == 1):
            mass, turn = 1.0 / self.dynamics.inverse_mass[b], self.poses.rotation[b]
            v, w = self.velocities.linear[b], turn.T @ self.velocities.angular[b]
            total += 0.5 * mass * v @ v + 0.5 * w @ self.dynamics.inertia[b] @ w
            total -= mass * self.dynamics.gravity @ self.poses.position[b]
        return float(total)

    def angular_momentum(self, b: int) -> Array:
        """Return angular momentum of body b about its centre of mass [kg m^2/s], world axes."""
        turn = self.poses.rotation[b]
        return np.asarray(turn @ self.dynamics.inertia[b] @ turn.T @ self.velocities.angular[b])

    def gap(self) -> float:
        """Return the smallest gap [m] of all pairs of pieces that must not overlap."""
        return float(least_gap(self.poses.vertices, self.geometry.shapes, self.apart, self.scratch))

    @cached_property
    def apart(self) -> NDArray[np.int64]:
        """Pairs of pieces that must not overlap (n, 2)."""
        return wanted_pairs(self.geometry)

    @cached_property
    def scratch(self) -> Scratch:
        """Return the scratch of a query."""
        return make_scratch()


def first_impact(world: World, poses: Any, velocities: Any, begin: float, end: float) -> tuple[int, float, int]:
    """Return (outcome, time [s], rounds) of the search for the first contact of bodies 0 and 1 on the paths in the memory."""
    m = world.memory
    return time_of_impact(
        world.geometry, poses, velocities.linear, velocities.angular, m.paths, m.series, m.reach, 0, 1, begin, end, UNKNOWN, 1.0,
        m.trial, m.a_rows, m.b_rows, m.edges, m.scratch,
    )


def hand(name: str = "hand", size: Vec3 = (0.4, 0.4, 0.1), mass: float = 2.0) -> Avatar:
    """Return a driven box without joints."""
    pieces = (Piece(Box(size)),)
    return rigid_avatar(name, pieces, solid(pieces, mass), material="m")
