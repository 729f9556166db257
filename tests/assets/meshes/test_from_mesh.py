"""`pieces_of_mesh` from the outside: meshes used as they are, decomposed, refused, or cached."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from avatarsim.assets.meshes import convex_pieces as from_mesh
from avatarsim.assets.meshes import pieces_of_mesh
from avatarsim.assets.meshes.convex_pieces import Pieces
from avatarsim.errors import InvalidFile, InvalidInput, InvalidShape, UnknownName
from avatarsim.scene.body import volume
from avatarsim.scene.shape import ConvexHull, ellipsoid_hull
from tests.assets.meshes.solids import Soup, cube, ell, knot, obj_text, surface_points, through, torus

Array = NDArray[np.float64]


def points(found: Pieces, k: int) -> Array:
    shape = found.pieces[k].shape
    assert isinstance(shape, ConvexHull)
    return shape.vertices


def written(path: Path, *soups: Soup) -> Path:
    path.write_text(obj_text(*soups), encoding="utf-8")
    return path


def box(low: tuple[float, float, float], size: tuple[float, float, float]) -> Soup:
    vertices, triangles = cube()
    return vertices * size + low, triangles


class StandIn:
    """Hulls in the place of those of CoACD, and the calls: how many meshes, and whether they are wrapped first."""

    def __init__(self) -> None:
        self.hulls: list[Array] = []
        self.asked: list[tuple[int, bool]] = []

    def __call__(self, meshes: list[object], options: object, remesh: bool, stream: object) -> list[Array]:
        assert self.hulls, "CoACD was called"
        self.asked.append((len(meshes), remesh))
        return self.hulls


@pytest.fixture
def coacd(monkeypatch: pytest.MonkeyPatch) -> StandIn:
    stand_in = StandIn()
    monkeypatch.setattr(from_mesh, "decomposed", stand_in)
    return stand_in


@pytest.mark.usefixtures("coacd")
def test_an_ell_of_two_authored_boxes_stays_two_vertex_by_vertex(tmp_path: Path) -> None:
    boxes = box((0.0, 0.0, 0.0), (3.0, 1.0, 1.0)), box((0.0, 1.0, 0.0), (1.0, 2.0, 1.0))
    found = pieces_of_mesh(written(tmp_path / "ell.obj", *boxes), scale=0.1)
    assert found.source == "convex groups" and len(found.pieces) == 2 and found.repairs == ()
    for k in range(2):
        np.testing.assert_array_equal(points(found, k), 0.1 * boxes[k][0])
    assert found.hausdorff <= 1e-15


@pytest.mark.usefixtures("coacd")
def test_a_convex_mesh_is_one_piece(tmp_path: Path) -> None:
    found = pieces_of_mesh(written(tmp_path / "cube.obj", cube()))
    assert found.source == "convex mesh" and found.vertices == (8,) and found.hausdorff <= 1e-15
    np.testing.assert_array_equal(points(found, 0), cube()[0])
    turned = pieces_of_mesh(cube(), 2.0, y_up=True)
    np.testing.assert_array_equal(points(turned, 0), 2.0 * cube()[0] @ [[1, 0, 0], [0, 0, 1], [0, -1, 0]])


@pytest.mark.usefixtures("coacd")
def test_too_many_vertices_are_enclosed_within_the_bound() -> None:
    from scipy.spatial import ConvexHull as QuickHull

    round_one = ellipsoid_hull((1.0, 0.7, 0.5), 300).vertices
    hull = QuickHull(round_one)
    facets = round_one[hull.simplices]
    outward = np.where((np.linalg.det(facets) > 0.0)[:, None], hull.simplices, hull.simplices[:, ::-1])
    found = pieces_of_mesh((round_one, outward), most_vertices=40)
    assert found.source == "convex mesh" and found.vertices == (40,)
    assert 0.005 < found.reached <= found.hausdorff < 0.15
    planes = QuickHull(points(found, 0)).equations
    assert (round_one @ planes[:, :3].T + planes[:, 3]).max() <= 1e-14
    closer = pieces_of_mesh((round_one, outward), 2.0, most_vertices=40, fit=0.01)
    assert closer.added <= 0.0101 and closer.vertices[0] > 40


def test_a_mesh_that_is_not_convex_is_decomposed_and_kept(cache_folder: Path) -> None:
    found = pieces_of_mesh(ell(), scale=0.1, quiet=True)
    assert found.source == "decomposed" and len(found.pieces) == 2 and not found.from_cache
    assert sum(volume(piece.shape) for piece in found.pieces) == pytest.approx(5e-3, rel=0.01)
    assert found.reached <= found.hausdorff < 0.006 * found.size
    # the same mesh in another unit is read from the cache, and is the same in its unit
    again = pieces_of_mesh(ell(), scale=1.0)
    assert again.from_cache and again.cache_note.startswith("read from")
    assert again.hausdorff == pytest.approx(10.0 * found.hausdorff)
    for k in range(2):
        np.testing.assert_allclose(points(again, k), 10.0 * points(found, k), rtol=1e-14)
    # a damaged entry is computed anew, to the same bits, with a note
    (entry,) = cache_folder.iterdir()
    whole = entry.read_bytes()
    entry.write_bytes(whole[:-20])
    mended = pieces_of_mesh(ell(), quiet=True)
    assert not mended.from_cache and "damaged" in mended.cache_note
    for k in range(2):
        np.testing.assert_array_equal(points(mended, k), points(again, k))


def test_pieces_hold_the_mesh_within_the_bound() -> None:
    from avatarsim.assets.meshes.hulls import hull_of

    soup = torus(around=16, across=8)
    found = pieces_of_mesh(soup, threshold=0.3, quiet=True, kept=False)
    hulls = [hull_of(points(found, k), "piece") for k in range(len(found.pieces))]
    on_mesh = surface_points(soup, 4000)
    assert np.min([hull.distances(on_mesh) for hull in hulls], axis=0).max() <= found.uncovered + 1e-12
    assert found.cache_note == "not kept: kept=False"
    # the hole is still open
    assert all(hull.heights(np.zeros((1, 3)))[0] > 0.0 for hull in hulls)
    assert found.hausdorff < 0.15 * found.size


@pytest.mark.usefixtures("coacd")
def test_a_hull_may_be_asked_for_even_of_an_open_mesh() -> None:
    vertices, triangles = ell()
    found = pieces_of_mesh((vertices, triangles[1:]), hull=True)
    assert found.source == "hull" and len(found.pieces) == 1
    assert found.repairs == ("the hull closes this: number of border edges of the mesh is 3",)
    assert 1.0 <= found.added <= 1.1 and found.uncovered == 0.0


@pytest.mark.parametrize(("repair", "refused"), [("auto", True), ("refuse", True), ("remesh", False)])
def test_open_meshes_are_refused_unless_wrapped(repair: str, refused: bool, coacd: StandIn) -> None:
    vertices, triangles = ell()
    coacd.hulls = [box((0.0, 0.0, 0.0), (3.0, 1.0, 1.0))[0], box((0.0, 0.0, 0.0), (1.0, 3.0, 1.0))[0]]
    if refused:
        with pytest.raises(InvalidShape, match=r"border edges of the mesh is 3; valid: 0, a closed surface; repair='remesh'"):
            pieces_of_mesh((vertices, triangles[1:]), repair=repair)
    else:
        found = pieces_of_mesh((vertices, triangles[1:]), repair=repair)
        assert found.repairs == ("wrapped in a closed surface: number of border edges of the mesh is 3",)
        assert coacd.asked == [(1, True)]


def test_a_surface_through_itself_is_wrapped_or_refused(coacd: StandIn) -> None:
    vertices, triangles = knot()
    with pytest.raises(InvalidShape, match="go through each other"):
        pieces_of_mesh((vertices, triangles), repair="refuse")
    coacd.hulls = [vertices]
    assert "wrapped in a closed surface" in pieces_of_mesh((vertices, triangles)).repairs[0]
    assert coacd.asked == [(1, True)]


def test_parts_through_one_another_are_decomposed_one_by_one(coacd: StandIn) -> None:
    both = through(ell())
    coacd.hulls = [both[0][:12], both[0][12:]]
    found = pieces_of_mesh(both)
    assert coacd.asked == [(2, False)] and len(found.repairs) == 1 and len(found.pieces) == 2


@pytest.mark.parametrize(("mesh", "match"), [
    ((np.zeros((0, 3)), np.zeros((0, 3))), "number of triangles"),
    ((np.zeros((4, 2)), [[0, 1, 2]]), r"shape of the vertices of a mesh is \(4, 2\)"),
    ((cube()[0], [[0, 1, 9]]), "vertex number of a triangle is 9.0; valid: a whole number from 0 to 7"),
    *(((cube()[0] + [0.0, value, 0.0], cube()[1]), "vertex 0 of the mesh") for value in (np.nan, np.inf, -np.inf)),
    ((cube()[0], [[0, 0, 1]]), "three different corners"),
    ((cube()[0] * [1.0, 1.0, 0.0], cube()[1]), "flat mesh has no volume|three different corners|border edges"),
    ((1730.0 * cube()[0], cube()[1]), r"size of the mesh \[m\] at scale 1 .*0\.001 for millimetres"),
    ((1e-6 * cube()[0], cube()[1]), r"size of the mesh \[m\] at scale 1"),
    *((value, "mesh") for value in (4.79, None, (np.zeros((4, 3)),), np.zeros((4, 3)))),
])
def test_what_is_no_body_is_refused(mesh: Any, match: str) -> None:
    with pytest.raises(InvalidShape, match=match):
        pieces_of_mesh(mesh)


@pytest.mark.parametrize(("option", "error", "match"), [
    ({"threshold": 5.0}, InvalidInput, "threshold of the decomposition is 5.0; valid: a finite number from 0.01 to 1"),
    ({"most_vertices": 3}, InvalidInput, "most vertices of a piece is 3; valid: a whole number from 8 to 4096"),
    ({"seed": -1}, InvalidInput, "seed"), ({"scale": 0.0}, InvalidInput, "scale of a mesh is 0"),
    ({"repair": "pray"}, UnknownName, "repair is 'pray'; valid: one of auto, refuse, remesh"),
    ({"hull": (971, 1.6)}, InvalidInput, "True or False"), ({"mesh": "nowhere.obj"}, InvalidFile, r"nowhere\.obj"),
])
def test_options_out_of_range_are_refused(option: dict[str, Any], error: type[InvalidInput], match: str) -> None:
    with pytest.raises(error, match=match):
        pieces_of_mesh(**{"mesh": cube(), **option})
