"""Triangles for drawing close round the volume of the shape, and face outwards."""

import numpy as np
import pytest
import trimesh

from avatarsim.player.surfaces import corners, surface
from avatarsim.scene.shape import Box, Capsule, ConvexHull, Ellipsoid, Piece, Shape, Sphere

GRID = np.stack(np.meshgrid(*[np.linspace(-0.5, 0.5, 7)] * 3), axis=-1).reshape(-1, 3)
TURN = (0.5, 0.5, -0.5, 0.5)
SHAPES: tuple[tuple[Shape, float, float], ...] = (
    (Box((1.0, 2.0, 3.0)), 6.0, 1e-12), (ConvexHull(GRID), 1.0, 1e-12),
    # polyhedra inside round shapes are a little smaller
    (Sphere(0.5), 4.0 / 3.0 * np.pi * 0.125, 0.05), (Ellipsoid((1.0, 0.5, 0.2)), 4.0 / 3.0 * np.pi * 0.1, 0.05),
    (Capsule(0.5, 1.0), np.pi * 0.25 + 4.0 / 3.0 * np.pi * 0.125, 0.05),
)


@pytest.mark.parametrize(("shape", "volume", "less"), SHAPES)
def test_surfaces_are_closed_outward_and_of_the_shapes_volume(shape: Shape, volume: float, less: float) -> None:
    vertices, faces = surface((Piece(shape, (3.0, -1.0, 2.0), TURN),))
    mesh = trimesh.Trimesh(vertices, faces)
    assert mesh.is_watertight and volume * (1.0 - less) - 1e-9 <= mesh.volume <= volume * (1.0 + 1e-9)


def test_pieces_are_one_mesh_where_they_are_put() -> None:
    place = (0.3, -0.2, 0.1)
    vertices, faces = surface((Piece(Box((2.0, 2.0, 2.0)), place, TURN), Piece(Box((1.0, 1.0, 4.0)), place)))
    assert vertices.min(axis=0) == pytest.approx([-0.7, -1.2, -1.9]) and vertices.max(axis=0) == pytest.approx([1.3, 0.8, 2.1])
    assert faces.max() == len(vertices) - 1 and len(faces) == 24
    assert [part.shape for part in surface(())] == [(0, 3), (0, 3)]


def test_large_hulls_are_drawn_by_their_farthest_corners() -> None:
    points = np.random.default_rng(3).normal(size=(4000, 3))
    points /= np.linalg.norm(points, axis=1)[:, None]
    drawn = corners(Piece(ConvexHull(points)), 64)
    assert 40 <= len(drawn) <= 64 and {tuple(one) for one in drawn.tolist()} <= {tuple(one) for one in points.tolist()}
    assert len(corners(Piece(ConvexHull(points)))) == len(points)
