"""The timing pass: serial, one thread, warm, nothing recorded, the engines of a scene taking turns repeat by repeat."""

import time
from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import dataclass
from multiprocessing.connection import Connection
from multiprocessing.process import BaseProcess

import numpy as np

from avatarsim.engine import Engine
from scenarios.engines import opened
from scenarios.job import Job
from scenarios.measure.timing import Timed
from scenarios.processes import begin, ended, quiet
from scenarios.run import described

MOST_FRAMES = 600
"""Frames timed at full length: ten seconds of motion hold every kind of frame a scene has."""
SHORT_FRAMES = 360
"""Frames timed in a quick comparison."""
REPEATS = 3
"""How often the same frames are run; the least of each frame is what it costs when nothing disturbs."""
WARM_FRAMES = 30
"""Frames run before anything is timed: compiles, fills caches, grows buffers."""
ENOUGH = 6.0
"""Time [s] after which an engine gets no further repeat in a quick comparison; its row says how many it had."""
PATIENCE = 300.0
"""Longest one repeat may take [s]."""


@dataclass(frozen=True, eq=False)
class Clocked:
    """One job's times, or why there are none."""

    job: Job
    timed: Timed | None
    note: str = ""


def repeat(job: Job, frames: int) -> tuple[list[int], dict[str, list[int]], str]:
    """Nanoseconds of each frame from outside and per stage, and the state hash of the last; a fresh load each time."""
    scenario, scene, motion = job.asked()
    samples = [motion(k) for k in range(min(frames, scenario.frames))]
    engine: Engine = opened(job.engine)
    around: list[int] = []
    stages: dict[str, list[int]] = {}
    try:
        shown = engine.load(scene, job.settings(engine, stages=True), scenario.dt)
        for k, sample in enumerate(samples):
            begun = time.perf_counter_ns()
            shown = engine.advance(sample, scenario.dt)
            around.append(time.perf_counter_ns() - begun)
            for name, spent in shown.stage_ns.items():
                stages.setdefault(name, [0] * len(samples))[k] = int(spent)
        return around, stages, shown.state_hash()
    finally:
        engine.close()


def _serve(connection: Connection, job: Job, frames: int) -> None:
    """Life of one timed engine: warm up, then one repeat for each word that comes in; none ends it."""
    quiet()
    try:
        begun = time.perf_counter()
        repeat(job, WARM_FRAMES)
        connection.send(("warm", time.perf_counter() - begun))
        while connection.recv():
            connection.send(("repeat", repeat(job, frames)))
    except (EOFError, ConnectionError):
        # the parent has gone
        return
    except Exception as error:
        with suppress(ConnectionError):
            connection.send(("failed", described(error)))


class _Seat:
    """One engine's place at the table: its process, what it has said so far, and whether it still takes part."""

    def __init__(self, job: Job, frames: int) -> None:
        self.job, self.note, self.warmup, self.spent = job, "", 0.0, 0.0
        self.repeats: list[tuple[list[int], dict[str, list[int]], str]] = []
        self.child: BaseProcess
        self.child, self.end = begin(_serve, job, frames)

    def hear(self) -> None:
        """Take in one message; an end without one, or a failure, takes the engine out."""
        try:
            if not self.end.poll(PATIENCE):
                self.child.kill()
                self.note = f"no answer within {PATIENCE:g} s"
                return
            kind, content = self.end.recv()
        except (EOFError, ConnectionError):
            self.note = ended(self.child)
            return
        if kind == "warm":
            self.warmup = content
        elif kind == "repeat":
            self.repeats.append(content)
        else:
            self.note = str(content)

    def turn(self) -> None:
        """One repeat, with nobody else at work."""
        begun = time.monotonic()
        with suppress(ConnectionError):
            self.end.send(True)
        self.hear()
        self.spent += time.monotonic() - begun

    def drop(self) -> None:
        """End the process at once: somebody stopped the run."""
        self.child.kill()
        self.child.join()
        self.end.close()

    def leave(self) -> Clocked:
        """End the process and hand over what it gave."""
        with suppress(ConnectionError):
            self.end.send(False)
        self.child.join(timeout=10.0)
        if self.child.is_alive():
            self.child.kill()
            self.child.join()
        self.end.close()
        if not self.repeats:
            return Clocked(self.job, None, self.note or "no repeat was run")
        around = np.array([repeat[0] for repeat in self.repeats], dtype=np.int64)
        names = sorted({name for repeat in self.repeats for name in repeat[1]})
        silent = [0] * around.shape[1]
        stages = {name: np.array([repeat[1].get(name, silent) for repeat in self.repeats], dtype=np.int64) for name in names}
        timed = Timed(around, stages, self.warmup, tuple(repeat[2] for repeat in self.repeats))
        return Clocked(self.job, timed, self.note or f"{len(self.repeats)} repeats of {around.shape[1]} frames")


def timed_pass(
    jobs: Sequence[Job], full: bool, done: Callable[[], None] = lambda: None, frames: Sequence[int] | None = None
) -> list[Clocked]:
    """Time all `jobs` of one scene. They warm up side by side; then one at a time, turn by turn, REPEATS times round.

    `done` is called after each job's last turn; `frames` says how many of each job are timed (otherwise MOST_FRAMES with `full`,
    else SHORT_FRAMES)."""
    counts = [MOST_FRAMES if full else SHORT_FRAMES] * len(jobs) if frames is None else frames
    seats: list[_Seat] = []
    try:
        seats.extend(_Seat(job, count) for job, count in zip(jobs, counts, strict=True))
        for seat in seats:
            seat.hear()
        for _ in range(REPEATS):
            for seat in seats:
                if not seat.note and (full or seat.spent < ENOUGH):
                    seat.turn()
    except BaseException:
        for seat in seats:
            seat.drop()
        raise
    clocked = []
    for seat in seats:
        clocked.append(seat.leave())
        done()
    return clocked
