"""Trials of hard cases: deliberately bad engines, and a good one."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from scenarios import catalog
from scenarios.job import Job
from scenarios.studies.checkpoint import Entry
from scenarios.studies.hard_cases import ask as room
from scenarios.studies.hard_cases import trial
from scenarios.studies.hard_cases.ask import SHORT, STUDY, tasks_of
from scenarios.studies.hard_cases.plan import Trial, trials
from scenarios.studies.hard_cases.trial import Task, tried
from scenarios.studies.hard_cases.variation import Variation
from scenarios.studies.study import Request


def task(engine: str, case: str = "stack_ten", change: Variation | None = None, preset: str = "default") -> Task:
    changed = change or Variation()
    return Task(Job(case, engine, preset, changed.seed), 0.2, Trial("", "", changed))


def moved(one: Entry, other: Entry) -> float:
    return float(np.abs(np.array(one["end"]) - np.array(other["end"])).max())


@pytest.mark.parametrize(("engine", "state", "spoilt"), [
    ("tunnels", "measured", "wrong_side_frames"), ("not_a_number", "measured", "not_finite_frames"),
    ("raises", "crashed", ""), ("speechless", "cannot-say", ""),
])
def test_a_bad_engine_has_its_fault_as_a_figure_or_a_state(site: Path, engine: str, state: str, spoilt: str) -> None:
    found = tried(task(engine))
    assert found["state"] == state and all(found["values"][spoilt] > 0.0 for _ in [0] if spoilt)


def test_a_trial_that_takes_too_long_is_not_measured(site: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(trial, "LATE", 0.5)
    assert tried(task("dawdles", "painleve"))["state"] == "not-measured"


def test_depth_and_end_are_those_of_a_world_of_size_1(site: Path) -> None:
    """An engine that stops 2 mm inside a world of size 10 is reported as 0.2 mm inside, and ends ten times nearer."""
    here, there = tried(task("two_millimetres")), tried(task("two_millimetres", change=Variation(scale=10.0, far=100.0)))
    assert here["values"]["residual_overlap_max"] == pytest.approx(2e-3, abs=1e-6)
    assert there["values"]["residual_overlap_max"] == pytest.approx(2e-4, abs=1e-6)
    assert moved(here, there) < 0.05 and len(here["end"]) == 10


def test_a_scene_that_cannot_be_built_is_no_fault_of_an_engine() -> None:
    assert tried(task("avatarsim", "split_invariance", Variation(scale=1e-3)))["state"] == "cannot-say"


def test_solver_step_is_changed_from_that_of_the_preset() -> None:
    """With twice MuJoCo's documented step of 2 ms a falling box ends at another place, by far less than its fall."""
    assert tried(task("avatarsim", change=Variation(step=2.0)))["state"] == "cannot-say"
    assert 1e-9 < moved(*(tried(task("mujoco", "tumbling_box", change)) for change in (None, Variation(step=2.0)))) < 0.05


def test_a_margin_that_a_preset_chose_grows_with_the_world() -> None:
    """Ten boxes that MuJoCo's tuned preset keeps 0.4 mm apart: at size 0.15 they end at the positions of size 1."""
    changes = (None, Variation(scale=0.15))
    assert moved(*(tried(task("mujoco", change=change, preset="tuned")) for change in changes)) < 2e-4


def request(folder: Path, *names: str, **presets: tuple[str, ...]) -> Request:
    return Request(folder, {name: catalog.get(name) for name in names}, presets, 1)


def test_every_engine_of_the_run_is_tried_in_its_cases(tmp_path: Path) -> None:
    presets = {"avatarsim": ("default",), "tracker": ("default",), "dies": ("a", "b")}
    tasks = tasks_of(request(tmp_path, "squeeze", "tunnelling", "ball_drop", **presets))
    assert {one.job.scenario for one in tasks} == {"squeeze"}
    assert {one.job.run for one in tasks} == {"avatarsim/default", "dies/a", "dies/b"}
    assert len(tasks) == len({(one.job.run, one.trial) for one in tasks}) == 3 * len(SHORT)
    long = replace(request(tmp_path, "tunnelling", avatarsim=("default",)), checkpoints=tmp_path)
    assert len(tasks_of(long)) == len(trials())
    # without a case nothing is written
    assert STUDY.carry_out(request(tmp_path, "ball_drop", avatarsim=("default",))) == ([], []) and not list(tmp_path.iterdir())


def test_rows_have_figures_states_and_end_distances(tmp_path: Path, site: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(room, "CASES", {"stack_ten": 0.2})
    monkeypatch.setattr(room, "SHORT", ("", "start 1e-05 m", "solver step 2 times"))
    rows, _ = STUDY.carry_out(request(tmp_path, "stack_ten", frozen=("default",), dies=("default",)))
    found = {(row.run, row.change, row.metric): row for row in rows}
    assert found["frozen/default", "", "end_distance"].value == 0.0
    # each body starts up to 1e-5 m off along every axis, and a frozen engine does not move it
    assert 1e-6 < (found["frozen/default", "start 1e-05 m", "end_distance"].value or 0.0) < 3e-5
    assert found["frozen/default", "solver step 2 times", "run"].status == "cannot-say"
    assert {row.status for row in rows if row.engine == "dies" and not row.change} == {"crashed"}
