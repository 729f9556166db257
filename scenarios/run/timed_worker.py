"""Timed worker processes: one engine in a process of its own, which loads and runs when it is told to, job after job.

A conversation over a pipe: between order and answer the parent sleeps. Pebble, which runs all other jobs, has threads that look
ten times a second: for ten engines 200 wake-ups a second, a hundredth of a processor, beside the frames that are being timed.
"""

import multiprocessing
import time
from contextlib import suppress
from multiprocessing.connection import Connection
from types import TracebackType
from typing import Self

from avatarsim.engine import Engine
from avatarsim.errors import described, ended_by
from avatarsim.running.processes import settled
from scenarios.engines import opened
from scenarios.job import Job
from scenarios.run.accuracy import prepare
from scenarios.run.processes import context

PATIENCE = 300.0
"""Longest one repeat may take [s]."""
LAST_WORDS = 30.0
"""Longest [s] to wait for how a process ends once its pipe has; shorter, and a busy machine would leave that untold."""
GO = "go"
"""The order to run what is loaded."""

Repeat = tuple[list[int], dict[str, list[int]], str]
"""Nanoseconds of each frame from outside and per stage, and the state hash of the last."""


class Prepared:
    """Frames of a job, loaded anew and ready to be timed: so many from frame `first` on, those before it run and not timed."""

    def __init__(self, job: Job, frames: int, first: int = 0) -> None:
        what = prepare(job)
        self.dt, samples = what.scenario.dt, what.first(first + frames)
        self.samples = samples[first:]
        self.engine: Engine = opened(job.engine)
        self.shown = self.engine.load(what.scene, job.settings(self.engine, stages=True), self.dt)
        for sample in samples[:first]:
            self.shown = self.engine.advance(sample, self.dt)

    def timed(self) -> Repeat:
        """Run the frames; once."""
        engine, shown, dt = self.engine, self.shown, self.dt
        around: list[int] = []
        stages: dict[str, list[int]] = {}
        try:
            for k, sample in enumerate(self.samples):
                begun = time.perf_counter_ns()
                shown = engine.advance(sample, dt)
                around.append(time.perf_counter_ns() - begun)
                for name, spent in shown.stage_ns.items():
                    stages.setdefault(name, [0] * len(self.samples))[k] = int(spent)
            return around, stages, shown.state_hash()
        finally:
            engine.close()


def repeat(job: Job, frames: int) -> Repeat:
    """The first frames of a job, timed; a fresh load each time."""
    return Prepared(job, frames).timed()


def _serve(connection: Connection) -> None:
    """Life of one timed engine: for each job that comes in, a load, and once it is told to go, its frames; each is answered with
    the seconds it took. None ends it."""
    settled()
    try:
        while (order := connection.recv()) is not None:
            begun = time.perf_counter()
            prepared = Prepared(*order)
            connection.send((time.perf_counter() - begun, None))
            if connection.recv() is None:
                return
            begun = time.perf_counter()
            answer = prepared.timed()
            connection.send((time.perf_counter() - begun, answer))
    except (EOFError, ConnectionError):
        # the parent has gone
        return
    except Exception as error:
        with suppress(ConnectionError):
            connection.send((0.0, described(error)))


class Seat:
    """The worker process of one engine, and what it was told to do. It answers one order at a time."""

    def __init__(self, patience: float = PATIENCE) -> None:
        self.end, there = multiprocessing.Pipe()
        self.child = context().Process(target=_serve, args=(there,), daemon=True)
        self.child.start()
        there.close()
        self.patience, self.gone = patience, False

    def prepare(self, job: Job, frames: int, first: int = 0) -> None:
        """Let it load `job` and run up to frame `first`; it will be asked so many frames from there on."""
        self._say((job, frames, first))

    def go(self) -> None:
        """Let it run what it has loaded."""
        self._say(GO)

    def _say(self, what: object) -> None:
        with suppress(ConnectionError):
            # `hear` tells of a process that has died meanwhile
            self.end.send(what)

    def hear(self) -> tuple[float, Repeat | None] | str:
        """Its answer to either, with the seconds it took; or why there is none, and never will be."""
        try:
            if self.end.poll(self.patience):
                spent, answer = self.end.recv()
                if not isinstance(answer, str):
                    return spent, answer
            else:
                self.child.kill()
                answer = f"no answer within {self.patience:g} s"
        except (EOFError, ConnectionError):
            self.child.join(LAST_WORDS)
            self.child.kill()
            self.child.join()
            answer = f"its process {ended_by(self.child.exitcode or 0)}"
        self.gone = True
        return answer

    def leave(self, at_once: bool = False) -> None:
        """End the process, in the middle of its work if `at_once`."""
        with suppress(ConnectionError):
            self.end.send(None)
        if at_once:
            self.child.kill()
        self.child.join(timeout=10.0)
        if self.child.is_alive():
            self.child.kill()
            self.child.join()
        self.end.close()


class Seats:
    """One process per name, started when it is first needed and again when it has ended; use as a context."""

    def __init__(self, patience: float = PATIENCE) -> None:
        self.patience = patience
        self.taken: dict[str, Seat] = {}

    def __enter__(self) -> Self:
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None) -> None:
        for seat in self.taken.values():
            seat.leave(at_once=kind is not None)

    def at(self, name: str) -> Seat:
        """The process of that name."""
        if name in self.taken and self.taken[name].gone:
            self.taken.pop(name).leave()
        if name not in self.taken:
            self.taken[name] = Seat(self.patience)
        return self.taken[name]
