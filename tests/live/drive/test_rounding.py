"""Drags of nearly equal goals end in nearly equal postures."""

import numpy as np
import pytest

from tests.live.drive.stages_driven import driver, ticks

DRAGS = [
    ("gallery", "human/left_hand", (3.0, 1.0, 1.2)), ("gallery", "human/right_hand", (-3.5, -0.4, 0.3)),
    ("gallery", "human/left_foot", (-2.0, 0.3, 0.5)), ("hand", "hand/index3", (0.4, 0.3, 1.3)),
]


def dragged(name: str, handle: str, goal: tuple[float, ...]) -> np.ndarray[tuple[int, ...], np.dtype[np.float64]]:
    """Return the postures of four seconds in which a link is dragged, a row each."""
    one = driver(name)
    one.drag(handle, goal)
    return np.array([np.concatenate([s.positions.ravel(), s.rotations.ravel(), s.angles]) for s in ticks(one, 240)])


@pytest.mark.parametrize(("name", "handle", "goal"), DRAGS)
def test_rounding_of_a_goal_does_not_grow(name: str, handle: str, goal: tuple[float, float, float]) -> None:
    shown, rng = dragged(name, handle, goal), np.random.default_rng(1)
    for size, bound in ((1e-13, 1e-9), (1e-9, 1e-5)):
        moved = np.array(goal) * (1.0 + size * rng.uniform(-1.0, 1.0, 3))
        assert np.abs(dragged(name, handle, tuple(moved.tolist())) - shown).max() < bound
