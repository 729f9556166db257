"""The timing pass: serial, one thread, warm, nothing recorded, the engines of a scene taking turns repeat by repeat."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from scenarios.job import Job
from scenarios.measure.timing import Timed
from scenarios.seat import Repeat, Seat

MOST_FRAMES = 900
"""Frames timed: all of every everyday scene at its short length, and of a longer one a quarter of a minute. With less the hand
over the table, which comes down to it slowly, would be timed in the air."""
REPEATS = 3
"""How often the same frames are run; the least of each frame is what it costs when nothing disturbs."""
WARM_FRAMES = 30
"""Frames run before anything is timed: compiles, fills caches, grows buffers."""
ENOUGH = 6.0
"""Time [s] after which an engine gets no further repeat in a quick comparison; its row says how many it had."""


@dataclass(frozen=True, eq=False)
class Clocked:
    """One job's times, or why there are none."""

    job: Job
    timed: Timed | None
    note: str = ""


class Turns:
    """What one job has given so far, turn by turn."""

    def __init__(self, job: Job, seat: Seat) -> None:
        self.job, self.seat, self.note, self.warmup, self.spent = job, seat, "", 0.0, 0.0
        self.repeats: list[Repeat] = []

    @property
    def frames(self) -> int:
        """How many frames its repeats have had; 0 before the first."""
        return len(self.repeats[0][0]) if self.repeats else 0

    def warmed(self) -> None:
        """Hear of the warm-up that it was told to run, which counts by itself."""
        if not self.note:
            self.hear()
        self.warmup, self.spent = self.spent, 0.0

    def turn(self) -> None:
        """The frames of one repeat, with nobody else at work."""
        self.seat.go()
        if found := self.hear():
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
        times = "1 repeat" if len(around) == 1 else f"{len(around)} repeats"
        timed = Timed(around, stages, self.warmup, tuple(repeat[2] for repeat in self.repeats))
        return Clocked(self.job, timed, self.note or f"{times} of {around.shape[1]} frames")


def loaded(table: Sequence[Turns], counts: Sequence[int]) -> list[Turns]:
    """Let all load side by side, each for so many frames; those that are ready, in a quiet moment."""
    asked = [at for at in table if not at.note]
    for at, count in zip(table, counts, strict=True):
        if not at.note:
            at.seat.prepare(at.job, count)
    for at in asked:
        at.hear()
    return [at for at in asked if not at.note]


def timed_pass(
    jobs: Sequence[Job], full: bool, done: Callable[[], None] = lambda: None, frames: Sequence[int] | None = None,
    seats: Sequence[Seat] = (), repeats: int = REPEATS,
) -> list[Clocked]:
    """Time all `jobs` of one scene, each in a fresh process, or in those of `seats`, one each, which go on. They warm up side by
    side; then one at a time, turn by turn, `repeats` times round.

    `done` is called after each job's last turn; `frames` says how many of each job are timed (otherwise MOST_FRAMES)."""
    counts = [MOST_FRAMES] * len(jobs) if frames is None else frames
    table: list[Turns] = []
    try:
        for k, job in enumerate(jobs):
            table.append(Turns(job, seats[k] if seats else Seat()))
        for at in loaded(table, [WARM_FRAMES] * len(table)):
            at.seat.go()
        for at in table:
            at.warmed()
        for _ in range(repeats):
            again = [(at, count) for at, count in zip(table, counts, strict=True) if full or at.spent < ENOUGH]
            for at in loaded([at for at, _ in again], [count for _, count in again]):
                at.turn()
    except BaseException:
        for at in table if not seats else ():
            at.seat.leave(at_once=True)
        raise
    for at in table:
        if not seats:
            at.seat.leave()
        done()
    return [at.clocked() for at in table]
