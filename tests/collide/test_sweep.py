"""Sweep and prune against its dumb twin."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from avatarsim.collide.status import CONVERGED, NOT_FINITE, OUT_OF_ROOM
from avatarsim.collide.sweep import all_pairs, axis_of_greatest_spread, sweep_and_prune

pytestmark = [pytest.mark.nojit, pytest.mark.boundscheck]


def random_boxes(rng, count, stretch=(1.0, 1.0, 1.0)):
    # On a coarse grid, so that boxes often touch exactly.
    low = rng.integers(0, 20, (count, 3)) * 0.5 * np.array(stretch)
    return np.hstack([low, low + rng.integers(0, 5, (count, 3)) * 0.5])


def both(boxes, allowed, order, cap=500):
    found, dumb = np.full((cap, 2), -1), np.full((cap, 2), -1)
    status, count = sweep_and_prune(boxes, allowed, order, found)
    dumb_status, dumb_count = all_pairs(boxes, allowed, dumb)
    assert (status, count) == (dumb_status, dumb_count)
    return status, count, found, dumb


@given(st.integers(0, 10**6), st.integers(0, 25))
@settings(deadline=None, max_examples=50)
def test_finds_the_pairs_of_the_dumb_twin_frame_after_frame(seed, count):
    rng = np.random.default_rng(seed)
    boxes = random_boxes(rng, count, rng.uniform(0.1, 3.0, 3))
    allowed, order = rng.random((count, count)) < 0.7, np.arange(count)
    for _ in range(4):
        status, pairs, found, dumb = both(boxes, allowed, order)
        assert status == CONVERGED
        assert set(map(tuple, found[:pairs])) == set(map(tuple, dumb[:pairs]))
        assert (found[:pairs, 0] < found[:pairs, 1]).all()
        assert sorted(order) == list(range(count))
        boxes += np.tile(rng.integers(-1, 2, (count, 3)) * 0.5, 2)


def test_sweeps_along_the_axis_on_which_the_boxes_differ_most():
    rng = np.random.default_rng(1)
    for axis in range(3):
        stretch = np.full(3, 0.1)
        stretch[axis] = 5.0
        assert axis_of_greatest_spread(random_boxes(rng, 20, stretch) + 1e6) == axis


def test_too_many_pairs_is_a_status_that_tells_how_many():
    boxes = np.tile([0.0, 0, 0, 1, 1, 1], (5, 1))
    pairs = np.full((3, 2), -1)
    assert sweep_and_prune(boxes, np.ones((5, 5), bool), np.arange(5), pairs) == (OUT_OF_ROOM, 10)
    assert (pairs >= 0).all()
    assert sweep_and_prune(boxes, np.ones((5, 5), bool), np.arange(5), np.zeros((10, 2), np.int64)) == (
        CONVERGED,
        10,
    )


@pytest.mark.parametrize("bad", [np.nan, np.inf])
def test_a_bound_that_is_not_finite_is_a_status_and_not_a_missing_pair(bad):
    boxes = np.tile([0.0, 0, 0, 1, 1, 1], (3, 1))
    for column in range(6):
        broken = boxes.copy()
        broken[1, column] = bad
        with np.errstate(invalid="ignore"):
            status, _ = sweep_and_prune(
                broken, np.ones((3, 3), bool), np.arange(3), np.zeros((9, 2), np.int64)
            )
        assert status == NOT_FINITE
