"""The short sweep of a comparison: a few settings of every engine in the everyday scenes and in scenes with a closed form.

All figures are of the run itself: errors of presets, and times of those whose every frame was timed, are taken from its two
passes; everything else is measured here. The store of the long sweep is not read. A budget of time decides what is asked: first
settings in a fixed order, then, errors being known, finer steps where another engine misses an accuracy that ours reaches.
"""

import math
import sys
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from enum import IntEnum

import numpy as np

from runfiles import ladder
from runfiles.accuracy import Reached, largest, missing
from runfiles.comparable import unsupported
from runfiles.csv_rows import csv_text
from runfiles.files import write_json, write_text
from runfiles.naming import BASELINE, stem
from runfiles.timing_protocol import REPEATS, WARM_FRAMES
from scenarios.job import Outcome
from scenarios.results.store import Entry
from scenarios.running.harness import tidy
from scenarios.running.own_settings import OwnSettings
from scenarios.running.phenomena import ONCE, repeats_of, short_errors_of
from scenarios.running.processes import side_by_side
from scenarios.running.seat import Seats
from scenarios.running.timing import MOST_FRAMES
from scenarios.studies.study import Request, Study
from scenarios.studies.sweep import clock, measure
from scenarios.studies.sweep.cell import Cell
from scenarios.studies.sweep.grid import Setting, applicable, settings_of, short_order
from scenarios.studies.sweep.rows import Row, rows_of, scene_of, with_fronts

ROWS, ABOUT = "sweep.csv", "sweep.json"
"""Points, and how they came about: which sweep, how long it took, what was left out."""

BUDGET = 35.0
"""Time [s] for which settings are chosen, on two processors. More: a comparison takes longer than its five minutes; less: ladders
of steps have too few rungs to show where an engine's error stops falling."""
FIRST = 0.35
"""Share of the budget that is spent in the fixed order, before it is known which engine misses which accuracy. Larger: nothing is
left for the margins and steps that would reach it; smaller: presets are missing, from which it is known."""
MARGINS = ("margin", "loose_margin")
"""Options that say from which distance on there is contact: with the step, what an overlap depends on."""
SOLVER = ("sleep", "iterations", "solver_iterations")
"""Options that cost little to try and may make a frame much cheaper where no avatar moves: tried there before fine steps."""
ROUNDS = 4
"""How often settings are chosen, each time by what the settings before took: estimates are too high by a third, and what they
leave of the budget is spent. More rounds wait for processes more often."""
PACES = (0.25, 4.0)
"""Least and largest measured time over estimated time that is believed: of a round of few settings it says little."""
LATEST = 2.0
"""Multiples of the budget after which no further scene is timed, should the estimate have been wrong."""
JUDGED = 1.2
"""Cost of a frame that is measured, in frames that are only recorded: the judge's share in the everyday scenes."""
STARTED = 0.15
"""Time [s] that a setting costs in a scene besides its frames: a load for each repeat, and the judge's start."""
UNKNOWN = 2e-3
"""Time of a frame [s] of an engine of which nothing is known in a scene."""
COARSE = 0.25
"""Least share of a frame's cost that is left when the steps are coarser: what does not go with their number."""


@dataclass(frozen=True, eq=False)
class Choice:
    """What is asked and what is left out, with the estimated time [s] of all that is asked."""

    asked: tuple[Cell, ...]
    left: tuple[tuple[Cell, float], ...]
    estimated: float


def cells_of(request: Request) -> list[Cell]:
    """Every setting of the short grid, every row of the user's own, and every further preset that the run measured there, in
    every scene in which it changes anything, in the order of the budget: first of each engine's list in all scenes, then the
    second, and so on. What only repeats its preset's step, or has no words for an error of the scene, is left out: of such an
    engine the presets stand there and say so."""
    own: dict[str, list[OwnSettings]] = {}
    for outcome in request.outcomes.values():
        job = outcome.job
        if job.base:
            own.setdefault(job.scenario, []).append(OwnSettings(job.engine, job.preset, job.base, job.options))
    ranked: list[tuple[tuple[int, float], Cell]] = []
    for name, scenario in sorted(request.scenarios.items(), key=lambda entry: not entry[1].everyday):
        if not short_errors_of(name, scenario):
            continue
        scene = scenario.as_run(request.full).build()
        for engine, presets in request.presets.items():
            if engine == BASELINE:
                continue
            rows = own.get(name, ())
            known, more = settings_of(engine, presets, rows), variants_of(name, engine, request)
            rank = {named: k for k, named in enumerate(short_order(engine, presets))} | {s.name: 0 for s in (*rows, *more)}
            for setting in (*known, *more):
                cell = Cell(name, setting, request.seed, request.full, most=MOST_FRAMES)
                if setting.name in rank and setting.base in presets and applicable(setting, scene) and _tells(cell, request):
                    ranked.append((_turn(cell, rank[setting.name], request), cell))
    return [cell for _, cell in sorted(ranked, key=lambda entry: entry[0])]


def variants_of(scenario: str, engine: str, request: Request) -> tuple[Setting, ...]:
    """Presets that the grid does not have and that the run measured in this scene: their times stand on the same page."""
    known = {setting.name for setting in settings_of(engine, ())}
    ran = [preset for preset in request.presets[engine] if stem(scenario, engine, preset, request.seed) in request.outcomes]
    return tuple(Setting(engine, preset, preset) for preset in ran if known and preset not in known)


class Turn(IntEnum):
    """Turns in which cells are asked."""

    PRESETS = 0
    COARSE_STEPS = 1
    SOLVER = 2
    FINE_STEPS = 3
    REST = 4


def _turn(cell: Cell, rank: int, request: Request) -> tuple[int, float]:
    """When a cell is asked: presets and the user's rows, coarse rungs of the ladder from the coarsest on, what turns the solver
    of an engine where there is no avatar, fine rungs by what they cost, so that as many fit as can, then all else by its `rank`
    in the engine's list."""
    setting = cell.setting
    if ladder.is_rung(setting.name):
        if ladder.is_coarse(setting.name):
            return Turn.COARSE_STEPS, -step(cell, request)
        return Turn.FINE_STEPS, cost(cell, request)
    if setting.is_preset or rank == 0:
        return Turn.PRESETS, rank
    return (Turn.SOLVER if turns_solver(cell) else Turn.REST), rank


def turns_solver(cell: Cell) -> bool:
    """Whether a cell turns nothing but SOLVER in the preset that the ladder is of, in a scene without an avatar."""
    options = set(cell.setting.options)
    return bool(options) and options <= set(SOLVER) and cell.setting.base == ladder.BASE and not scene_of(cell).avatars


def _tells(cell: Cell, request: Request) -> bool:
    """Whether a setting says more than the preset beneath it."""
    setting, base = cell.setting, _base(cell, request)
    if base is None or setting.is_preset:
        return True
    before = measure.step_of(base)
    if set(setting.options) == {"dt"} and before is not None and math.isclose(before, _number(setting.options["dt"])):
        return False
    if len(setting.options) == 1 and not set(setting.options).isdisjoint(MARGINS):
        (name, value), = setting.options.items()
        if measure.number_of(base, name) == _number(value):
            return False
    said, run = base.about.get("cannot_say"), f"{setting.engine}/{setting.base}"
    errors = short_errors_of(cell.scenario, request.scenarios[cell.scenario])
    return not (isinstance(said, Mapping) and set(unsupported(run, said)).intersection(errors))


def _number(value: object) -> float:
    return float(value) if isinstance(value, int | float) else math.nan


def _base(cell: Cell, request: Request) -> Outcome | None:
    """What the accuracy pass of the run says of the preset beneath a cell."""
    setting = cell.setting
    return request.outcomes.get(f"{cell.scenario}.{setting.engine}.{setting.base}.{cell.seed}")


def step(cell: Cell, request: Request) -> float:
    """The time step [s] of a cell; nan where the engine has none, or where it is not known."""
    if "dt" in cell.setting.options:
        return _number(cell.setting.options["dt"])
    base = _base(cell, request)
    return _number(None if base is None else measure.step_of(base))


def refined(cells: Sequence[Cell], errors: Mapping[Cell, Entry], request: Request) -> list[Cell]:
    """The same cells, presets, coarse rungs of the ladder and what turns a solver first; then those that may reach an accuracy
    that ours reaches and an engine misses in what was measured so far: finer steps, the coarsest first, then margins, which are
    of one engine only."""
    worst = [
        Reached(
            cell.scenario, cell.setting.engine,
            largest(entry, short_errors_of(cell.scenario, request.scenarios[cell.scenario])), step(cell, request),
        )
        for cell, entry in errors.items()
    ]
    wanted = missing(worst)

    def key(cell: Cell) -> tuple[int, float]:
        place, options = (cell.scenario, cell.setting.engine), cell.setting.options
        if cell.setting.is_preset or ladder.is_coarse(cell.setting.name) or turns_solver(cell):
            return 0, 0.0
        at = step(cell, request) if "dt" in options else math.nan
        if at < wanted.get(place, 0.0):
            return 1, -at
        if ladder.is_rung(cell.setting.name):
            return 2, 0.0
        return (3, 0.0) if place in wanted and not set(options).isdisjoint(MARGINS) else (4, 0.0)

    return sorted(cells, key=key)


def recorded_as(cell: Cell) -> str:
    """The stem under which the run's own passes know a cell: presets and the user's rows only."""
    setting = cell.setting
    return f"{cell.scenario}.{setting.engine}.{setting.name}.{cell.seed}"


def frame_cost(cell: Cell, request: Request) -> tuple[float, float]:
    """Estimated time [s] of a rendered frame, recorded and bare: what the preset beneath took in both passes, by how much finer
    the setting steps."""
    setting = cell.setting
    stem = f"{cell.scenario}.{setting.engine}.{setting.base}.{cell.seed}"
    base, clocked = _base(cell, request), request.clocked.get(stem)
    if base is None or not base.frame_seconds > 0.0:
        known = [o.frame_seconds for o in request.outcomes.values() if o.job.engine == setting.engine]
        both = max(known, default=UNKNOWN) * setting.cut
        return both, both
    factor = setting.cut * _finer(setting, base)
    bare = base.frame_seconds if clocked is None or clocked.timed is None else float(np.mean(clocked.timed.around_ns)) * 1e-9
    return base.frame_seconds * factor, bare * factor


def _finer(setting: Setting, base: Outcome) -> float:
    """How many times as many steps a frame has as with the preset beneath; 1 where that is not known."""
    before, after = measure.step_of(base), setting.options.get("dt")
    if before is None or not isinstance(after, int | float) or not after > 0.0:
        return 1.0
    return max(COARSE, before / after)


def cost(cell: Cell, request: Request) -> float:
    """Estimated time [s] of what is still to be measured of a cell."""
    frames = frames_of(cell, request)
    (recorded, bare), workers = frame_cost(cell, request), max(request.jobs, 1)
    few = min(frames, cell.most)
    measured = 0.0 if known_errors(cell, request) else frames * recorded * JUDGED / workers
    timed = 0.0 if known_times(cell, request) else (few * repeats_of(few) + WARM_FRAMES) * bare
    return measured + timed + (STARTED if measured or timed else 0.0)


def frames_of(cell: Cell, request: Request) -> int:
    """Rendered frames of the cell's scene at the length that is run."""
    return request.scenarios[cell.scenario].as_run(request.full).frames


def known_errors(cell: Cell, request: Request) -> Entry | None:
    """What the accuracy pass of the run measured of a cell: the same job by the same judge."""
    outcome = request.outcomes.get(recorded_as(cell))
    return None if outcome is None else measure.entry_of(outcome)


def known_times(cell: Cell, request: Request) -> Entry | None:
    """What the timing pass of the run says of a cell, if it timed all the frames that are timed here, and as often: of more
    repeats the first, so that all times of a scene are the least of equally many."""
    clocked, repeats = request.clocked.get(recorded_as(cell)), repeats_of(min(frames_of(cell, request), cell.most))
    if clocked is None or clocked.timed is None or clocked.timed.around_ns.shape[1] != cell.timed_frames:
        return None
    if len(clocked.timed.around_ns) < repeats:
        return None
    recorded = request.outcomes.get(recorded_as(cell))
    same = replace(clocked, timed=clocked.timed.first_repeats(repeats))
    return clock.time_entry(same, cell.setting.cut, () if recorded is None else recorded.resting)


def chosen(cells: Sequence[Cell], request: Request, budget: float) -> Choice:
    """Each cell in turn that still fits into `budget` [s]; what does not fit is left out, and a cheaper one after it may fit."""
    asked, left, spent = list[Cell](), list[tuple[Cell, float]](), 0.0
    for cell in cells:
        each = cost(cell, request)
        if spent + each <= budget:
            asked.append(cell)
            spent += each
        else:
            left.append((cell, each))
    return Choice(tuple(asked), tuple(left), spent)


@dataclass(eq=False)
class ShortSweep:
    """One short sweep; `now` is a clock [s]."""

    request: Request
    budget: float = BUDGET
    now: Callable[[], float] = time.monotonic
    errors: dict[Cell, Entry] = field(default_factory=dict)
    times: dict[Cell, Entry] = field(default_factory=dict)
    late: list[str] = field(default_factory=list)
    begun: float = 0.0
    rounds: int = 0
    reused: int = 0
    """Cells whose times are the run's own."""

    def ask(self) -> list[str]:
        """Measure what was chosen and write both files; returns a sentence for each time that could not be taken."""
        self.begun, cells = self.now(), cells_of(self.request)
        if not cells:
            return []
        asked, left = self._rounds(cells)
        order = list(dict.fromkeys(cell.scenario for cell in cells))
        by_scene = sorted(cells, key=lambda cell: order.index(cell.scenario))
        rows = with_fronts([row for cell in by_scene for row in self._rows(cell, left)])
        write_text(self.request.folder / ROWS, csv_text(rows, Row))
        write_json(self.request.folder / ABOUT, {
            "form": "short", "seconds": round(self.now() - self.begun, 1), "budget": self.budget, "rounds": self.rounds,
            "settings": len(asked), "reused": self.reused,
            "left": [f"{cell.scenario}: {cell.setting.run}" for cell in left], "late": self.late,
            "repeats": REPEATS, "once": ONCE,
        })
        return list(self._untimed(asked))

    def _rounds(self, cells: Sequence[Cell]) -> tuple[list[Cell], Mapping[Cell, float]]:
        """Choose and measure until the budget is spent: what was asked, and what did not fit with the time it would take."""
        asked, waiting, pace = list[Cell](), list(cells), 1.0
        choice = chosen(waiting, self.request, FIRST * self.budget)
        while choice.asked and self.rounds < ROUNDS:
            before = self.now()
            self.rounds += 1
            asked += choice.asked
            self._measure(choice.asked)
            self._clock(choice.asked)
            pace = min(max((self.now() - before) / max(choice.estimated, STARTED), PACES[0]), PACES[1])
            waiting = refined([cell for cell, _ in choice.left], self.errors, self.request)
            room = self.budget - (self.now() - self.begun)
            choice = chosen(waiting, self.request, max(room, 0.0) / pace)
        return asked, {cell: pace * cost(cell, self.request) for cell in waiting}

    def _measure(self, cells: Sequence[Cell]) -> None:
        self.errors |= {cell: entry for cell in cells if (entry := known_errors(cell, self.request)) is not None}
        todo = {cell.job.stem: cell for cell in cells if cell not in self.errors}
        # scene by scene: a process finds the scene again that it had before
        jobs = sorted((cell.job for cell in todo.values()), key=lambda job: job.scenario)
        for job, entry in measure.told(side_by_side(measure.errors, jobs, self.request.jobs, tidy)):
            self.errors[todo[job.stem]] = entry

    def _clock(self, cells: Sequence[Cell]) -> None:
        """Time what ran through, scene by scene; the run's own times are taken where they are of the same frames."""
        ran = [cell for cell in cells if self.errors[cell]["state"] == "measured"]
        known = {cell: entry for cell in ran if (entry := known_times(cell, self.request)) is not None}
        self.times |= known
        self.reused += len(known)
        todo = [cell for cell in ran if cell not in known]
        with Seats() as seats:
            for scenario in dict.fromkeys(cell.scenario for cell in todo):
                if self.now() - self.begun > LATEST * self.budget:
                    self.late.append(scenario)
                    continue
                scene = [cell for cell in todo if cell.scenario == scenario]
                rendered = scene[0].timed_frames // scene[0].setting.cut
                clock.times(scene, seats, self.times.__setitem__, repeats_of(rendered), self.errors)
                print(f"sweep: {scenario}, {len(scene)} settings timed", file=sys.stderr, flush=True)

    def _rows(self, cell: Cell, left: Mapping[Cell, float]) -> list[Row]:
        errors = short_errors_of(cell.scenario, self.request.scenarios[cell.scenario])
        found = self.errors.get(cell)
        if cell in left:
            note = f"left out: an estimated {left[cell]:.1f} s did not fit into the {self.budget:g} s of the short sweep"
            found = {"state": "not-measured", "note": note, "values": {}, "missing": {}}
        timed = self.times.get(cell)
        if timed is None and cell.scenario in self.late:
            timed = {"p50": None, "note": f"not timed: more than {LATEST * self.budget:g} s had passed"}
        return rows_of(cell, errors, found, timed)

    def _untimed(self, cells: Sequence[Cell]) -> Iterator[str]:
        for cell in cells:
            timed = self.times.get(cell)
            if timed is not None and timed["p50"] is None:
                yield f"{cell.scenario} {cell.setting.run} was not timed: {timed['note']}"


def ask(request: Request) -> Sequence[str]:
    """The short sweep over the scenes of `request` that belong to it."""
    return ShortSweep(request).ask()


STUDY = Study("sweep", ask)
