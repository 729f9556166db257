"""Motion of contacts of smooth surfaces: against the same query a moment before and after."""

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from avatarsim.collision.signed_distance import signed_distance
from avatarsim.model.geometry import place
from avatarsim.rigid.contact_generation import FOUND, find_contacts
from avatarsim.rigid.contacts import SHARP, TWO_BALLS
from avatarsim.rigid.rolling import curvature
from avatarsim.scene.shape import Box, Capsule, ConvexHull, Ellipsoid, Shape, Sphere
from tests.collision.solids import SCRATCH
from tests.rigid.upper_world import World, thing

Array = NDArray[np.float64]
GAP, MOMENT = 2e-8, 1e-4
"""Gap [m] of the bodies, and time [s] before and after."""

HULL = ConvexHull(np.array([[0.0, 0.0, 0.12], [0.1, 0.0, -0.1], [-0.08, 0.07, -0.1], [-0.05, -0.1, -0.06]]))
SHAPES: dict[str, Shape] = {
    "ball": Sphere(0.06), "capsule": Capsule(0.05, 0.3), "thin": Capsule(0.02, 0.4), "egg": Ellipsoid((0.1, 0.07, 0.05)),
    "box": Box((0.2, 0.3, 0.1)), "hull": HULL,
}
TRIALS = 30


def asked(world: World, turns: Array, t: float, linear: Array, angular: Array, start: Array) -> tuple[float, Array, Array, Array]:
    """Return (gap, normal, point on A, point on B) t seconds on, with velocities that stay."""
    for b in range(2):
        world.poses.position[b] = start[b] + t * linear[b]
        world.poses.rotation[b] = Rotation.from_rotvec(t * angular[b]).as_matrix() @ turns[b]
        place(world.geometry, world.poses, b)
    found = signed_distance(world.poses.vertices, world.geometry.shapes, 0, 1, (0.0, 0.0, 0.0), SCRATCH)
    return found[1], np.array(found[2]), np.array(found[3]), np.array(found[4])


def laid(world: World, rng: np.random.Generator) -> tuple[Array, Array]:
    """Return (positions, rotations) of two bodies that touch, turned at random; sometimes as they lie."""
    start = np.array([rng.normal(size=3), [0.0, 0.0, 0.0]])
    turns = Rotation.random(2, random_state=rng).as_matrix()
    if rng.random() < 0.5:
        # axes across one another, or a capsule along a face
        turns[0] = turns[1] @ Rotation.from_euler("xyz", rng.choice([0.0, 90.0], 3), degrees=True).as_matrix()
    start[0] /= np.linalg.norm(start[0])
    still = np.zeros((2, 3))
    for _ in range(40):
        gap, n, _, _ = asked(world, turns, 0.0, still, still, start)
        if abs(gap - GAP) < 1e-13:
            break
        start[0] -= (gap - GAP) * n
    return start, turns


@pytest.mark.boundscheck
@pytest.mark.parametrize("other", ["ball", "capsule", "thin", "egg", "box", "hull"])
@pytest.mark.parametrize("one", ["ball", "capsule", "egg"])
def test_point_contacts_move_as_the_next_query_says(one: str, other: str) -> None:
    """Normal, points and the acceleration of the gap, by differences; and both arms lead to one point."""
    rng, tried = np.random.default_rng(7), 0
    for trial in range(TRIALS):
        bodies = [thing("a", SHAPES[one], (0.0, 0.0, 0.0)), thing("b", SHAPES[other], (0.0, 0.0, 0.0))]
        world = World(bodies if trial % 2 else bodies[::-1], gravity=(0.0, 0.0, 0.0))
        start, turns = laid(world, rng)
        _, n, on_a, on_b = asked(world, turns, 0.0, start, start, start)
        linear, angular = rng.normal(size=(2, 3)), 3.0 * rng.normal(size=(2, 3))
        u = linear[0] + np.cross(angular[0], on_a - start[0]) - linear[1] - np.cross(angular[1], on_b - start[1])
        linear[0] -= (u @ n) * n
        world.memory.moving[:] = 1
        world.velocities.linear[:], world.velocities.angular[:] = linear, angular
        outcome, _ = find_contacts(
            world.geometry, world.dynamics, world.poses, world.velocities, np.array([[0, 1]]), world.memory
        )
        contacts = world.memory.contacts
        assert outcome == FOUND and contacts.used[0] >= 1
        if contacts.used[0] > 1:
            continue
        assert contacts.smooth[0] != SHARP
        curvature(contacts, linear, angular)
        before, after = (asked(world, turns, t, linear, angular, start) for t in (-MOMENT, MOMENT))
        bend = (before[0] - 2.0 * GAP + after[0]) / MOMENT**2
        scale = 1.0 + np.abs(bend)
        rates = [(after[i] - before[i]) / (2.0 * MOMENT) for i in range(1, 4)]
        if max(np.linalg.norm(r) for r in rates) > 30.0 or np.linalg.norm(after[1] - 2.0 * n + before[1]) > 1e-4:
            # from an edge to a corner or a face meanwhile
            continue
        tried += 1
        assert contacts.bias_acceleration[0] @ n == pytest.approx(bend, abs=2e-3 * scale)
        across = np.eye(3) - np.outer(n, n)
        slips = [
            linear[0] + np.cross(angular[0], x[2] - start[0] - s * MOMENT * linear[0])
            - linear[1] - np.cross(angular[1], x[3] - start[1] - s * MOMENT * linear[1])
            for s, x in ((-1.0, before), (1.0, after))
        ]
        np.testing.assert_allclose(
            across @ contacts.bias_acceleration[0], across @ (slips[1] - slips[0]) / (2.0 * MOMENT), atol=2e-3 * scale
        )
        if contacts.smooth[0] == TWO_BALLS:
            continue
        np.testing.assert_allclose(contacts.sway_a[0] + linear[0], rates[1], atol=2e-3 * scale)
        np.testing.assert_allclose(contacts.sway_b[0] + linear[1], contacts.sway_a[0] + linear[0], atol=1e-12)
    assert tried >= TRIALS // 3
