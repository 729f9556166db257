"""Meshes of files become coarser where they are too fine for a page, and keep their place and their sharp edges."""

import numpy as np
import pytest
import trimesh

from avatarsim.player.simplified import creased, simplified, visual_surfaces
from avatarsim.player.surfaces import Surface
from avatarsim.scene.shape import Box, Piece
from tests.assets.meshes.solids import cube, torus

BALL = trimesh.creation.icosphere(subdivisions=5, radius=0.5)


def test_meshes_that_are_few_enough_stay() -> None:
    meshes = [cube(), torus(around=12, across=8)]
    for found, given in zip(simplified(meshes, 12 + 2 * 12 * 8), meshes, strict=True):
        assert found[0] is given[0] and found[1] is given[1]


@pytest.mark.parametrize("most", [3_000, 300])
def test_fine_meshes_become_coarse_ones_near_their_surface(most: int) -> None:
    shifted: Surface = np.asarray(BALL.vertices) + [100.0, -3.0, 0.2], np.asarray(BALL.faces, dtype=np.int64)
    (ball,) = simplified([shifted], most)
    assert most / 8 < len(ball[1]) <= most
    away = np.abs(np.linalg.norm(ball[0] - [100.0, -3.0, 0.2], axis=1) - 0.5)
    # a cell's vertex is nearest to its planes: off by the arc that it replaces, h^2 / 2r
    assert away.max() < 8.0 / most
    assert trimesh.Trimesh(*ball, process=False).area == pytest.approx(np.pi, rel=0.03)


def test_corners_of_a_fine_box_stay_where_they_are() -> None:
    fine = trimesh.creation.box((1.0, 2.0, 3.0)).subdivide().subdivide().subdivide().subdivide()
    ((points, triangles),) = simplified([(np.asarray(fine.vertices), np.asarray(fine.faces, dtype=np.int64))], 500)
    assert len(triangles) <= 500
    np.testing.assert_allclose(np.ptp(points, axis=0), (1.0, 2.0, 3.0), rtol=0.02)


def test_vertices_are_shared_across_edges_that_look_round_alone() -> None:
    points, triangles = creased(cube())
    assert len(points) == 24 and len(triangles) == 12
    assert {tuple(corner) for corner in points[triangles].reshape(-1, 3)} == {tuple(corner) for corner in cube()[0]}
    assert len(creased((np.asarray(BALL.vertices), np.asarray(BALL.faces)))[0]) == len(BALL.vertices)


def test_named_visuals_are_drawn_as_primitives_and_meshes() -> None:
    box = Piece(Box((1.0, 1.0, 1.0)), (5.0, 0.0, 0.0))
    found = visual_surfaces({"a": (cube(), box), "b": (box,), "c": (cube(),)}, ["a", "b", "other"])
    assert {name: len(triangles) for name, (_, triangles) in found.items()} == {"a": 24, "b": 12}
    assert found["a"][0].max(axis=0) == pytest.approx((5.5, 1.0, 1.0))
