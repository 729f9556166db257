"""GJK and the closest points of its simplices, against brute-force twins: exact distances, proofs, and statuses."""

from itertools import combinations
from math import inf

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from avatarsim.collision.gjk import (
    closest_on_segment,
    closest_on_tetrahedron,
    closest_on_triangle,
    gjk,
    upright,
)
from avatarsim.collision.status import NOT_FINITE
from tests.collision.solids import (
    NO_SEED,
    SCRATCH,
    as_arrays,
    ball,
    box,
    ellipsoid,
)

pytestmark = [pytest.mark.nojit, pytest.mark.boundscheck]


@pytest.mark.parametrize("bad", [np.nan, np.inf])
def test_a_body_that_is_not_finite_is_a_status(bad):
    for axis in range(3):
        for a, b in ((box(0.1, 0.1, 0.1), ball(0.2)), (ellipsoid(0.1, 0.1, 0.1), ball(0.2))):
            vertices, shapes = as_arrays(a, b)
            # A bad position reaches every point of a body, but only the centre of an ellipsoid.
            vertices[: 8 if len(a.rows) == 8 else 1, axis] = bad
            for margin in (inf, 0.0):
                for first, second in ((0, 1), (1, 0)):
                    with np.errstate(invalid="ignore"):
                        status = gjk(vertices, shapes, first, second, NO_SEED, margin, SCRATCH)[0]
                    assert status == NOT_FINITE


grid = st.integers(-3, 3).map(lambda k: k / 2.0)
fine = st.floats(-1.0, 1.0, allow_subnormal=False)
point = st.one_of(st.tuples(grid, grid, grid), st.tuples(fine, fine, fine))


def dumb_distance(*corners):
    """Return the smallest distance from the origin over every sub-simplex whose own affine minimum lies inside it."""
    found = []
    for count in range(1, len(corners) + 1):
        for some in combinations(np.array(corners, float), count):
            edges = np.array([c - some[0] for c in some[1:]]).T.reshape(3, -1)
            share = np.linalg.lstsq(edges, -some[0], rcond=1e-12)[0] if count > 1 else np.zeros(0)
            if (share >= -1e-12).all() and share.sum() <= 1.0 + 1e-12:
                found.append(np.linalg.norm(some[0] + edges @ share))
    return min(found)


def check(corners, p, share):
    assert min(share) >= 0.0
    assert sum(share) == pytest.approx(1.0, abs=1e-12)
    np.testing.assert_allclose(np.array(share) @ np.array(corners), p, atol=1e-9)
    assert np.linalg.norm(p) == pytest.approx(dumb_distance(*corners), abs=1e-9)


@given(point, point)
@settings(deadline=None)
def test_segment(a, b):
    check((a, b), *closest_on_segment(a, b))


@given(point, point, point)
@settings(max_examples=150, deadline=None)
def test_triangle(a, b, c):
    check((a, b, c), *closest_on_triangle(a, b, c))


@given(point, point, point, point)
@settings(max_examples=150, deadline=None)
def test_tetrahedron(a, b, c, d):
    inside, p, share = closest_on_tetrahedron(a, b, c, d)
    check((a, b, c, d), p, share)
    if inside:
        assert min(share) > 0.0


def test_the_direction_is_right_far_below_rounding():
    height = 1e-14
    p, _ = closest_on_triangle((1.0, 0.3, height), (-0.7, 0.9, height), (-0.1, -1.0, height))
    assert p == pytest.approx((0.0, 0.0, height), rel=1e-6)
    p, _ = closest_on_segment((1.0, 0.0, height), (-0.7, 0.0, height))
    assert p == pytest.approx((0.0, 0.0, height), rel=1e-6)


@pytest.mark.parametrize("exponent", range(-14, 0))
def test_thin_triangles_prove_their_distance_by_its_direction(exponent):
    rng = np.random.default_rng(5)
    for k in range(60):
        a, u = rng.normal(size=3), rng.normal(size=3)
        v = rng.uniform(-1.0, 1.0) * u + 10.0**exponent * rng.normal(size=3)
        # Some with the origin's foot inside, at a distance far above the triangle's width or far below it.
        normal = np.cross(u, v) / np.linalg.norm(np.cross(u, v))
        a = a if k % 3 == 0 else -0.3 * u - 0.3 * v + normal * 10.0 ** rng.uniform(-8, 0)
        corners = [a, a + u, a + v][k % 3 :] + [a, a + u, a + v][: k % 3]
        p, share = closest_on_triangle(*(tuple(corner.tolist()) for corner in corners))
        assert min(share) >= 0.0
        np.testing.assert_allclose(np.array(share) @ np.array(corners), p, atol=2e-14)
        # Below: no corner is nearer along p; above: p is a point of the triangle.
        length = np.linalg.norm(p)
        assert min(np.array(corners) @ p) / length >= length - 2e-14


def test_a_normal_is_at_right_angles_to_nearly_parallel_edges():
    rng = np.random.default_rng(6)
    for exponent in range(-14, 0):
        u = rng.normal(size=3)
        v = 0.3 * u + 10.0**exponent * rng.normal(size=3)
        for first, second in ((u, v), (v, u)):
            n = np.array(upright(tuple(first.tolist()), tuple(second.tolist())))
            n /= np.linalg.norm(n)
            assert abs(n @ u) < 2e-15 and abs(n @ v) < 2e-15
            assert n @ np.cross(first, second) > 0.0
