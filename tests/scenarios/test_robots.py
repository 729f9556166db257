"""Robots of installed packages pass the Shield without overlap of their own geoms, by MuJoCo's distance."""

from importlib.util import find_spec
from pathlib import Path

import pytest

import avatarsim as av
from avatarsim.assets.models.coordinates import Coordinates, Slot
from scenarios.robots import OwnGeoms, drive, driven, lost_joints, own_joints

PACKAGE = Path(next(iter(find_spec("pybullet_data").submodule_search_locations)))  # type: ignore[union-attr, arg-type]
KUKA = PACKAGE / "kuka_iiwa" / "model.urdf"


@pytest.mark.parametrize("path", [KUKA, PACKAGE / "xarm" / "xarm6_robot.urdf"])
def test_a_robot_never_overlaps_by_its_own_geoms(path: Path) -> None:
    found = drive(path, frames=40, seed=3, rate=60.0)
    assert found.own_joints == found.joints and not found.lost
    assert found.kind == "robot" and found.joints >= 6 and found.overlap == 0.0 and found.is_kept
    assert 0.0 < found.free < 1.0 and 0.5 < found.acceleration


def test_the_judge_sees_what_the_motion_would_do() -> None:
    model = av.load_avatar(KUKA)
    judge = OwnGeoms(KUKA, model)
    assert max(judge.deepest(q)[0] for q in driven(model, 60, 3, 60.0)) > 0.01


def test_joints_that_follow_keep_their_own_limits(tmp_path: Path) -> None:
    link = '<link name="{0}"><collision><origin xyz="0 0 {1}"/><geometry><sphere radius=".1"/></geometry></collision></link>'
    joint = (
        '<joint name="{0}" type="revolute"><parent link="{1}"/><child link="{2}"/><origin xyz="0 0 1"/><axis xyz="1 0 0"/>'
        '<limit lower="-3" upper="3" velocity="2" effort="1"/>{3}</joint>'
    )
    path = tmp_path / "arm.urdf"
    path.write_text(
        '<robot name="arm">' + link.format("world", 0) + link.format("a", 0.5) + link.format("b", 0.5)
        + joint.format("lead", "world", "a", "") + joint.format("follow", "a", "b", '<mimic joint="lead" multiplier="2"/>')
        + "</robot>"
    )
    found = drive(path, frames=40, seed=3, rate=60.0)
    assert found.joints == 2 and found.is_kept and found.acceleration > 0.9


def test_joints_that_move_nothing_are_lost_unless_fixed(tmp_path: Path) -> None:
    arm = '<body name="{0}" pos="{1} 0 0"><joint name="{0}" axis="0 1 0"/><geom size=".1"/></body>'
    path = tmp_path / "two.xml"
    loose = '<body pos="0 3 0"><freejoint/><geom size=".1"/></body>'
    path.write_text(f"<mujoco><worldbody>{arm.format('a', 0)}{arm.format('b', 2)}{loose}</worldbody></mujoco>")
    own = own_joints(path)
    slots = (Slot("a", "hinge", 0, 0), Slot("b", "fixed", -1), Slot("joint 2 of c", "slide", 1, 1))
    assert own == ["a", "b"] and lost_joints(own, av.load_avatar(path).coordinates, False) == ["b"]
    assert lost_joints(own, Coordinates(slots, 2, 2), False) == ["b"] and lost_joints(own, Coordinates(slots, 2, 2), True) == []
    assert len(lost_joints([*own, "", ""], Coordinates(slots, 2, 2), True)) == 1
    # the option that the model names drives both
    assert drive(path, 2, 0, 60.0).joints == 2
