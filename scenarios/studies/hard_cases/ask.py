"""The study of hard cases: every change of every case in every engine, and rows of the result of each trial."""

from collections.abc import Iterator, Sequence

import numpy as np

from runfiles.naming import BASELINE
from runfiles.table import Row
from scenarios.engines import takes_part
from scenarios.job import Job, reuses_process
from scenarios.studies.checkpoint import Entry, key_of
from scenarios.studies.hard_cases.plan import CASES, trials
from scenarios.studies.hard_cases.trial import FIGURES, LATE, Task, tried
from scenarios.studies.study import Head, Request, Study, answers

NAME = "hard_cases"
TIMEOUT = 3.0 * LATE
"""Longest [s] without an answer: an engine that never comes back from a frame is in an endless loop."""
LEFT_OUT = ("tunnelling",)
"""Cases of the long form only: as dear as four others, with one end under every change."""
SHORT = (
    "", "start 1e-05 m", "frame time 1/15 s", "solver step 2 times", "size 10", "distance 1000 m", "together draw 2",
    "together draw 7",
)
"""Changes of the short form: the coarsest frame and step, one size and place, and two draws of all changes with few frames."""


def tasks_of(request: Request) -> list[Task]:
    """Return every change of every case that the run has, by every engine and preset that took part but the raw tracker."""
    changes = [trial for trial in trials() if request.long or trial.name in SHORT]
    cases = [
        (case, seconds) for case, seconds in CASES.items()
        if case in request.scenarios and (request.long or case not in LEFT_OUT)
    ]
    return [
        Task(Job(case, engine, preset, trial.change.seed), seconds, trial) for trial in changes for case, seconds in cases
        for engine, presets in request.presets.items() if engine != BASELINE for preset in presets
        if takes_part(engine, preset, request.scenarios[case])
    ]


def ask(request: Request) -> tuple[list[Row], list[str]]:
    """Try everything, side by side. Returns the rows, and a sentence for each engine and preset that could not be run."""
    tasks = {key_of(NAME, task): task for task in tasks_of(request)}
    entries = dict(answers(
        tried, tasks, request, request.checkpoint(NAME), NAME, lambda task: reuses_process(task.job), TIMEOUT, "not-measured",
    ))
    plain = {(task.job.scenario, task.job.run): entries[key] for key, task in tasks.items() if task.trial.name == ""}
    rows = [
        row for key, task in tasks.items() for row in rows_of(task, entries[key], plain.get((task.job.scenario, task.job.run)))
    ]
    absent = {row.run: row.note for row in rows if row.status == "not-measured"}
    return rows, [f"{run} was not tried: {note}" for run, note in absent.items()]


def rows_of(task: Task, entry: Entry, plain: Entry | None) -> Iterator[Row]:
    """Yield the rows of a trial, compared with the unchanged one of its case and engine."""
    job = task.job
    head = Head(NAME, job.scenario, job.engine, job.preset, task.trial.name, seed=job.seed, frames=entry["frames"])
    if entry["state"] != "measured":
        yield head.without(entry["state"], entry["note"])
        return
    for metric in FIGURES:
        value = entry["values"].get(metric)
        yield head.row(metric, None if value is None else float(value), entry["note"])
    # another user's motion ends elsewhere, and is no measure of anything
    apart = None if task.trial.kind == "user" or plain is None else distance(entry["end"], plain.get("end", ()))
    yield head.row("end_distance", apart)


def distance(end: Sequence[Sequence[float]], other: Sequence[Sequence[float]]) -> float | None:
    """Return the largest distance [m] between two ends; None where one of them has none."""
    if not end or len(end) != len(other):
        return None
    return float(np.max(np.linalg.norm(np.array(end, dtype=np.float64) - np.array(other, dtype=np.float64), axis=1)))


STUDY = Study(NAME, ask)
