"""The study of settings: error against frame time of every engine over its own settings.

The short form is part of a comparison. All its figures are of the run itself: errors of presets, and times of those whose every
frame was timed, are taken from the two passes of the run. A budget of time decides the choice: first settings in a fixed order,
then, errors being known, finer steps where another engine misses an accuracy avatarsim reaches. The long form runs everything.
"""

import math
import sys
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field

from runfiles.table import Row
from scenarios.job import reuses_process
from scenarios.run.progress import Progress
from scenarios.run.sweep_scenes import SWEEP_SCENES
from scenarios.run.timed_worker import TimedWorkers
from scenarios.studies.checkpoint import Checkpoint, Entry, key_of
from scenarios.studies.settings import clock, measure
from scenarios.studies.settings.cell import Cell
from scenarios.studies.settings.plan import (
    STARTED,
    cells_of,
    chosen,
    cost,
    errors_of,
    known_errors,
    known_times,
    refined,
    repeats_in,
)
from scenarios.studies.settings.rows import NAME, rows_of
from scenarios.studies.study import Request, Study, answers

BUDGET = 35.0
"""Time [s] for which settings are chosen, on two processors. More: a comparison takes longer than its five minutes; less: ladders
of steps have too few rungs to show where an engine's error stops falling."""
FIRST = 0.35
"""Share of the budget that is spent in the fixed order, before it is known which engine misses which accuracy. Larger: nothing is
left for the margins and steps that would reach it; smaller: presets are missing, from which it is known."""
ROUNDS = 4
"""Rounds in which settings are chosen, each by the times of those before: estimates are too high by a third, and the rest of
the budget is spent. More rounds wait for processes more often."""
PACES = (0.25, 4.0)
"""Least and largest measured time over estimated time that is believed: a round of few settings gives a poor ratio."""
LATEST = 2.0
"""Multiples of the budget after which no further scene is timed, should the estimate have been wrong."""


@dataclass(eq=False)
class Sweep:
    """One study of settings; `now` is a clock [s]."""

    request: Request
    budget: float = BUDGET
    now: Callable[[], float] = time.monotonic
    errors: dict[Cell, Entry] = field(default_factory=dict)
    times: dict[Cell, Entry] = field(default_factory=dict)
    late: list[str] = field(default_factory=list)
    begun: float = 0.0
    rounds: int = 0

    def __post_init__(self) -> None:
        if self.request.long:
            self.budget = math.inf
        self.checkpoint: Checkpoint = self.request.checkpoint(NAME)

    def ask(self) -> tuple[list[Row], list[str]]:
        """Measure the settings that the budget allows. Returns the rows, and a sentence for each time that could not be taken."""
        self.begun, cells = self.now(), cells_of(self.request)
        requested, left = self._rounds(cells)
        order = {scenario: k for k, scenario in enumerate(dict.fromkeys(cell.scenario for cell in cells))}
        rows = [row for cell in sorted(cells, key=lambda cell: order[cell.scenario]) for row in self._rows(cell, left)]
        return rows, list(self._untimed(requested))

    def _rounds(self, cells: Sequence[Cell]) -> tuple[list[Cell], Mapping[Cell, float]]:
        """Choose and measure until the budget is spent. Returns the cells that were run, and the cost [s] of the others."""
        requested, waiting, pace = list[Cell](), list(cells), 1.0
        choice = chosen(waiting, self.request, FIRST * self.budget)
        while choice.requested and self.rounds < ROUNDS:
            before = self.now()
            self.rounds += 1
            requested += choice.requested
            self._measure(choice.requested)
            self._clock(choice.requested)
            pace = min(max((self.now() - before) / max(choice.estimated, STARTED), PACES[0]), PACES[1])
            waiting = refined([cell for cell, _ in choice.left], self.errors, self.request)
            room = self.budget - (self.now() - self.begun)
            choice = chosen(waiting, self.request, max(room, 0.0) / pace)
        return requested, {cell: pace * cost(cell, self.request) for cell in waiting}

    def _measure(self, cells: Sequence[Cell]) -> None:
        self.errors |= {cell: entry for cell in cells if (entry := known_errors(cell, self.request)) is not None}
        # scene by scene: a process finds the scene again that it had before
        todo = sorted((cell for cell in cells if cell not in self.errors), key=lambda cell: cell.job.scenario)
        by_key = {key_of(NAME, cell.job): cell for cell in todo}
        jobs = {key: cell.job for key, cell in by_key.items()}
        for key, entry in answers(measure.errors, jobs, self.request, self.checkpoint, NAME, reuses_process):
            self.errors[by_key[key]] = entry

    def _clock(self, cells: Sequence[Cell]) -> None:
        """Time the cells that ran through, scene by scene; times of the run's own passes are taken where they fit."""
        ran = [cell for cell in cells if self.errors[cell]["state"] == "measured"]
        self.times |= {cell: entry for cell in ran if (entry := known_times(cell, self.request)) is not None}
        keys = {cell: key_of(NAME, "times", cell.job, cell.timed_frames) for cell in ran if cell not in self.times}
        stored = {cell: entry for cell, key in keys.items() if (entry := self.checkpoint.get(key)) is not None}
        self.times |= stored
        todo = [cell for cell in keys if cell not in stored]

        def done(cell: Cell, entry: Entry) -> None:
            self.times[cell] = entry
            progress.step(cell.scenario)
            if entry["p50"] is not None:
                self.checkpoint.put(keys[cell], entry)

        with TimedWorkers() as workers, Progress("settings, times", len(todo), sys.stderr, part=True) as progress:
            for scenario in dict.fromkeys(cell.scenario for cell in todo):
                if self.now() - self.begun > LATEST * self.budget:
                    self.late.append(scenario)
                    continue
                scene = {cell: repeats_in(cell, self.request) for cell in todo if cell.scenario == scenario}
                clock.times(list(scene), workers, done, list(scene.values()), self.errors)

    def _rows(self, cell: Cell, left: Mapping[Cell, float]) -> list[Row]:
        entry, timed = self.errors.get(cell), self.times.get(cell)
        if cell in left or entry is None:
            note = f"left out: an estimated {left.get(cell, 0.0):.1f} s did not fit into {self.budget:g} s"
            entry = {"state": "not-measured", "note": note, "values": {}, "missing": {}}
        if timed is None and cell.scenario in self.late:
            timed = {"p50": None, "note": f"not timed: more than {LATEST * self.budget:g} s had passed"}
        return rows_of(cell, errors_of(cell, self.request), entry, timed)

    def _untimed(self, cells: Sequence[Cell]) -> Iterator[str]:
        for cell in cells:
            timed = self.times.get(cell)
            if timed is not None and timed["p50"] is None:
                yield f"{cell.scenario} {cell.setting.run} was not timed: {timed['note']}"


STUDY = Study(NAME, lambda request: Sweep(request).ask(), lambda scenario: scenario.name in SWEEP_SCENES)
