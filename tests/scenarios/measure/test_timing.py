"""Frame times: minimum of all repeats, own time, tails with enough frames, and windows shared by all engines."""

from dataclasses import replace

import numpy as np
import pytest

from runfiles.timing_protocol import PHASE_FRAMES, REPEATS, TAIL_FRAMES
from scenarios.measure.frames import work
from scenarios.measure.timing import TAIL, Round, Timed, frame_times, time_notes
from scenarios.measure.value import Missing
from tests.scenarios.examples import fist_scene, resting


def test_the_least_of_all_repeats_counts() -> None:
    pattern = np.array([[1000, 9000, 3000], [2000, 2000, 50000], [4000, 8000, 60000]])
    around = np.tile(pattern, 67)
    found = frame_times(Timed(around, {}, 1.5, ("a", "a", "a")))
    assert found["frame_time_p50"] == 2.0 and found["frame_time_max"] == 60.0
    assert found["frame_time_raw_p50"] == pytest.approx(4.0)
    assert found["frame_time_python_p50"] == 2.0
    assert found["warmup"] == 1.5 and found["deterministic"] == 1.0


def test_the_engines_own_time_is_its_stages_without_our_adapter() -> None:
    around = np.array([[10_000, 10_000]])
    stages = {"step": np.array([[3000, 1000]]), "detect": np.array([[3000, 1000]]), "adapter": np.array([[2000, 2000]])}
    found = frame_times(Timed(around, stages))
    assert found["frame_time_p95"] == pytest.approx(5.8) and found["frame_time_p50"] == 4.0
    assert found["frame_time_python_p50"] == 10.0
    assert found["stage_share_step"] == found["stage_share_detect"] == 50.0
    assert "stage_share_adapter" not in found and "deterministic" not in found


@pytest.mark.parametrize(("ends", "recorded", "same"), [
    ("ab", (), 0.0), ("cc", "abcd", 1.0), ("cc", "acbc", 0.0),
])
def test_deterministic_means_equal_bits_in_all_repeats(ends: str, recorded: str, same: float) -> None:
    timed = Timed(np.ones((2, 2), dtype=np.int64), {}, 0.0, tuple(ends))
    assert frame_times(timed, tuple(recorded))["deterministic"] == same


def test_work_is_a_mean_per_frame_and_frames_of_a_state_a_sum() -> None:
    states = {name: np.array([9, 1, 0, k, 1]) for k, name in enumerate(("waiting", "planning", "following", "out_of_work"))}
    found = work(replace(resting(fist_scene(), 4), counts={**states, "pairs": np.array([100, 1, 2, 3, 4])}))
    # the first state is no frame
    assert found == {"waiting": 2.0, "planning": 3.0, "following": 4.0, "out_of_work": 5.0, "pairs_per_frame": 2.5}


@pytest.mark.parametrize(("repeats", "frames", "tail"), [
    (REPEATS, TAIL_FRAMES, True), (REPEATS - 1, TAIL_FRAMES, False), (REPEATS, TAIL_FRAMES - 1, False), (9, 1000, True),
])
def test_tail_wants_enough_repeats_of_enough_frames(repeats: int, frames: int, tail: bool) -> None:
    timed = Timed(np.full((repeats, frames), 5000, dtype=np.int64), warm_frames=30)
    found = frame_times(timed)
    assert found["frame_time_p50"] == found["frame_time_p95"] == 5.0
    for name in TAIL:
        value, said = found[name], f"{repeats} x {frames} frames, 30 "
        assert value == 5.0 if tail else isinstance(value, Missing) and value.reason.startswith(said)
    notes = time_notes(timed, found)
    assert set(notes) == {name for name in found if name.startswith("frame_time_") and isinstance(found[name], float)}
    assert found["frame_time_max"] == 5.0 and set(notes.values()) == {f"{repeats} x {frames} frames, 30 warm-up frames"}


def test_medians_are_of_shared_frames_and_tails_of_all_own() -> None:
    around = np.full((REPEATS, TAIL_FRAMES), 9000, dtype=np.int64)
    around[0, :50], around[1, :50], around[0, 7] = 3000, 1000, 50_000
    around[:, -1] = 70_000
    timed = Timed(around, warm_frames=30, shared=Round(1, 0, 50))
    found = frame_times(timed)
    # one repeat of 50 frames: the faster second repeat is not counted, since the others do not have it
    assert found["frame_time_p50"] == found["frame_time_python_p50"] == found["frame_time_raw_p50"] == 3.0
    assert found["frame_time_max"] == 70.0
    assert timed.compared_us.shape == (50,) and timed.compared_us[7] == 50.0 and timed.best_us.shape == (TAIL_FRAMES,)
    notes = time_notes(timed, found)
    assert notes["frame_time_p50"] == notes["frame_time_p95"] == "1 x 50 frames, 30 warm-up frames"
    assert notes["frame_time_p99"] == notes["frame_time_max"] == f"{REPEATS} x {TAIL_FRAMES} frames, 30 warm-up frames"


@pytest.mark.parametrize("moving", [0, PHASE_FRAMES - 1, PHASE_FRAMES, 80, 180])
def test_a_median_of_two_phases_is_told_apart(moving: int) -> None:
    """Return times in which the first frames move and take 20 us, and the others rest and take 1 us."""
    around = np.full((REPEATS, 180), 1000, dtype=np.int64)
    around[:, :moving] = 20_000
    timed, rests = Timed(around), [k >= moving for k in range(200)]
    found = frame_times(timed, resting=rests)
    notes = time_notes(timed, found, rests)
    assert ("frame_time_moving_p50" in found) == ("frame_time_resting_p50" in found) == (moving in (PHASE_FRAMES, 80))
    assert found["resting_frames"] == pytest.approx(100.0 * (180 - moving) / 180)
    if moving == 80:
        assert (found["frame_time_moving_p50"], found["frame_time_resting_p50"], found["frame_time_p50"]) == (20.0, 1.0, 1.0)
        assert notes["frame_time_moving_p50"].startswith(f"80 of {REPEATS} x 180 frames")
        assert notes["frame_time_p50"].endswith("; moving 20 us, resting 1 us")
    # a run whose recording is shorter than the timed frames gives no figure
    assert not {"frame_time_moving_p50", "resting_frames"} & set(frame_times(timed, resting=rests[:179]))


def test_no_tail_below_a_percentile_over_fewer_frames() -> None:
    """The first 50 frames are compared, and they are the expensive ones."""
    around = np.full((REPEATS, 5 * TAIL_FRAMES), 1000, dtype=np.int64)
    around[:, :5] = 40_000
    found = frame_times(Timed(around, shared=Round(REPEATS, 0, 50)))
    assert found["frame_time_p95"] == pytest.approx(40.0, rel=0.5) and found["frame_time_max"] == 40.0
    tail = found["frame_time_p99"]
    assert isinstance(tail, Missing) and "3 x 50 frames" in tail.reason and isinstance(found["frame_time_raw_p99"], Missing)
    whole = frame_times(Timed(around))
    assert whole["frame_time_p95"] == whole["frame_time_p99"] == 1.0


def test_shares_of_the_frames_are_those_of_a_sorted_list() -> None:
    """201 frames of 0 to 200 us, out of order: the share of frames is the time; slower repeats show in the raw ones alone."""
    fast = np.random.default_rng(0).permutation(201) * 1000
    found = frame_times(Timed(np.array([fast, fast + 400_000, fast + 800_000])))
    assert (found["frame_time_p50"], found["frame_time_p95"], found["frame_time_p99"]) == (100.0, 190.0, 198.0)
    # of all repeats together: 0 to 200, 400 to 600, 800 to 1000
    every = np.sort(np.concatenate([np.arange(201.0) + 400.0 * k for k in range(3)]))
    for share in (95, 99):
        below = np.mean(every <= found[f"frame_time_raw_p{share}"])
        assert below == pytest.approx(share / 100.0, abs=1.0 / len(every))
