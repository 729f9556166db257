"""Series hold what the run itself measured, and come back from disk as they went, until something they depend on changes."""

from dataclasses import fields, replace
from pathlib import Path

import numpy as np
import pytest

from scenarios.job import Job
from scenarios.posture_table.runs import Kept, Seen, seen
from scenarios.posture_table.series import Series
from scenarios.running.run import accuracy


@pytest.fixture(scope="module")
def job() -> Job:
    """Chatter, a jump of the user and frames in contact, all within the first 80 frames; by an engine that overlaps."""
    return Job("teleport", "avatarsim", "paper", frames=80)


@pytest.fixture(scope="module")
def found(job: Job, tmp_path_factory: pytest.TempPathFactory) -> Seen:
    return seen(job, tmp_path_factory.mktemp("runs"), None)


def test_series_pooled_give_the_figures_of_the_run(job: Job, found: Seen, tmp_path: Path) -> None:
    values, s = accuracy(job, tmp_path).values, found.series
    assert s is not None and len(s.turn) == 80
    held = s.contact > 0.0
    same = {
        "chatter_frames": 100.0 * s.shakes[held].mean(), "reversal_p95": np.percentile(s.reversal[held], 95.0),
        "silent_offset_frames": s.silent.sum(), "pose_jump_max": s.turn.max(), "root_jump_max": s.way.max(),
        "tracker_offset_rms": np.sqrt((s.offset**2).mean()), "tracker_angle_rms": np.sqrt((s.angle**2).mean()),
        "tracker_offset_max": s.farthest.max(), "wrong_side_frames": s.wrong.sum(),
        "residual_overlap_max": s.overlap.max(),
    }
    for name, value in same.items():
        assert values[name] == pytest.approx(value, rel=1e-9, abs=1e-12), name
    assert s.limits.max() == pytest.approx(values["joint_limit_excess_max"], abs=1e-9)
    assert 0 < held.sum() and s.turn.max() > 15.0


def test_no_recording_is_left(job: Job, tmp_path: Path) -> None:
    run = seen(replace(job, frames=5), tmp_path, None)
    assert run.state == "measured" and not list(tmp_path.glob("recordings/*"))


def test_a_run_that_ends_early_says_why(tmp_path: Path) -> None:
    run = seen(Job("teleport", "avatarsim", "no such preset", frames=5), tmp_path, None)
    assert run.state == "crashed" and "no such preset" in run.note and run.series is None


def test_a_kept_run_comes_back_to_the_last_bit_and_another_motion_does_not(found: Seen, tmp_path: Path) -> None:
    kept, times = Kept(tmp_path), np.array([1.5, np.nan, 3.25])
    assert kept.get(found.job) is None
    kept.put(replace(found, times=times))
    back = Kept(tmp_path).get(found.job)
    assert back is not None and back.series is not None and found.series is not None
    assert back.figures == found.figures and np.array_equal(back.times, times, equal_nan=True)
    for entry in fields(Series):
        assert np.array_equal(getattr(back.series, entry.name), getattr(found.series, entry.name), equal_nan=True)
    assert kept.get(replace(found.job, frames=79)) is None and kept.get(replace(found.job, seed=1)) is None
