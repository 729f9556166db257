"""Hulls: heights and distances against brute force, the depth of surfaces below them."""

import numpy as np
import pytest

from avatarsim.assets.meshes.hulls import depth_below, hull_of
from avatarsim.assets.meshes.mesh_queries import point_triangle
from avatarsim.errors import InvalidShape
from tests.assets.meshes.solids import channel, cube, ell, torus

CLOUD = np.array([np.array([1.0, 2.0, 0.5]) * p / np.linalg.norm(p) for p in np.random.default_rng(5).normal(size=(200, 3))])


def test_distances_against_every_facet() -> None:
    hull = hull_of(CLOUD, "cloud")
    points = 3.0 * np.random.default_rng(6).normal(size=(20, 3))
    expected = [
        0.0 if hull.heights(p[None])[0] <= 0.0 else min(point_triangle(p[None], f[None])[0] for f in hull.facets) for p in points
    ]
    np.testing.assert_allclose(hull.distances(points), expected, atol=1e-12)


@pytest.mark.parametrize(("soup", "depth"), [(cube(), 0.0), (channel(), 1.0)])
def test_depth_below_the_hull(soup: tuple[np.ndarray, np.ndarray], depth: float) -> None:
    vertices, triangles = soup
    assert depth_below(hull_of(vertices, "x"), vertices[triangles]) == pytest.approx(depth, abs=1e-12)


def test_no_sample_of_a_surface_lies_deeper_than_the_bound() -> None:
    for soup in (ell(), channel(), torus()):
        hull = hull_of(soup[0], "x")
        corners = soup[0][soup[1]]
        samples = np.random.default_rng(0).dirichlet((1.0, 1.0, 1.0), 50) @ corners
        assert -hull.heights(samples.reshape(-1, 3)).min() <= depth_below(hull, corners) + 1e-12


@pytest.mark.parametrize("points", [np.eye(3), np.zeros((9, 3)), np.random.default_rng(0).normal(size=(20, 3)) * [1.0, 1.0, 0.0]])
def test_what_has_no_volume_is_refused(points: np.ndarray) -> None:
    with pytest.raises(InvalidShape, match=r"thickness of plate .*flat mesh has no volume"):
        hull_of(points, "plate")
