from dataclasses import replace

import numpy as np
import pytest

from scenarios.measure.counts import work
from scenarios.measure.timing import Timed, frame_times
from tests.scenarios.examples import fist_scene, resting


def test_the_least_of_all_repeats_counts_and_the_raw_times_stand_beside() -> None:
    around = np.array([[1000, 9000, 3000], [2000, 2000, 50000]])
    found = frame_times(Timed(around, {}, 1.5, ("a", "a")))
    assert found["frame_time_p50"] == 2.0 and found["frame_time_max"] == 3.0
    assert found["frame_time_raw_max"] == 50.0
    assert found["frame_time_raw_p50"] == pytest.approx(2.5)
    assert found["frame_time_python_p50"] == 2.0
    assert found["warmup"] == 1.5 and found["deterministic"] == 1.0


def test_the_engines_own_time_is_its_stages_without_our_adapter() -> None:
    around = np.array([[10_000, 10_000]])
    stages = {"step": np.array([[3000, 1000]]), "detect": np.array([[3000, 1000]]), "adapter": np.array([[2000, 2000]])}
    found = frame_times(Timed(around, stages))
    assert found["frame_time_max"] == 6.0 and found["frame_time_python_p50"] == 10.0
    assert found["stage_share_step"] == found["stage_share_detect"] == 50.0
    assert "stage_share_adapter" not in found and "deterministic" not in found


def test_repeats_that_end_in_other_bits_are_not_deterministic() -> None:
    assert frame_times(Timed(np.ones((2, 2), dtype=np.int64), {}, 0.0, ("a", "b")))["deterministic"] == 0.0


def test_the_accuracy_pass_must_have_reached_the_same_bits_at_the_same_frame() -> None:
    timed = Timed(np.ones((2, 2), dtype=np.int64), {}, 0.0, ("c", "c"))
    assert frame_times(timed, ("a", "b", "c", "d"))["deterministic"] == 1.0
    assert frame_times(timed, ("a", "c", "b", "c"))["deterministic"] == 0.0


def test_work_is_a_mean_per_frame_and_resyncs_a_sum() -> None:
    recording = replace(
        resting(fist_scene(), 4), counts={"pairs": np.array([100, 1, 2, 3, 4]), "resyncs": np.array([0, 1, 0, 2, 0])},
    )
    assert work(recording) == {"pairs_per_frame": 2.5, "resyncs": 3.0}


def test_shares_of_the_frames_are_those_of_a_sorted_list() -> None:
    """101 frames of 0 to 100 us, out of order: the share of frames is the time; the slower repeat shows in the raw ones alone."""
    fast = np.random.default_rng(0).permutation(101) * 1000
    found = frame_times(Timed(np.array([fast, fast + 200_000])))
    assert (found["frame_time_p50"], found["frame_time_p95"], found["frame_time_p99"]) == (50.0, 95.0, 99.0)
    # of both repeats together: 0 to 100, then 200 to 300
    both = np.sort(np.concatenate([np.arange(101.0), np.arange(200.0, 301.0)]))
    for share in (95, 99):
        below = np.mean(both <= found[f"frame_time_raw_p{share}"])
        assert below == pytest.approx(share / 100.0, abs=1.0 / len(both))


def test_what_is_trapped_walled_and_crossed_is_a_sum_over_the_run() -> None:
    numbers = {name: np.array([9, 1, 0, k, 1]) for k, name in enumerate(("trapped", "walled", "crossings", "leaps"))}
    found = work(replace(resting(fist_scene(), 4), counts=numbers))
    # the first state is no frame
    assert found == {"trapped": 2.0, "walled": 3.0, "crossings": 4.0, "leaps": 5.0}
