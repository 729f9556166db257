"""The exact answers against each other and against closed forms: they decide, so nothing else may."""

import numpy as np
import pytest
from scipy.optimize import nnls
from scipy.spatial.transform import Rotation

from avatarsim.scene.shape import ellipsoid_hull
from reference.judging.minkowski import signed_distance
from reference.judging.segments import point_segment_distance, segment_distance, triangle_distance

CORNERS = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)], dtype=np.float64)


@pytest.mark.parametrize(("shift", "signed"), [
    ((3.0, 0, 0), 1.0), ((2.0, 0, 0), 0.0), ((1.5, 0, 0), -0.5), ((0, 0, 0), -2.0), ((3.0, 3.0, 0), np.sqrt(2.0)),
    ((3.0, 3.0, 3.0), np.sqrt(3.0)), ((1.0, 1.5, 1.25), -0.5),
])
def test_two_cubes(shift, signed):
    assert signed_distance(CORNERS + np.array(shift), 0.0, CORNERS, 0.0) == pytest.approx(signed, abs=1e-14)
    assert signed_distance(CORNERS + np.array(shift), 0.1, CORNERS, 0.2) == pytest.approx(signed - 0.3, abs=1e-14)


@pytest.mark.parametrize(("height", "signed"), [(2.0, 0.8), (1.1, -0.1), (0.5, -0.7), (0.0, -0.9)])
def test_a_ball_and_a_cube(height, signed):
    assert signed_distance(np.array([[0.3, 0.1, height]]), 0.2, CORNERS, 0.0) == pytest.approx(signed, abs=1e-14)


def test_concentric_balls_and_capsules_are_as_deep_as_radii():
    origin, stick = np.zeros((1, 3)), np.array([[0, 0, -1.0], [0, 0, 1.0]])
    assert signed_distance(origin, 0.2, origin, 0.3) == pytest.approx(-0.5)
    assert signed_distance(stick, 0.2, origin, 0.3) == pytest.approx(-0.5)
    assert signed_distance(stick, 0.2, stick, 0.3) == pytest.approx(-0.5)
    assert signed_distance(stick, 0.2, stick + np.array([0.7, 0, 0.5]), 0.3) == pytest.approx(0.2)


def bounds_of_the_gap(a, b):
    """Return the point of the difference nearest to the origin by least distance programming (Lawson and Hanson): how far it is,
    and how far the plane through it is, which no point is below."""
    points = (a[:, None] - b[None]).reshape(-1, 3)
    weights, _ = nnls(np.vstack([points.T, np.ones(len(points))]), np.array([0.0, 0.0, 0.0, 1.0]))
    nearest = points.T @ (weights / weights.sum())
    return (points @ nearest).min() / np.linalg.norm(nearest), np.linalg.norm(nearest)


def test_two_exact_gaps_agree_on_hulls():
    """Depths are compared with all axes of both polytopes in `test_judge_proof.py`."""
    rng = np.random.default_rng(2)
    apart = 0
    for _ in range(60):
        a, b = (ellipsoid_hull(tuple(rng.uniform(0.02, 0.2, 3)), int(rng.integers(8, 52))).vertices for _ in range(2))
        turns = Rotation.random(2, rng=rng).as_matrix()
        a, b = a @ turns[0].T + rng.normal(size=3) * rng.choice([0.01, 0.1, 0.3]), b @ turns[1].T
        whole = signed_distance(a, 0.0, b, 0.0)
        if whole > 0.0:
            apart += 1
            assert bounds_of_the_gap(a, b) == pytest.approx((whole, whole), abs=1e-12)
    assert 10 < apart < 45


def test_segment_distance_is_the_least_over_a_fine_grid():
    rng = np.random.default_rng(4)
    share = np.linspace(0.0, 1.0, 401)[:, None]
    for k in range(40):
        a, b, c, d = rng.normal(size=(4, 3))
        if k % 4 == 0:
            d = c + (b - a) * rng.uniform(-2.0, 2.0)
        if k % 5 == 0:
            b = a
        grid = np.linalg.norm((a + share * (b - a))[:, None] - (c + share * (d - c))[None], axis=-1).min()
        exact = float(segment_distance(a, b, c, d))
        assert grid - 0.02 <= exact <= grid + 1e-12
    assert float(segment_distance(np.zeros(3), np.array([2.0, 0, 0]), np.array([1.0, -1, 0.5]), np.array([1.0, 1, 0.5]))) == 0.5


def test_triangle_distance_is_the_least_over_a_fine_grid():
    rng = np.random.default_rng(6)
    u, v = np.meshgrid(np.linspace(0, 1, 201), np.linspace(0, 1, 201))
    keep = u + v <= 1.0
    u, v = u[keep][:, None], v[keep][:, None]
    for _ in range(40):
        p, a, b, c = rng.normal(size=(4, 3))
        grid = np.linalg.norm(a + u * (b - a) + v * (c - a) - p, axis=1).min()
        assert grid - 0.03 <= float(triangle_distance(p, a, b, c)) <= grid + 1e-12


def test_distance_from_a_segment_that_is_a_point():
    assert float(point_segment_distance(np.array([3.0, 4.0, 0]), np.zeros(3), np.zeros(3))) == 5.0
