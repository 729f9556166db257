"""Repairs of meshes: detection of edges, parts and crossings, repaired meshes, and refusals by name and number."""

import numpy as np
import pytest

from avatarsim.assets.meshes import repairs as crossings
from avatarsim.assets.meshes.mesh import Mesh, signed_volume
from avatarsim.assets.meshes.repairs import crossing_pairs, edges_of, mended, to_flip
from tests.assets.meshes.solids import cube, ell, mesh, through, together, torus


def test_a_sound_mesh_is_left_alone() -> None:
    for soup in (cube(), ell(), torus(), together(cube(), cube(2.0, 3.0))):
        assert len(crossing_pairs(*soup)) == 0
        sound = mended(mesh(soup))
        assert sound.repairs == () and sound.faults == () and not sound.separate
        np.testing.assert_array_equal(sound.mesh.triangles, soup[1])


def test_equal_vertices_are_merged_and_reported() -> None:
    """Formats without shared vertices are not reported."""
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


def test_a_moebius_band_has_one_side() -> None:
    n = 7
    band = [t for i in range(n) for t in ((2 * i, 2 * i + 2, 2 * i + 1), (2 * i + 1, 2 * i + 2, 2 * i + 3))]
    # the last two columns are the first two, upside down
    triangles = np.array([[{2 * n: 1, 2 * n + 1: 0}.get(v, v) for v in t] for t in band])
    assert to_flip(len(triangles), edges_of(triangles)) is None


def crossing(*triangles: list[tuple[float, float, float]]) -> int:
    vertices = np.array(triangles, dtype=float).reshape(-1, 3)
    return len(crossing_pairs(vertices, np.arange(len(vertices)).reshape(-1, 3)))


FLAT = [(0.0, 0.0, 0.0), (4.0, 0.0, 0.0), (0.0, 4.0, 0.0)]


def test_through_beside_touching_and_in_one_plane() -> None:
    assert crossing(FLAT, [(1.0, 1.0, -1.0), (1.0, 1.2, 1.0), (1.3, 1.0, 1.0)]) == 1
    assert crossing(FLAT, [(3.0, 3.0, -1.0), (3.0, 3.2, 1.0), (3.3, 3.0, 1.0)]) == 0
    assert crossing(FLAT, [(1.0, 1.0, 0.0), (1.0, 1.2, 1.0), (1.3, 1.0, 1.0)]) == 0
    assert crossing(FLAT, [(1.0, 1.0, 0.0), (1.0, 1.2, 0.0), (1.3, 1.0, 0.0)]) == 0


def test_two_cubes_through_each_other(monkeypatch: pytest.MonkeyPatch) -> None:
    both = through(cube())
    pairs = crossing_pairs(*both)
    assert len(pairs) > 0
    assert (np.sort(pairs, axis=1) // 12 == [0, 1]).all()
    # in small portions the result is the same
    monkeypatch.setattr(crossings, "PAIRS_AT_ONCE", 10)
    assert {tuple(sorted(p)) for p in crossing_pairs(*both).tolist()} == {tuple(sorted(p)) for p in pairs.tolist()}


def test_random_triangles_against_a_system_of_equations_per_edge() -> None:
    rng = np.random.default_rng(3)
    for _ in range(200):
        one, other = rng.normal(size=(2, 3, 3))
        got = crossing(one.tolist(), other.tolist()) == 1
        assert got == (solved(one, other) or solved(other, one))


def solved(one: np.ndarray, other: np.ndarray) -> bool:
    """Return True if an edge of `one` passes the plane of `other` at a point in `other`, by barycentric coordinates."""
    for k in range(3):
        p, q = one[k], one[(k + 1) % 3]
        columns = np.stack([other[1] - other[0], other[2] - other[0], p - q], axis=1)
        u, v, share = np.linalg.solve(columns, p - other[0])
        if u > 0 and v > 0 and u + v < 1 and 0 < share < 1:
            return True
    return False
