"""The gallery: ten walls that close it, a doorway one can pass, objects that stand in nothing, meshes that are convex."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from scipy.spatial import ConvexHull as QuickHull

from avatarsim.assets.meshes.mesh import groups
from avatarsim.errors import InvalidFile, MissingPackage
from avatarsim.scene.body import Role, solid
from avatarsim.scene.scene import Scene
from avatarsim.scene.shape import ConvexHull, Sphere
from avatarsim.spatial import rotation
from reference.judging.judge import Judge, Verdict
from scenarios import data_folder
from scenarios.building.cases import driven
from scenarios.building.gallery import MESHES, PEDESTALS, convex_pieces, gallery, inside, meshes, walls
from scenarios.data_folder import data_file
from scenarios.motion.mocap import load_clip

SCENE = Scene("probed", gallery(), (driven("probe", Sphere(0.4), 1.0),))
"""The gallery with a ball in it as wide as a person."""
JUDGE = Judge(SCENE)


def probed(x: float, y: float, z: float) -> Verdict:
    """The judge's verdict on the ball at a place in the gallery."""
    positions = np.array([*(body.position for body in SCENE.bodies), (x, y, z)])
    return JUDGE.overlaps(positions, np.array([*(body.orientation for body in SCENE.bodies), rotation.IDENTITY]))


def test_ten_walls_a_floor_and_about_twenty_objects_some_of_them_meshes_of_hundreds_of_triangles() -> None:
    bodies = gallery()
    assert len(walls()) == 10 and 20 <= len(bodies) - 1 - 10 <= 22
    assert all(body.role is Role.FIXED for body in bodies)
    assert {"floor", "table", *MESHES, *PEDESTALS} <= {body.name for body in bodies}
    triangles = [sum(len(t) for _, t in groups(data_file(row[0]))) for row in MESHES.values()]
    assert sum(count >= 200 for count in triangles) >= 5 and max(triangles) < 5000
    assert sum(len(body.pieces) > 1 for body in meshes()) >= 5


@pytest.mark.parametrize("name", sorted(MESHES))
def test_every_piece_of_a_mesh_is_already_convex(name: str) -> None:
    for vertices, triangles in groups(data_file(MESHES[name][0])):
        corners = vertices[triangles] - vertices.mean(axis=0)
        # a closed surface's volume by signed tetrahedra: that of its hull only if the surface is convex
        volume = abs(np.linalg.det(corners).sum()) / 6.0
        assert volume == pytest.approx(QuickHull(vertices).volume, rel=2e-3)


def test_the_doorway_lets_a_person_through_and_the_wall_beside_it_does_not() -> None:
    for x in np.linspace(-1.0, 1.0, 21):
        assert probed(x, 0.0, 1.2).deepest == 0.0
    assert probed(0.0, 1.2, 1.2).deepest > 0.4
    assert probed(0.0, 0.0, 2.3).deepest > 0.1


@pytest.mark.parametrize("turn", np.linspace(0.0, 2.0 * np.pi, 16, endpoint=False))
def test_the_walls_are_closed_all_round(turn: float) -> None:
    d = np.array([np.cos(turn), np.sin(turn)])
    out = min(5.0 / max(abs(d[0]), 1e-9), 3.0 / max(abs(d[1]), 1e-9))
    x, y = out * d
    assert any(name.startswith("wall") for pair in probed(x, y, 2.6).pairs for name in pair[:2])


def test_objects_stand_in_nothing() -> None:
    bodies = tuple(
        body if body.name == "floor" or body.name.startswith("wall")
        else replace(body, role=Role.SIMULATED, mass=solid(body.pieces, 1.0))
        for body in gallery()
    )
    verdict = Judge(Scene("loose", bodies)).overlaps(
        np.array([body.position for body in bodies]), np.array([body.orientation for body in bodies]), 1e-3
    )
    # and they do stand: something is within a millimetre of what carries it
    assert verdict.deepest < 1e-6 and verdict.gap < 1e-3


def test_the_region_ends_inside_the_walls() -> None:
    region = inside("x")
    assert -5.2 < region.low[0] < -5.0 < 5.0 < region.high[0] and region.low[1] < -3.0 < 3.0 < region.high[1] < 3.2


def test_without_the_data_package_it_is_missing_by_name(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(data_folder, "find_spec", lambda name: None)
    for needs_it in (meshes.__wrapped__, lambda: load_clip("walk")):
        with pytest.raises(MissingPackage, match="pybullet_data"):
            needs_it()


CUBE = "\n".join(f"v {x} {y} {z}" for x in (0, 1) for y in (0, 1) for z in (0, 1)) + "\no cube\n"


def test_polygons_and_counting_from_the_end_are_understood(tmp_path: Path) -> None:
    path = tmp_path / "cube.obj"
    path.write_text(CUBE + "f 1/1/1 2 4 3\nf -1 -2 -4 -3\nf 1 2 6 5\n", encoding="utf-8")
    ((vertices, triangles),) = groups(path)
    assert vertices.shape == (8, 3) and triangles.shape == (6, 3)
    (piece,) = convex_pieces(path, 2.0, y_up=False)
    # scaled, its middle over the origin, standing on z = 0
    assert isinstance(piece.shape, ConvexHull)
    assert piece.shape.vertices.min(axis=0).tolist() == [-1.0, -1.0, 0.0]
    assert piece.shape.vertices.max(axis=0).tolist() == [1.0, 1.0, 2.0]


def test_a_file_with_y_up_is_turned(tmp_path: Path) -> None:
    path = tmp_path / "post.obj"
    path.write_text("v 0 0 0\nv 1 0 0\nv 0 0 1\nv 0 5 0\nf 1 2 3\nf 1 2 4\n", encoding="utf-8")
    (piece,) = convex_pieces(path, 1.0, y_up=True)
    assert isinstance(piece.shape, ConvexHull) and piece.shape.vertices[:, 2].max() == 5.0


@pytest.mark.parametrize("text", [None, "v 0 0\n", CUBE, CUBE + "f 1 2 9\n", CUBE + "f 1 2 x\n", CUBE + "f 0 1 2\n"])
def test_a_broken_or_absent_mesh_is_refused_by_name(tmp_path: Path, text: str | None) -> None:
    if text is not None:
        (tmp_path / "broken.obj").write_text(text, encoding="utf-8")
    with pytest.raises(InvalidFile, match=r"broken\.obj"):
        groups(tmp_path / "broken.obj")
    with pytest.raises(InvalidFile, match="no_such_file"):
        data_file("no_such_file.obj")
