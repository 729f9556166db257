"""Conversion of geoms to convex pieces, and the geoms that count."""

from pathlib import Path
from typing import Any

import mujoco
import numpy as np
import pytest

import avatarsim as av
from avatarsim.assets.meshes.hulls import hull_of
from avatarsim.assets.models.model import in_room
from avatarsim.assets.models.pieces_of_geoms import PLANE, SIDES
from avatarsim.errors import InvalidFile
from avatarsim.scene.body import volume
from avatarsim.spatial import rotation
from tests.assets.meshes.solids import Soup, ell, obj_text, torus
from tests.assets.models.test_links_of_tree import written
from tests.own_cache import keep_pieces_in


def room_of(folder: Path, geoms: str, head: str = "", **options: object) -> dict[str, av.Body]:
    """Return the bodies of a room of these geoms, by name."""
    model = av.load_room(written(folder, geoms, head=head), **options)  # type: ignore[arg-type]
    return {body.name: body for body in model.bodies}


SHAPES = {
    'type="sphere" size="0.2"': av.Sphere(0.2),
    'type="capsule" size="0.1 0.3"': av.Capsule(0.1, 0.6),
    'type="capsule" size="0.1" fromto="0 0 0 0 0 1"': av.Capsule(0.1, 1.0),
    'type="box" size="0.1 0.2 0.3"': av.Box((0.2, 0.4, 0.6)),
    'type="ellipsoid" size="0.1 0.2 0.3"': av.Ellipsoid((0.1, 0.2, 0.3)),
}


@pytest.mark.parametrize("geom", SHAPES)
def test_primitives_are_what_they_are(geom: str, tmp_path: Path) -> None:
    body = room_of(tmp_path, f'<geom name="it" {geom}/>')["it"]
    assert [piece.shape for piece in body.pieces] == [SHAPES[geom]]


def test_a_plane_is_a_box_below_it(tmp_path: Path) -> None:
    wall = room_of(tmp_path, '<geom name="wall" type="plane" size="1 1 0.1" pos="2 0 0" zaxis="-1 0 0"/>')["wall"]
    (piece,) = wall.pieces
    assert piece.shape == av.Box(PLANE)
    np.testing.assert_allclose(piece.position, (2.0 + 0.5 * PLANE[2], 0.0, 0.0), atol=1e-12)
    np.testing.assert_allclose(rotation.rotate(piece.orientation, (0.0, 0.0, 1.0)), (-1.0, 0.0, 0.0), atol=1e-12)


OFF = ('pos="0 0 1"', 'pos="248 -90 1"', 'pos="-40 3 1" zaxis="1 0 0"', 'pos="7 150 0" euler="0.3 0.1 2"')


@pytest.mark.parametrize("place", OFF)
@pytest.mark.parametrize("torsos", [((0.0, 0.0),), ((300.0, -20.0),), ((0.0, 0.0), (400.0, 300.0))])
def test_a_plane_is_under_what_moves_wherever_its_centre_is(
    place: str, torsos: tuple[tuple[float, float], ...], tmp_path: Path
) -> None:
    parts = '<joint type="slide"/><geom size="0.1"/>'
    bodies = "".join(f'<body name="torso {k}" pos="{x} {y} 9">{parts}</body>' for k, (x, y) in enumerate(torsos))
    ground = f'<geom name="ground" type="plane" size="250 0.8 0.2" {place}/>'
    path = tmp_path / "walkers.xml"
    path.write_text(f'<mujoco><worldbody><body name="base">{ground}</body>{bodies}</worldbody></mujoco>')
    model = av.load_avatar(path, avatar="torso 0")
    base = next(body for body in model.room if body.name == "base")
    (piece,) = base.pieces
    assert isinstance(piece.shape, av.Box)
    for x, y in torsos:
        off = rotation.rotate(rotation.conjugate(piece.orientation), np.subtract((x, y, 9.0), piece.position))
        assert (np.abs(off[:2]) <= 0.5 * piece.shape.size[0] - 99.0).all(), "with room to walk"


def test_the_floor_of_a_room_carries_an_avatar_at_the_origin(tmp_path: Path) -> None:
    drawer = '<body pos="500 0 1"><joint type="slide"/><geom size="0.1"/></body>'
    ground = room_of(tmp_path, f'<geom name="ground" type="plane" size="1 1 1"/>{drawer}')["ground"]
    (piece,) = ground.pieces
    assert isinstance(piece.shape, av.Box) and abs(piece.position[0]) <= 0.5 * piece.shape.size[0] - 99.0


def test_a_prism_stands_around_its_cylinder(tmp_path: Path) -> None:
    shape = room_of(tmp_path, '<geom name="can" type="cylinder" size="0.3 0.5"/>')["can"].pieces[0].shape
    assert isinstance(shape, av.ConvexHull) and len(shape.vertices) == 2 * SIDES
    # corners outside, middles of the sides on the cylinder
    np.testing.assert_allclose(np.linalg.norm(shape.vertices[:, :2], axis=1) * np.cos(np.pi / SIDES), 0.3)
    np.testing.assert_allclose(np.abs(shape.vertices[:, 2]), 0.5)


def meshed(folder: Path, soup: Soup, placed: str = "", scale: str = "1 1 1") -> Path:
    """Return a model of one mesh called m."""
    (folder / "m.obj").write_text(obj_text(soup))
    head = f'<asset><mesh file="m.obj" scale="{scale}"/></asset>'
    return written(folder, f'<geom name="it" type="mesh" mesh="m" {placed}/>', head=head)


def test_a_mesh_becomes_its_hull_where_mujoco_has_it(tmp_path: Path) -> None:
    (piece,) = av.load_room(meshed(tmp_path, ell(), 'pos="1 2 3" euler="10 20 30"', "2 2 2")).bodies[0].pieces
    assert isinstance(piece.shape, av.ConvexHull)
    corners = rotation.rotate(piece.orientation, piece.shape.vertices) + np.array(piece.position)
    turn = np.zeros(4)
    mujoco.mju_euler2Quat(turn, np.deg2rad([10.0, 20.0, 30.0]), "xyz")
    ours = rotation.rotate(turn, 2.0 * np.asarray(ell()[0], dtype=np.float64)) + np.array([1.0, 2.0, 3.0])
    assert all(np.abs(ours - corner).max(axis=1).min() < 1e-6 for corner in corners)
    assert piece.shape.vertices.shape[0] >= 8


FITS: tuple[dict[str, Any], ...] = ({"most_vertices": 20}, {"most_vertices": 20, "fit": 1e-3}, {"most_vertices": 4096})


def test_a_hull_of_fewer_vertices_holds_the_mesh(tmp_path: Path) -> None:
    path = meshed(tmp_path, torus(around=40, across=20))
    few, closer, whole = (av.load_room(path, **option).bodies[0].pieces[0].shape for option in FITS)
    assert isinstance(few, av.ConvexHull) and isinstance(closer, av.ConvexHull) and isinstance(whole, av.ConvexHull)
    assert len(few.vertices) <= 20 < len(closer.vertices) <= len(whole.vertices)
    assert hull_of(few.vertices, "few").heights(whole.vertices).max() <= 1e-12
    assert hull_of(whole.vertices, "whole").distances(closer.vertices).max() <= 1e-3


@pytest.fixture
def own_cache(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Cache convex pieces in a folder of this test."""
    keep_pieces_in(tmp_path / "cache", monkeypatch)


@pytest.mark.usefixtures("own_cache")
def test_a_mesh_is_decomposed_when_asked(tmp_path: Path) -> None:
    path = meshed(tmp_path, ell())
    pieces, named, whole = (av.load_room(path, meshes=meshes).bodies[0].pieces for meshes in ("decompose", ("m",), "hull"))
    assert len(named) == len(pieces) >= 2
    assert sum(volume(piece.shape) for piece in pieces) < 0.95 * volume(whole[0].shape)


@pytest.mark.usefixtures("own_cache")
def test_an_open_mesh_is_not_decomposed_unless_it_is_wrapped(tmp_path: Path) -> None:
    path = meshed(tmp_path, (ell()[0], ell()[1][1:]))
    with pytest.raises(InvalidFile, match=r"mesh of it: number of border edges .*repair=\"remesh\".*meshes=\"hull\""):
        av.load_room(path, meshes="decompose")
    assert len(av.load_room(path).bodies[0].pieces) == 1


@pytest.mark.parametrize("ending", ["ply", "off", "glb", "stl", "dae"])
def test_meshes_that_mujoco_does_not_read_are_read_for_it(ending: str, tmp_path: Path) -> None:
    import trimesh

    shape = trimesh.Trimesh(*ell(), process=False)
    shape.export(tmp_path / f"ell.{ending}", file_type="stl_ascii" if ending == "stl" else ending)
    head = f'<asset><mesh name="m" file="ell.{ending}"/></asset>'
    body = room_of(tmp_path, '<geom name="it" type="mesh" mesh="m"/>', head)["it"]
    (piece,) = body.pieces
    assert isinstance(piece.shape, av.ConvexHull)
    corners = rotation.rotate(piece.orientation, piece.shape.vertices) + np.array(piece.position)
    np.testing.assert_allclose(corners.min(axis=0), np.asarray(ell()[0]).min(axis=0), atol=1e-6)
    np.testing.assert_allclose(corners.max(axis=0), np.asarray(ell()[0]).max(axis=0), atol=1e-6)


@pytest.mark.parametrize("ending", ["obj", "ply"])
def test_a_mesh_without_thickness_is_a_plate(ending: str, tmp_path: Path) -> None:
    import trimesh

    square = trimesh.Trimesh([[0.0, 0, 0], [0.2, 0, 0], [0.2, 0.1, 0], [0, 0.1, 0]], [[0, 1, 2], [0, 2, 3]], process=False)
    square.export(tmp_path / f"flat.{ending}")
    head = f'<asset><mesh name="m" file="flat.{ending}"/></asset>'
    model = av.load_room(written(tmp_path, '<geom name="it" type="mesh" mesh="m"/>', head=head))
    (piece,) = model.bodies[0].pieces
    assert isinstance(piece.shape, av.ConvexHull)
    corners = rotation.rotate(piece.orientation, piece.shape.vertices) + np.array(piece.position)
    np.testing.assert_allclose(np.ptp(corners, axis=0), [0.2, 0.1, 2e-4], atol=1e-6)
    assert any("m" in note for note in model.notes)


def test_of_a_mesh_in_another_format_the_copy_beside_it_is_taken(tmp_path: Path) -> None:
    path = written(tmp_path, '<geom name="it" type="mesh" mesh="m"/>', head='<asset><mesh name="m" file="ell.wrl"/></asset>')
    with pytest.raises(InvalidFile, match=r"mesh m of model\.xml is 'ell\.wrl'; .*put the copy beside it"):
        av.load_room(path)
    (tmp_path / "ell.obj").write_text(obj_text(ell()))
    assert len(av.load_room(path).bodies[0].pieces) == 1


def test_a_visual_is_left_out_unless_a_pair_names_it(tmp_path: Path) -> None:
    geoms = '<geom name="seen" size="0.1" contype="0" conaffinity="0"/><geom name="felt" size="0.1"/>'
    assert set(room_of(tmp_path, geoms)) == {"felt"}
    body = '<body name="ball"><freejoint/><geom name="b" size="0.1" pos="0 0 1"/></body>'
    path = written(tmp_path, geoms + body, '<contact><pair geom1="seen" geom2="b"/></contact>')
    assert {one.name for one in av.load_room(path).bodies} == {"seen", "felt", "ball"}


def test_height_fields_are_refused_by_name_and_can_be_left_out(tmp_path: Path) -> None:
    head = '<asset><hfield name="hills" nrow="3" ncol="3" size="1 1 1 0.1" elevation="0 0 0 0 1 0 0 0 0"/></asset>'
    path = written(tmp_path, '<geom name="ground" type="hfield" hfield="hills"/><geom name="box" size="0.1"/>', head=head)
    with pytest.raises(InvalidFile, match=r"type of ground is 'hfield'; .*leave=\(\"ground\",\)"):
        av.load_room(path)
    assert [body.name for body in av.load_room(path, leave=("ground",)).bodies] == ["box"]


def test_a_file_in_which_nothing_collides_is_refused(tmp_path: Path) -> None:
    path = written(tmp_path, '<body><joint/><geom size="0.1" contype="0" conaffinity="0"/></body>')
    for load, of in ((av.load_avatar, "avatar model in "), (av.load_room, "")):
        with pytest.raises(InvalidFile, match=rf"shapes of {of}model\.xml that collide is 0; valid: at least 1: <collision>"):
            load(path)


SEEN = """
<body name="arm" pos="0 0 1">
  <joint name="elbow" type="hinge" axis="0 0 1" pos="0.5 0 0"/>
  <geom name="hidden" type="box" size="0.1 0.1 0.1" group="3"/>
  <geom name="seen" type="mesh" mesh="m" contype="0" conaffinity="0" group="2"/>
  <geom name="knob" type="sphere" size="0.2" contype="0" conaffinity="0" group="1"/>
  <body name="bare"><joint axis="1 0 0"/><geom type="capsule" size="0.05 0.1"/></body>
  <body name="cover"><geom type="box" size="0.1 0.2 0.3" contype="0" conaffinity="0" mass="1"/></body>
</body>
<body name="stone" pos="3 0 0"><geom type="mesh" mesh="m" pos="0 0 1"/></body>
"""


def test_visuals_are_the_shown_geoms_in_frames_of_links(tmp_path: Path) -> None:
    (tmp_path / "m.obj").write_text(obj_text(ell()))
    model = av.load_avatar(written(tmp_path, SEEN, head='<asset><mesh file="m.obj"/></asset>'))
    assert model.avatar is not None
    assert set(model.visuals) == {"model/arm", "model/cover", "stone"}
    mesh, knob = model.visuals["model/arm"]
    assert isinstance(mesh, tuple) and isinstance(knob, av.Piece)
    # the link's frame is in the centre of its joint
    assert knob.shape == av.Sphere(0.2) and knob.position == pytest.approx((-0.5, 0.0, 0.0))
    corners = mesh[0][mesh[1]]
    np.testing.assert_allclose(corners.min(axis=(0, 1)), (-0.5, 0.0, 0.0), atol=1e-6)
    np.testing.assert_allclose(corners.max(axis=(0, 1)), (2.5, 3.0, 1.0), atol=1e-6)
    # a mesh that collides is drawn as the mesh, not its hull: the notch of an L stays open
    (stone,) = model.visuals["stone"]
    assert isinstance(stone, tuple) and len(stone[1]) == len(ell()[1])
    pieces = [piece.shape for link in model.avatar.links for piece in link.pieces]
    assert pieces == [av.Box((0.2, 0.2, 0.2)), av.Capsule(0.05, 0.2)]


def test_visuals_of_a_room_keep_to_their_bodies(tmp_path: Path) -> None:
    (tmp_path / "m.obj").write_text(obj_text(ell()))
    head = '<asset><mesh file="m.obj"/></asset>'
    model = av.load_avatar(written(tmp_path, SEEN, head=head))
    both = in_room(model, av.load_room(written(tmp_path, '<body name="stone"><geom type="mesh" mesh="m"/></body>', head=head)))
    assert set(both.visuals) == {*model.visuals, "room_stone"} <= set(both.scene().names)


def test_a_geom_stands_where_the_file_has_it(tmp_path: Path) -> None:
    geom = '<geom type="box" size="0.1 0.2 0.3" pos="0.5 0 0" euler="90 0 0"/>'
    body = f'<body name="shelf" pos="1 2 3" euler="0 0 90">{geom}</body>'
    shelf = room_of(tmp_path, body)["shelf"]
    piece = shelf.pieces[0]
    np.testing.assert_allclose(shelf.position, (1.0, 2.0, 3.0))
    np.testing.assert_allclose(rotation.rotate(shelf.orientation, piece.position), (0.0, 0.5, 0.0), atol=1e-15)
    np.testing.assert_allclose(rotation.rotate(piece.orientation, (0.0, 0.0, 1.0)), (0.0, -1.0, 0.0), atol=1e-15)
