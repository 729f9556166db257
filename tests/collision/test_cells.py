"""Cells: no pair falls between them, on any level, at any place."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from avatarsim.collision.grid import (
    BEYOND,
    FARTHEST,
    LEVELS,
    boxes_meet,
    first_cell,
    half_cell,
    key_of,
    last_cell,
    level_of,
    place_of,
)

pytestmark = [pytest.mark.nojit, pytest.mark.boundscheck]

PLACE = st.one_of(st.floats(-1e3, 1e3), st.floats(-1e12, 1e12), st.sampled_from([0.0, 0.25, -0.25, 1e5, 2.0**39]))
LENGTH = st.one_of(st.floats(0.0, 10.0), st.floats(0.0, 1e11), st.integers(-30, 38).map(lambda power: 2.0**power))


@given(PLACE, LENGTH, LENGTH, st.sampled_from([-1.0, -0.999999, 0.0, 0.5, 1.0]))
@settings(deadline=None, max_examples=300)
def test_a_search_looks_into_the_cell_of_every_box_that_meets(place: float, mine: float, theirs: float, where: float) -> None:
    """Box 1 begins anywhere from one own length below box 0 up to its end: exactly touching ends are among the cases."""
    other = place + where * (theirs if where < 0.0 else mine)
    boxes = np.array([[place] * 3 + [place + mine] * 3, [other] * 3 + [other + theirs] * 3])
    level = level_of(boxes, 1)
    if level != BEYOND and boxes_meet(boxes, 0, 1):
        cell = half_cell(boxes[1, 0], level) >> 1
        assert first_cell(boxes, 0, 0, level) <= cell <= last_cell(boxes, 0, 0, level)


def test_levels_are_for_lengths_that_grow_fourfold() -> None:
    for k in range(-9, 18):
        box = np.array([[0.0, 0.0, 0.0, 4.0**k, 0.0, 0.0]])
        here = level_of(box, 0)
        # exactly a power of two goes one level up, a hair less does not
        assert level_of(0.99 * box, 0) == here - 1 and level_of(4.0 * box, 0) == here + 1
    assert level_of(np.zeros((1, 6)), 0) == 0
    assert level_of(np.array([[-FARTHEST, 0, 0, 0, 0, 0.0]]), 0) == BEYOND
    assert level_of(np.array([[-0.9 * FARTHEST, 0, 0, 0.9 * FARTHEST, 0, 0.0]]), 0) < LEVELS


def test_keys_tell_neighbours_and_levels_apart() -> None:
    keys = {key_of(x, y, z, level) for x in range(-3, 4) for y in range(-3, 4) for z in range(-3, 4) for level in range(LEVELS)}
    assert len(keys) == 7**3 * LEVELS and min(keys) >= 0
    assert {place_of(key, 64) for key in keys} == set(range(64))
