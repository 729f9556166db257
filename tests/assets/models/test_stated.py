"""Statements of a model file: gravity, friction and keyframes are applied; unsupported ones are reported."""

import pickle
from math import sqrt
from pathlib import Path

import mujoco
import numpy as np
import pytest

import avatarsim as av
from avatarsim.assets.models.model import in_room
from avatarsim.errors import InvalidFile, InvalidInput, UnknownName
from avatarsim.scene.body import Role

BALL = (
    '<geom name="floor" type="plane" size="5 5 .1"/>'
    '<body name="ball" pos="0 0 1"><freejoint/><geom type="sphere" size=".05"/></body>'
)
SLOPE = 25.0
"""Slope of the ramp [degrees]: its tangent is 0.466."""


def mjcf(folder: Path, world: str, rest: str = "") -> Path:
    """Return an MJCF file with this world."""
    path = folder / "model.xml"
    path.write_text(f"<mujoco>{rest}<worldbody>{world}</worldbody></mujoco>")
    return path


def played(model: av.Model, seconds: float) -> np.ndarray:
    """Return positions (frames, 3) of the first loose body, at 250 Hz."""
    scene = model.scene()
    engine = av.AvatarsimEngine()
    engine.load(scene, av.Settings(), 0.004)
    loose = next(k for k, body in enumerate(scene.bodies) if body.role is Role.SIMULATED)
    steps = range(round(seconds / 0.004))
    return np.array([engine.advance(scene.first_sample, 0.004).shown.positions[loose].copy() for _ in steps])


@pytest.mark.parametrize(("gravity", "scale"), [("0 0 -1.62", 1.0), ("0 0 -981", 0.01), ("0 0 -3.7", 1.0)])
def test_gravity_is_that_of_the_file(tmp_path: Path, gravity: str, scale: float) -> None:
    model = av.load_room(mjcf(tmp_path, BALL, f'<option gravity="{gravity}"/>'), scale=scale)
    expected = scale * float(gravity.split()[2])
    assert model.gravity == pytest.approx((0.0, 0.0, expected))
    assert any("gravity" in note for note in model.notes) is (scale == 1.0)
    heights = played(model, sqrt(2.0 * 0.95 * scale / -expected) + 0.1)[:, 2]
    landed = 0.004 * (1 + int(np.argmax(np.diff(heights) > 0.0)))
    assert landed == pytest.approx(sqrt(2.0 * 0.95 * scale / -expected), abs=0.008)


def test_a_flag_takes_gravity_away(tmp_path: Path) -> None:
    model = av.load_room(mjcf(tmp_path, BALL, '<option><flag gravity="disable"/></option>'))
    assert model.gravity == (0.0, 0.0, 0.0) and any("gravity" in note for note in model.notes)


@pytest.mark.parametrize(
    ("option", "word"),
    [
        ('<option><flag contact="disable"/></option>', "contacts"), ('<option wind="1 0 0" density="2"/>', "wind"),
        ('<option><flag filterparent="disable"/></option>', "parent"), ("", ""),
    ],
)
def test_statements_without_a_counterpart_are_said(tmp_path: Path, option: str, word: str) -> None:
    note = [one for one in av.load_room(mjcf(tmp_path, BALL, option)).notes if "the file states" in one]
    assert word in " ".join(note) if word else not note


def test_gravity_of_the_earth_is_in_metres_in_any_unit(tmp_path: Path) -> None:
    assert av.load_room(mjcf(tmp_path, BALL), scale=0.01).gravity == (0.0, 0.0, -9.81)


def ramp(friction: str, of_box: str) -> str:
    """Return a box on a ramp."""
    return (
        f'<geom name="ramp" type="box" size="2 .5 .05" euler="0 {SLOPE} 0" {friction}/>'
        f'<body name="box" pos="0.0634 0 0.1360" euler="0 {SLOPE} 0"><freejoint/>'
        f'<geom name="b" type="box" size=".1 .1 .1" {of_box}/></body>'
    )


@pytest.mark.parametrize(
    ("of_ramp", "of_box", "pair", "expected"),
    [
        ("", "", "", 1.0), ('friction="0.2"', 'friction="0.3"', "", 0.3), ('friction="0.2"', 'friction="0.9"', "", 0.9),
        ('friction="0.2" priority="1"', 'friction="0.9"', "", 0.2),
        ('condim="1"', 'condim="1"', "", 0.0), ('condim="1" friction="0.8"', 'friction="0.3"', "", 0.8),
        ('condim="1" priority="2"', 'friction="0.9"', "", 0.0), ("", 'priority="-1" friction="3"', "", 1.0),
        ("", "", '<option o_friction=".05 .05 .01 .01 .01"><flag override="enable"/></option>', 0.05),
        ("", "", '<contact><pair geom1="ramp" geom2="b" condim="1" friction="2"/></contact>', 0.0),
        ("", "", '<default><pair friction=".15"/></default><contact><pair geom1="ramp" geom2="b"/></contact>', 0.15),
        ('friction="0"', 'friction="0"', "", 0.0),
        ("", "", '<contact><pair geom1="ramp" geom2="b" friction="0.1 0.1 0.005 0.0001 0.0001"/></contact>', 0.1),
    ],
)
def test_friction_is_that_of_mujoco(tmp_path: Path, of_ramp: str, of_box: str, pair: str, expected: float) -> None:
    path = mjcf(tmp_path, ramp(of_ramp, of_box), pair)
    scene = av.load_room(path).scene()
    law = scene.materials.contact(*scene.material_names)
    whole = mujoco.MjModel.from_xml_path(str(path))
    data = mujoco.MjData(whole)
    data.qpos[2] -= 0.01
    mujoco.mj_forward(whole, data)
    sliding = data.contact.friction[0, 0] if data.contact.dim[0] > 1 else 0.0
    # MuJoCo takes 1e-5 for less
    assert sliding == pytest.approx(expected, abs=1e-5)
    assert law.friction == pytest.approx(expected) and law.restitution == 0.3


def test_friction_of_several_geoms_and_of_two_files(tmp_path: Path) -> None:
    geoms = '<geom size=".1" friction="0.3"/><geom size=".1" pos="1 0 0" friction="0.7"/>'
    mixed = f'<body name="x" pos="0 0 2"><freejoint/>{geoms}</body>'
    model = av.load_room(mjcf(tmp_path, mixed))
    assert any("x" in note and "friction" in note for note in model.notes)
    scene = in_room(model, av.load_room("floor")).scene()
    # the floor of the room is wood, whose friction against wood is 0.3
    assert scene.materials.contact(*scene.material_names).friction == 0.7


def test_pairs_share_materials_unless_their_friction_differs(tmp_path: Path) -> None:
    bodies = "".join(f'<body pos="{k} 0 1"><freejoint/><geom name="g{k}" size=".1"/></body>' for k in range(210))
    pairs = "".join(f'<pair geom1="g{k}" geom2="g0"/>' for k in range(1, 210))
    model = av.load_room(mjcf(tmp_path, bodies, f"<contact>{pairs}</contact>"))
    assert len(model.bodies) == 210 and len(model.frictions.materials) == 1


def test_a_pair_says_nothing_of_other_geoms_of_its_bodies(tmp_path: Path) -> None:
    box = '<body><freejoint/><geom name="b" size=".1"/><geom name="c" size=".1" pos="1 0 0"/></body>'
    pair = '<contact><pair geom1="floor" geom2="b" friction="0.1"/>{}</contact>'
    for more, expected in (("", 1.0), ('<pair geom1="c" geom2="floor" friction="0.2"/>', 0.2)):
        scene = av.load_room(mjcf(tmp_path, f'<geom name="floor" type="plane" size="1 1 1"/>{box}', pair.format(more))).scene()
        assert scene.materials.contact(*scene.material_names).friction == expected


def test_pairs_of_neighbours_that_never_touch_are_said(tmp_path: Path) -> None:
    arm = (
        '<body><joint/><geom name="a" size=".1"/><body pos="1 0 0"><joint/><geom name="b" size=".1"/></body></body>'
    )
    model = av.load_avatar(mjcf(tmp_path, arm, '<contact><pair geom1="a" geom2="b"/></contact>'))
    assert any("states them" in note for note in model.notes)


KEYED = (
    '<body name="base"><geom type="box" size=".1 .1 .1"/><body name="arm" pos="0 0 .3"><joint name="j" axis="0 1 0" ref="10"/>'
    '<geom type="capsule" size=".03" fromto="0 0 0 .4 0 0"/></body></body>'
    '<body name="ball" pos="2 0 1"><freejoint/><geom size=".05"/></body>'
    '<body name="m" mocap="true" pos="0 2 0"><geom size=".05"/></body>'
)
KEYS = (
    '<keyframe><key name="first" qpos="0.5 2 0 3 1 0 0 0" ctrl="7" mpos="0 3 0"/>'
    '<key name="home" qpos="0.7 2 0 4 0 1 0 0"/></keyframe>'
    '<actuator><position joint="j"/></actuator>'
)


@pytest.mark.parametrize(
    ("keyframe", "angle", "height", "place"),
    [
        (None, 0.7, 4.0, 2.0), ("first", 0.5, 3.0, 3.0), (0, 0.5, 3.0, 3.0), ("1", 0.7, 4.0, 2.0),
        ("qpos0", np.deg2rad(10.0), 1.0, 2.0),
    ],
)
def test_a_keyframe_is_the_start(tmp_path: Path, keyframe: str | int | None, angle: float, height: float, place: float) -> None:
    model = av.load_avatar(mjcf(tmp_path, KEYED, KEYS), keyframe=keyframe)
    assert model.start is not None and model.coordinates is not None
    assert model.start.angles == pytest.approx([angle - np.deg2rad(10.0)])
    assert model.bodies[0].position[2] == height and model.moving[0].links[0].anchor[1] == place
    assert any("keyframe" in note for note in model.notes) is (keyframe != "qpos0")
    av.AvatarsimEngine().load(model.scene(), av.Settings(), 0.01)


@pytest.mark.parametrize(
    ("keyframe", "error"),
    [
        ("hom", UnknownName), (2, InvalidInput), (True, InvalidInput), (-1, InvalidInput), (1.5, InvalidInput),
        ([], InvalidInput), ("", UnknownName), (b"home", InvalidInput),
    ],
)
def test_a_keyframe_that_is_not_there(tmp_path: Path, keyframe: str | int, error: type[Exception]) -> None:
    with pytest.raises(error, match="keyframe"):
        av.load_avatar(mjcf(tmp_path, KEYED, KEYS), keyframe=keyframe)


def test_joints_beyond_their_limits_at_the_start_are_said(tmp_path: Path) -> None:
    path = mjcf(tmp_path, KEYED.replace('name="j"', 'name="j" range="-5 5"'), KEYS)
    model = av.load_avatar(path)
    assert model.start is not None and model.start.angles == pytest.approx(np.deg2rad([-5.0]))
    assert any("limits" in note for note in model.notes)


def test_a_mocap_pose_without_a_turn_is_unturned(tmp_path: Path) -> None:
    model = av.load_avatar(mjcf(tmp_path, KEYED, KEYS.replace('mpos="0 3 0"', 'mquat="0 0 0 0"')), keyframe="first")
    assert model.moving[0].links[0].orientation == (1.0, 0.0, 0.0, 0.0)


def test_plugins_of_an_include_belong_to_the_element_around(tmp_path: Path) -> None:
    (tmp_path / "parts.xml").write_text('<mujocoinclude><plugin plugin="p"/><geom size=".1" pos="0 0 3"/></mujocoinclude>')
    model = av.load_avatar(mjcf(tmp_path, KEYED + '<body><include file="parts.xml"/></body>'))
    assert any("p" in note for note in model.notes) and len(model.bodies) == 2
    (tmp_path / "parts.xml").write_text('<mujocoinclude><plugin plugin="p"/></mujocoinclude>')
    shaped = '<asset><mesh name="m"><include file="parts.xml"/></mesh></asset>'
    with pytest.raises(InvalidFile, match="plugin"):
        av.load_avatar(mjcf(tmp_path, KEYED, shaped))
    with pytest.raises(InvalidFile, match="plugin"):
        av.load_room(mjcf(tmp_path, '<body><geom type="sdf" mesh="g"><plugin plugin="mujoco.sdf.gear"/></geom></body>'))


PLUGINS = '<extension><plugin plugin="some.pid"><instance name="i"><config key="kp" value="4"/></instance></plugin></extension>'
LEFT_OUT = {
    "an included file of plugins": ("", '<include file="parts.xml"/>', "some.pid"),
    "one that begins with a comment": ("", '<include file="noted.xml"/>', "some.pid"),
    "a tuple that names an actuator": ("", '<actuator><motor name="m" joint="j"/></actuator>'
                                       '<custom><tuple name="t"><element objtype="actuator" objname="m"/></tuple></custom>', ""),
    "points of a deformable body": (
        '<flexcomp name="f" type="grid" count="2 2 1" spacing=".1 .1 .1" radius=".01" dim="2"/>', "", ""),
    "a plugin that drives": ("", PLUGINS + '<actuator><plugin plugin="some.pid" instance="i" joint="j"/></actuator>', "some.pid"),
}
"""Name -> elements of the world and beside it that are no part of an avatar, and a word of the report."""


@pytest.mark.parametrize("name", LEFT_OUT)
def test_what_is_no_part_of_an_avatar_is_left_out(tmp_path: Path, name: str) -> None:
    world, rest, word = LEFT_OUT[name]
    (tmp_path / "parts.xml").write_text(f"<mujocoinclude>{PLUGINS}</mujocoinclude>")
    (tmp_path / "noted.xml").write_text(f"<mujocoinclude><!-- nothing but plugins -->{PLUGINS}</mujocoinclude>")
    model = av.load_avatar(mjcf(tmp_path, KEYED + world, rest))
    assert model.avatar is not None and [link.name for link in model.avatar.links] == ["base", "arm"]
    assert any(word in note for note in model.notes)


URDF = """<robot name="r"><material name="grey"><color rgba="1 1 1 1"/></material><material name="grey"/>
<link name="world"/><link name="a">
<visual><geometry><box size="0.4 0.4 0.4"/></geometry><material name="grey"/><material name="grey"/></visual>
{}</link><joint name="j" type="revolute"><parent link="world"/><child link="a"/><axis xyz="0 0 1"/>
<limit lower="-1" upper="1"/></joint></robot>"""


def test_trees_that_are_no_avatar_are_reported_with_an_option(tmp_path: Path) -> None:
    shape = '<geom size=".1"/>'
    arm = '<body name="{}" pos="{} 0 0"><joint axis="0 0 1"/>{}</body>'
    seen = shape.replace("/>", ' contype="0" conaffinity="0"/>')
    loose = '<body name="c" pos="0 3 0"><freejoint/><geom size=".1"/><body pos="0 0 1"><joint/><geom size=".1"/></body></body>'
    trees = arm.format("a", 0, shape), arm.format("b", 2, shape), arm.format("goal", 4, seen)
    model = av.load_avatar(mjcf(tmp_path, "".join(trees)))
    assert sum('avatar=("a", "b", "goal")' in note for note in model.notes) == 2
    path = mjcf(tmp_path, trees[0] + trees[2] + loose)
    both = av.load_avatar(path, avatar=("a", "goal"))
    assert both.avatar is not None and both.coordinates is not None and both.coordinates.width == 2
    assert sum("c is no avatar" in note and "avatar=(" not in note for note in both.notes) == 1


@pytest.mark.parametrize("missing", [False, True])
def test_pages_draw_visuals_of_urdf_where_they_compile(tmp_path: Path, missing: bool) -> None:
    more = '<visual><geometry><mesh filename="none.stl"/></geometry></visual>' if missing else ""
    path = tmp_path / "r.urdf"
    path.write_text(URDF.format(f'<collision><geometry><sphere radius="0.1"/></geometry></collision>{more}'))
    model = pickle.loads(pickle.dumps(av.load_avatar(path)))
    both = in_room(model, av.load_room("floor"))
    for one in (model, both):
        assert list(one.visuals) == ([] if missing else ["r"])
        assert missing or [getattr(part, "shape", part) for part in one.visuals["r"]] == [av.Box((0.4, 0.4, 0.4))]
    assert [type(piece.shape) for piece in model.avatar.links[-1].pieces] == [av.Sphere]


@pytest.mark.parametrize("urdf", [True, False])
def test_shapes_to_be_looked_at_collide_when_asked(tmp_path: Path, urdf: bool) -> None:
    if urdf:
        path = tmp_path / "r.urdf"
        path.write_text(URDF.replace('<material name="grey"/>', "").format(""))
    else:
        shape = '<geom type="box" size=".2 .2 .2" contype="0" conaffinity="0"/>'
        path = mjcf(tmp_path, f'<body><joint axis="0 0 1"/>{shape}</body>')
    with pytest.raises(InvalidFile, match='collide="visual"'):
        av.load_avatar(path)
    model = av.load_avatar(path, collide="visual")
    assert model.avatar is not None
    (piece,) = (piece for link in model.avatar.links for piece in link.pieces)
    assert isinstance(piece.shape, av.Box) and piece.shape.size == pytest.approx((0.4, 0.4, 0.4))
    with pytest.raises(UnknownName):
        av.load_avatar(path, collide="both")


def test_bodies_without_shapes_to_be_looked_at_keep_their_own(tmp_path: Path) -> None:
    world = (
        '<geom name="floor" type="plane" size="1 1 1"/><body><joint axis="0 0 1"/>'
        '<geom type="box" size=".1 .1 .1" contype="0" conaffinity="0"/>{}'
        '<body pos="0 0 1"><joint/><geom size=".1"/></body></body>'
    )
    rest = '<contact><pair geom1="floor" geom2="proxy"/></contact>'
    path = mjcf(tmp_path, world.format('<geom name="proxy" size=".2"/>'), rest)
    model = av.load_avatar(path, collide="visual")
    assert model.avatar is not None and [body.name for body in model.bodies] == ["floor"]
    assert [[type(piece.shape) for piece in link.pieces] for link in model.avatar.links] == [[av.Box], [av.Sphere]]


def test_an_avatar_without_shapes_is_refused_beside_a_floor(tmp_path: Path) -> None:
    seen = '<body><joint/><geom size=".1" contype="0" conaffinity="0"/></body>'
    path = mjcf(tmp_path, f'<geom type="plane" size="1 1 1"/>{seen}')
    with pytest.raises(InvalidFile, match='avatar .* 0; .*collide="visual"'):
        av.load_avatar(path)
    assert len(av.load_avatar(path, collide="visual").bodies) == 1


def test_links_without_visuals_keep_their_collisions(tmp_path: Path) -> None:
    shapes = '<collision><geometry><sphere radius="0.1"/></geometry></collision>'
    more = '<link name="b">{}</link><joint name="k" type="fixed"><parent link="a"/><child link="b"/></joint></robot>'
    (tmp_path / "r.urdf").write_text(URDF.format(shapes).replace("</robot>", more.format(shapes)))
    model = av.load_avatar(tmp_path / "r.urdf", collide="visual")
    assert model.avatar is not None
    found = {link.name: [type(piece.shape) for piece in link.pieces] for link in model.avatar.links}
    assert found["a"] == [av.Box] and found["b"] == [av.Sphere]


@pytest.mark.parametrize(("friction", "stays"), [(1.0, True), (0.5, True), (0.4, False)])
def test_a_box_stays_on_a_ramp_by_the_friction_of_the_file(tmp_path: Path, friction: float, stays: bool) -> None:
    of = f'friction="{friction}"'
    places = played(av.load_room(mjcf(tmp_path, ramp(of, of))), 1.0)
    assert bool(np.linalg.norm(places[-1] - places[5]) < 1e-3) is stays
