"""Times and errors of every contender in every cell."""

import argparse
import sys
import time
from collections.abc import Sequence
from dataclasses import dataclass
from fnmatch import fnmatchcase
from functools import partial
from importlib import import_module
from math import inf, nan
from pathlib import Path

import numpy as np

from avatarsim.errors import InvalidInput, described
from benchmarks.narrow_phase.contender import Array, Cell, Contender, Mode, Trial
from benchmarks.narrow_phase.pairs import MODES, cells, make_trial, truths
from benchmarks.output import print_pivot, print_rows, write_rows
from benchmarks.timing import take_turns

LIBRARIES = ("avatarsim", "coal", "fcl", "mujoco", "pybullet")
RIGHT = 1e-6
"""Error [m] up to which an answer is right: the bound on residual overlap."""
WARM_FRAMES = 2
"""Frames that a contender runs before each of its turns, untimed: the others have just emptied the processor's caches."""
ENOUGH = 2.0
"""Time [s] after which a contender gets no further repeat in a cell: fcl iterates for milliseconds on spheres that overlap."""


@dataclass(frozen=True)
class Plan:
    """Pairs per cell, frames, repeats, and every how many frames answers are judged."""

    pairs: int
    frames: int
    repeats: int
    judge_every: int


FULL: dict[Mode, Plan] = {"cold": Plan(20, 10, 9, 1), "coherent": Plan(20, 100, 5, 5)}
QUICK: dict[Mode, Plan] = {"cold": Plan(3, 2, 1, 1), "coherent": Plan(3, 6, 1, 2)}


@dataclass(frozen=True)
class Row:
    """One contender in one cell and mode: time [us] per query, median of each frame over the repeats, then the mean of all
    frames; largest error [m] of the judged answers (inf: one is missing), and the share of those that are not right."""

    shape_a: str
    shape_b: str
    regime: str
    mode: str
    engine: str
    library: str
    per_call: bool
    us_p50: float
    max_error_m: float
    share_wrong: float
    judged: int
    repeats: int


@dataclass(frozen=True)
class Summary:
    """One contender in all cells: geometric means of its times [us] per query, number of cells and modes in which every judged
    answer is right, of how many, and its largest error [m] where it answered."""

    engine: str
    per_call: bool
    us_cold: float
    us_coherent: float
    right: int
    cells: int
    max_error_m: float


def contenders(libraries: Sequence[str] = LIBRARIES) -> tuple[list[Contender], dict[str, str]]:
    """Return all contenders there are, and of each library that cannot be used the reason."""
    present: list[Contender] = []
    absent: dict[str, str] = {}
    for library in libraries:
        try:
            present += import_module(f"benchmarks.narrow_phase.in_{library}").contenders()
        except Exception as error:
            # a broken installation of a library does not end the others
            absent[library] = described(error)
    return present, absent


def measure(taking_part: Sequence[Contender], cell: Cell, mode: Mode, plan: Plan) -> list[Row]:
    """Return one row per contender. A first pass, untimed, gives the answers; a contender that fails there has no row."""
    trial = make_trial(cell, mode, plan.pairs, plan.frames)
    judged = range(0, plan.frames, plan.judge_every)
    truth = truths(trial, judged)
    errors: dict[Contender, Array] = {}
    for one in taking_part:
        try:
            one.load(trial)
            errors[one] = errors_of(answers(one, trial, judged), truth)
        except Exception as error:
            # whatever a library raises is its own result
            print(f"{one.name}, {cell.name}, {mode}: not measured: {described(error)}", file=sys.stderr)
    spent = take_turns({one: partial(times, one, trial) for one in errors}, plan.repeats, ENOUGH)
    rows = []
    for one, wrong in errors.items():
        us, share = float(np.median(spent[one], axis=0).mean()), float((wrong > RIGHT).mean())
        head = (*cell, mode, one.name, one.library, one.per_call)
        rows.append(Row(*head, us, float(wrong.max()), share, wrong.size, len(spent[one])))
    return rows


def errors_of(answers: Array, truth: Array) -> Array:
    """Return the distance of answers from the truth [m]; inf for an answer that is missing or is no number."""
    return np.where(np.isfinite(answers), np.abs(answers - truth), inf)


def answers(one: Contender, trial: Trial, judged: range) -> Array:
    """Answers (judged frames, pairs) [m] of a pass through all frames."""
    one.begin()
    distances = []
    for frame in range(len(trial.at)):
        one.pose(frame)
        one.query()
        if frame in judged:
            distances.append(one.answers())
    return np.array(distances)


def times(one: Contender, trial: Trial) -> Array:
    """Return microseconds (frames,) per query."""
    clock, spent = time.perf_counter_ns, []
    for frame in range(min(WARM_FRAMES, len(trial.at))):
        one.pose(frame)
        one.query()
    one.begin()
    for frame in range(len(trial.at)):
        one.pose(frame)
        begun = clock()
        one.query()
        spent.append(clock() - begun)
    return np.array(spent) / (1e3 * trial.pairs)


def summaries(rows: Sequence[Row]) -> list[Summary]:
    """Return one row per contender that was measured."""
    per_engine = []
    for engine in dict.fromkeys(row.engine for row in rows):
        own = [row for row in rows if row.engine == engine]
        logs = ([np.log(row.us_p50) for row in own if row.mode == mode] for mode in MODES)
        cold, coherent = (float(np.exp(np.mean(times or [nan]))) for times in logs)
        right = sum(row.max_error_m <= RIGHT for row in own)
        largest = max((row.max_error_m for row in own if row.max_error_m < inf), default=nan)
        per_engine.append(Summary(engine, own[0].per_call, cold, coherent, right, len(own), largest))
    return per_engine


def run(arguments: argparse.Namespace, folder: Path) -> int:
    """Measure, write, print. 3: a library is missing. Raises InvalidInput for a pattern that matches no cell."""
    chosen = [cell for cell in cells() if fnmatchcase(cell.name, arguments.cells)]
    if not chosen:
        names = ", ".join(cell.name for cell in cells())
        raise InvalidInput("--cells", arguments.cells, f"a pattern that matches one of {names}")
    taking_part, absent = contenders()
    rows: list[Row] = []
    for number, cell in enumerate(chosen, start=1):
        for mode, plan in (QUICK if arguments.quick else FULL).items():
            rows += measure(taking_part, cell, mode, plan)
        print(f"narrow phase {number}/{len(chosen)}  {cell.name}", file=sys.stderr, flush=True)
    for mode in MODES:
        here = [row for row in rows if row.mode == mode]
        print_pivot(f"{mode}: us per query, median", here, ("shape_a", "shape_b", "regime"), "engine", "us_p50")
    print_rows(f"all cells; right: off by at most {RIGHT:g} m from the exact distance", summaries(rows))
    write_rows(folder / "narrow_phase.csv", rows, Row)
    write_rows(folder / "narrow_phase_engines.csv", summaries(rows), Summary)
    for name, why in absent.items():
        print(f"{name}: not measured: {why}")
    return 3 if absent else 0
