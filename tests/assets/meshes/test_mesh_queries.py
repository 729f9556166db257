"""Inside, outside and distances of meshes: by formula, by a dense grid of each triangle, and bounds by brute force."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from avatarsim.assets.meshes.mesh_queries import Surface, inside_closed, inside_open, point_triangle
from tests.assets.meshes.solids import cube, ell, together, torus


def in_ell(points: np.ndarray) -> np.ndarray:
    x, y, z = points.T
    return (z > 0) & (z < 1) & (x > 0) & (y > 0) & (((x < 3) & (y < 1)) | ((x < 1) & (y < 3)))


def test_the_ell_against_its_formula() -> None:
    """Random points, and a grid whose points see many edges."""
    corners = ell()[0][ell()[1]]
    points = np.random.default_rng(0).uniform(-1.5, 3.5, (4000, 3))
    assert 100 < in_ell(points).sum() < 3900
    np.testing.assert_array_equal(inside_open(points, corners), in_ell(points))
    grid = np.stack(np.meshgrid(*[np.arange(-1, 26) / 8.0 + 1.0 / 16.0] * 3, indexing="ij"), axis=-1).reshape(-1, 3)
    for asked in (points, grid):
        np.testing.assert_array_equal(inside_closed(asked, corners), in_ell(asked))


def test_a_hollow_is_outside_and_an_overlap_of_two_parts_inside() -> None:
    vertices, triangles = together(cube(0.0, 3.0), cube(1.0, 2.0))
    hollow = np.concatenate([triangles[:12], triangles[12:, ::-1]])
    points = np.array([[0.5, 0.5, 0.5], [1.5, 1.4, 1.3]])
    assert inside_closed(points, vertices[hollow]).tolist() == [True, False]
    assert inside_closed(points, vertices[triangles]).tolist() == [True, True]


def test_a_cube_without_one_triangle_still_has_an_inside() -> None:
    corners = cube()[0][cube()[1]][1:]
    assert inside_open(np.array([[0.5, 0.5, 0.5], [0.5, 0.5, 1.5]]), corners).tolist() == [True, False]


WEIGHTS = np.array([(i, j, 60 - i - j) for i in range(61) for j in range(61 - i)]) / 60.0
"""Barycentric coordinates of a fine grid over a triangle."""

numbers = st.floats(-1.0, 1.0)


@given(st.lists(numbers, min_size=12, max_size=12))
def test_distance_from_a_triangle_against_a_grid_of_its_points(values: list[float]) -> None:
    point, corners = np.array(values[:3]), np.array(values[3:]).reshape(3, 3)
    found = float(point_triangle(point[None], corners[None])[0])
    grid = np.linalg.norm(WEIGHTS @ corners - point, axis=1).min()
    longest = np.linalg.norm(corners - np.roll(corners, 1, axis=0), axis=1).max()
    assert found <= grid + 1e-12
    assert found >= grid - longest / 60.0


@pytest.mark.parametrize(
    ("corners", "point", "distance"),
    [
        ([(0, 0, 0), (1, 0, 0), (0, 1, 0)], (0.2, 0.2, 0.7), 0.7),
        ([(0, 0, 0), (1, 0, 0), (0, 1, 0)], (0.5, -0.3, 0.4), 0.5),
        ([(0, 0, 0), (1, 0, 0), (2, 0, 0)], (1.5, 0.0, 0.4), 0.4),
        ([(1, 1, 1), (1, 1, 1), (1, 1, 1)], (1.0, 1.0, 3.0), 2.0),
    ],
)
def test_faces_edges_and_flat_triangles(corners: list[tuple[float, ...]], point: tuple[float, ...], distance: float) -> None:
    assert point_triangle(np.array([point]), np.array([corners], dtype=float))[0] == pytest.approx(distance)


@pytest.mark.parametrize("soup", [ell(), torus()])
def test_the_two_bounds_hold_the_distance_between_them(soup: tuple[np.ndarray, np.ndarray]) -> None:
    corners = soup[0][soup[1]]
    points = np.random.default_rng(0).uniform(-4.0, 4.0, (400, 3))
    # on the axis of the torus every triangle of the inner ring is equally near
    points[:50, :2] = 0.0
    exact = np.array([point_triangle(np.tile(p, (len(corners), 1)), corners).min() for p in points])
    surface = Surface(corners)
    above, below = surface.distances(points, exact)
    assert (above >= exact - 1e-12).all() and (below <= exact + 1e-12).all()
    assert (above - exact).max() < 0.05
    assert surface.exact(points[7]) == pytest.approx(exact[7])
