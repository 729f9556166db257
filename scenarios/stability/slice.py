"""The slice of the perturbed hard cases that is part of every comparison: which cases, which changes, and why these.

What is in it was chosen by cost, so that all engines get through it in a quarter of a minute on two processors.
"""

import sys
from collections.abc import Sequence

from runfiles.csv_rows import csv_text
from runfiles.files import write_text
from runfiles.naming import BASELINE
from scenarios.running.progress import Progress
from scenarios.stability.outcome import UNASKED, Outcome, Task
from scenarios.stability.plan import CASES, Trial, trials
from scenarios.stability.rows import NAME, SLICE, Row, rows
from scenarios.stability.side_by_side import answers
from scenarios.studies.study import Request, Study
from scenarios.variants import takes_part

LEFT_OUT = {
    "tunnelling": "as dear as four other cases, and what becomes of it is the same under every change",
}
"""Cases that only `make stability` tries, and why."""
CHANGES = {
    ("plain", "as it is"): "what the others are held against",
    ("start", "1e-05 m"): "far below what an eye sees, far above rounding",
    ("frame time", "1/15 s"): "the coarsest: the fewest frames, the hardest steps",
    ("solver step", "2 times"): "the coarser; of engines with a step of their own, which another frame time does not reach",
    ("size", "10"): "one size; units must not matter",
    ("distance", "1000 m"): "one distance; float64 has 1e-13 m there, so it must not matter either",
    ("together", "draw 2"): "all changes at once; of all draws but draw 0, this and the next have the fewest frames",
    ("together", "draw 7"): "all changes at once; in draw 0 one trial of one engine takes half as long as all others together",
}
"""Kind and level of each change, and why it."""


def slice_trials() -> list[Trial]:
    """The changes of the slice, as the long form has them."""
    return [trial for trial in trials() if (trial.kind, trial.level) in CHANGES]


def slice_tasks(request: Request) -> list[Task]:
    """Every change of every case that the run has, by every engine and preset that took part but the raw tracker."""
    cases = [(case, seconds) for case, seconds in CASES.items() if case in request.scenarios and case not in LEFT_OUT]
    return [
        Task(case, seconds, engine, preset, trial) for trial in slice_trials() for case, seconds in cases
        for engine, presets in request.presets.items() if engine != BASELINE for preset in presets
        if takes_part(engine, preset, request.scenarios[case])
    ]


def ask(request: Request) -> list[str]:
    """Try the slice and write its rows into the run's folder; nothing where the run has none of its cases."""
    tasks = slice_tasks(request)
    if not tasks:
        return []
    done: dict[Task, Outcome] = {}
    with Progress("stability", len(tasks), sys.stderr) as progress:
        for task, end in answers(tasks, request.jobs):
            done[task] = end
            progress.step(f"{task.case} {task.run} {task.trial.kind} {task.trial.level} {end.state}")
    found = rows({task: done[task] for task in tasks}, SLICE)
    write_text(request.folder / NAME, csv_text(found, Row))
    return _silent(found)


def _silent(found: Sequence[Row]) -> list[str]:
    """A sentence for each engine and preset that could not be asked."""
    absent = {row.run: row.note for row in found if row.state in UNASKED[1:]}
    return [f"{run} was not tried: {note}" for run, note in absent.items()]


STUDY = Study("stability", ask)
