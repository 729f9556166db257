"""Wrong values in files are refused by name, with value and range; missing ones have their defaults."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

import avatarsim as av
from avatarsim.assets.models.preflight import texts_of
from avatarsim.assets.motions.load import load_motion
from avatarsim.scene.joint import MANY_TURNS, Ball, Hinges
from tests.assets.motions.files import ASF, WALKER, amc, bvh
from tests.assets.motions.robots import driven, saved

URDF = """<robot name="two">
<link name="base">
<inertial><origin xyz="0 0 0.01"/><mass value="2.0"/>
<inertia ixx="0.021" iyy="0.022" izz="0.023" ixy="0.001" ixz="0" iyz="0"/></inertial>
<visual><geometry><sphere radius="-7"/></geometry></visual>
<collision><geometry><box size="0.2 0.2 0.1"/></geometry></collision>
<collision><origin xyz="0 0 0.3" rpy="0 0 0"/><geometry><sphere radius="0.05"/></geometry></collision>
<collision><origin xyz="0 0 0.6"/><geometry><cylinder radius="0.04" length="0.11"/></geometry></collision>
</link>
<link name="arm">
<inertial><mass value="0.5"/><inertia ixx="0.01" iyy="0.01" izz="0.01" ixy="0" ixz="0" iyz="0"/></inertial>
<collision><origin xyz="0.3 0 0"/><geometry><capsule radius="0.03" length="0.21"/></geometry></collision>
</link>
<link name="tool"/>
<joint name="grip" type="fixed"><parent link="arm"/><child link="tool"/><axis xyz="0 0 0"/></joint>
<joint name="elbow" type="revolute"><parent link="base"/><child link="arm"/><origin xyz="0.31 0 0" rpy="0 0 0.1"/>
<axis xyz="0 1 0"/><limit lower="-1.0" upper="1.5" effort="10" velocity="3"/><dynamics damping="0.1" friction="0.2"/></joint>
</robot>"""

MJCF = """<mujoco model="two">
<option timestep="0.002"/>
<default><geom density="900"/></default>
<worldbody>
<geom name="floor" type="plane" size="0 0 0.1" pos="0 0 -2"/>
<body name="base" quat="1 0 0 0">
<freejoint/>
<inertial pos="0 0 0" mass="2.0" diaginertia="0.021 0.022 0.023"/>
<geom name="box" type="box" size="0.1 0.12 0.05" friction="1 0.005 0.0001" margin="0" mass="1.5"/>
<geom name="ball" size="0.05" pos="0 0 0.3"/>
<body name="arm" pos="0.31 0 0">
<inertial pos="0 0 0" mass="0.6" fullinertia="0.031 0.03 0.03 0.001 0 0"/>
<joint name="elbow" axis="0 1 0" range="-60 90" damping="0.1" frictionloss="0.2" armature="0.01" stiffness="0.3" ref="5"/>
<geom name="upper" type="capsule" size="0.03" fromto="0.2 0 0 0.4 0 0"/>
<body name="hand" pos="0.5 0 0">
<joint name="wrist" type="ball" range="0 40"/>
<geom name="palm" type="cylinder" size="0.031 0.05" density="500"/>
</body></body></body>
</worldbody>
</mujoco>"""

NUMBERS = ("nan", "inf", "-inf", "1e999", "some", "", "1 2 3 4 5 6 7")
"""Texts that are valid for no attribute."""

ATTRIBUTES: tuple[tuple[str, str, str, str, tuple[str, ...]], ...] = (
    ("urdf", 'mass value="', "2.0", "link base", ("-2",)), ("urdf", 'ixx="', "0.021", "link base", ("-0.02",)),
    ("urdf", 'ixy="', "0.001", "link base", ()), ("urdf", 'box size="', "0.2 0.2 0.1", "base", ("-1 1 1", "0 1 1", "1 1")),
    ("urdf", 'sphere radius="', "0.05", "link base", ("-0.05", "0")),
    ("urdf", 'cylinder radius="', "0.04", "link base", ("-1", "0")), ("urdf", 'length="', "0.11", "link base", ("-1", "0")),
    ("urdf", 'capsule radius="', "0.03", "link arm", ("-1", "0")), ("urdf", 'length="', "0.21", "link arm", ("-1", "0")),
    ("urdf", 'axis xyz="', "0 1 0", "joint elbow", ("0 0 0", "0 1")),
    ("urdf", 'origin xyz="', "0.31 0 0", "joint elbow", ("1 1",)),
    ("urdf", 'rpy="', "0 0 0.1", "joint elbow", ("0 0",)), ("urdf", 'lower="', "-1.0", "joint elbow", ("2", "1.5")),
    ("urdf", 'effort="', "10", "joint elbow", ("-10",)), ("urdf", 'velocity="', "3", "joint elbow", ("-3",)),
    ("urdf", 'damping="', "0.1", "joint elbow", ("-0.1",)), ("urdf", 'friction="', "0.2", "joint elbow", ("-0.2",)),
    ("xml", 'timestep="', "0.002", "timestep", ("-1", "0")), ("xml", 'density="', "900", "density", ("-900",)),
    ("xml", 'quat="', "1 0 0 0", "body base", ("0 0 0 0", "1 0 0")), ("xml", 'mass="', "2.0", "body base", ("-2",)),
    ("xml", 'diaginertia="', "0.021 0.022 0.023", "body base", ("-1 1 1", "1")),
    ("xml", 'fullinertia="', "0.031 0.03 0.03 0.001 0 0", "arm", ("-1 1 1 0 0 0",)),
    ("xml", 'box" size="', "0.1 0.12 0.05", "geom box", ("-1 1 1", "0 1 1", "1 1 0")),
    ("xml", 'ball" size="', "0.05", "ball", ("-1",)),
    ("xml", 'friction="', "1 0.005 0.0001", "geom box", ("-1",)), ("xml", 'margin="', "0", "geom box", ("-1",)),
    ("xml", 'mass="', "1.5", "geom box", ("-1.5",)), ("xml", 'fromto="', "0.2 0 0 0.4 0 0", "geom upper", ("1 0 0 1 0 0",)),
    ("xml", 'pos="', "0.31 0 0", "body arm", ("0 0",)), ("xml", 'axis="', "0 1 0", "joint elbow", ("0 0 0",)),
    ("xml", 'range="', "-60 90", "joint elbow", ("90 -60", "10 10", "90")), ("xml", 'damping="', "0.1", "joint elbow", ("-1",)),
    ("xml", 'frictionloss="', "0.2", "joint elbow", ("-1",)), ("xml", 'armature="', "0.01", "joint elbow", ("-1",)),
    ("xml", 'stiffness="', "0.3", "joint elbow", ("-1",)), ("xml", 'ref="', "5", "joint elbow", ("1 1",)),
    ("xml", 'range="', "0 40", "joint wrist", ("10 40", "0 -40")),
    ("xml", 'palm" type="cylinder" size="', "0.031 0.05", "palm", ("0 1",)),
    ("xml", 'density="', "500", "geom palm", ("-500",)),
)
"""Format, text before a value, the value, the subject of the error, and wrong values that are numbers."""

ANY_LENGTH = ("friction", "damping", "stiffness", "size")
"""Attributes with any count of numbers."""


def written(folder: Path, form: str, text: str) -> Path:
    path = folder / f"model.{form}"
    path.write_text(text)
    return path


@pytest.mark.parametrize("case", ATTRIBUTES, ids=lambda case: f"{case[3]} {case[1].strip('=')}")
def test_numbers_of_models_are_refused_by_name(tmp_path: Path, case: tuple[str, str, str, str, tuple[str, ...]]) -> None:
    form, before, good, about, wrong = case
    whole = URDF if form == "urdf" else MJCF
    assert whole.count(f"{before}{good}\"") == 1
    for value in (*wrong, *NUMBERS):
        if value == NUMBERS[-1] and any(name in before for name in ANY_LENGTH):
            continue
        path = written(tmp_path, form, whole.replace(f'{before}{good}"', f'{before}{value}"'))
        with pytest.raises(av.InvalidInput) as found:
            texts_of(path, tmp_path)
        assert about in found.value.thing and "line" in found.value.thing and found.value.valid, str(found.value)
        # limits are shown together
        assert str(found.value.value) in (value, f"{value} and 1.5"), str(found.value)


@pytest.mark.parametrize(("form", "good", "wrong"), [
    ("urdf", 'value="2.0"', 'value="-2"'), ("urdf", ' upper="1.5"', ""), ("xml", 'range="-60 90"', 'range="90 -60"'),
])
def test_models_with_wrong_numbers_are_not_loaded(tmp_path: Path, form: str, good: str, wrong: str) -> None:
    text = URDF if form == "urdf" else MJCF
    assert text.count(good) == 1
    with pytest.raises(av.InvalidInput, match="base|arm|elbow"):
        av.load_room(written(tmp_path, form, text.replace(good, wrong)))


def test_what_is_left_out_of_a_model_has_its_default(tmp_path: Path) -> None:
    urdf = av.load_avatar(written(tmp_path, "urdf", URDF)).avatar
    assert urdf is not None and urdf.links[0].mass.mass == 2.0
    joint = urdf.links[1].joint
    assert isinstance(joint, Hinges) and (joint.hinges[0].lower, joint.hinges[0].upper) == (-1.0, 1.5)
    found = driven(av.load_avatar(written(tmp_path, "urdf", URDF.replace(' lower="-1.0" upper="1.5"', "")))).avatar
    joint = found.links[1].joint
    assert isinstance(joint, Hinges) and (joint.hinges[0].lower, joint.hinges[0].upper) == (-MANY_TURNS, MANY_TURNS)
    massless = av.load_avatar(written(tmp_path, "urdf", URDF.replace('<mass value="2.0"/>', '<mass value="0"/>')))
    assert massless.avatar is not None and any("without mass" in note and "base" in note for note in massless.notes)
    inferred = URDF[: URDF.index("<inertial>")] + URDF[URDF.index("<visual>") :]
    without = av.load_avatar(written(tmp_path, "urdf", inferred)).avatar
    # from the density of water
    assert without is not None and without.links[0].mass.mass == pytest.approx(massless.avatar.links[0].mass.mass, rel=0.02)
    free = driven(av.load_avatar(written(tmp_path, "xml", MJCF.replace(' range="-60 90"', "").replace("0 40", "0 0")))).avatar
    joint, ball = free.links[1].joint, free.links[2].joint
    assert isinstance(joint, Hinges) and joint.hinges[0].upper - joint.hinges[0].lower > MANY_TURNS
    assert isinstance(ball, Ball) and ball.limits is None


STANDING = np.zeros((5, 30)) + np.r_[0.0, 90.0, 0.0, np.zeros(27)]


def smpl(folder: Path) -> Path:
    arrays = {"poses": np.zeros((9, 156)), "trans": np.zeros((9, 3)), "mocap_framerate": np.array(60.0)}
    return saved(folder / "body.npz", arrays)


def recording(folder: Path) -> Path:
    (folder / "w.bvh").write_text(bvh(WALKER, STANDING))
    return folder / "w.bvh"


def acclaim(folder: Path) -> Path:
    (folder / "07.asf").write_text(ASF)
    (folder / "07_01.amc").write_text(amc(np.zeros((5, 22))))
    return folder / "07_01.amc"


@pytest.mark.parametrize(("made", "name"), [
    (smpl, "mass"), (smpl, "stature"), (smpl, "rate"), (recording, "mass"), (recording, "scale"), (acclaim, "mass"),
    (acclaim, "scale"), (acclaim, "rate"),
])
def test_options_of_motions_are_refused_by_name(tmp_path: Path, made: Callable[[Path], Path], name: str) -> None:
    path = made(tmp_path)
    assert load_motion(path).model() is not None
    for value in (-1.0, 0.0, float("nan"), float("inf"), "x"):
        with pytest.raises(av.InvalidInput) as found:
            load_motion(path, **{name: value}).model()
        assert name in found.value.thing and found.value.valid
        assert found.value.value is value
