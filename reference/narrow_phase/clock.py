"""The clock: all contenders of a cell in turns, repeat by repeat; only their queries lie between two readings."""

import gc
import time
from collections.abc import Mapping
from collections.abc import Sequence as Many
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from avatarsim.errors import described
from reference.narrow_phase.cells import Mode, Sequence
from reference.narrow_phase.contender import Contender

Array = NDArray[np.float64]

WARM_FRAMES = 2
"""Frames that a contender runs before each of its turns, untimed: the others have just emptied the processor's caches."""

ENOUGH = 2.0
"""Time [s] after which a contender gets no further repeat in a cell: python-fcl iterates for milliseconds on spheres that
overlap, and the row says how many repeats it had."""


def _none() -> Array:
    return np.zeros((0, 0))


@dataclass(frozen=True, eq=False)
class Clocked:
    """What one contender did in one cell: times (repeats, frames) [us] per query, answers (judged frames, pairs) [m].

    calls (repeats, frames) [us]: the same of two spheres, in the same turns: what a call costs. Empty unless it was asked for.
    """

    times: Array = field(default_factory=_none)
    answers: Array = field(default_factory=_none)
    calls: Array = field(default_factory=_none)
    trouble: str = ""

    @property
    def call(self) -> float:
        """Median cost of a call [us]; nan if it was not asked for."""
        return float(np.median(self.calls)) if self.calls.size else float("nan")

    @property
    def quartiles(self) -> tuple[float, float, float]:
        """25th, 50th, 75th percentile [us] of a query: of each frame over the repeats, then the mean of all frames.

        Frame by frame, because a disturbance of the machine hits a frame of a repeat, not the frame in all of them.
        """
        low, middle, high = np.percentile(self.times, (25, 50, 75), axis=0).mean(axis=1).tolist()
        return low, middle, high


def clocked(
    contenders: Many[Contender], sequence: Sequence, mode: Mode, repeats: int, judged: range,
    callers: Mapping[str, tuple[Contender, Sequence]],
) -> dict[str, Clocked]:
    """By name, what every contender did. One pass that is not timed, for the answers in `judged` frames; then `repeats` rounds in
    which each contender in turn runs the whole sequence, each round begun by another one. One that fails is out, and its trouble
    says why. `callers`: by name, the same contender once more, loaded with spheres, which follows it in every turn."""
    answers: dict[str, Array] = {}
    trouble: dict[str, str] = {}
    for contender in contenders:
        name = contender.identity.name
        try:
            contender.load(sequence, mode)
            answers[name] = _answers(contender, sequence, judged)
        except Exception as error:
            # whatever a library throws is its own result, not the end of the others
            trouble[name] = described(error)
    running = [contender for contender in contenders if contender.identity.name in answers]
    times: dict[str, list[list[float]]] = {name: [] for name in answers}
    calls: dict[str, list[list[float]]] = {name: [] for name in answers}
    collecting = gc.isenabled()
    gc.disable()
    try:
        for round_ in range(repeats):
            first = round_ % max(1, len(running))
            for contender in running[first:] + running[:first]:
                name = contender.identity.name
                if sum(map(sum, times[name])) > 1e9 * ENOUGH:
                    continue
                times[name].append(_times(contender, sequence))
                if name in callers:
                    calls[name].append(_times(*callers[name]))
    finally:
        if collecting:
            gc.enable()
    found = {name: Clocked(trouble=why) for name, why in trouble.items()}
    for name, rows in times.items():
        spheres = callers[name][1].pairs if name in callers else 1
        found[name] = Clocked(np.array(rows) / (1e3 * sequence.pairs), answers[name], np.array(calls[name]) / (1e3 * spheres))
    return found


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
    for frame in range(min(WARM_FRAMES, sequence.frames)):
        contender.pose(frame)
        contender.ask()
    contender.begin()
    for frame in range(sequence.frames):
        contender.pose(frame)
        begun = clock()
        contender.ask()
        spent.append(float(clock() - begun))
    return spent
