"""A replay contains the recorded data and opens at a fault."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from reports.pages.scripts import data
from reports.reading.kept import Drawn, read_scene, shown
from reports.replay.scene import BYTES_PER_POSE, MAX_BYTES, replay, stride
from tests.player.test_payload import unpacked
from tests.reports.recorded import STATES, recording, scene
from tests.reports.small_runs import OURS

NAME, THEIRS, SHORT = "arm_wall", "mujoco/default", 12


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """Return a folder with recordings of two engines; that of the other engine ends early and sinks."""
    scene(tmp_path, NAME)
    recording(tmp_path, NAME, OURS)
    recording(tmp_path, NAME, THEIRS, states=SHORT, sinks=True)
    return tmp_path


def bodies(folder: Path) -> Drawn:
    """Return the bodies from the scene's file."""
    found = read_scene(folder, NAME)
    assert found is not None
    return found


def held(folder: Path, **change: Any) -> Any:
    """Return the data of a replay; ``change`` are values of arrays of our recording from state 5 on."""
    found = shown(folder, NAME, [OURS, THEIRS])
    for name, value in change.items():
        getattr(found[0], name)[5:, 1] = value
    return replay(NAME, bodies(folder), found, OURS)


def test_poses_and_pairs_come_back(folder: Path) -> None:
    found = held(folder)
    ours, theirs = found["views"]
    assert (ours["states"], theirs["states"], len(found["times"])) == (STATES, SHORT, STATES)
    assert found["moving"] == [1, 2] and found["ghost"]["bodies"] == [2] and found["ghost"]["states"] == STATES
    heights = unpacked(ours["places"], found["low"][2], found["high"][2]).reshape(STATES, 2, 3)[:, 0, 2]
    assert heights == pytest.approx(1.0 - 5.0 * (np.arange(STATES) / 60.0) ** 2, abs=1e-4)
    # depths below the level of overlap give no pair
    assert theirs["pairs"] == {9: [(2, 0)], 10: [(2, 0)]} and not ours["pairs"]
    assert {state: caption[1].split(":")[0] for state, caption in theirs["captions"].items()} == {9: "10 mm", 10: "20 mm"}


@pytest.mark.parametrize("value", [np.nan, np.inf])
@pytest.mark.parametrize("name", ["positions", "orientations"])
def test_what_is_no_number_is_hidden_and_not_drawn(folder: Path, name: str, value: float) -> None:
    found = held(folder, **{name: value})
    places = unpacked(found["views"][0]["places"], 0.0, 1.0).reshape(STATES, 2, 3)
    assert np.isnan(places[5:, 0]).all() and not np.isnan(places[:5]).any()
    captions = found["views"][0]["captions"]
    assert sorted(captions) == list(range(5, STATES)) and {kind for kind, _ in captions.values()} == {"overlap"}
    data(found)


def test_replay_opens_where_ours_looks_worst(folder: Path) -> None:
    ours, theirs = shown(folder, NAME, [OURS, THEIRS])
    ours.positions[12, 2, 0] += 0.4
    found: Any = replay(NAME, bodies(folder), [ours, theirs], OURS)
    # the jump there and the jump back are equal apart from rounding
    assert found["opens"] in (12, 13)
    calm: Any = replay(NAME, bodies(folder), [shown(folder, NAME, [OURS])[0]], OURS)
    assert calm["opens"] == 0
    alone: Any = replay(NAME, bodies(folder), [theirs], OURS)
    assert alone["opens"] == 10


def test_the_view_holds_the_user_too(folder: Path) -> None:
    ours = shown(folder, NAME, [OURS])[0]
    near: Any = replay(NAME, bodies(folder), [ours], OURS)
    ours.raw_positions[:, :, 0] += 3.0
    far: Any = replay(NAME, bodies(folder), [ours], OURS)
    # user and link are 1.5 m from their middle
    assert far["eye"]["near"] >= 1.5 + far["eye"]["reach"] - 1e-9 > near["eye"]["near"]


def test_without_a_recording_of_an_engine_there_is_no_replay(folder: Path) -> None:
    assert replay(NAME, bodies(folder), [], OURS) is None
    recording(folder, NAME, "tracker/default")
    assert replay(NAME, bodies(folder), shown(folder, NAME, ["tracker/default"]), OURS) is None


@pytest.mark.parametrize("frames", [1, 600, 1200, 3601])
@pytest.mark.parametrize("moving", [1, 15, 216])
def test_a_long_scene_leaves_out_states(frames: int, moving: int) -> None:
    step = stride([frames] * 6, moving)
    kept = 6 * moving * BYTES_PER_POSE * frames / step
    assert step >= 1 and kept <= MAX_BYTES and (step > 1) == (frames > 600 or 6 * moving * BYTES_PER_POSE * frames > MAX_BYTES)
