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


Repeat = tuple[list[int], dict[str, list[int]], str]
"""Nanoseconds of each frame from outside and per stage, and the state hash of the last."""


@dataclass(frozen=True, eq=False)
class Clocked:
    """One job's times, or why there are none."""

    job: Job
    timed: Timed | None
    note: str = ""


def repeat(job: Job, frames: int) -> Repeat:
    """The first frames of a job, timed; a fresh load each time."""
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


def _serve(connection: Connection) -> None:
    """Life of one timed engine: a repeat for each job that comes in, with how long all of it took; none ends it."""
    quiet()
    try:
        while (asked := connection.recv()) is not None:
            begun = time.perf_counter()
            answer = repeat(*asked)
            connection.send((time.perf_counter() - begun, answer))
    except (EOFError, ConnectionError):
        # the parent has gone
        return
    except Exception as error:
        with suppress(ConnectionError):
            connection.send((0.0, described(error)))


class Seat:
    """One engine's place at the table: its process, and what has been asked of it. It answers one thing at a time."""

    def __init__(self, patience: float = PATIENCE) -> None:
        self.child: BaseProcess
        self.child, self.end = begin(_serve)
        self.patience, self.gone = patience, False

    def ask(self, job: Job, frames: int) -> None:
        """Let it run so many frames of `job`."""
        with suppress(ConnectionError):
            # one that has died meanwhile is heard of
            self.end.send((job, frames))

    def hear(self) -> tuple[float, Repeat] | str:
        """Its answer, with the seconds it took; or why there is none, and never will be."""
        try:
            if self.end.poll(self.patience):
                spent, answer = self.end.recv()
                if not isinstance(answer, str):
                    return spent, answer
            else:
                self.child.kill()
                answer = f"no answer within {self.patience:g} s"
        except (EOFError, ConnectionError):
            answer = ended(self.child)
        self.gone = True
        return answer

    def leave(self, at_once: bool = False) -> None:
        """End the process, in the middle of its work if somebody stopped the run."""
        with suppress(ConnectionError):
            self.end.send(None)
        if at_once:
            self.child.kill()
        self.child.join(timeout=10.0)
        if self.child.is_alive():
            self.child.kill()
            self.child.join()
        self.end.close()


class Turns:
    """What one job has given so far, turn by turn."""

    def __init__(self, job: Job, seat: Seat) -> None:
        self.job, self.seat, self.note, self.warmup, self.spent = job, seat, "", 0.0, 0.0
        self.repeats: list[Repeat] = []

    def warmed(self) -> float:
        """Hear of the warm-up that was asked for; seconds per frame it had, 0 when it failed."""
        found = self.seat.hear()
        if isinstance(found, str):
            self.note = found
            return 0.0
        self.warmup, (around, _, _) = found
        return 1e-9 * float(np.median(around))

    def turn(self, frames: int) -> None:
        """One repeat, with nobody else at work."""
        self.seat.ask(self.job, frames)
        found = self.seat.hear()
        if isinstance(found, str):
            self.note = found
            return
        self.spent += found[0]
        self.repeats.append(found[1])

    def clocked(self) -> Clocked:
        """All that it gave."""
        if not self.repeats:
            return Clocked(self.job, None, self.note or "no repeat was run")
        around = np.array([repeat[0] for repeat in self.repeats], dtype=np.int64)
        names = sorted({name for repeat in self.repeats for name in repeat[1]})
        silent = [0] * around.shape[1]
        stages = {name: np.array([repeat[1].get(name, silent) for repeat in self.repeats], dtype=np.int64) for name in names}
        timed = Timed(around, stages, self.warmup, tuple(repeat[2] for repeat in self.repeats))
        return Clocked(self.job, timed, self.note or f"{len(self.repeats)} repeats of {around.shape[1]} frames")


def timed_pass(
    jobs: Sequence[Job], full: bool, done: Callable[[], None] = lambda: None, frames: Sequence[int] | None = None,
    seats: Sequence[Seat] = (),
) -> list[Clocked]:
    """Time all `jobs` of one scene, each in a fresh process, or in those of `seats`, one each, which go on. They warm up side by
    side; then one at a time, turn by turn, REPEATS times round.

    `done` is called after each job's last turn; `frames` says how many of each job are timed (otherwise MOST_FRAMES with `full`,
    else SHORT_FRAMES)."""
    counts = [MOST_FRAMES if full else SHORT_FRAMES] * len(jobs) if frames is None else frames
    table: list[Turns] = []
    try:
        for k, job in enumerate(jobs):
            table.append(Turns(job, seats[k] if seats else Seat()))
            table[-1].seat.ask(job, WARM_FRAMES)
        for at in table:
            at.warmed()
        for _ in range(REPEATS):
            for at, count in zip(table, counts, strict=True):
                if not at.note and (full or at.spent < ENOUGH):
                    at.turn(count)
    except BaseException:
        for at in table if not seats else ():
            at.seat.leave(at_once=True)
        raise
    for at in table:
        if not seats:
            at.seat.leave()
        done()
    return [at.clocked() for at in table]
