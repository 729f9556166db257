"""A replay holds what was recorded, and opens where something is wrong."""

import base64
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from reports.pages.scripts import data
from reports.reading.kept import Drawn, drawn, shown
from reports.replay.packed import LEAST, MISSING, MOST, codes, text
from reports.replay.scene import BYTES_PER_POSE, MOST_BYTES, replay, stride
from tests.reports.recorded import STATES, recording, scene
from tests.reports.small_runs import OURS

NAME, THEIRS, SHORT = "arm_wall", "mujoco/default", 12


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """Recordings of two engines; theirs ends early and sinks."""
    scene(tmp_path, NAME)
    recording(tmp_path, NAME, OURS)
    recording(tmp_path, NAME, THEIRS, states=SHORT, sinks=True)
    return tmp_path


def bodies(folder: Path) -> Drawn:
    """The scene's file."""
    found = drawn(folder, NAME)
    assert found is not None
    return found


def unpacked(packed: str, stretch: tuple[float, float]) -> np.ndarray:
    """The numbers again, as a page unpacks them."""
    found = np.frombuffer(base64.b64decode(packed), dtype="<u2").astype(np.float64)
    low, high = stretch
    return np.where(found == MISSING, np.nan, low + (found - LEAST) / (MOST - LEAST) * (high - low))


def held(folder: Path, **change: Any) -> Any:
    """The data of a replay; ``change`` are values that arrays of our recording have from state 5 on."""
    found = shown(folder, NAME, [OURS, THEIRS])
    for name, value in change.items():
        getattr(found[0], name)[5:, 1] = value
    return replay(bodies(folder), found, OURS)


def test_poses_and_pairs_come_back(folder: Path) -> None:
    found = held(folder)
    ours, theirs = found["runs"]
    assert (ours["run"], ours["frames"], theirs["run"], theirs["frames"]) == (OURS, STATES, THEIRS, SHORT)
    assert found["moving"] == [1, 2] and found["links"] == [2] and found["ghost"]["frames"] == STATES
    heights = unpacked(ours["places"], (found["low"][2], found["high"][2])).reshape(STATES, 2, 3)[:, 0, 2]
    assert heights == pytest.approx(1.0 - 5.0 * (np.arange(STATES) / 60.0) ** 2, abs=1e-4)
    # depths below what counts as overlap are no pair
    assert theirs["pairs"][10] == [(2, 0, "20 mm")] and theirs["pairs"][9] == [(2, 0, "10 mm")] and not any(ours["pairs"])


@pytest.mark.parametrize("value", [np.nan, np.inf])
@pytest.mark.parametrize("name", ["positions", "orientations"])
def test_what_is_no_number_is_hidden_and_not_drawn(folder: Path, name: str, value: float) -> None:
    found = held(folder, **{name: value})
    places = unpacked(found["runs"][0]["places"], (0.0, 1.0)).reshape(STATES, 2, 3)
    assert np.isnan(places[5:, 0]).all() and not np.isnan(places[:5]).any()
    assert found["runs"][0]["broken"] == list(range(5, STATES)) and found["runs"][1]["broken"] == []
    data(found)


def test_it_opens_where_ours_looks_worst_and_offers_the_worst_of_the_others(folder: Path) -> None:
    ours, theirs = shown(folder, NAME, [OURS, THEIRS])
    ours.positions[12, 2, 0] += 0.4
    found: Any = replay(bodies(folder), [ours, theirs], OURS)
    # the jump there and the jump back are equal but for rounding
    assert found["opens"]["ours"]["state"] in (12, 13) and found["opens"]["others"] == {"state": 10, "run": THEIRS}
    calm: Any = replay(bodies(folder), [shown(folder, NAME, [OURS])[0]], OURS)
    assert calm["opens"] == {}
    alone: Any = replay(bodies(folder), [theirs], OURS)
    assert set(alone["opens"]) == {"others"}


def test_the_view_holds_the_user_too(folder: Path) -> None:
    ours = shown(folder, NAME, [OURS])[0]
    near: Any = replay(bodies(folder), [ours], OURS)
    ours.raw_positions[:, :, 0] += 3.0
    far: Any = replay(bodies(folder), [ours], OURS)
    # user and link are 1.5 m from their middle
    assert far["near"] >= 1.5 + max(far["reach"]) - 1e-9 > near["near"]


def test_without_a_recording_of_an_engine_there_is_no_replay(folder: Path) -> None:
    assert replay(bodies(folder), [], OURS) is None
    recording(folder, NAME, "tracker/default")
    assert replay(bodies(folder), shown(folder, NAME, ["tracker/default"]), OURS) is None


def test_packed_numbers_come_back_within_half_a_step() -> None:
    values = np.array([-1.0, 0.0, 0.123456, 3.0, np.nan, np.inf, 9.0])
    found = unpacked(text(codes(values, -1.0, 3.0)), (-1.0, 3.0))
    assert found[:4] == pytest.approx(values[:4], abs=0.5 * 4.0 / 65534 + 1e-12)
    assert np.isnan(found[4:6]).all() and found[6] == 3.0
    assert unpacked(text(codes(np.zeros(3), 0.0, 0.0)), (0.0, 0.0)).tolist() == [0.0] * 3


@pytest.mark.parametrize("frames", [1, 600, 1200, 3601])
@pytest.mark.parametrize("moving", [1, 15, 216])
def test_a_long_scene_leaves_out_states(frames: int, moving: int) -> None:
    step = stride([frames] * 6, moving)
    kept = 6 * moving * BYTES_PER_POSE * frames / step
    assert step >= 1 and kept <= MOST_BYTES and (step > 1) == (frames > 600 or 6 * moving * BYTES_PER_POSE * frames > MOST_BYTES)
