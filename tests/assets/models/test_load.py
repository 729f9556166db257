"""Contents of one file: the requested avatar, loose and fixed bodies with their masses, rooms from other files."""

from pathlib import Path
from typing import Any

import mujoco
import numpy as np
import pytest
import trimesh

import avatarsim as av
from avatarsim.errors import InvalidFile
from avatarsim.scene.body import Role
from avatarsim.spatial import rotation
from tests.assets.meshes.solids import cube, ell, obj_text
from tests.assets.models.mujoco_twin import Twin, greatest_difference
from tests.assets.models.test_links_of_tree import GEOM, written
from tests.assets.motions.robots import driven
from tests.own_cache import keep_pieces_in

TWO = (
    f'<body name="small"><joint name="a"/>{GEOM}</body><body name="big" pos="1 0 0"><freejoint/>{GEOM}'
    f'<body name="leg" pos="0 0 -1"><joint name="b"/>{GEOM}</body></body>'
)


def test_the_avatar_is_the_tree_of_most_joints_or_that_asked_for(tmp_path: Path) -> None:
    path = written(tmp_path, TWO)
    by_default, asked = av.load_avatar(path), av.load_avatar(path, avatar="small")
    assert by_default.avatar is not None and [link.name for link in by_default.avatar.links] == ["big", "leg"]
    assert by_default.coordinates is not None and by_default.coordinates.width == 8
    (small,) = by_default.bodies
    assert (small.name, small.role) == ("small", Role.FIXED)
    assert asked.avatar is not None and [link.name for link in asked.avatar.links] == ["small"]
    (big,) = asked.bodies
    assert (big.name, big.role, len(big.pieces)) == ("big", Role.SIMULATED, 2)
    np.testing.assert_allclose(big.pieces[1].position, (0.0, 0.0, -1.0))


def test_two_arms_can_be_one_avatar(tmp_path: Path) -> None:
    arm = f'<body name="{{0}}" pos="{{1}} 0 0">{GEOM}' \
          f'<body name="{{0}} arm" pos="0 0.5 0.5"><joint name="{{0}}"/>{GEOM}</body></body>'
    path = written(tmp_path, arm.format("left", -1) + arm.format("right", 1))
    model = av.load_avatar(path, avatar=("left", "right arm"))
    assert model.avatar is not None and model.coordinates is not None and not model.bodies
    assert [link.name for link in model.avatar.links] == ["world", "left", "left arm", "right", "right arm"]
    assert model.coordinates.names == ("left", "right")
    assert greatest_difference(Twin(path), model, 5) <= 1e-12
    assert frozenset(("left arm", "right arm")) not in {frozenset(pair) for pair in model.avatar.ignore}


def test_trees_that_go_apart_are_not_one_avatar(tmp_path: Path) -> None:
    path = written(tmp_path, TWO)
    with pytest.raises(InvalidFile, match=r"trees of the avatar in model\.xml is 'free'; .*root=\"fixed\""):
        av.load_avatar(path, avatar=("small", "big"))
    model = av.load_avatar(path, avatar=("small", "big"), root="fixed")
    assert model.avatar is not None and len(model.avatar.links) == 4


def test_names_are_given_once_each(tmp_path: Path) -> None:
    ball = '<geom size="0.1"/>'
    geoms = f'<geom name="box" size="0.1"/>{ball}<body name="box">{ball}</body><body>{ball}</body>'
    assert [body.name for body in av.load_room(written(tmp_path, geoms)).bodies] == ["box", "world 1", "box 2", "body 2"]


def test_masses_are_mujocos_also_of_bodies_put_together(tmp_path: Path) -> None:
    loose = '<body name="cup" pos="1 2 3" euler="10 20 30"><freejoint/><geom type="box" size="0.1 0.2 0.3" pos="0.1 0 0"/>' \
            '<body pos="0 0.5 0" euler="40 0 0"><geom type="capsule" size="0.1 0.2"/></body></body>'
    ellipsoid = '<geom type="ellipsoid" size="0.1 0.2 0.3" euler="1 2 3" pos="0.2 0 0"/>'
    link = f'<body name="hand"><joint pos="0.1 0.2 0.3"/>{ellipsoid}</body>'
    path = written(tmp_path, link + loose)
    model = av.load_avatar(path, avatar="hand")
    spec = mujoco.MjSpec.from_file(str(path))
    compiled = spec.compile()
    data = mujoco.MjData(compiled)
    mujoco.mj_forward(compiled, data)
    (cup,) = model.bodies
    assert cup.mass is not None and cup.mass.mass == pytest.approx(compiled.body_subtreemass[2], rel=1e-12)
    where = np.array(cup.position) + rotation.rotate(cup.orientation, cup.mass.centre)
    np.testing.assert_allclose(where, data.subtree_com[2], atol=1e-12)
    # the inertia about the body's own origin, as MuJoCo sums it over the tree (spatial inertia about the centre of mass)
    turn = rotation.to_matrix(cup.orientation)
    ours = turn @ cup.mass.inertia @ turn.T
    x, y, z, xy, xz, yz = np.asarray(data.crb[2])[:6]
    theirs = np.array([[x, xy, xz], [xy, y, yz], [xz, yz, z]])
    np.testing.assert_allclose(ours, theirs, rtol=1e-9, atol=1e-9)
    hand = driven(model).avatar.links[0].mass
    np.testing.assert_allclose(hand.centre, compiled.body_ipos[1] - np.array([0.1, 0.2, 0.3]), atol=1e-12)
    np.testing.assert_allclose(np.linalg.eigvalsh(hand.inertia), np.sort(compiled.body_inertia[1]), rtol=1e-9)


def test_links_without_mass_get_that_of_water_or_a_gram(tmp_path: Path) -> None:
    body = f'<body name="a"><joint/>{GEOM}<body name="frame"><geom size="0.1" mass="0"/><body name="mount"/></body></body>'
    model = driven(av.load_avatar(written(tmp_path, body)))
    assert model.avatar.links[1].mass.mass == pytest.approx(1000.0 * 4.0 / 3.0 * np.pi * 1e-3)
    assert model.avatar.links[2].mass.mass == 1e-3


ROD = '<inertial><mass value="{}"/><inertia ixx="{}" iyy="{}" izz="{}" ixy="{}" ixz="0" iyz="0"/></inertial>'


@pytest.mark.parametrize("numbers", [
    (1, 1, 1, 5, 0), (1, 0, 0, 0, 0), (2, 0, 1, 1, 0), (1, 1, 1, 1, 1), (0, 0, 0, 0, 0), (1e-3, 1e-9, 0, 1e-9, 0),
])
def test_moments_that_no_solid_has_are_raised(numbers: tuple[float, ...], tmp_path: Path) -> None:
    ball = '<collision><geometry><sphere radius="0.1"/></geometry></collision>'
    joint = '<joint name="j" type="continuous"><parent link="a"/><child link="b"/><axis xyz="0 0 1"/></joint>'
    text = f'<robot name="r"><link name="a">{ball}</link><link name="b">{ROD.format(*numbers)}{ball}</link>{joint}</robot>'
    (tmp_path / "r.urdf").write_text(text)
    model = av.load_avatar(tmp_path / "r.urdf")
    assert model.avatar is not None and model.notes
    mass = model.avatar.links[1].mass
    assert mass.mass == pytest.approx(numbers[0] or 1000.0 * 4.0 / 3.0 * np.pi * 1e-3)
    moments = np.linalg.eigvalsh(mass.inertia)
    assert 0.0 < moments[0] and moments[2] <= (moments[0] + moments[1]) * (1.0 + 1e-9)


def test_rooms_from_meshes_and_the_word_floor(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    keep_pieces_in(tmp_path / "cache", monkeypatch)
    (tmp_path / "ell.obj").write_text(obj_text(ell()))
    room = av.load_room(tmp_path / "ell.obj", scale=0.5)
    (body,) = room.bodies
    assert body.name == "ell" and body.role is Role.FIXED and len(body.pieces) >= 2
    ((vertices, triangles),) = dict[str, Any](room.visuals)["ell"]
    assert vertices.max() == 1.5 and len(triangles) == len(ell()[1])
    for ending in ("stl", "ply", "glb"):
        path = tmp_path / f"cube.{ending}"
        trimesh.Trimesh(*cube(), process=False).export(path)
        assert len(av.load_room(path).bodies[0].pieces) == 1
    (floor,) = av.load_room("floor").bodies
    piece = floor.pieces[0]
    assert isinstance(piece.shape, av.Box) and piece.position[2] + 0.5 * piece.shape.size[2] == 0.0


@pytest.mark.parametrize(("name", "said"), [
    ("a.pkl", r"format of a\.pkl is '\.pkl'; valid: .*a pickle runs code"), ("a.usd", "export an MJCF or URDF"),
    ("a.xacro", "xacro robot.urdf.xacro > robot.urdf"), ("a.txt", r"one of \.xml \.mjcf \.urdf"), ("a", r"one of \.xml"),
    ("gone.xml", r"model gone\.xml is 'No such file or directory'"),
])
def test_other_formats_are_refused_with_what_to_do(name: str, said: str, tmp_path: Path) -> None:
    if name != "gone.xml":
        (tmp_path / name).write_bytes(b"some")
    for load in (av.load_avatar, av.load_room):
        with pytest.raises(InvalidFile, match=said):
            load(tmp_path / name)


def test_includes_and_folders_of_meshes_are_found_as_mujoco_does(tmp_path: Path) -> None:
    (tmp_path / "parts").mkdir()
    (tmp_path / "meshes").mkdir()
    (tmp_path / "meshes" / "cube.obj").write_text(obj_text(cube()))
    (tmp_path / "parts" / "asset.xml").write_text('<mujoco><asset><mesh name="cube" file="cube.obj"/></asset></mujoco>')
    (tmp_path / "parts" / "all.xml").write_text('<mujoco><include file="asset.xml"/></mujoco>')
    leg = f'<body name="leg"><joint name="knee"/>{GEOM}</body>'
    (tmp_path / "parts" / "leg.xml").write_text(f"<mujoco><worldbody>{leg}</worldbody></mujoco>")
    head = '<compiler meshdir="meshes"/><include file="parts/all.xml"/><asset><model name="leg" file="parts/leg.xml"/></asset>'
    attached = '<attach model="leg" body="leg" prefix="left_"/>'
    body = f'<body name="hip"><joint name="hip"/><geom type="mesh" mesh="cube"/>{attached}</body>'
    model = av.load_avatar(written(tmp_path, body, head=head))
    assert model.avatar is not None and [link.name for link in model.avatar.links] == ["hip", "left_leg"]


def test_meshes_beside_a_sibling_include_are_found(tmp_path: Path) -> None:
    for name in ("parts/assets", "parts/meshes", "robot"):
        (tmp_path / name).mkdir(parents=True)
    (tmp_path / "parts" / "meshes" / "cube.obj").write_text(obj_text(cube()))
    mesh = '<mujocoinclude><asset><mesh file="../parts/meshes/cube.obj"/></asset></mujocoinclude>'
    (tmp_path / "parts" / "assets" / "cube.xml").write_text(mesh)
    body = '<body name="hip"><joint name="hip"/><geom type="mesh" mesh="cube"/></body>'
    path = written(tmp_path / "robot", body, head='<include file="../parts/assets/cube.xml"/>')
    assert mujoco.MjModel.from_xml_path(str(path)).nmesh == 1
    model = av.load_avatar(path, folder=tmp_path)
    assert model.avatar is not None and len(model.avatar.links[0].pieces) == 1


ROBOT = '<robot name="r"><link name="base"><collision><geometry><mesh filename="{}"/></geometry></collision></link></robot>'


@pytest.mark.parametrize("mesh", ["package://robot/meshes/cube.obj", "package://meshes/cube.obj", "../meshes/cube.obj"])
def test_urdf_finds_meshes_of_its_package(mesh: str, tmp_path: Path) -> None:
    for name in ("robot/urdf", "robot/meshes"):
        (tmp_path / name).mkdir(parents=True)
    (tmp_path / "robot" / "meshes" / "cube.obj").write_text(obj_text(cube()))
    path = tmp_path / "robot" / "urdf" / "robot.urdf"
    path.write_text(ROBOT.format(mesh))
    with pytest.raises(InvalidFile, match=r"mesh cube of robot\.urdf is .*folder="):
        av.load_avatar(path)
    assert av.load_avatar(path, folder=tmp_path / "robot").avatar is not None
    # package.xml marks the extent of a package
    (tmp_path / "robot" / "package.xml").write_text("<package/>")
    assert av.load_avatar(path).avatar is not None
