"""Distances from triangles against a search over a dense grid of each triangle, and bounds against brute force."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from avatarsim.assets.meshes.mesh_queries import Surface, finer, halves, point_triangle
from tests.assets.meshes.solids import ell, torus

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


def test_finer_triangles_are_the_same_surface() -> None:
    vertices, triangles = ell()
    fine = finer(vertices[triangles], 0.2)
    assert np.linalg.norm(fine - fine.mean(axis=1, keepdims=True), axis=2).max() <= 0.2
    area = np.linalg.norm(np.cross(fine[:, 1] - fine[:, 0], fine[:, 2] - fine[:, 0]), axis=1).sum() / 2.0
    assert area == pytest.approx(22.0)
    assert len(halves(fine)) == 2 * len(fine)


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
