"""GJK: exact distances of cores, proofs at the margin, and honesty where it cannot tell."""

from math import inf, sqrt

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from avatarsim.collision.gjk import closest_points, gjk
from avatarsim.collision.status import CONVERGED, NOT_FINITE
from avatarsim.collision.support import gap_along
from tests.collision.solids import (
    NO_SEED,
    SCRATCH,
    as_arrays,
    ball,
    box,
    capsule,
    dumb_core_distance,
    ellipsoid,
    exact_core_depth,
    random_hull,
)

pytestmark = [pytest.mark.nojit, pytest.mark.boundscheck]


def run(a, b, seed=NO_SEED, margin=inf):
    vertices, shapes = as_arrays(a, b)
    status, n, distance, count = gjk(vertices, shapes, 0, 1, seed, margin, SCRATCH)
    return status, np.array(n), distance, count


def test_distance_of_hulls_equals_least_squares_over_all_convex_combinations():
    rng = np.random.default_rng(5)
    apart = 0
    for _ in range(20):
        a = random_hull(rng, 15)
        b = random_hull(rng, 15).moved(Rotation.from_quat(rng.normal(size=4)), rng.normal(size=3))
        status, n, distance, count = run(a, b)
        assert status == CONVERGED
        if exact_core_depth(a, b) > 0.0:
            assert distance == 0.0
            continue
        apart += 1
        assert distance == pytest.approx(dumb_core_distance(a, b), abs=1e-9)
        on_a, on_b = closest_points(count, SCRATCH)
        np.testing.assert_allclose(np.subtract(on_a, on_b), distance * n, atol=1e-12)
    assert apart > 5


def test_the_core_leaves_the_radius_out():
    status, n, distance, _ = run(ball(0.3), capsule(0.2, 1.0).moved(shift=(0.0, 1.0, 0.0)))
    assert (status, distance) == (CONVERGED, 1.0)
    np.testing.assert_allclose(n, (0.0, -1.0, 0.0), atol=1e-15)


def test_any_seed_gives_the_same_distance():
    rng = np.random.default_rng(6)
    a, b = random_hull(rng), random_hull(rng).moved(shift=(1.0, 0.5, 0.2))
    base = run(a, b)
    for seed in rng.normal(size=(10, 3)):
        again = run(a, b, tuple(seed))
        assert again[2] == pytest.approx(base[2], abs=1e-13)
        np.testing.assert_allclose(again[1], base[1], atol=1e-9)


def test_stopping_at_the_margin_returns_a_proof():
    a, b = box(0.5, 0.5, 0.5), box(0.5, 0.5, 0.5).moved(shift=(3.0, 4.0, 1.0))
    vertices, shapes = as_arrays(a, b)
    exact = sqrt(2.0**2 + 3.0**2)
    for margin in (0.0, 1.0, exact - 1e-6):
        status, n, distance, _ = run(a, b, margin=margin)
        assert status == CONVERGED
        assert margin < distance <= exact + 1e-12
        assert gap_along(vertices, shapes, 0, 1, tuple(n)) == pytest.approx(distance, abs=1e-12)
    assert run(a, b, margin=exact + 1e-6)[2] == pytest.approx(exact, abs=1e-12)


def test_overlapping_cores_have_distance_zero_and_no_direction():
    status, n, distance, _ = run(box(0.5, 0.5, 0.5), ellipsoid(0.5, 0.2, 0.3).moved(shift=(0.4, 0.1, 0.0)))
    assert (status, distance) == (CONVERGED, 0.0)
    assert not n.any()


def test_ellipsoid_above_a_floor_in_closed_form():
    turn = Rotation.from_rotvec([0.4, -0.7, 0.2])
    axes = np.array([0.5, 0.3, 0.2])
    # Half height of a turned ellipsoid: |diag(axes) R^T z|.
    half = np.linalg.norm(axes * turn.as_matrix()[2])
    solid = ellipsoid(*axes).moved(turn, (0.1, 0.2, 1.0))
    status, n, distance, _ = run(solid, box(3.0, 3.0, 0.1))
    assert status == CONVERGED
    assert distance == pytest.approx(0.9 - half, abs=1e-12)
    np.testing.assert_allclose(n, (0.0, 0.0, 1.0), atol=1e-6)


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
