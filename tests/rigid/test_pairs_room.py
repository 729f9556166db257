"""More near pairs than there is room for: the horizon is halved, and what has no room in any case waits; nothing overlaps."""

import numpy as np
import pytest

from avatarsim.rigid import state
from avatarsim.rigid.state import OUT_OF_ROOM
from avatarsim.scene.shape import Box
from tests.rigid.upper_world import World, ball, thing

SIDE, RADIUS, SPEED = 4, 0.01, 60.0


@pytest.fixture(autouse=True)
def little_room(monkeypatch):
    """Give worlds room for few pairs of bodies."""
    monkeypatch.setattr(state, "PAIRS_ROOM", 120)
    monkeypatch.setattr(state, "PAIRS_PER_BODY", 1)


def bag_of_balls(seed: int) -> World:
    """Return a lattice of balls, each thrown in a direction of its own: in a frame each could meet each."""
    rng = np.random.default_rng(seed)
    cells = np.stack(np.meshgrid(*[np.arange(SIDE)] * 3), axis=-1).reshape(-1, 3)
    ways = rng.normal(size=(len(cells), 3))
    ways *= SPEED / np.linalg.norm(ways, axis=1, keepdims=True)
    return World(
        [ball(f"ball{k}", 2.2 * RADIUS * cell, RADIUS, 0.01, velocity=tuple(way))
         for k, (cell, way) in enumerate(zip(cells, ways, strict=True))],
        gravity=(0.0, 0.0, 0.0),
    )


@pytest.mark.parametrize("seed", range(4))
def test_balls_with_more_near_pairs_than_room_stay_apart(seed):
    """A horizon that is short enough has room: they fly, and none is in another."""
    world = bag_of_balls(seed)
    for _ in range(6):
        assert world.frame() != OUT_OF_ROOM
        assert world.gap() >= 0.0
    assert np.ptp(world.poses.position, axis=0).min() > 10.0 * SIDE * RADIUS


def test_boards_whose_boxes_always_meet_wait():
    """Slanted boards side by side: at rest their boxes meet already, so no horizon helps, and they keep their places."""
    turn = (np.cos(np.pi / 8), 0.0, np.sin(np.pi / 8), 0.0)
    boards = [thing(f"board{k}", Box((2.0, 2.0, 0.01)), (0.03 * k, 0.0, 0.0), orientation=turn, velocity=(0.0, 0.0, -3.0 * k))
              for k in range(20)]
    world = World(boards)
    before, speed = world.poses.position.copy(), world.velocities.linear.copy()
    assert world.frame() == OUT_OF_ROOM
    np.testing.assert_array_equal(world.poses.position, before)
    np.testing.assert_array_equal(world.velocities.linear, speed)
    assert world.gap() > 0.0
