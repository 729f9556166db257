"""Many unseen motions at length: every broken promise fails the command and is named with its seed; how it looks never does."""

import math
from dataclasses import replace
from pathlib import Path

import pytest

from scenarios.job import Job, Outcome
from scenarios.studies.broken import broken, figure
from scenarios.studies.unseen_motions import Seen, jobs, seen, table
from scenarios.unseen import NAME
from scenarios.unseen.__main__ import main

KEPT = {
    "residual_overlap_max": 1e-7, "wrong_side_frames": 0.0, "not_finite_frames": 0.0, "joint_limit_excess_max": 1e-12,
    "reach_cone_excess_max": 0.0, "chatter_frames": 99.0, "reversal_p95": 0.02,
    "own_acceleration_rms": 50.0, "dash_frames": 3.0, "silent_offset_frames": 9.0,
}


def result(seed: int = 7, **figures: float) -> Seen:
    job = Job("unseen_wall", "avatarsim", "default", seed, catalogue=NAME)
    return Seen(Outcome(job, "measured", frames=600, values={**KEPT, **figures}), 1234.5)


def test_every_motion_in_every_room_with_rising_seeds() -> None:
    found = jobs(3, 10)
    assert len(found) == 15 and {job.seed for job in found} == {10, 11, 12} and {job.catalogue for job in found} == {NAME}


@pytest.mark.parametrize(("metric", "value"), [
    ("residual_overlap_max", 2e-6), ("residual_overlap_max", float("nan")), ("joint_limit_excess_max", 1e-6),
    ("reach_cone_excess_max", 1.0), ("wrong_side_frames", 1.0), ("not_finite_frames", 1.0),
])
def test_a_broken_promise_is_named_with_its_seed(metric: str, value: float) -> None:
    ((broke, said),) = broken(result(42, **{metric: value}).outcome).items()
    assert broke == metric and "unseen_wall --seed 42" in said


def test_how_it_looks_has_no_bound_and_stands_in_the_table() -> None:
    assert broken(result().outcome) == {}
    head, line = table([result(), replace(result(8), slowest=2000.0)]).splitlines()
    assert head and line.split() == "unseen_wall 2 1e-07 1e-12 99.00 20.00 50.00 6 18 2000".split()


def test_a_figure_that_is_missing_has_broken_its_promise() -> None:
    empty = replace(result(), outcome=replace(result().outcome, values={}))
    assert len(broken(empty.outcome)) == 5


def test_a_motion_is_run_measured_and_timed_and_leaves_no_recording(tmp_path: Path) -> None:
    found = seen(Job("unseen_floor", "tracker", "default", 3, frames=8, catalogue=NAME), tmp_path)
    assert found.outcome.state == "measured" and found.slowest > 0.0 and not list(tmp_path.glob("recordings/*"))
    # the raw tracker is its own target; in eight frames it meets nothing, and so has no frame in contact
    assert figure(found.outcome, "not_finite_frames") == 0.0 and figure(found.outcome, "dash_frames") == 0.0
    assert math.isnan(figure(found.outcome, "chatter_frames"))


def test_the_command_says_where_its_seed_comes_from(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["--motions", "0"]) == 2 and main(["--seed", "-1"]) == 2
    assert main(["--motions", "1", "--seed", "5", "--frames", "4", "--jobs", "2"]) == 0
    said = capsys.readouterr().out
    assert "seed 5 of the unseen motions, as asked for" in said and said.count("unseen_") == 5
