"""Time of the first frame after `load` against the median frame, each scene in a process of its own.

Kernels should be compiled already (`python -m avatarsim`): the first process would compile them, within `load`.
"""

import argparse
import multiprocessing
import sys
import time
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from avatarsim.errors import InvalidInput, StartOverlaps, described
from avatarsim.jit.linking import CalledKernel
from benchmarks.output import print_rows, write_rows
from runfiles.naming import GATED
from scenarios import catalog
from scenarios.engines import opened
from scenarios.job import Job
from scenarios.running.asked import asked as prepared
from scenarios.running.offered import filtered

MOST_TIMES = 10.0
"""Longest first frame, in multiples of the median frame."""
FRAMES, QUICK_FRAMES = 600, 20
"""Most frames run per scene: the median is that of ten seconds."""
TRIES = 3
"""Processes per scene before its first frame counts as too long: work that `load` has left is in each, a disturbance by the
rest of the machine is not."""
REFUSED = "refused, as it overlaps at the start"
CLOCKED = 100
"""Calls of the clock before the first frame, which shall not pay for the clock's own first call."""


@dataclass(frozen=True)
class Row:
    """One scene in one process: time of `load` [s], of the first and of the median frame [us], their ratio, and the number of
    kernels that frames loaded."""

    scene: str
    preset: str
    load_s: float
    first_us: float
    median_us: float
    ratio: float
    late_kernels: int

    @property
    def good(self) -> bool:
        """Whether the first frame is short and loads nothing."""
        return self.late_kernels == 0 and self.ratio <= MOST_TIMES


def measure(scene: str, preset: str, frames: int) -> Row:
    """Run a scene in this process, which has run nothing yet. Raises StartOverlaps where the engine refuses the first pose."""
    job = Job(scene, GATED[0], preset)
    what = prepared(job)
    engine, samples, clock, dt = opened(job.engine), what.samples[:frames], time.perf_counter_ns, what.scenario.dt
    begun = clock()
    engine.load(what.scene, job.settings(engine), dt)
    load, made = (clock() - begun) * 1e-9, CalledKernel.made
    spent = np.zeros(len(samples), np.int64)
    for _ in range(CLOCKED):
        clock()
    for k, sample in enumerate(samples):
        begun = clock()
        engine.advance(sample, dt)
        spent[k] = clock() - begun
    engine.close()
    first, median = 1e-3 * float(spent[0]), 1e-3 * float(np.median(spent))
    return Row(scene, preset, load, first, median, first / median, CalledKernel.made - made)


def attempt(scene: str, preset: str, frames: int) -> Row | str:
    """The same, or the reason why there is no first frame."""
    try:
        return measure(scene, preset, frames)
    except StartOverlaps:
        return REFUSED
    except Exception as error:
        # the trouble of one scene does not end the measurement
        return described(error)


def alone(scene: str, preset: str, frames: int) -> Row | str:
    """Measure a scene in a fresh process, again where its first frame takes too long; the smallest ratio counts."""
    found: list[Row] = []
    while len(found) < TRIES and not (found and (found[-1].good or found[-1].late_kernels)):
        with ProcessPoolExecutor(1, multiprocessing.get_context("spawn")) as process:
            answer = process.submit(attempt, scene, preset, frames).result()
        if isinstance(answer, str):
            return answer
        found.append(answer)
    return min(found, key=lambda row: (-row.late_kernels, row.ratio))


def run(asked: argparse.Namespace, folder: Path) -> int:
    """Measure, write, print. 1: a first frame is long or loads a kernel; 3: a scene could not run. Raises InvalidInput for a
    pattern that matches no scene."""
    names = filtered(catalog.scenarios(), asked.filter)
    if not names:
        raise InvalidInput("--filter", asked.filter, "patterns that match scenes; `python -m scenarios list` names them")
    found: list[Row | str] = []
    for preset in asked.preset:
        for name in names:
            found.append(alone(name, preset, QUICK_FRAMES if asked.quick else FRAMES))
            told = found[-1] if isinstance(found[-1], str) else "measured"
            print(f"first frame  {name} {preset}: {told}", file=sys.stderr, flush=True)
    rows = sorted((row for row in found if isinstance(row, Row)), key=lambda row: (-row.late_kernels, -row.ratio))
    bad = sum(not row.good for row in rows)
    print_rows(f"{bad} of {len(rows)} first frames take more than {MOST_TIMES:g} medians, or load a kernel", rows)
    write_rows(folder / "first_frame.csv", rows, Row)
    return 1 if bad else 3 if any(isinstance(one, str) and one != REFUSED for one in found) else 0
