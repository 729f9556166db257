"""What is mended and said, and what is refused by name and number."""

import numpy as np
import pytest

from avatarsim.assets.meshes.mesh import Mesh, signed_volume
from avatarsim.assets.meshes.repairs import finite, mended
from avatarsim.errors import InvalidShape
from tests.assets.meshes.solids import Soup, cube, ell, mesh, together, torus


def test_a_sound_mesh_is_left_alone() -> None:
    for soup in (cube(), ell(), torus(), together(cube(), cube(2.0, 3.0))):
        sound = mended(mesh(soup))
        assert sound.repairs == () and sound.faults == () and not sound.separate
        np.testing.assert_array_equal(sound.mesh.triangles, soup[1])


def test_equal_vertices_are_merged_and_said_but_not_for_formats_without_shared_ones() -> None:
    vertices, triangles = cube()
    loose = vertices[triangles].reshape(-1, 3), np.arange(36).reshape(-1, 3)
    sound = mended(mesh(loose))
    assert sound.repairs == ("28 vertices at the place of another were merged with it",) and sound.faults == ()
    silent = Mesh("cube.stl", *loose, np.zeros(12, dtype=np.int64), welded=False)
    assert mended(silent).repairs == () and mended(silent).faults == ()


def test_degenerate_triangles_and_copies_are_dropped() -> None:
    vertices, triangles = cube()
    sound = mended(mesh((vertices, np.concatenate([triangles, [[0, 0, 1], [2, 5, 2]], triangles[3:4, [1, 2, 0]]]))))
    assert sound.repairs == (
        "2 triangles with fewer than three different corners were dropped",
        "1 triangles with the corners of another were dropped",
    )
    np.testing.assert_array_equal(sound.mesh.triangles, triangles)


def test_a_triangle_in_a_line_that_closes_a_seam_stays() -> None:
    vertices, triangles = cube()
    # one edge gets a vertex in its middle on one side only; a triangle without area closes the gap
    a, b, c = triangles[0]
    split = np.concatenate([triangles[1:], [[a, 8, c], [8, b, c], [a, b, 8]]])
    sound = mended(mesh((np.vstack([vertices, 0.5 * (vertices[a] + vertices[b])]), split)))
    assert sound.repairs == () and sound.faults == ()


@pytest.mark.parametrize("turned", [[0], [1, 2, 5], [*range(11)]])
def test_triangles_that_face_another_side_are_turned_over(turned: list[int]) -> None:
    vertices, triangles = cube()
    triangles = triangles.copy()
    triangles[turned] = triangles[turned][:, ::-1]
    sound = mended(mesh((vertices, triangles)))
    assert sound.faults == () and "were turned over" in sound.repairs[0]
    assert signed_volume(sound.mesh.corners) == pytest.approx(1.0)


def test_a_mesh_inside_out_is_turned_and_a_hollow_is_not() -> None:
    vertices, triangles = together(cube(0.0, 3.0), cube(1.0, 2.0))
    hollow = np.concatenate([triangles[:12], triangles[12:, ::-1]])
    assert mended(mesh((vertices, hollow))).repairs == ()
    assert signed_volume(mended(mesh((vertices, hollow))).mesh.corners) == pytest.approx(26.0)
    beside = together(cube(), cube(2.0, 3.0))
    sound = mended(mesh((beside[0], np.concatenate([beside[1][:12], beside[1][12:, ::-1]]))))
    assert sound.repairs == ("1 closed part faced inwards and was turned outwards",)
    assert signed_volume(sound.mesh.corners) == pytest.approx(2.0)


def test_an_open_surface_is_a_fault_with_the_number_of_its_border_edges() -> None:
    vertices, triangles = ell()
    sound = mended(mesh((vertices, triangles[1:]), "ell.obj"))
    assert [(fault.value, fault.open, fault.crossing) for fault in sound.faults] == [(3, True, False)]
    with pytest.raises(InvalidShape, match=r"border edges of ell\.obj is 3; valid: 0, a closed surface; repair='remesh'"):
        sound.refuse()


def test_a_surface_through_itself_is_a_fault() -> None:
    # one vertex of a torus pulled across its hole, through the other side
    vertices, triangles = torus(around=12, across=8)
    vertices = vertices.copy()
    vertices[0] += [-2.2, 0.07, 0.03]
    sound = mended(mesh((vertices, triangles), "knot"))
    assert [(fault.open, fault.crossing) for fault in sound.faults] == [(False, True)]
    assert sound.faults[0].value > 0 and "go through each other" in sound.faults[0].thing


def through() -> Soup:
    vertices, triangles = cube()
    turn = np.array([[0.8, -0.6, 0.0], [0.6, 0.8, 0.0], [0.0, 0.0, 1.0]])
    return together((vertices, triangles), (vertices @ turn.T + [0.3, 0.2, 0.4], triangles))


def test_closed_parts_through_one_another_are_taken_one_by_one() -> None:
    sound = mended(mesh(through()))
    assert sound.separate and sound.faults == ()
    assert sound.repairs == ("2 closed parts go through one another: every part was decomposed by itself",)


@pytest.mark.parametrize("value", [np.nan, np.inf, -np.inf])
def test_a_vertex_that_is_not_finite_is_named(value: float) -> None:
    vertices, triangles = cube()
    vertices = vertices.copy()
    vertices[3, 1] = value
    with pytest.raises(InvalidShape, match="vertex 3 of thing"):
        finite(mesh((vertices, triangles)))


def test_nothing_at_all_is_refused() -> None:
    empty = mesh((np.zeros((0, 3)), np.zeros((0, 3), dtype=np.int64)))
    with pytest.raises(InvalidShape, match="number of triangles of thing is 0"):
        finite(empty)
    with pytest.raises(InvalidShape, match="three different corners"):
        mended(mesh((cube()[0], np.array([[0, 0, 1]]))))
