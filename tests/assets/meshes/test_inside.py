"""Inside and outside, by formula."""

import numpy as np

from avatarsim.assets.meshes.mesh_queries import inside_closed, inside_open, ragged
from tests.assets.meshes.solids import cube, ell, together, torus

POINTS = np.random.default_rng(0).uniform(-1.5, 3.5, (4000, 3))


def in_ell(points: np.ndarray) -> np.ndarray:
    x, y, z = points.T
    return (z > 0) & (z < 1) & (x > 0) & (y > 0) & (((x < 3) & (y < 1)) | ((x < 1) & (y < 3)))


def test_the_ell_against_its_formula() -> None:
    corners = ell()[0][ell()[1]]
    expected = in_ell(POINTS)
    assert 100 < expected.sum() < 3900
    np.testing.assert_array_equal(inside_closed(POINTS, corners), expected)
    np.testing.assert_array_equal(inside_open(POINTS, corners), expected)


def test_points_over_corners_and_edges_of_a_cube() -> None:
    corners = cube()[0][cube()[1]]
    grid = np.stack(np.meshgrid(*[np.arange(-0.5, 2.0, 0.25)] * 3, indexing="ij"), axis=-1).reshape(-1, 3)
    on = ((grid == 0.0) | (grid == 1.0)).any(axis=1)
    expected = ((grid > 0.0) & (grid < 1.0)).all(axis=1)
    np.testing.assert_array_equal(inside_closed(grid, corners)[~on], expected[~on])


def test_a_grid_in_the_ell_whose_points_see_many_edges() -> None:
    corners = ell()[0][ell()[1]]
    grid = np.stack(np.meshgrid(*[np.arange(-1, 26) / 8.0 + 1.0 / 16.0] * 3, indexing="ij"), axis=-1).reshape(-1, 3)
    np.testing.assert_array_equal(inside_closed(grid, corners), in_ell(grid))


def test_the_hole_of_a_torus_is_outside() -> None:
    corners = torus()[0][torus()[1]]
    assert inside_closed(np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, -1.0, 0.1]]), corners).tolist() == [False, True, True]


def test_a_hollow_is_outside_and_an_overlap_of_two_parts_inside() -> None:
    vertices, triangles = together(cube(0.0, 3.0), cube(1.0, 2.0))
    hollow = np.concatenate([triangles[:12], triangles[12:, ::-1]])
    points = np.array([[0.5, 0.5, 0.5], [1.5, 1.4, 1.3]])
    assert inside_closed(points, vertices[hollow]).tolist() == [True, False]
    assert inside_closed(points, vertices[triangles]).tolist() == [True, True]


def test_a_cube_without_one_triangle_still_has_an_inside() -> None:
    corners = cube()[0][cube()[1]][1:]
    assert inside_open(np.array([[0.5, 0.5, 0.5], [0.5, 0.5, 1.5]]), corners).tolist() == [True, False]


def test_ragged_counts() -> None:
    owner, number = ragged(np.array([2, 0, 3]))
    assert owner.tolist() == [0, 0, 2, 2, 2] and number.tolist() == [0, 1, 0, 1, 2]
