"""Scenes from a user's files: their content, start and motion, and rejected files."""

import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from avatarsim.clips.reading import Reading
from avatarsim.errors import InvalidFile, InvalidInput, StartOverlaps
from avatarsim.live.orders import World
from avatarsim.live.recording import Recorder
from avatarsim.scene.scene import Scene
from scenarios import catalog, own_scenes
from scenarios.__main__ import main
from scenarios.cli.plan import scenarios as offered
from scenarios.scenario import Scenario
from tests.clips.made import carrying, robot
from tests.live.small import plan, pushed

HOUSE = Path(__file__).resolve().parents[2]
BOXES = """<mujoco><worldbody><geom name="ground" type="plane" size="5 5 .1"/>
<body name="a" pos="0 0 {height}"><freejoint/><geom type="box" size=".1 .1 .1" mass="1"/></body>
<body name="ball" pos="0 0 1"><freejoint/><geom type="sphere" size=".08" mass="0.5"/></body>
</worldbody></mujoco>"""
ARM = """<mujoco><worldbody><body name="upper" pos="0 1 1"><joint name="shoulder" axis="0 1 0" range="-90 90" limited="true"/>
<geom type="capsule" size=".03" fromto="0 0 0 .3 0 0" mass="1"/><body name="lower" pos=".35 0 0">
<joint name="elbow" axis="0 1 0" range="0 120" limited="true"/>
<geom type="capsule" size=".03" fromto="0.05 0 0 .3 0 0" mass="1"/></body></body></worldbody></mujoco>"""


@pytest.fixture
def boxes(tmp_path: Path) -> str:
    (tmp_path / "Two boxes.xml").write_text(BOXES.format(height=0.15))
    return str(tmp_path / "Two boxes.xml")


@pytest.fixture
def arm(tmp_path: Path) -> tuple[str, str]:
    (tmp_path / "arm.xml").write_text(ARM)
    np.savez(tmp_path / "reach.npz", qpos=np.stack([np.linspace(0.0, 1.0, 40), np.linspace(0.2, 0.8, 40)], axis=1), fps=60.0)
    return str(tmp_path / "arm.xml"), str(tmp_path / "reach.npz")


def taken() -> tuple[Scenario, Scene]:
    """Return the only scenario that was taken, and its scene."""
    (scenario,) = catalog.scenarios().values()
    return scenario, scenario.build()


def test_own_scenes_stand_in_the_place_of_the_catalogue(boxes: str) -> None:
    own_scenes.take_files([boxes, boxes], None, None, None, 2.0)
    assert set(catalog.scenarios()) == {"own_two_boxes", "own_two_boxes_2"} == set(offered("compare"))
    scenario = catalog.get("own_two_boxes")
    assert scenario.frames == 120 and scenario.everyday and "Two boxes.xml" in scenario.title
    scene = scenario.build()
    assert {"a", "ball"} <= set(scene.names) and scene.avatars == () and scene.effects.dynamics


def test_a_motion_drives_the_avatar_from_a_free_start(arm: tuple[str, str]) -> None:
    own_scenes.take_files([arm[0]], None, "floor", arm[1], 60.0)
    scenario, scene = taken()
    assert len(scene.avatars[0].links) >= 2 and scenario.frames == 40 + 30
    motion = scenario.motion(scene, 0)
    assert motion(scenario.frames - 1).angles == pytest.approx([1.0, 0.8])
    assert any(bound.metric == "joint_limit_excess_max" for bound in scenario.bounds)
    # without a motion it stays in its first posture
    own_scenes.take_files([arm[0]], None, None, None, 1.0)
    scenario, scene = taken()
    held = scenario.motion(scene, 0)(30)
    assert held.angles.tolist() == scene.first_sample.angles.tolist() and held.time == pytest.approx(31 / 60)


def test_the_object_of_a_motion_is_a_moving_body(tmp_path: Path) -> None:
    path = carrying(tmp_path / "carry.npz", object_size=(0.1, 0.1, 0.1))
    own_scenes.take_files([str(robot(tmp_path))], None, None, str(path), 60.0)
    scenario, scene = taken()
    assert [avatar.name for avatar in scene.avatars] == ["stick", "cube"] and scene.avatars[1].moves
    motion = scenario.motion(scene, 0)
    assert motion(scenario.frames - 1).positions[2] == pytest.approx((0.3, 0.0, 0.6), abs=0.02)


def test_an_avatar_goes_into_a_room_of_another_file(boxes: str, arm: tuple[str, str]) -> None:
    own_scenes.take_files([boxes], arm[0], None, arm[1], 1.0)
    scene = taken()[1]
    assert scene.avatars and {"a", "ball"} <= {body.name.removeprefix("room_") for body in scene.bodies}


def test_scales_are_metres_a_unit_of_each_file(tmp_path: Path, boxes: str, arm: tuple[str, str]) -> None:
    (tmp_path / "shelf.xml").write_text(
        '<mujoco><worldbody><body name="board" pos="4 0 1"><geom type="box" size=".1 .1 .1"/></body></worldbody></mujoco>')

    def made(scale: float = 1.0, reading: Reading = own_scenes.AS_FOUND) -> Scene:
        own_scenes.take_files([boxes], arm[0], str(tmp_path / "shelf.xml"), None, 1.0, scene_scale=scale, reading=reading)
        return taken()[1]

    plain, scaled = made(), made(0.5, Reading(avatar_scale=0.2, room_scale=2.0))
    places = [{body.name: body.position for body in scene.bodies} for scene in (plain, scaled)]
    assert places[0]["ball"][2] == pytest.approx(1.0) and places[1]["ball"][2] == pytest.approx(0.5)
    assert places[0]["board"][0] == pytest.approx(4.0) and places[1]["board"][0] == pytest.approx(8.0)
    spans = [scene.avatars[0].span for scene in (plain, scaled)]
    assert spans[1] == pytest.approx(0.2 * spans[0])
    # and a file that has the avatar itself
    own_scenes.take_files([arm[0]], None, None, arm[1], 1.0, scene_scale=0.5)
    assert taken()[1].avatars[0].span == pytest.approx(0.5 * spans[0])


def test_what_cannot_be_run_is_refused_at_the_door(tmp_path: Path, boxes: str, arm: tuple[str, str]) -> None:
    (tmp_path / "arm_in_ball.xml").write_text(ARM.replace("0 1 1", "0 0 1"))
    with pytest.raises(StartOverlaps, match="ball"):
        own_scenes.take_files([boxes], str(tmp_path / "arm_in_ball.xml"), None, None, 1.0)
    with pytest.raises(InvalidFile):
        own_scenes.take_files([str(tmp_path / "absent.xml")], None, None, None, 1.0)
    with pytest.raises(InvalidInput, match="seconds"):
        own_scenes.take_files([boxes], None, None, None, float("nan"))
    with pytest.raises(InvalidInput):
        own_scenes.take_files([boxes], None, None, arm[1], 1.0)
    assert own_scenes.scenarios() == {}


def test_what_was_changed_for_a_free_start_is_said(tmp_path: Path) -> None:
    (tmp_path / "sunk.xml").write_text(BOXES.format(height=0.05))
    said = own_scenes.take_files([str(tmp_path / "sunk.xml")], None, None, None, 1.0)
    assert any(one.startswith("own_sunk: ") and "raised" in one for one in said)


def test_the_command_runs_them(tmp_path: Path, boxes: str, arm: tuple[str, str]) -> None:
    """In its own process: its child processes inherit the options, and outlive a test."""
    # an avatar without contacts is a scene too
    words = ["--scene", boxes, arm[0], "--engine", "avatarsim", "--jobs", "0", "--frames", "5", "--out", str(tmp_path / "out")]
    command = [sys.executable, "-m", "scenarios", "compare", *words]
    good = subprocess.run(command, cwd=HOUSE, capture_output=True, text=True, check=False)
    assert good.returncode == 0 and "own_two_boxes" in good.stdout and "own_arm" in good.stdout


@pytest.mark.parametrize(("words", "named"), [
    (["--room-scale", "2"], ["--room-scale", "2.0", "--room"]), (["--keyframe", "home"], ["--keyframe", "home"]),
    (["--scene", "x", "--room-scale", "2"], ["--room"]),
    (["--scene", "x", "--scene-scale", "nan"], ["nan"]), (["--scene", "x", "--scene-scale", "0"], ["--scene-scale", "0"]),
    (["--scene", "x", "--avatar-scale", "-1", "--avatar", "x"], ["--avatar-scale", "-1.0"]),
    (["--scene", "x", "--avatar-scale", "2"], ["--avatar"]), (["--scene", "x.xml", "--scene-scale", "1e9"], ["x.xml"]),
    (["--scene", "none.xml", "--engine", "avatarsim"], ["none.xml"]),
    (["--scene", "x.xml", "--filter", "ball*"], ["--filter", "--scene"]), (["--motion", "x"], ["--motion"]),
])
def test_options_that_do_not_go_together_are_refused(
    words: list[str], named: list[str], capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["compare", *words]) == 2
    err = capsys.readouterr().err
    assert all(name in err for name in named)


def test_a_recording_brings_its_own_skeleton(boxes: str, tmp_path: Path) -> None:
    walk = tmp_path / "walk.bvh"
    frames = "\n".join(f"0 {90 + k} 0 0 0 0 {k} 0 0" for k in range(20))
    walk.write_text(
        "HIERARCHY\nROOT Hips\n{\nOFFSET 0 0 0\nCHANNELS 6 Xposition Yposition Zposition Zrotation Xrotation Yrotation\n"
        "JOINT Spine\n{\nOFFSET 0 20 0\nCHANNELS 3 Zrotation Xrotation Yrotation\nEnd Site\n{\nOFFSET 0 30 0\n}\n}\n}\n"
        f"MOTION\nFrames: 20\nFrame Time: 0.033333\n{frames}\n")
    own_scenes.take_files([boxes], None, None, str(walk), 5.0)
    scene = taken()[1]
    assert len(scene.avatars[0].links) == 2 and {"a", "ball"} <= set(scene.names)


def test_excluded_pairs_of_a_room_stay_under_new_names(boxes: str, arm: tuple[str, str], tmp_path: Path) -> None:
    stuck = tmp_path / "stuck.xml"
    apart = '</worldbody><contact><exclude body1="a" body2="ball"/></contact>'
    stuck.write_text(BOXES.format(height=0.15).replace('pos="0', 'pos="3').replace("</worldbody>", apart))
    own_scenes.take_files([boxes], arm[0], str(stuck), None, 1.0)
    assert ("room_a", "room_ball") in {tuple(sorted(pair)) for pair in taken()[1].exclude}


def test_live_recording_is_a_scene_with_its_motion(tmp_path: Path) -> None:
    world = World(plan())
    recorder = Recorder(tmp_path / "mine.live", world.plan, world.shown.state_hash())
    for frame in range(1, 91):
        recorder.frame(pushed(frame), world.advance(pushed(frame)).state_hash())
    recorder.close()
    own_scenes.take_files([str(tmp_path / "mine.live")], None, None, None, 5.0)
    (scenario,) = own_scenes.scenarios().values()
    scene = scenario.build()
    assert scenario.frames == 90 and scene.name == scenario.name and scene.names == plan().scene.names
    motion = scenario.motion(scene, 0)
    np.testing.assert_array_equal(motion(41).positions, pushed(42).positions)
    with pytest.raises(InvalidFile, match="--room beside mine.live"):
        own_scenes.take_files([str(tmp_path / "mine.live")], None, "floor", None, 5.0)
    with pytest.raises(InvalidFile, match="--scene-scale beside mine.live"):
        own_scenes.take_files([str(tmp_path / "mine.live")], None, None, None, 5.0, scene_scale=0.5)
    # and one without frames
    Recorder(tmp_path / "none.live", world.plan, world.shown.state_hash()).close()
    with pytest.raises(InvalidFile, match="frames of none.live"):
        own_scenes.take_files([str(tmp_path / "none.live")], None, None, None, 5.0)
