"""Farthest corners of a box against all of them."""

import numpy as np
import pytest

from avatarsim.collision.support import foremost
from avatarsim.model.geometry import geometry, poses
from avatarsim.scene.body import ContactLaw, PairTable, fixed
from avatarsim.scene.scene import Scene
from avatarsim.scene.shape import Box, Piece


@pytest.mark.nojit
@pytest.mark.boundscheck
@pytest.mark.parametrize(("toward", "count"), [((0.0, 0.0, 1.0), 4), ((1.0, 1.0, 0.0), 2), ((1.0, 0.5, 0.25), 1)])
def test_a_face_an_edge_and_a_corner(toward: tuple[float, float, float], count: int) -> None:
    body = fixed("box", (Piece(Box((1.0, 1.0, 1.0))),), "m")
    geo = geometry(Scene("a box", (body,), materials=PairTable({("m", "m"): ContactLaw(0.0, 0.0)})))
    vertices = poses(geo, np.zeros((1, 3)), np.array([[1.0, 0.0, 0.0, 0.0]])).vertices
    first, last = geo.shapes.start[0], geo.shapes.start[1]
    ahead = vertices[first:last, :3] @ np.array(toward)
    farthest = np.flatnonzero(ahead >= ahead.max() - 1e-9)
    found, second, one = foremost(vertices, geo.shapes, 0, toward, 1e-9)
    assert found == count == len(farthest)
    np.testing.assert_array_equal(one if count > 1 else second, vertices[first + farthest[0], :3])
    if count > 1:
        np.testing.assert_array_equal(second, vertices[first + farthest[1], :3])
    else:
        assert one == (0.0, 0.0, 0.0)
