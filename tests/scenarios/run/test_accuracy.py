"""The accuracy pass, in this process, on small scenes and engines of our own."""

import sys
from dataclasses import replace
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest

from avatarsim.errors import InvalidFile, MissingPackage, StartOverlaps
from avatarsim.scene.scene import Scene
from avatarsim.scene.tracker import TrackerSample, rest
from avatarsim.spatial import rotation
from runfiles import record
from scenarios.job import Job
from scenarios.run.accuracy import accuracy
from scenarios.scenario import Motion, Scenario
from tests.scenarios.bad_engines import MODULE, joined
from tests.scenarios.examples import DT, drop, fist, fist_motion, fist_scene

CATALOGUE = "a_catalogue_for_tests"


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A run folder, with the bad engines joined and a catalogue of three scenes."""
    site = tmp_path / "site"
    site.mkdir()
    monkeypatch.syspath_prepend(joined(site))
    module = ModuleType(CATALOGUE)
    offered: dict[str, Scenario] = {"fist": fist(), "drop": drop(), "refusing": Scenario(
        "refusing", "Begins badly.", "Refusal.", fist_scene, fist_motion, 5, expects={"refusal": True},
    )}
    monkeypatch.setattr(module, "get", offered.__getitem__, raising=False)
    monkeypatch.setattr(module, "offered", offered, raising=False)
    monkeypatch.setitem(sys.modules, CATALOGUE, module)
    return tmp_path / "run"


def job(scenario: str, engine: str, **more: object) -> Job:
    return Job(scenario, engine, "default", catalogue=CATALOGUE, **more)


def test_a_run_is_recorded_and_measured(folder: Path) -> None:
    outcome = accuracy(job("fist", "tunnels"), folder)
    assert (outcome.state, outcome.frames, len(outcome.overlap_m)) == ("measured", 30, 31)
    # 20 mm a frame for 30 frames, from 0: 0.6 m, and the wall's face is 0.4 m from where the fist begins to touch
    assert outcome.values["residual_overlap_max"] == pytest.approx(0.2, abs=1e-8)
    assert outcome.values["wrong_side_frames"] == 5.0
    assert outcome.values["tracker_offset_rms"] == 0.0
    assert outcome.about["settings"]["badness"] == ("Tunnels", "a test needs it")
    kept = record.load(folder / "recordings" / "fist.tunnels.default.0.npz")
    assert kept.positions[:, 1, 0] == pytest.approx(0.02 * np.arange(31))
    assert kept.raw_positions[:, 0, 0] == pytest.approx(0.02 * np.arange(31))
    assert kept.times == pytest.approx(np.arange(31) * DT)
    assert kept.meta["engine"] == "tunnels" and kept.meta["names"] == ["wall", "fist"] and len(str(kept.meta["scene_hash"])) == 16
    assert len(set(kept.state_hashes.tolist())) == 31


def test_what_happened_inside_frames_is_measured_and_then_left_out(folder: Path) -> None:
    """A second run has the figures of the first, and needs no state inside a frame for them."""
    asked = Job("ball_drop", "avatarsim", "default", frames=50)
    first = accuracy(asked, folder)
    kept = record.load(folder / "recordings" / "ball_drop.avatarsim.default.0.npz")
    assert "restitution_error_max" in first.values and len(kept.inside_time) == 0 and kept.frames == 50
    assert kept.overlap.tolist() == list(first.overlap_m)
    assert accuracy(asked, folder).values == first.values


@pytest.mark.parametrize("engine", ["tunnels", "not_a_number"])
def test_an_earlier_run_is_answered_from_as_if_it_were_run_again(folder: Path, engine: str) -> None:
    """To the last digit, figures that are no numbers or missing among them."""
    first = accuracy(job("fist", engine), folder)
    again = accuracy(job("fist", engine), folder)
    assert [repr(value) for value in first.values.values()] == [repr(value) for value in again.values.values()]
    assert list(first.values) == list(again.values) and repr(first.overlap_m) == repr(again.overlap_m)


def test_the_run_is_the_same_bits_again(folder: Path) -> None:
    accuracy(job("fist", "two_millimetres"), folder)
    one = record.load(folder / "recordings" / "fist.two_millimetres.default.0.npz").state_hashes.tolist()
    accuracy(job("fist", "two_millimetres"), folder)
    assert record.load(folder / "recordings" / "fist.two_millimetres.default.0.npz").state_hashes.tolist() == one


def test_frames_cut_a_run_short_and_options_reach_the_engine(folder: Path) -> None:
    outcome = accuracy(job("fist", "tunnels", frames=3, base="other", options={"gain": 2}), folder)
    assert outcome.frames == 3 and outcome.about["settings"]["gain"] == 2


def test_not_a_number_is_recorded_and_counted(folder: Path) -> None:
    outcome = accuracy(job("fist", "not_a_number"), folder)
    assert outcome.state == "measured" and outcome.values["not_finite_frames"] == 27.0
    assert np.isnan(outcome.values["residual_overlap_max"])
    assert np.isnan(record.load(folder / "recordings" / "fist.not_a_number.default.0.npz").positions[-1]).all()


def test_an_engine_that_raises_has_crashed_and_its_frames_stay(folder: Path) -> None:
    outcome = accuracy(job("fist", "raises"), folder)
    assert (outcome.state, outcome.frames) == ("crashed", 4)
    assert outcome.note == "in frame 4: RuntimeError: the solver has lost its way"
    kept = record.load(folder / "recordings" / "fist.raises.default.0.npz")
    assert kept.frames == 3 and kept.meta["error"] == outcome.note


def test_a_missing_package_is_not_measured(folder: Path) -> None:
    outcome = accuracy(job("fist", "absent"), folder)
    assert outcome.state == "not-measured" and "a_package_that_nobody_has" in outcome.note


def test_what_is_no_engine_has_crashed_before_it_began(folder: Path) -> None:
    outcome = accuracy(job("fist", "no_engine"), folder)
    assert outcome.state == "crashed" and "avatarsim.engine.Engine" in outcome.note


def test_an_engine_without_words_for_the_scene_is_not_run(folder: Path) -> None:
    outcome = accuracy(job("fist", "speechless"), folder)
    assert (outcome.state, outcome.note) == ("cannot-say", "it knows spheres only")
    assert not (folder / "recordings").exists()


def test_a_preset_that_the_engine_lacks_names_those_it_has(folder: Path) -> None:
    outcome = accuracy(Job("fist", "tunnels", "fastest", catalogue=CATALOGUE), folder)
    assert outcome.state == "crashed" and "'fastest'" in outcome.note and "default, other" in outcome.note


@pytest.mark.parametrize(("scenario", "state"), [("fist", "crashed"), ("refusing", "refused")])
def test_a_refused_start_is_right_where_the_scene_expects_it(
    folder: Path, monkeypatch: pytest.MonkeyPatch, scenario: str, state: str,
) -> None:
    accuracy(job("drop", "tunnels"), folder)

    def refuse(self: object, *arguments: object) -> None:
        raise StartOverlaps([("fist", "wall", 0.01)])

    monkeypatch.setattr(sys.modules[MODULE].Frozen, "load", refuse)
    outcome = accuracy(job(scenario, "tunnels"), folder)
    assert outcome.state == state and "fist in wall by 10 mm" in outcome.note


@pytest.mark.parametrize("error", [
    InvalidFile("clip.txt", "12 frames and a half", "whole frames"), MissingPackage("trimesh", "assets", "the duck"),
])
def test_a_scene_that_cannot_be_made_is_not_measured_and_earlier_files_stay(folder: Path, error: Exception) -> None:
    accuracy(job("fist", "tunnels"), folder)
    before = (folder / "recordings" / "fist.tunnels.default.0.npz").read_bytes()

    def broken() -> None:
        raise error

    sys.modules[CATALOGUE].offered["broken"] = Scenario("broken", "B.", "B.", broken, fist_motion, 3)
    outcome = accuracy(job("broken", "tunnels"), folder)
    assert outcome.state == "not-measured" and str(error) in outcome.note
    assert (folder / "recordings" / "fist.tunnels.default.0.npz").read_bytes() == before


def test_a_tracker_sample_that_is_no_number_is_named_before_any_engine_sees_it(folder: Path) -> None:
    def lost(scene: object, seed: int) -> object:
        motion = fist_motion(scene, seed)
        return lambda k: replace(motion(k), positions=np.full((1, 3), np.nan)) if k == 2 else motion(k)

    sys.modules[CATALOGUE].offered["lost"] = replace(fist(), name="lost", motion=lost)
    outcome = accuracy(job("lost", "tunnels"), folder)
    assert outcome.state == "not-measured" and "InvalidSample: tracker positions" in outcome.note


def test_a_second_run_in_the_same_folder_keeps_whole_recordings_only(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = folder / "recordings" / "fist.tunnels.default.0.npz"
    first = accuracy(job("fist", "tunnels"), folder)
    written = path.stat().st_mtime_ns
    again = accuracy(job("fist", "tunnels"), folder)
    assert path.stat().st_mtime_ns == written and again.values == first.values and again.overlap_m == first.overlap_m
    assert (again.notes, again.hashes, again.frame_seconds) == (first.notes, first.hashes, first.frame_seconds)
    (folder / "overlaps" / "fist.tunnels.default.0.npz").unlink()
    accuracy(job("fist", "tunnels"), folder)
    assert (folder / "overlaps" / "fist.tunnels.default.0.npz").exists(), "the pairs that overlap are part of what is kept"
    path.write_bytes(path.read_bytes()[:-100])
    assert accuracy(job("fist", "tunnels"), folder).values == first.values, "a truncated one is made anew"
    written = path.stat().st_mtime_ns
    accuracy(job("fist", "tunnels", options={"gain": 1}), folder)
    assert path.stat().st_mtime_ns > written, "other settings are another run"
    written = path.stat().st_mtime_ns
    monkeypatch.setattr("scenarios.run.accuracy.code_hash", lambda: "0" * 16)
    accuracy(job("fist", "tunnels", options={"gain": 1}), folder)
    assert path.stat().st_mtime_ns > written, "other code is another run"


def spinning_motion(scene: Scene, seed: int) -> Motion:
    """The fist where it is, turning by 0.3 rad a frame."""
    def sample(frame: int) -> TrackerSample:
        turn = rotation.from_axis_angle(np.array([0.0, 0.0, 1.0]), np.array(0.3 * (frame + 1)))
        return replace(rest(scene.avatars, (frame + 1) * DT), rotations=turn[None])

    return sample


def test_quaternions_of_a_recording_keep_their_side(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    spinning = replace(fist(60), name="spinning", motion=spinning_motion)
    monkeypatch.setattr(sys.modules[CATALOGUE], "get", {"spinning": spinning}.__getitem__)
    assert accuracy(job("spinning", "avatarsim"), folder).state == "measured"
    kept = record.load(folder / "recordings" / "spinning.avatarsim.default.0.npz")
    for turns in (kept.orientations, kept.raw_orientations):
        assert ((turns[1:] * turns[:-1]).sum(axis=-1) > 0.0).all() and (turns[:, -1, 0] < -0.9).any()
