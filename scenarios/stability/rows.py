"""One row per trial, as stability.csv holds them, and a table of what to conclude from them, per engine and kind of change."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from scenarios.stability.outcome import NOT_A_NUMBER, SURVIVED, UNASKED, Outcome, Task
from scenarios.stability.plan import KINDS

NAME = "stability.csv"
"""The file of rows in a run's folder."""
LONG, SLICE = "long", "slice"
"""Which plan a row belongs to."""


@dataclass(frozen=True)
class Row:
    """A trial: what was changed, how it ended, and `moved` [m], how far the end of anything is from where the plain trial of the
    same case and engine ended. Lengths and energies in a world of size 1; nan where there is nothing to compare. `form` is
    LONG for a row of `make stability`, SLICE for one of the slice that a comparison tries."""

    case: str
    run: str
    kind: str
    level: str
    start: float
    seed: int
    user: int
    dt: float
    scale: float
    far: float
    state: str
    frames: int
    overlap: float
    energy: float
    bad: int
    moved: float
    seconds: float
    note: str
    form: str


def apart(end: Outcome, plain: Outcome | None) -> float:
    """Largest distance [m] between two ends; nan where one of them has none."""
    if plain is None or not end.end or len(end.end) != len(plain.end):
        return math.nan
    return float(np.max(np.linalg.norm(np.array(end.end) - np.array(plain.end), axis=1)))


def rows(done: Mapping[Task, Outcome], form: str) -> list[Row]:
    """All trials, each beside its plain one."""
    plain = {(task.case, task.run): end for task, end in done.items() if task.trial.kind == "plain"}
    found = []
    for task, end in done.items():
        change, trial = task.trial.change, task.trial
        # another user's motion ends elsewhere, and is no measure of anything
        moved = math.nan if trial.kind == "user" else apart(end, plain.get((task.case, task.run)))
        found.append(Row(
            task.case, task.run, trial.kind, trial.level, change.start, change.seed, change.user, change.dt, change.scale,
            change.far, end.state, end.frames, end.overlap, end.energy, end.bad, moved, end.seconds, end.note,
            form,
        ))
    return found


def worst(values: Sequence[float]) -> float:
    """The largest of those that are numbers; nan without any."""
    known = [value for value in values if not math.isnan(value)]
    return max(known, default=math.nan)


def table(found: Sequence[Row]) -> str:
    """A line per engine and kind of change."""
    lines = [
        f"{'engine':20}{'change':12}{'survived':>12}{'no number':>11}{'overlap':>11}{'energy':>11}{'moved p50':>11}{'moved':>11}",
        f"{'':20}{'':12}{'of':>12}{'':>11}{'m':>11}{'J':>11}{'m':>11}{'m':>11}",
    ]
    for run in dict.fromkeys(row.run for row in found):
        for kind in KINDS:
            here = [row for row in found if row.run == run and row.kind == kind and row.state not in UNASKED]
            if not here:
                continue
            lived = sum(row.state == SURVIVED for row in here)
            lost = sum(row.state == NOT_A_NUMBER for row in here)
            moved = [row.moved for row in here if not math.isnan(row.moved)]
            middle = float(np.median(moved)) if moved else math.nan
            lines.append(
                f"{run:20}{kind:12}{f'{lived}/{len(here)}':>12}{lost:>11}{_figure(worst([row.overlap for row in here]))}"
                f"{_figure(worst([row.energy for row in here]))}{_figure(middle)}{_figure(worst(moved))}"
            )
    return "\n".join(lines)


def _figure(value: float) -> str:
    return f"{'-':>11}" if math.isnan(value) else f"{value:>11.2g}"
