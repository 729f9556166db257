"""Inputs are known by the hash of every file that they were read from: meshes of a model, the skeleton of an AMC file."""

import hashlib
from dataclasses import replace
from pathlib import Path

import pytest

from avatarsim.assets.motions.load import options_of
from avatarsim.clips.inputs import files_of, load_models, motion_files, options_for, skeleton_of
from avatarsim.clips.options import FLOOR, ClipOptions
from avatarsim.clips.reading import Reading
from avatarsim.errors import InvalidFile, UnknownName
from avatarsim.scene.shape import Sphere
from tests.assets.meshes.solids import cube, obj_text
from tests.clips.made import ROBOT, bvh

ASSET = '<compiler meshdir="parts"/><asset><mesh name="tip" file="tip.obj"/></asset><worldbody>'
MESHED = ROBOT.replace("<worldbody>", ASSET).replace("</body>", '<geom type="mesh" mesh="tip" pos="0.6 0 0"/></body>', 1)
URDF = """<robot name="some"><link name="base"><collision><geometry><mesh filename="package://some/tip.obj"/></geometry></collision>
<inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link>
<link name="arm"><inertial><origin xyz="0 0 2"/><mass value="1"/>
<inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>
<collision><origin xyz="0 0 2"/><geometry><sphere radius="0.2"/></geometry></collision></link>
<joint name="elbow" type="revolute"><parent link="base"/><child link="arm"/><axis xyz="0 1 0"/>
<limit lower="-1" upper="1" effort="1" velocity="1"/></joint></robot>"""


def small_cube() -> str:
    """Return an OBJ file."""
    vertices, triangles = cube()
    return obj_text((0.1 * vertices, triangles))


def sha(path: Path) -> str:
    return hashlib.sha256(path.read_bytes()).hexdigest()


def test_a_model_is_all_files_that_it_names(tmp_path: Path) -> None:
    (tmp_path / "parts").mkdir()
    mesh = tmp_path / "parts" / "tip.obj"
    mesh.write_text(small_cube())
    model = tmp_path / "robot.xml"
    model.write_text(MESHED)
    (tmp_path / "unused.obj").write_text("o nothing")
    options = ClipOptions(avatar=model, room=Path(FLOOR))
    first = files_of(options)
    assert first.avatar == (("parts/tip.obj", sha(mesh)), ("robot.xml", sha(model))) and first.room == ()
    avatar, room = load_models(options, first)
    assert load_models(options, first)[0] is avatar and room is not None and room.bodies[0].name == "floor"
    # another file under the same name is another model
    model.write_text(MESHED.replace('size="0.1"', 'size="0.15"'))
    again, _ = load_models(options, files_of(options))
    shapes = [one.avatar.links[0].pieces[0].shape for one in (avatar, again) if one and one.avatar]
    assert [shape.radius for shape in shapes if isinstance(shape, Sphere)] == [0.1, 0.15]


def test_meshes_of_a_package_and_included_files_count_too(tmp_path: Path) -> None:
    (tmp_path / "some").mkdir()
    (tmp_path / "package.xml").write_text("<package/>")
    (tmp_path / "some" / "tip.obj").write_text(small_cube())
    (tmp_path / "robot.urdf").write_text(URDF)
    assert [name for name, _ in files_of(ClipOptions(avatar=tmp_path / "robot.urdf")).avatar] == ["robot.urdf", "some/tip.obj"]
    (tmp_path / "arm.xml").write_text(f"<mujoco>{ROBOT.partition('>')[2]}")
    (tmp_path / "whole.xml").write_text('<mujoco><include file="arm.xml"/></mujoco>')
    assert [name for name, _ in files_of(ClipOptions(avatar=tmp_path / "whole.xml")).avatar] == ["arm.xml", "whole.xml"]


def test_a_room_is_no_avatar_and_a_mesh_is_its_own_file(tmp_path: Path) -> None:
    room = tmp_path / "room.obj"
    room.write_text(obj_text(cube()))
    options = ClipOptions(room=room, reading=Reading(room_scale=2.0, room_up="y"))
    assert files_of(options).room == (("room.obj", sha(room)),)
    _, found = load_models(options, files_of(options))
    assert found is not None and found.bodies[0].name == "room"
    (tmp_path / "still.xml").write_text('<mujoco><worldbody><geom type="box" size="1 1 1"/></worldbody></mujoco>')
    with pytest.raises(InvalidFile, match="avatar in still.xml|still.xml"):
        load_models(ClipOptions(avatar=tmp_path / "still.xml"), files_of(ClipOptions(avatar=tmp_path / "still.xml")))


def test_a_motion_is_its_file_and_its_skeleton(tmp_path: Path) -> None:
    clip = bvh(tmp_path / "a.bvh")
    assert motion_files(clip, Reading(asf="/none.asf")) == (("a.bvh", sha(clip)),)
    amc = tmp_path / "02_01.amc"
    amc.write_text("#!OML\n")
    assert motion_files(amc, Reading()) == (("02_01.amc", sha(amc)),) and skeleton_of(amc, Reading()) is None
    (tmp_path / "02.asf").write_text("one")
    assert [name for name, _ in motion_files(amc, Reading())] == ["02_01.amc", "02.asf"]
    assert options_for(amc, Reading(scale=0.1)) == {"scale": 0.1, "skeleton": str(tmp_path / "02.asf")}
    (tmp_path / "02_01.asf").write_text("two")
    assert skeleton_of(amc, Reading()) == tmp_path / "02_01.asf"
    (tmp_path / "other.asf").write_text("three")
    asked = Reading(asf=str(tmp_path / "other.asf"))
    assert [name for name, _ in motion_files(amc, asked)] == ["02_01.amc", "other.asf"]


def test_readers_say_which_options_they_have() -> None:
    assert set(options_of(".bvh")) >= {"scale", "up"} and "rate" not in options_of(".bvh")
    assert set(options_of(".csv")) >= {"rate", "quaternion", "joints"} and options_of(".xyz") == ()
    assert set(options_of(".amc")) >= {"skeleton", "rate"}
    asked = Reading(
        scale=1.0, up="y", file_rate=30.0, quaternion="wxyz", joints="a", offsets="b", stature=1.7, asf="c", mass=70.0,
        limits=False,
    ).of_motion()
    # each word of a command line is an option of some reader
    known = {name for suffix in (".amc", ".bvh", ".csv", ".npz", ".txt") for name in options_of(suffix)}
    assert set(asked) <= known


def test_a_keyframe_is_of_the_avatars_file_where_there_is_one(tmp_path: Path) -> None:
    ground = '<mujoco><worldbody><geom name="ground" type="plane" size="1 1 1"/></worldbody></mujoco>'
    keys = '<keyframe><key name="bent" qpos="0 0 0.5 1 0 0 0 0.02"/></keyframe></mujoco>'
    (tmp_path / "robot.xml").write_text(ROBOT.replace("</mujoco>", keys))
    (tmp_path / "room.xml").write_text(ground)
    options = ClipOptions(tmp_path / "robot.xml", tmp_path / "room.xml", reading=Reading(keyframe="bent"))
    avatar, room = load_models(options, files_of(options))
    assert avatar is not None and avatar.start is not None and avatar.start.angles.tolist() == [0.02]
    assert room is not None and [body.name for body in room.bodies] == ["ground"]
    alone = replace(options, avatar=None)
    with pytest.raises(UnknownName, match="keyframe of room.xml"):
        load_models(alone, files_of(alone))


def test_a_home_counts_by_its_file(tmp_path: Path) -> None:
    clip, other = bvh(tmp_path / "a.bvh"), bvh(tmp_path / "b.bvh", seed=1)
    for home in (str(other), f"{other}:3"):
        read, options = Reading(home=home), str(ClipOptions(reading=Reading(home=home)).as_json())
        assert motion_files(clip, read) == (("a.bvh", sha(clip)), ("b.bvh", sha(other))) and read.of_motion() == {"home": home}
        assert Path(home).name in options and str(tmp_path) not in options
    assert motion_files(clip, Reading(home="3")) == (("a.bvh", sha(clip)),)
    assert "home" in options_of(".amc") and "home" not in options_of(".csv")
