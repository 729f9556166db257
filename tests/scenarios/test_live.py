"""Scenes of the catalogue driven live: which scene and which engines are meant, and what is refused."""

import numpy as np
import pytest

pytest.importorskip("viser")

from avatarsim.errors import InvalidInput, UnknownName
from avatarsim.live.stages import NAMES, stage
from avatarsim.scene.tracker import link_poses
from scenarios.live import judged, main, plan_of, staged_of

QUIET = ["--no-browser", "--port", "0"]


@pytest.mark.parametrize("name", NAMES)
def test_a_built_in_stage_is_the_same_as_in_the_package(name: str) -> None:
    assert staged_of(name) == (stage(name), {})


def test_a_scene_of_the_catalogue_comes_with_its_motion() -> None:
    found, clips = staged_of("hand_over_table")
    (clip,) = clips.values()
    assert found.scene.name == "hand_over_table" and found.handles and len(clip.times) > 1


def test_what_cannot_be_driven_is_refused_by_name() -> None:
    with pytest.raises(UnknownName, match="opera"):
        staged_of("opera")
    with pytest.raises(InvalidInput, match="a scene with an avatar"):
        staged_of("ball_drop")


def test_a_rival_is_asked_for_with_its_preset_or_has_the_tuned_one() -> None:
    scene = stage("hand").scene
    assert plan_of("mujoco", scene, 60.0).name == "mujoco/tuned"
    assert plan_of("pybullet/default", scene, 90.0).settings.preset == "default"
    with pytest.raises(UnknownName, match="'opera'"):
        plan_of("opera/tuned", scene, 60.0)


def test_the_judge_sees_a_hand_in_the_table_and_none_above_it() -> None:
    scene = stage("hand").scene
    depth = judged(scene)
    first = scene.first_sample
    links = link_poses(scene.avatars, first)
    bodies = np.array([body.position for body in scene.bodies]), np.array([body.orientation for body in scene.bodies])
    positions, orientations = (np.concatenate((a, b)) for a, b in zip(bodies, links, strict=True))
    assert depth(scene, positions, orientations, first.angles) <= 1e-6
    positions[len(scene.bodies):, 2] -= 0.25
    assert depth(scene, positions, orientations, first.angles) > 0.01


@pytest.mark.parametrize(("arguments", "said"), [
    (["--scene", "opera"], "opera"),
    (["--scene", "ball_drop"], "a scene with an avatar"),
    (["--engine", "mujoco/opera"], "preset of mujoco"),
    (["--motion", "walk.bvh"], "--avatar"),
])
def test_wrong_usage_ends_with_2_and_a_sentence(arguments: list[str], said: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main([*QUIET, *arguments]) == 2
    assert said in capsys.readouterr().err


def test_a_rival_runs_beside(capsys: pytest.CaptureFixture[str]) -> None:
    assert main([*QUIET, "--scene", "hand", "--engine", "mujoco/tuned", "--seconds", "1"]) == 0
    assert "http://127.0.0.1:" in capsys.readouterr().err
