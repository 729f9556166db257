"""Plan of the study of settings: the settings of each engine that are run in each scene, their order, and their cost."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from enum import IntEnum

import numpy as np

from runfiles import ladder
from runfiles.accuracy import Reached, largest, missing
from runfiles.comparable import silenced_metrics
from runfiles.engines import about
from runfiles.naming import BASELINE, stem
from runfiles.timing_protocol import WARM_FRAMES
from scenarios.job import Outcome
from scenarios.run.own_settings import OwnSettings
from scenarios.run.sweep_scenes import long_errors_of, repeats_of, short_errors_of
from scenarios.run.timing import MOST_FRAMES
from scenarios.studies.checkpoint import Entry
from scenarios.studies.settings import clock, measure
from scenarios.studies.settings.cell import TIMED, Cell
from scenarios.studies.settings.grid import Setting, applicable, settings_of, short_order
from scenarios.studies.study import Request

MARGINS = ("margin", "loose_margin")
"""Options for the distance at which contact begins: with the step, an overlap depends on them."""
SOLVER = ("sleep", "iterations", "solver_iterations")
"""Options that cost little to try and may make a frame much cheaper where no avatar moves: tried there before fine steps."""
JUDGED = 1.2
"""Cost of a frame that is measured, in frames that are only recorded: the judge's share in the everyday scenes."""
STARTED = 0.15
"""Time [s] that a setting costs in a scene besides its frames: a load for each repeat, and the judge's start."""
UNKNOWN = 2e-3
"""Time of a frame [s] of an engine of which nothing is known in a scene."""
COARSE = 0.25
"""Least share of a frame's cost that is left when the steps are coarser: the part that does not go with their number."""


@dataclass(frozen=True, eq=False)
class Choice:
    """Cells that are run and cells that are left out, with the estimated time [s] of all that are run."""

    requested: tuple[Cell, ...]
    left: tuple[tuple[Cell, float], ...]
    estimated: float


def errors_of(cell: Cell, request: Request) -> tuple[str, ...]:
    """Return the metrics that are errors in the scene of a cell."""
    return errors_in(cell.scenario, request)


def errors_in(scenario: str, request: Request) -> tuple[str, ...]:
    """Return the metrics that are errors in a scene; none where no setting is tried in it."""
    return long_errors_of(scenario) if request.long else short_errors_of(scenario, request.scenarios[scenario])


def cells_of(request: Request) -> list[Cell]:
    """Return the settings of every scene in which they change anything, in the order in which a budget is spent on them.

    Those of the short grid, or of all of it in the long form, every row of the user's own, and every further preset that the run
    measured there: first of each engine's list in all scenes, then the second, and so on. A setting that repeats its preset's
    step, or cannot express an error of the scene, is left out.
    """
    own: dict[str, list[OwnSettings]] = {name: list(request.own) for name in request.scenarios}
    for outcome in request.outcomes.values():
        job = outcome.job
        if job.base:
            own.setdefault(job.scenario, []).append(OwnSettings(job.engine, job.preset, job.base, job.options))
    ranked: list[tuple[tuple[int, float], Cell]] = []
    for name, scenario in sorted(request.scenarios.items(), key=lambda entry: not entry[1].everyday):
        if not errors_in(name, request):
            continue
        scene = scenario.as_run(request.full).build()
        for engine, presets in request.presets.items():
            if engine == BASELINE:
                continue
            rows = own.get(name, ())
            known, more = settings_of(engine, presets, rows), variants_of(name, engine, request)
            order = [setting.name for setting in known] if request.long else short_order(engine, presets)
            rank = {named: k for k, named in enumerate(order)} | {s.name: 0 for s in (*rows, *more)}
            for setting in (*known, *more):
                most = TIMED if request.long else MOST_FRAMES
                cell = Cell(name, setting, request.seed, request.full, request.frames, most=most)
                if setting.name in rank and setting.base in presets and applicable(setting, scene) and _tells(cell, request):
                    ranked.append((_turn(cell, rank[setting.name], request), cell))
    return [cell for _, cell in sorted(ranked, key=lambda entry: entry[0])]


def variants_of(scenario: str, engine: str, request: Request) -> tuple[Setting, ...]:
    """Return the presets that the grid does not have and that the run measured in this scene, but those for some metrics only."""
    known = {setting.name for setting in settings_of(engine, ())}
    ran = [preset for preset in request.presets[engine] if stem(scenario, engine, preset, request.seed) in request.outcomes]
    left = known | {name for name, variant in about(engine).variants.items() if variant.metrics}
    return tuple(Setting(engine, preset, preset) for preset in ran if known and preset not in left)


class Turn(IntEnum):
    """Turns in which cells are run."""

    PRESETS = 0
    COARSE_STEPS = 1
    FINE_STEPS = 2
    SOLVER = 3
    REST = 4


def _turn(cell: Cell, rank: int, request: Request) -> tuple[int, float]:
    """Return the turn of a cell: presets and the user's rows, coarse rungs of the ladder from the coarsest on, fine rungs by
    their cost, so that as many fit as can, options of the solver where there is no avatar, all else by its `rank` in the
    engine's list."""
    setting = cell.setting
    if ladder.is_rung(setting.name):
        if ladder.is_coarse(setting.name):
            return Turn.COARSE_STEPS, -step(cell, request)
        return Turn.FINE_STEPS, cost(cell, request)
    if setting.is_preset or rank == 0:
        return Turn.PRESETS, rank
    return (Turn.SOLVER if turns_solver(cell) else Turn.REST), rank


def turns_solver(cell: Cell) -> bool:
    """Return True if a cell turns nothing but SOLVER in the preset that the ladder is of, in a scene without an avatar."""
    options = set(cell.setting.options)
    return bool(options) and options <= set(SOLVER) and cell.setting.base == ladder.BASE and not cell.scene.avatars


def _tells(cell: Cell, request: Request) -> bool:
    """Return True if a setting adds something to the preset beneath it."""
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
    features, run = base.about.get("unsupported"), f"{setting.engine}/{setting.base}"
    errors = errors_of(cell, request)
    return not (isinstance(features, Mapping) and set(silenced_metrics(run, features)).intersection(errors))


def _number(value: object) -> float:
    return float(value) if isinstance(value, int | float) else math.nan


def _base(cell: Cell, request: Request) -> Outcome | None:
    """Return the outcome of the preset beneath a cell in the accuracy pass of the run."""
    setting = cell.setting
    return request.outcomes.get(stem(cell.scenario, setting.engine, setting.base, cell.seed))


def step(cell: Cell, request: Request) -> float:
    """Return the time step [s] of a cell; nan where the engine has none, or where it is not known."""
    if "dt" in cell.setting.options:
        return _number(cell.setting.options["dt"])
    base = _base(cell, request)
    return _number(None if base is None else measure.step_of(base))


def refined(cells: Sequence[Cell], errors: Mapping[Cell, Entry], request: Request) -> list[Cell]:
    """Return the same cells, presets and coarse rungs of the ladder first; then finer steps, the cheapest first, of engines that
    miss an accuracy in the errors measured so far; then options of the solver, other rungs, margins, and the rest."""
    worst = [
        Reached(
            cell.scenario, cell.setting.engine,
            largest(entry, errors_of(cell, request)), step(cell, request),
        )
        for cell, entry in errors.items()
    ]
    wanted = missing(worst)

    def key(cell: Cell) -> tuple[int, float]:
        place, options = (cell.scenario, cell.setting.engine), cell.setting.options
        if cell.setting.is_preset or ladder.is_coarse(cell.setting.name):
            return 0, 0.0
        at = step(cell, request) if "dt" in options else math.nan
        if at < wanted.get(place, 0.0):
            return 1, cost(cell, request)
        if turns_solver(cell) or ladder.is_rung(cell.setting.name):
            return 2, 0.0
        return (3, 0.0) if place in wanted and not set(options).isdisjoint(MARGINS) else (4, 0.0)

    return sorted(cells, key=key)


def frame_cost(cell: Cell, request: Request) -> tuple[float, float]:
    """Return the estimated time [s] of a rendered frame, recorded and bare: the time of the preset beneath in both passes, by how
    much finer the setting steps."""
    setting = cell.setting
    beneath = stem(cell.scenario, setting.engine, setting.base, cell.seed)
    base, clocked = _base(cell, request), request.clocked.get(beneath)
    if base is None or not base.frame_seconds > 0.0:
        known = [o.frame_seconds for o in request.outcomes.values() if o.job.engine == setting.engine]
        both = max(known, default=UNKNOWN) * setting.cut
        return both, both
    factor = setting.cut * _finer(setting, base)
    bare = base.frame_seconds if clocked is None or clocked.timed is None else float(np.mean(clocked.timed.around_ns)) * 1e-9
    return base.frame_seconds * factor, bare * factor


def _finer(setting: Setting, base: Outcome) -> float:
    """Return the ratio of a frame's steps to those with the preset beneath; 1 where that is not known."""
    before, after = measure.step_of(base), setting.options.get("dt")
    if before is None or not isinstance(after, int | float) or not after > 0.0:
        return 1.0
    return max(COARSE, before / after)


def cost(cell: Cell, request: Request) -> float:
    """Return the estimated time [s] of the measurements of a cell that are still missing."""
    frames = frames_of(cell, request)
    (recorded, bare), workers = frame_cost(cell, request), max(request.workers, 1) if isinstance(request.workers, int) else 1
    few = min(frames, cell.most)
    measured = 0.0 if known_errors(cell, request) else frames * recorded * JUDGED / workers
    timed = 0.0 if known_times(cell, request) else (few * repeats_in(cell, request) + WARM_FRAMES) * bare
    return measured + timed + (STARTED if measured or timed else 0.0)


def repeats_in(cell: Cell, request: Request) -> int:
    """Return how often the frames of a cell are timed.

    Fine rungs of the ladder once: they cost most, and a median over a scene's frames hardly changes with more. All others as
    often as the comparison times their scene.
    """
    if request.long:
        return clock.REPEATS
    name = cell.setting.name
    fine = ladder.is_rung(name) and not ladder.is_coarse(name)
    return 1 if fine else repeats_of(cell.timed_frames // cell.setting.cut)


def frames_of(cell: Cell, request: Request) -> int:
    """Return rendered frames of the cell's scene at the length that is run."""
    return request.scenarios[cell.scenario].as_run(request.full).frames


def known_errors(cell: Cell, request: Request) -> Entry | None:
    """Return the errors of a cell from the accuracy pass of the run: the same job by the same judge."""
    outcome = request.outcomes.get(cell.recorded_as)
    return None if outcome is None else measure.entry_of(outcome)


def known_times(cell: Cell, request: Request) -> Entry | None:
    """Return the times of a cell from the timing pass of the run, if it timed all the frames that are timed here, as often or
    more often. They are the figures of the run's own table, so that a preset has one time on all pages."""
    clocked, repeats = request.clocked.get(cell.recorded_as), repeats_in(cell, request)
    if clocked is None or clocked.timed is None or clocked.timed.compared.frames != cell.timed_frames:
        return None
    if clocked.timed.compared.repeats < repeats:
        return None
    recorded = request.outcomes.get(cell.recorded_as)
    return clock.time_entry(clocked, cell.setting.cut, () if recorded is None else recorded.resting)


def chosen(cells: Sequence[Cell], request: Request, budget: float) -> Choice:
    """Choose each cell in turn that still fits into `budget` [s]; others are left out, and a cheaper one after them may fit."""
    requested, left, spent = list[Cell](), list[tuple[Cell, float]](), 0.0
    for cell in cells:
        each = cost(cell, request)
        if spent + each <= budget:
            requested.append(cell)
            spent += each
        else:
            left.append((cell, each))
    return Choice(tuple(requested), tuple(left), spent)
