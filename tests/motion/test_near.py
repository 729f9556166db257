"""Promised boxes hold the motion, and sleepers near it wake."""

import numpy as np

from avatarsim.motion.near import boxes_near, grow, turn_within
from avatarsim.scene.shape import Box
from tests.loops.upper_world import GRAVITY, World, ball, slab, thing


def test_a_grown_box_holds_the_whole_flight() -> None:
    """Tumbling boxes sampled along their frame never leave it."""
    rng = np.random.default_rng(5)
    for scale in (0.1, 3.0, 100.0):
        velocity, spin = tuple(rng.normal(size=3)), tuple(scale * rng.normal(size=3))
        body = thing("box", Box((0.1, 0.2, 0.5)), (0.0, 0.0, 9.0), velocity=velocity, angular_velocity=spin)
        world = World([body])
        box, t = np.zeros((1, 6)), 1.0 / 30.0
        turn = turn_within(float(np.linalg.norm(spin)), t)
        poses = world.poses
        grow(poses.hulls, poses.position, world.memory.span, 0, world.velocities.linear, np.array(GRAVITY), turn, t, box)
        for _ in range(40):
            assert world.frame(t / 40) == 0
            assert np.all(world.poses.hulls[0, :3] >= box[0, :3]) and np.all(world.poses.hulls[0, 3:] <= box[0, 3:])


def test_boxes_near_is_symmetric_and_has_a_margin() -> None:
    a = np.array([[0.0, 0.0, 0.0, 1.0, 1.0, 1.0], [1.00005, 0.0, 0.0, 2.0, 1.0, 1.0], [1.2, 0.0, 0.0, 2.0, 1.0, 1.0]])
    assert boxes_near(a, a, 0, 1) and boxes_near(a, a, 1, 0)
    assert not boxes_near(a, a, 0, 2)


def test_a_sleeper_wakes_when_a_moving_body_comes_near_and_not_before() -> None:
    resting = ball("resting", (0.0, 0.0, 0.1 + 2e-8))
    world = World([slab(), resting, ball("flier", (2.0, 0.0, 0.1 + 2e-8), velocity=(-3.0, 0.0, 0.0))], 1.0)
    world.run(0.1)
    assert world.memory.asleep[1] == 1
    world.run(0.9)
    assert world.velocities.linear[1, 0] < -2.9
