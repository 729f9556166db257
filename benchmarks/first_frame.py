"""Time of the first frame after `load` against the median frame, each scene in a process of its own.

Kernels should be compiled already (`python -m avatarsim`): the first process would compile them, within `load`.
"""

import argparse
import sys
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from avatarsim.errors import InvalidInput, StartOverlaps
from benchmarks.output import print_rows, write_rows
from runfiles.naming import GATED
from scenarios import catalog
from scenarios.cli.plan import filtered
from scenarios.job import Job
from scenarios.run.timed_worker import TimedWorker

MAX_RATIO = 10.0
"""Longest first frame, in multiples of the median frame."""
FRAMES, QUICK_FRAMES = 600, 20
"""Most frames run per scene: the median is that of ten seconds."""
TRIES = 3
"""Processes per scene before its first frame counts as too long: work that `load` has left is in each, a disturbance by the
rest of the machine is not."""


@dataclass(frozen=True)
class Row:
    """One scene: time [s] to build and load it, of the first and of the median frame [us], and their ratio."""

    scene: str
    preset: str
    load_s: float
    first_us: float
    median_us: float
    ratio: float


def measure(scene: str, preset: str, frames: int) -> Row | str:
    """Run a scene in a fresh process; the reason where it cannot run."""
    process = TimedWorker()
    try:
        process.prepare(Job(scene, GATED[0], preset), frames)
        loaded = process.answer()
        if isinstance(loaded, str):
            return loaded
        process.start()
        answer = process.answer()
    finally:
        process.close()
    if isinstance(answer, str) or answer[1] is None:
        return str(answer)
    us = 1e-3 * np.array(answer[1][0])
    first, median = float(us[0]), float(np.median(us))
    return Row(scene, preset, loaded[0], first, median, first / median)


def best(scene: str, preset: str, frames: int) -> Row | str:
    """Measure a scene, again where its first frame takes too long; the smallest ratio counts."""
    tries: list[Row] = []
    while len(tries) < TRIES and not (tries and tries[-1].ratio <= MAX_RATIO):
        answer = measure(scene, preset, frames)
        if isinstance(answer, str):
            return answer
        tries.append(answer)
    return min(tries, key=lambda row: row.ratio)


def run(arguments: argparse.Namespace, folder: Path) -> int:
    """Measure, write, print. 1: a first frame is long; 3: a scene could not run. InvalidInput: no scene matches."""
    names = filtered(catalog.scenarios(), arguments.filter)
    if not names:
        raise InvalidInput("--filter", arguments.filter, "patterns that match scenes; `python -m scenarios list` names them")
    rows: list[Row] = []
    failed = 0
    for preset in arguments.preset:
        for name in names:
            result = best(name, preset, QUICK_FRAMES if arguments.quick else FRAMES)
            print(f"first frame  {name} {preset}{f': {result}' if isinstance(result, str) else ''}", file=sys.stderr, flush=True)
            if isinstance(result, Row):
                rows.append(result)
            elif not result.startswith(StartOverlaps.__name__):
                failed += 1
    rows.sort(key=lambda row: -row.ratio)
    bad = sum(not row.ratio <= MAX_RATIO for row in rows)
    print_rows(f"{bad} of {len(rows)} first frames take more than {MAX_RATIO:g} medians", rows)
    write_rows(folder / "first_frame.csv", rows, Row)
    return 1 if bad else 3 if failed else 0
