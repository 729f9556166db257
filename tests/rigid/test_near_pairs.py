"""Swept boxes contain the motion, and sleeping bodies near it wake."""

import numpy as np

from avatarsim.rigid.near_pairs import MARGIN, NARROW, boxes_near, grow, margin_for, turn_within
from avatarsim.scene.shape import Box
from tests.rigid.upper_world import GRAVITY, World, ball, slab, thing


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
        grow(poses.hulls, poses.position, world.memory.span, 0, world.velocities.linear, np.array(GRAVITY), turn, t, MARGIN, box)
        for _ in range(40):
            assert world.frame(t / 40) == 0
            assert np.all(world.poses.hulls[0, :3] >= box[0, :3]) and np.all(world.poses.hulls[0, 3:] <= box[0, 3:])


def test_boxes_near_is_symmetric_and_has_a_margin() -> None:
    a = np.array([[0.0, 0.0, 0.0, 1.0, 1.0, 1.0], [1.00005, 0.0, 0.0, 2.0, 1.0, 1.0], [1.2, 0.0, 0.0, 2.0, 1.0, 1.0]])
    assert boxes_near(a, a, 0, 1, MARGIN) and boxes_near(a, a, 1, 0, MARGIN)
    assert not boxes_near(a, a, 0, 2, MARGIN)


def test_a_sleeper_wakes_when_a_moving_body_comes_near_and_not_before() -> None:
    resting = ball("resting", (0.0, 0.0, 0.1 + 2e-8))
    world = World([slab(), resting, ball("flier", (2.0, 0.0, 0.1 + 2e-8), velocity=(-3.0, 0.0, 0.0))], 1.0)
    world.run(0.1)
    assert world.memory.asleep[1] == 1
    world.run(0.9)
    assert world.velocities.linear[1, 0] < -2.9


def test_the_margin_follows_small_bodies_where_nobody_is_driven() -> None:
    """From a centimetre on it is what it always was."""
    span, everybody = np.array([0.3, 0.01, 1e-3]), np.ones(3, np.bool_)
    assert margin_for(span[:2], everybody[:2], False) == MARGIN
    assert margin_for(span, everybody, False) == 0.05 * 1e-3
    assert margin_for(span, everybody, True) == MARGIN
    assert margin_for(span, ~everybody, False) == MARGIN
    assert margin_for(np.array([1e-6]), everybody[:1], False) == NARROW


def test_tiny_balls_in_lanes_are_no_island() -> None:
    """Fifty balls of a hundredth of a millimetre, ten radii apart, fly at a wall at once: every frame is done, all come back."""
    wall = slab(size=(1e-2, 1e-2, 1e-3))
    bodies = [ball(f"b{k}", (1e-4 * (k - 25), 0.0, 1e-5 + 1e-6 * k), radius=1e-5, velocity=(0.0, 0.0, -0.01)) for k in range(50)]
    world = World([wall, *bodies], restitution=1.0, gravity=(0.0, 0.0, 0.0))
    world.run(0.1)
    assert np.array_equal(world.velocities.linear[1:, 2], np.full(50, 0.01))
