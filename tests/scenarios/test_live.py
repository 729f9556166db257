"""Scenes of the catalogue driven live: the chosen scene and engines, and rejected input."""

import pytest

pytest.importorskip("viser")

from avatarsim.live.stages import NAMES, stage
from scenarios.live import judged, main, plan_of, staged_of
from tests.scenarios.scene_rules import first_poses

QUIET = ["--no-browser", "--port", "0"]


@pytest.mark.parametrize("name", NAMES)
def test_a_built_in_stage_is_the_same_as_in_the_package(name: str) -> None:
    assert staged_of(name) == (stage(name), {})


def test_a_scene_of_the_catalogue_comes_with_its_motion() -> None:
    found, clips = staged_of("hand_over_table")
    (clip,) = clips.values()
    assert found.scene.name == "hand_over_table" and found.handles and len(clip.times) > 1


def test_engine_has_the_preset_that_is_named_or_its_first() -> None:
    scene = stage("hand").scene
    assert plan_of("mujoco", scene, 60.0).name == "mujoco/tuned"
    assert plan_of("pybullet/default", scene, 90.0).settings.preset == "default"


def test_the_judge_sees_a_hand_in_the_table_and_none_above_it() -> None:
    scene = stage("hand").scene
    depth = judged(scene)
    first, (positions, orientations) = scene.first_sample, first_poses(scene)
    assert depth(scene, positions, orientations, first.angles) <= 1e-6
    deepest = 0.0
    for _ in range(12):
        positions[len(scene.bodies):, 2] -= 0.025
        deepest = max(deepest, depth(scene, positions, orientations, first.angles))
    assert deepest > 0.01


@pytest.mark.parametrize(("arguments", "named"), [
    (["--scene", "opera"], "opera"), (["--scene", "ball_drop"], "ball_drop"), (["--engine", "opera/tuned"], "opera"),
    (["--engine", "mujoco/opera"], "opera"), (["--motion", "walk.bvh"], "--avatar"),
])
def test_wrong_usage_ends_with_2(arguments: list[str], named: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main([*QUIET, *arguments]) == 2
    assert named in capsys.readouterr().err


def test_another_engine_runs_beside(capsys: pytest.CaptureFixture[str]) -> None:
    assert main([*QUIET, "--scene", "hand", "--engine", "mujoco/tuned", "--seconds", "0.2"]) == 0
    assert "http://127.0.0.1:" in capsys.readouterr().err
