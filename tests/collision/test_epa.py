"""Depth of cores: flat differences, unfinished polytopes, and the sign where the origin is outside."""

from math import inf

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from avatarsim.collision.epa import epa
from avatarsim.collision.gjk import gjk
from avatarsim.collision.status import CONVERGED, OUT_OF_ITERATIONS
from tests.collision.solids import (
    NO_SEED,
    SCRATCH,
    as_arrays,
    ball,
    box,
    capsule,
    ellipsoid,
    exact_core_depth,
    random_hull,
)

pytestmark = [pytest.mark.nojit, pytest.mark.boundscheck]


def run(a, b, seed=NO_SEED):
    vertices, shapes = as_arrays(a, b)
    _, _, _, count = gjk(vertices, shapes, 0, 1, NO_SEED, inf, SCRATCH)
    return epa(vertices, shapes, 0, 1, seed, count, SCRATCH)


def test_depth_of_boxes_in_closed_form():
    status, m, depth, _, _ = run(box(0.5, 0.5, 0.5), box(0.5, 0.5, 0.5).moved(shift=(0.1, 0.2, 0.7)))
    assert status == CONVERGED
    assert depth == pytest.approx(0.3, abs=1e-15)
    np.testing.assert_allclose(m, (0.0, 0.0, 1.0), atol=1e-15)


def test_an_origin_outside_gets_a_negative_depth_that_proves_it():
    status, m, depth, _, _ = run(box(0.5, 0.5, 0.5), box(0.5, 0.5, 0.5).moved(shift=(0.0, 0.0, 1.25)))
    assert (status, depth) == (CONVERGED, -0.25)
    assert m[2] == 1.0


@pytest.mark.parametrize("seed", [NO_SEED, (0.0, 1.0, 0.3), (1.0, 0.0, 0.0), (0.0, 0.0, -2.0)])
def test_flat_differences_have_depth_zero_across_them(seed):
    turn = Rotation.from_rotvec([0.0, 0.0, 0.7])
    for a, b, directions in (
        (capsule(0.1, 1.0), capsule(0.1, 1.0).moved(turn), [(1, 0, 0), (0, 1, 0)]),
        (capsule(0.1, 1.0), capsule(0.1, 1.0), [(1, 0, 0)]),
        (ball(0.1), ball(0.1), []),
    ):
        status, m, depth, _, faces = run(a, b, seed)
        assert (status, depth, faces) == (CONVERGED, 0.0, 0)
        assert np.linalg.norm(m) == pytest.approx(1.0, abs=1e-14)
        for d in directions:
            assert abs(np.dot(m, d)) < 1e-14
        assert np.dot(m, seed) <= 1e-15


def test_concentric_balls_made_as_ellipsoids_are_beyond_epa_alone_which_says_so():
    status, m, depth, _, _ = run(ellipsoid(0.5, 0.5, 0.5), ellipsoid(0.3, 0.3, 0.3))
    assert status == OUT_OF_ITERATIONS
    assert depth == pytest.approx(0.8, abs=1e-12)
    assert np.linalg.norm(m) == pytest.approx(1.0, abs=1e-14)


def test_deep_hulls_equal_qhull():
    rng = np.random.default_rng(11)
    for _ in range(10):
        turn = Rotation.from_quat(rng.normal(size=4))
        a, b = random_hull(rng, 15), random_hull(rng, 15).moved(turn, rng.normal(size=3) * 0.05)
        status, _, depth, _, _ = run(a, b)
        assert status == CONVERGED
        assert depth == pytest.approx(exact_core_depth(a, b), abs=1e-12)
