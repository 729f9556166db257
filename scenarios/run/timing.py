"""The timing pass: serial, one thread, warm, nothing recorded, the engines of a scene taking turns repeat by repeat."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from math import nan

import numpy as np

from runfiles.timing_protocol import PHASE_FRAMES, REPEATS, TAIL_FRAMES, WARM_FRAMES
from scenarios.job import Job
from scenarios.measure.timing import Shared, Timed
from scenarios.run.machine import Meter, clock, load_average, reading_ns
from scenarios.run.timed_worker import Repeat, Seat

MOST_FRAMES = 900
"""Frames timed: all of every everyday scene at its short length, and of a longer one a quarter of a minute. With less the hand
over the table, which comes down to it slowly, would be timed in the air."""
ENOUGH = 6.0
"""Time [s] after which an engine gets no further repeat in a quick comparison; its row says how many it had."""


@dataclass(frozen=True, eq=False)
class Clocked:
    """One job's times, or why there are none."""

    job: Job
    timed: Timed | None
    note: str = ""


class Turns:
    """What one job has given so far, turn by turn, from frame `first` on. In a `fresh` process its warm-up is a figure of its
    own."""

    def __init__(self, job: Job, seat: Seat, fresh: bool, first: int = 0) -> None:
        self.job, self.seat, self.fresh, self.first = job, seat, fresh, first
        self.note, self.warmup, self.warm_frames, self.spent = "", nan, 0, 0.0
        self.repeats: list[Repeat] = []

    def warmed(self) -> None:
        """Take the answer to the warm-up, which counts by itself."""
        if not self.note and (found := self.hear()):
            self.warm_frames = len(found[0])
        if self.fresh:
            self.warmup = self.spent
        self.spent = 0.0

    def turn(self, meter: Meter) -> None:
        """The frames of one repeat, while no other engine runs."""
        with meter.running():
            self.seat.go()
            found = self.hear()
        if found:
            self.repeats.append(found)

    def hear(self) -> Repeat | None:
        """What it answers to either order; None when it has loaded, or is gone, which its note says."""
        found = self.seat.hear()
        if isinstance(found, str):
            self.note = found
            return None
        self.spent += found[0]
        return found[1]

    def clocked(self) -> Clocked:
        """All that it gave."""
        if not self.repeats:
            return Clocked(self.job, None, self.note or "no repeat was run")
        around = np.array([repeat[0] for repeat in self.repeats], dtype=np.int64)
        names = sorted({name for repeat in self.repeats for name in repeat[1]})
        silent = [0] * around.shape[1]
        stages = {name: np.array([repeat[1].get(name, silent) for repeat in self.repeats], dtype=np.int64) for name in names}
        hashes = tuple(repeat[2] for repeat in self.repeats)
        timed = Timed(around, stages, self.warmup, hashes, self.warm_frames, self.first)
        return Clocked(self.job, timed, self.note or timed.protocol.said)


def loaded(table: Sequence[Turns], counts: Sequence[int], warm: bool = True) -> list[Turns]:
    """Let all load side by side, each for so many frames from its first on, or from the scene's to get `warm`; those that are
    ready, in a quiet moment."""
    asked = [at for at in table if not at.note]
    for at, count in zip(table, counts, strict=True):
        if not at.note:
            at.seat.prepare(at.job, count, 0 if warm else at.first)
    for at in asked:
        at.hear()
    return [at for at in asked if not at.note]


def timed_pass(
    jobs: Sequence[Job], full: bool, done: Callable[[], None] = lambda: None, frames: Sequence[int] | None = None,
    seats: Sequence[Seat] = (), repeats: int | Sequence[int] = REPEATS, meter: Meter | None = None,
    firsts: Sequence[int] | None = None,
) -> list[Clocked]:
    """Time all `jobs` of one scene, each in a fresh process, or in those of `seats`, one each, which go on. They warm up side by
    side, each on a load that is thrown away; then one at a time, turn by turn, `repeats` times round, each on a load of its own.

    `done` is called after each job's last turn; `frames` says how many of each job are timed (otherwise MOST_FRAMES), `repeats`
    how often, for all or for each, `firsts` at which frame timing begins. `meter` runs during every turn."""
    counts = [MOST_FRAMES] * len(jobs) if frames is None else frames
    often = [repeats] * len(jobs) if isinstance(repeats, int) else repeats
    meter, table = meter or Meter(), list[Turns]()
    try:
        for k, job in enumerate(jobs):
            table.append(Turns(job, seats[k] if seats else Seat(), fresh=not seats, first=0 if firsts is None else firsts[k]))
        for at in loaded(table, [WARM_FRAMES] * len(table)):
            at.seat.go()
        for at in table:
            at.warmed()
        for turn in range(max(often, default=0)):
            plan = zip(table, counts, often, strict=True)
            again = [(at, count) for at, count, most in plan if turn < most and (full or at.spent < ENOUGH)]
            for at in loaded([at for at, _ in again], [count for _, count in again], warm=False):
                at.turn(meter)
    except BaseException:
        for at in table if not seats else ():
            at.seat.leave(at_once=True)
        raise
    for at in table:
        if not seats:
            at.seat.leave()
        done()
    return [at.clocked() for at in table]


def timing_facts(meter: Meter) -> dict[str, object]:
    """What goes into the provenance of times: the protocol at its fullest, and what the machine did meanwhile."""
    others = None if meter.others is None else round(meter.others, 3)
    return {
        "repeats": REPEATS, "warm_frames": WARM_FRAMES, "tail_frames": TAIL_FRAMES, "phase_frames": PHASE_FRAMES,
        "load_after": load_average(), "busy_elsewhere": others, "reading_ns": reading_ns(), **clock(),
    }


def compared(found: Sequence[Clocked]) -> list[Clocked]:
    """The engines of one scene, each told which repeats and frames all of them had: by those they are compared."""
    every = [clocked.timed for clocked in found if clocked.timed is not None]
    if not every:
        return list(found)
    repeats = min(timed.around_ns.shape[0] for timed in every)
    first, last = max(timed.first for timed in every), min(timed.first + timed.around_ns.shape[1] for timed in every)
    shared = Shared(repeats, first, max(0, last - first))
    return [
        clocked if clocked.timed is None else replace(clocked, timed=replace(clocked.timed, shared=shared)) for clocked in found
    ]
