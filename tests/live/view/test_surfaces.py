"""Surfaces for the eye: on the shape, closed, and with their fronts outwards."""

import numpy as np
import pytest
import trimesh

from avatarsim.live.view.surfaces import surface
from avatarsim.scene.shape import Box, Capsule, ConvexHull, Ellipsoid, Piece, Shape, Sphere

TURN = (0.5, 0.5, -0.5, 0.5)


@pytest.mark.parametrize(("shape", "volume"), [
    (Sphere(0.5), 4.0 / 3.0 * np.pi * 0.125), (Box((1.0, 2.0, 3.0)), 6.0), (Ellipsoid((1.0, 0.5, 0.2)), 4.0 / 3.0 * np.pi * 0.1),
    (Capsule(0.5, 1.0), np.pi * 0.25 + 4.0 / 3.0 * np.pi * 0.125),
    (ConvexHull(np.array([(0.0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)])), 1.0 / 6.0),
])
def test_surfaces_are_closed_outward_and_of_the_shapes_volume(shape: Shape, volume: float) -> None:
    vertices, faces = surface((Piece(shape, (3.0, -1.0, 2.0), TURN),))
    mesh = trimesh.Trimesh(vertices, faces)
    assert mesh.is_watertight and mesh.volume == pytest.approx(volume, rel=0.06) and mesh.volume > 0.0


def test_pieces_are_one_mesh() -> None:
    vertices, faces = surface((Piece(Sphere(0.1)), Piece(Box((1.0, 1.0, 1.0)), (2.0, 0.0, 0.0))))
    assert faces.max() == len(vertices) - 1 and len(trimesh.Trimesh(vertices, faces).split()) == 2
