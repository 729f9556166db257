"""Supports of shapes against numpy's argmax and the ellipsoid's closed form."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from avatarsim.collision.support import farthest, foremost, gap_along, largest, reach, support
from avatarsim.spatial.vec3 import dot
from tests.collision.solids import as_arrays, ball, box, capsule, ellipsoid, random_hull

pytestmark = [pytest.mark.nojit, pytest.mark.boundscheck]


def test_points_support_is_the_farthest_vertex():
    rng = np.random.default_rng(1)
    solids = [random_hull(rng).moved(shift=rng.normal(size=3)) for _ in range(3)]
    vertices, shapes = as_arrays(*solids)
    for s, solid in enumerate(solids):
        for d in rng.normal(size=(20, 3)):
            point, index = support(vertices, shapes, s, tuple(d))
            best = int((solid.rows @ d).argmax())
            assert index == shapes.start[s] + best
            assert point == tuple(solid.rows[best])
            assert reach(vertices, shapes, s, tuple(d)) == pytest.approx((solid.rows @ d).max(), abs=1e-15)


def test_ellipsoid_support_beats_every_sampled_point():
    rng = np.random.default_rng(2)
    turn = Rotation.from_quat(rng.normal(size=4))
    solid = ellipsoid(0.5, 0.2, 0.1).moved(turn, (1.0, -2.0, 3.0))
    vertices, shapes = as_arrays(solid)
    on_ball = rng.normal(size=(500, 3))
    on_ball /= np.linalg.norm(on_ball, axis=1, keepdims=True)
    samples = solid.rows[0] + on_ball @ solid.rows[1:]
    for d in rng.normal(size=(20, 3)):
        point, index = support(vertices, shapes, 0, tuple(d))
        local = np.linalg.solve(solid.rows[1:].T, np.array(point) - solid.rows[0])
        assert index == 0
        assert np.linalg.norm(local) == pytest.approx(1.0, abs=1e-14)
        assert (samples @ d).max() <= np.array(point) @ d + 1e-14
        assert reach(vertices, shapes, 0, tuple(d)) == pytest.approx(np.array(point) @ d, abs=1e-14)


def test_ellipsoid_support_along_zero_is_its_centre():
    vertices, shapes = as_arrays(ellipsoid(0.5, 0.2, 0.1).moved(shift=(1.0, 2.0, 3.0)))
    assert support(vertices, shapes, 0, (0.0, 0.0, 0.0)) == ((1.0, 2.0, 3.0), 0)


def test_gap_along_is_the_signed_gap_of_two_shadows():
    vertices, shapes = as_arrays(ball(0.2).moved(shift=(0.0, 0.0, 1.0)), box(0.5, 0.5, 0.3))
    assert gap_along(vertices, shapes, 0, 1, (0.0, 0.0, 1.0)) == pytest.approx(0.5, abs=1e-15)
    assert gap_along(vertices, shapes, 1, 0, (0.0, 0.0, -1.0)) == pytest.approx(0.5, abs=1e-15)
    assert gap_along(vertices, shapes, 0, 1, (0.0, 0.0, -1.0)) == pytest.approx(-1.5, abs=1e-15)
    assert gap_along(vertices, shapes, 0, 1, (1.0, 0.0, 0.0)) == pytest.approx(-0.7, abs=1e-15)


@pytest.mark.parametrize("axis", [0, 1, 2])
def test_a_nan_in_a_pose_never_proves_separation(axis):
    for solid in (capsule(0.1, 0.3), box(0.1, 0.2, 0.3), ellipsoid(0.3, 0.2, 0.1)):
        shift = np.zeros(3)
        shift[axis] = np.nan
        vertices, shapes = as_arrays(solid.moved(shift=shift), ball(0.1).moved(shift=(9.0, 9.0, 9.0)))
        for n in ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0), (-0.6, 0.0, -0.8)):
            assert not (gap_along(vertices, shapes, 0, 1, n) > 0.0)
            assert not (gap_along(vertices, shapes, 1, 0, n) > 0.0)


@pytest.mark.parametrize("many", [*range(1, 10), 16, 23, 52, 300])
def test_the_lowest_row_of_those_with_the_largest_product(many):
    rng = np.random.default_rng(many)
    rows = rng.normal(size=(many + 9, 3))
    rows[:5], rows[5 + many :] = 1e9, 1e9  # never read
    for k in range(60):
        if k == 30:  # from here on, with ties
            rows[5 : 5 + many] = rows[5 : 5 + many].round()
        d = tuple((rng.normal(size=3) if k % 3 else np.eye(3)[k % 9 // 3]).tolist())
        products = np.array([dot(tuple(x), d) for x in rows[5 : 5 + many].tolist()])
        assert farthest(rows, 5, 5 + many, d) == 5 + int(products.argmax())
        assert largest(rows, 5, 5 + many, d) == products.max()


@pytest.mark.parametrize(("toward", "count"), [((0.0, 0.0, 1.0), 4), ((1.0, 1.0, 0.0), 2), ((1.0, 0.5, 0.25), 1)])
def test_foremost_corners_are_those_of_face_edge_or_corner(toward, count):
    vertices, shapes = as_arrays(box(0.5, 0.5, 0.5))
    ahead = vertices @ np.array(toward)
    corners = vertices[ahead >= ahead.max() - 1e-9]
    found, second, first = foremost(vertices, shapes, 0, toward, 1e-9)
    assert found == count == len(corners)
    if count > 1:
        np.testing.assert_array_equal((first, second), corners[:2])
    else:
        assert second == tuple(corners[0]) and first == (0.0, 0.0, 0.0)


@pytest.mark.parametrize("many", [1, 2, 3, 40])
def test_rows_of_nan(many):
    """Of nothing but these the first is farthest; as the first of sound ones it reaches the largest product."""
    rows = np.full((many, 3), np.nan)
    assert farthest(rows, 0, many, (1.0, 0.0, 0.0)) == 0
    assert farthest(np.ones((many, 3)), 0, many, (np.nan, 0.0, 0.0)) == 0
    rows[1:] = 1.0
    assert np.isnan(largest(rows, 0, many, (1.0, 0.0, 0.0)))


@pytest.mark.parametrize("many", [3, 4, 40])
def test_infinite_rows_are_farthest(many):
    for where in (many - 2, many - 1):
        rows = np.ones((many, 3))
        rows[where, 1] = np.inf
        assert farthest(rows, 0, many, (0.5, 1.0, 0.5)) == where
        assert largest(rows, 0, many, (0.5, 1.0, 0.5)) == np.inf
