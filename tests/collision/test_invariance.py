"""Stratified pairs moved, turned and scaled together: the answer goes with them. (Exchanging a and b: judged.py, every pair.)"""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from avatarsim.collision.scratch import make_scratch
from avatarsim.collision.signed_distance import signed_distance
from avatarsim.collision.status import CONVERGED
from avatarsim.model.geometry import ELLIPSOID
from tests.collision.judged import RELATIVE, ULPS
from tests.collision.strata import BATCH, draw

SCRATCH = make_scratch()
PLACED = ("apart", "shallow", "deep", "concentric", "flush", "grazing")


def one_pair(stratum, number, k):
    """Rows, shapes of a batch and where pair k lies in it."""
    batch = draw(stratum, 3, number)
    return batch.vertices, batch.shapes, 2 * k, 2 * k + 1


def moved(vertices, shapes, a, b, turn, shift, factor):
    """Vertices of the batch with one pair turned, scaled and shifted, and the shapes scaled."""
    rows = vertices.copy()
    for s in (a, b):
        here = slice(shapes.start[s], shapes.start[s + 1])
        rows[here] = turn.apply(rows[here]) * factor
        rows[here if shapes.kind[s] != ELLIPSOID else shapes.start[s]] += shift
    larger = shapes.copy()
    larger.radius *= factor
    larger.extent *= factor
    return rows, larger


def gap_of(vertices, shapes, a, b):
    """Gap and normal; the status has to be CONVERGED."""
    status, gap, n, _, _ = signed_distance(vertices, shapes, a, b, (0.0, 0.0, 0.0), SCRATCH)
    assert status == CONVERGED
    return gap, np.array(n)


@given(
    st.sampled_from(PLACED), st.integers(0, 3), st.integers(0, BATCH - 1), st.integers(0, 2**32 - 1), st.floats(-3.0, 3.0)
)
def test_a_rigid_motion_and_a_scale_change_nothing_but_the_frame(stratum, number, k, seed, exponent):
    vertices, shapes, a, b = one_pair(stratum, number, k)
    rng = np.random.default_rng(seed)
    turn, factor = Rotation.from_quat(rng.normal(size=4)), 10.0**exponent
    shift = rng.normal(size=3) * 10.0 ** rng.uniform(-3.0, 1.0) * factor
    rows, larger = moved(vertices, shapes, a, b, turn, shift, factor)
    here, n = gap_of(vertices, shapes, a, b)
    there, turned = gap_of(rows, larger, a, b)
    size = max(larger.extent[a], larger.extent[b])
    rounding = ULPS * np.spacing(np.abs(rows[larger.start[a] : larger.start[b + 1]]).max())
    # The two answers may each be off by the bar, no more.
    assert abs(there - factor * here) <= 2.0 * RELATIVE * size + rounding
    if here > 0.1 * max(shapes.extent[a], shapes.extent[b]):
        # Apart the direction is unique, and as sure as the square root of the gap's error.
        np.testing.assert_allclose(turned, turn.apply(n), atol=1e-3)


@given(st.sampled_from(PLACED), st.integers(0, 3), st.integers(0, BATCH - 1), st.integers(0, 2**32 - 1))
def test_moving_one_shape_changes_the_gap_by_no_more_than_it_was_moved(stratum, number, k, seed):
    vertices, shapes, a, b = one_pair(stratum, number, k)
    rng = np.random.default_rng(seed)
    size = max(shapes.extent[a], shapes.extent[b])
    step = rng.normal(size=3) * size * 10.0 ** rng.uniform(-9.0, 0.0)
    here, _ = gap_of(vertices, shapes, a, b)
    rows = vertices.copy()
    rows[slice(shapes.start[b], shapes.start[b + 1]) if shapes.kind[b] != ELLIPSOID else shapes.start[b]] += step
    there, _ = gap_of(rows, shapes, a, b)
    assert abs(there - here) <= np.linalg.norm(step) + 2.0 * RELATIVE * size
