"""The query against closed forms; coincident centres; poses that are no numbers."""

from math import nan

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from avatarsim.collision.signed_distance import signed_distance, signed_distance_up_to
from avatarsim.collision.status import CONVERGED, NOT_FINITE
from avatarsim.collision.support import gap_along
from tests.collision.solids import (
    NO_SEED,
    SCRATCH,
    as_arrays,
    ask,
    ball,
    box,
    capsule,
    ellipsoid,
    random_hull,
)

pytestmark = [pytest.mark.nojit, pytest.mark.boundscheck]

RELATIVE = 1e-9
"""The bar: depth and distance to this fraction of the shape's size."""


@given(st.floats(-3.0, 3.0), st.floats(-3.0, 3.0), st.floats(0.01, 1.0), st.floats(0.01, 1.0))
@settings(deadline=None, max_examples=50)
def test_ball_and_ball(x, y, r, s):
    status, gap, n, on_a, on_b = ask(ball(r).moved(shift=(x, y, 0.3)), ball(s))
    distance = np.sqrt(x * x + y * y + 0.09)
    assert status == CONVERGED
    assert gap == pytest.approx(distance - r - s, abs=1e-12)
    np.testing.assert_allclose(n, np.array([x, y, 0.3]) / distance, atol=1e-12)
    np.testing.assert_allclose(on_b, s * n, atol=1e-12)
    np.testing.assert_allclose(on_a, np.array([x, y, 0.3]) - r * n, atol=1e-12)


@pytest.mark.parametrize("seed", [NO_SEED, (1.0, 2.0, -2.0)])
def test_coincident_centres_give_the_same_finite_unit_normal(seed):
    for a in (ball(0.4), capsule(0.4, 1.0), ellipsoid(0.4, 0.4, 0.4), box(0.4, 0.4, 0.4)):
        first = ask(a, a, seed)
        assert np.linalg.norm(first[2]) == pytest.approx(1.0, abs=1e-12)
        assert first[1] == pytest.approx(-0.8, abs=1e-12)
        np.testing.assert_array_equal(ask(a, a, seed)[2], first[2])
    if any(seed):
        np.testing.assert_allclose(ask(ball(0.4), ball(0.4), seed)[2], np.array(seed) / 3.0, atol=1e-15)


def test_a_nan_pose_is_a_status_and_never_apart():
    vertices, shapes = as_arrays(box(0.1, 0.1, 0.1).moved(shift=(nan, 0.0, 0.0)), ball(0.2))
    status, gap, _, _, _ = signed_distance(vertices, shapes, 0, 1, NO_SEED, SCRATCH)
    assert status == NOT_FINITE
    assert np.isnan(gap)
    assert signed_distance_up_to(vertices, shapes, 0, 1, NO_SEED, 0.0, SCRATCH)[0] == NOT_FINITE


def test_answers_do_not_depend_on_earlier_questions():
    rng = np.random.default_rng(26)
    a, b = random_hull(rng), random_hull(rng).moved(shift=(0.2, 0.1, 0.3))
    vertices, shapes = as_arrays(a, b)
    first = signed_distance(vertices, shapes, 0, 1, NO_SEED, SCRATCH)
    ask(ellipsoid(0.5, 0.5, 0.5), ellipsoid(0.3, 0.3, 0.3))
    assert signed_distance(vertices, shapes, 0, 1, NO_SEED, SCRATCH) == first


def checked_both_ways(a, b):
    """Status, proof along the normal, witness points, and both orders; returns the gap."""
    status, gap, n, on_a, on_b = ask(a, b)
    size = max(a.size, b.size)
    vertices, shapes = as_arrays(a, b)
    assert status == CONVERGED
    assert gap_along(vertices, shapes, 0, 1, tuple(n)) == pytest.approx(gap, abs=RELATIVE * size)
    np.testing.assert_allclose(on_a - on_b, gap * n, atol=RELATIVE * size)
    other = ask(b, a)
    assert other[0] == CONVERGED
    assert other[1] == pytest.approx(gap, abs=RELATIVE * size)
    return gap


@pytest.mark.parametrize("scale", [1e-3, 1.0, 1e3])
@pytest.mark.parametrize("shift", [(0.0, 0.0, 0.0), (1e-10, 2e-10, 0.0), (1e-4, 0.0, 1e-5)])
def test_concentric_and_nearly_so(shift, scale):
    for a, b, depth in (
        (ellipsoid(0.5, 0.5, 0.5), ellipsoid(0.3, 0.3, 0.3), 0.8),
        (ellipsoid(0.5, 0.49, 0.48), ellipsoid(0.3, 0.31, 0.31), 0.79),
        (ellipsoid(0.5, 0.3, 0.2), ellipsoid(0.5, 0.3, 0.2), 0.4),
        (ellipsoid(0.5, 0.4, 0.3), ball(0.1), 0.4),
        (ellipsoid(0.5, 0.5, 0.5), box(0.3, 0.2, 0.1), 0.6),
        (ellipsoid(0.5, 0.5, 0.5), capsule(0.1, 0.2), 0.6),
    ):
        gap = checked_both_ways(a.moved(scale=scale), b.moved(scale=scale, shift=np.array(shift) * scale)) / scale
        assert gap == pytest.approx(-depth, abs=RELATIVE + 2.0 * float(np.linalg.norm(shift)))
