"""The slice of a comparison: part of the long form, tried in the run itself, and told from it in the file."""

import csv
from pathlib import Path

import pytest

from scenarios import catalog
from scenarios.stability import slice as room
from scenarios.stability.plan import CASES, trials
from scenarios.stability.rows import NAME, SLICE
from scenarios.stability.slice import CHANGES, LEFT_OUT, ask, slice_tasks, slice_trials
from scenarios.studies.study import Request


def request(folder: Path, names: tuple[str, ...], **presets: tuple[str, ...]) -> Request:
    return Request(folder, folder, {name: catalog.get(name) for name in names}, presets, 0, 0, False)


def test_the_slice_is_part_of_the_long_form() -> None:
    assert {(trial.kind, trial.level) for trial in slice_trials()} == set(CHANGES) and set(LEFT_OUT) < set(CASES)
    assert slice_trials()[0].kind == "plain", "the others are held against it"
    # draw 0 is left to the long form for what one trial of it costs
    frames = {trial.level: trial.change.dt for trial in trials() if trial.kind == "together" and trial.level != "draw 0"}
    chosen = {level for kind, level in CHANGES if kind == "together"}
    assert min(frames[level] for level in chosen) >= max(dt for level, dt in frames.items() if level not in chosen)


def test_every_engine_that_took_part_is_tried_in_the_cases_of_the_run(tmp_path: Path) -> None:
    presets = {"avatarsim": ("default",), "tracker": ("default",), "dies": ("a", "b")}
    tasks = slice_tasks(request(tmp_path, ("squeeze", "tunnelling", "ball_drop"), **presets))
    runs = ("avatarsim/default", "dies/a", "dies/b")
    assert {(task.case, task.run) for task in tasks} == {("squeeze", run) for run in runs}
    assert len(tasks) == len(set(tasks)) == 3 * len(CHANGES)


def test_its_rows_say_that_they_are_a_slice(tmp_path: Path, site: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(room, "CASES", {"stack_ten": 1.0})
    assert ask(request(tmp_path, ("stack_ten",), frozen=("default",), raises=("default",))) == []
    with (tmp_path / NAME).open(newline="") as file:
        rows = list(csv.DictReader(file))
    assert {row["form"] for row in rows} == {SLICE} and len(rows) == 2 * len(CHANGES)
    stepped = [row for row in rows if row["kind"] == "solver step"]
    assert {(row["run"], row["state"]) for row in stepped} == {(f"{name}/default", "cannot say") for name in ("frozen", "raises")}
    other = {(row["run"], row["state"]) for row in rows if row not in stepped}
    assert other == {("frozen/default", "survived"), ("raises/default", "crashed")}


def test_without_a_case_nothing_is_written(tmp_path: Path) -> None:
    assert ask(request(tmp_path, ("ball_drop",), avatarsim=("default",))) == []
    assert list(tmp_path.iterdir()) == []
