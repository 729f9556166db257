"""The accuracy pass, in this process, on small scenes and engines of tests."""

import sys
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np
import pytest

from avatarsim.errors import InvalidSample, StartOverlaps
from avatarsim.scene.scene import Scene
from avatarsim.scene.tracker import TrackerSample, link_poses, rest
from avatarsim.spatial import rotation
from runfiles import record
from scenarios.job import Job
from scenarios.run.accuracy import accuracy, prepare
from scenarios.scenario import Motion, Scenario
from tests.scenarios.bad_engines import MODULE, joined
from tests.scenarios.examples import DT, drop, fist, fist_motion

CATALOGUE = "a_catalogue_for_tests"
FIST = Path("recordings") / "fist.tunnels.default.0.npz"


@pytest.fixture
def offered(monkeypatch: pytest.MonkeyPatch) -> dict[str, Scenario]:
    """Return a catalogue of three scenes; a test may change it."""
    found = {"fist": fist(), "drop": drop(), "refusing": replace(fist(5), expects={"refusal": True})}
    module = ModuleType(CATALOGUE)
    monkeypatch.setattr(module, "get", found.__getitem__, raising=False)
    monkeypatch.setitem(sys.modules, CATALOGUE, module)
    return found


@pytest.fixture
def folder(tmp_path: Path, offered: dict[str, Scenario], monkeypatch: pytest.MonkeyPatch) -> Path:
    """Return a run folder, with the bad engines installed."""
    site = tmp_path / "site"
    site.mkdir()
    monkeypatch.syspath_prepend(joined(site))
    return tmp_path / "run"


def job(scenario: str, engine: str = "tunnels", preset: str = "default", **more: Any) -> Job:
    return Job(scenario, engine, preset, catalogue=CATALOGUE, **more)


def moved(change: Callable[[int, TrackerSample], TrackerSample]) -> Callable[[Scene, int], Motion]:
    """Return the scenario of the fist with a changed motion."""
    def motion(scene: Scene, seed: int) -> Motion:
        user = fist_motion(scene, seed)
        return lambda k: change(k, user(k))

    return motion


@pytest.mark.usefixtures("offered")
@pytest.mark.parametrize(
    "other", [{"seed": 1}, {"frames": 2}, {"narrow": ("friction",)}, {"force": ("friction",)}, {"full": True}],
)
def test_engines_of_a_scene_share_what_is_prepared(other: dict[str, Any]) -> None:
    first = prepare(job("fist"))
    assert prepare(job("fist", "mujoco", options={"dt": 0.001})) is first
    assert prepare(job("fist", "mujoco")).samples is first.samples
    assert prepare(job("fist", **other)) is not first and prepare(job("drop")).scene.name != first.scene.name


def test_the_tracker_has_its_links_where_kinematics_says(offered: dict[str, Scenario]) -> None:
    """And a scenario of the same name is prepared anew."""
    found = prepare(job("fist"))
    assert len(found.states) == found.scenario.frames + 1 and found.states[0] is found.scene.first_sample
    for k, state in enumerate(found.states):
        positions, orientations = link_poses(found.scene.avatars, state)
        assert found.raw[0][k].tolist() == positions.tolist() and found.raw[1][k].tolist() == orientations.tolist()
    offered["fist"] = fist()
    assert prepare(job("fist")) is not found


def test_a_run_is_recorded_and_measured(folder: Path) -> None:
    outcome = accuracy(job("fist"), folder)
    assert (outcome.state, outcome.frames, len(outcome.overlap_m)) == ("measured", 30, 31)
    # 20 mm per frame for 30 frames, from 0: 0.6 m; the fist begins to touch the wall's face at 0.4 m
    assert outcome.values["residual_overlap_max"] == pytest.approx(0.2, abs=1e-8)
    assert (outcome.values["wrong_side_frames"], outcome.values["tracker_offset_rms"]) == (5.0, 0.0)
    assert dict[str, Any](outcome.about)["settings"]["badness"] == ("Tunnels", "a test needs it")
    kept = record.load(folder / FIST)
    assert kept.positions[:, 1, 0] == pytest.approx(0.02 * np.arange(31))
    assert kept.raw_positions[:, 0, 0] == pytest.approx(0.02 * np.arange(31))
    assert kept.times == pytest.approx(np.arange(31) * DT)
    assert kept.meta["engine"] == "tunnels" and kept.meta["names"] == ["wall", "fist"] and len(str(kept.meta["scene_hash"])) == 16
    assert len(set(kept.state_hashes.tolist())) == 31


def test_states_inside_frames_are_measured_and_then_left_out(folder: Path) -> None:
    ball = Job("ball_drop", "avatarsim", "default", frames=50)
    first = accuracy(ball, folder)
    kept = record.load(folder / "recordings" / "ball_drop.avatarsim.default.0.npz")
    assert "restitution_error_max" in first.values and len(kept.inside_time) == 0 and kept.frames == 50
    assert kept.overlap.tolist() == list(first.overlap_m) and accuracy(ball, folder).values == first.values


@pytest.mark.parametrize("engine", ["tunnels", "not_a_number"])
def test_second_job_has_the_figures_of_the_first_to_the_bit(folder: Path, engine: str) -> None:
    first, again = accuracy(job("fist", engine), folder), accuracy(job("fist", engine), folder)
    assert repr(first.values) == repr(again.values) and repr(first.overlap_m) == repr(again.overlap_m)
    assert (again.notes, again.hashes, again.frame_seconds) == (first.notes, first.hashes, first.frame_seconds)


def test_a_recording_is_kept_while_it_is_whole_and_of_this_job(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def written(**more: Any) -> int:
        accuracy(job("fist", **more), folder)
        return (folder / FIST).stat().st_mtime_ns

    first = written()
    hashes = record.load(folder / FIST).state_hashes.tolist()
    assert written() == first
    (folder / "overlaps" / FIST.name).unlink()
    second = written()
    assert second > first and (folder / "overlaps" / FIST.name).exists()
    (folder / FIST).write_bytes((folder / FIST).read_bytes()[:-100])
    written()
    assert record.load(folder / FIST).state_hashes.tolist() == hashes
    third, fourth = written(), written(options={"gain": 1})
    monkeypatch.setattr("scenarios.run.accuracy.code_hash", lambda: "0" * 16)
    assert third < fourth < written(options={"gain": 1})


def test_frames_cut_a_run_short_and_options_reach_the_engine(folder: Path) -> None:
    outcome = accuracy(job("fist", frames=3, base="other", options={"gain": 2}), folder)
    assert outcome.frames == 3 and dict[str, Any](outcome.about)["settings"]["gain"] == 2


def test_an_engine_that_raises_has_crashed_and_its_frames_stay(folder: Path) -> None:
    outcome = accuracy(job("fist", "raises"), folder)
    assert (outcome.state, outcome.frames) == ("crashed", 4)
    assert "in frame 4" in outcome.note and "RuntimeError" in outcome.note
    kept = record.load(folder / "recordings" / "fist.raises.default.0.npz")
    assert kept.frames == 3 and kept.meta["error"] == outcome.note


def test_an_engine_that_returns_no_record_has_crashed_with_its_type(folder: Path) -> None:
    outcome = accuracy(job("fist", "unrecorded"), folder)
    assert outcome.state == "crashed" and outcome.frames == 1 and "InvalidInput" in outcome.note and "ndarray" in outcome.note


@pytest.mark.parametrize(("scenario", "state"), [("fist", "crashed"), ("refusing", "refused")])
def test_a_refused_start_is_right_where_the_scene_expects_it(
    folder: Path, monkeypatch: pytest.MonkeyPatch, scenario: str, state: str,
) -> None:
    accuracy(job("drop"), folder)

    def refuse(self: object, *arguments: object) -> None:
        raise StartOverlaps([("fist", "wall", 0.01)])

    monkeypatch.setattr(sys.modules[MODULE].Frozen, "load", refuse)
    assert accuracy(job(scenario), folder).state == state


def test_invalid_sample_is_found_before_any_engine_runs(folder: Path, offered: dict[str, Scenario]) -> None:
    nowhere = np.full((1, 3), np.nan)
    offered["lost"] = replace(fist(), motion=moved(lambda k, one: replace(one, positions=nowhere) if k == 2 else one))
    for _ in range(2):
        with pytest.raises(InvalidSample):
            _ = prepare(job("lost")).samples
    outcome = accuracy(job("lost"), folder)
    assert outcome.state == "not-measured" and "InvalidSample" in outcome.note


def test_quaternions_of_a_recording_keep_their_side(folder: Path, offered: dict[str, Scenario]) -> None:
    def spinning(scene: Scene, seed: int) -> Motion:
        axis, still = np.array([0.0, 0.0, 1.0]), rest(scene.avatars, 0.0)
        turns = [rotation.from_axis_angle(axis, np.array(0.3 * (k + 1)))[None] for k in range(60)]
        return lambda k: replace(still, time=(k + 1) * DT, rotations=turns[k])

    offered["fist"] = replace(fist(60), motion=spinning)
    assert accuracy(job("fist", "avatarsim"), folder).state == "measured"
    kept = record.load(folder / "recordings" / "fist.avatarsim.default.0.npz")
    for turns in (kept.orientations, kept.raw_orientations):
        assert ((turns[1:] * turns[:-1]).sum(axis=-1) > 0.0).all() and (turns[:, -1, 0] < -0.9).any()
