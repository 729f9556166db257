"""The clock: all contenders of a cell in turns, repeat by repeat; only their queries lie between two readings."""

import gc
import time
from collections.abc import Sequence as Many
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from reference.narrow_phase.cells import Mode, Sequence
from reference.narrow_phase.contender import Contender

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Clocked:
    """What one contender did in one cell: times (repeats, frames) [us] per query, answers (judged frames, pairs) [m]."""

    times: Array
    answers: Array
    trouble: str = ""

    @property
    def quartiles(self) -> tuple[float, float, float]:
        """25th, 50th, 75th percentile [us] of a query: of each frame over the repeats, then the mean of all frames.

        Frame by frame, because a disturbance of the machine hits a frame of a repeat, not the frame in all of them.
        """
        low, middle, high = np.percentile(self.times, (25, 50, 75), axis=0).mean(axis=1).tolist()
        return low, middle, high


def clocked(
    contenders: Many[Contender], sequence: Sequence, mode: Mode, repeats: int, judged: range
) -> dict[str, Clocked]:
    """By name, what every contender did. One pass that is not timed, for the answers in `judged` frames and to warm up; then
    `repeats` rounds in which each contender runs the whole sequence. Who fails is out, and its trouble says why."""
    answers: dict[str, Array] = {}
    trouble: dict[str, str] = {}
    for contender in contenders:
        name = contender.identity.name
        try:
            contender.load(sequence, mode)
            answers[name] = _answers(contender, sequence, judged)
        except Exception as error:
            # whatever a library throws is its own result, not the end of the others
            trouble[name] = f"{type(error).__name__}: {error}"
    running = [contender for contender in contenders if contender.identity.name in answers]
    times: dict[str, list[list[float]]] = {contender.identity.name: [] for contender in running}
    collecting = gc.isenabled()
    gc.disable()
    try:
        for _ in range(repeats):
            for contender in running:
                times[contender.identity.name].append(_times(contender, sequence))
    finally:
        if collecting:
            gc.enable()
    done = {name: Clocked(np.array(rows) / (1e3 * sequence.pairs), answers[name]) for name, rows in times.items()}
    nothing = np.zeros((0, 0))
    return {c.identity.name: done.get(c.identity.name) or Clocked(nothing, nothing, trouble[c.identity.name]) for c in contenders}


def _answers(contender: Contender, sequence: Sequence, judged: range) -> Array:
    contender.begin()
    found = []
    for frame in range(sequence.frames):
        contender.pose(frame)
        contender.ask()
        if frame in judged:
            found.append(contender.answers())
    return np.array(found)


def _times(contender: Contender, sequence: Sequence) -> list[float]:
    """Nanoseconds of every frame."""
    clock, spent = time.perf_counter_ns, []
    contender.begin()
    for frame in range(sequence.frames):
        contender.pose(frame)
        begun = clock()
        contender.ask()
        spent.append(float(clock() - begun))
    return spent
