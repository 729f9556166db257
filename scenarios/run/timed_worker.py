"""Timed workers: processes that stay, and load and run jobs by orders through a pipe.

So the parent sleeps while frames are timed; the threads of Pebble, which runs all other jobs, would wake ten times a second.
"""

import multiprocessing
import time
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass
from multiprocessing.connection import Connection
from types import TracebackType
from typing import Self

from avatarsim.engine import Engine
from avatarsim.errors import described, ended_by
from avatarsim.running.processes import settled
from avatarsim.scene.scene import Scene
from avatarsim.scene.tracker import TrackerSample
from scenarios.engines import opened
from scenarios.job import Job
from scenarios.run.accuracy import prepare
from scenarios.run.machine import Pace
from scenarios.run.processes import context

TIMEOUT = 300.0
"""Longest time of one repeat [s]."""
EXIT_TIMEOUT = 30.0
"""Longest wait [s] for the exit code of a process whose pipe has closed; shorter, and a busy machine would leave it unknown."""
START = "start"
"""The order to run the loaded frames."""

Repeat = tuple[list[int], dict[str, list[int]], str]
"""Times [ns] of all frames from outside and per stage, and the state hash of the last."""


@dataclass(frozen=True)
class Window:
    """A scene and the samples of its frames: those that run `before`, and those that are `timed`."""

    scene: Scene
    dt: float
    before: Sequence[TrackerSample]
    timed: Sequence[TrackerSample]


def window(job: Job, frames: int, first: int = 0) -> Window:
    """Return so many frames of a job's scene from frame `first` on. It is sent to the processes of all engines, each of which
    would take ten times as long to make it."""
    prepared = prepare(job)
    return Window(prepared.scene, prepared.scenario.dt, prepared.samples[:first], prepared.samples[first : first + frames])


class LoadedFrames:
    """The frames of a window, ready to be timed in one engine; those before have run."""

    def __init__(self, job: Job, given: Window) -> None:
        self.dt, self.samples = given.dt, given.timed
        self.engine: Engine = opened(job.engine)
        self.shown = self.engine.load(given.scene, job.settings(self.engine, stages=True), self.dt)
        for sample in given.before:
            self.shown = self.engine.advance(sample, self.dt)

    def run(self) -> Repeat:
        """Run the frames once, and close the engine."""
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
    """Load a job in this process and time its first frames."""
    return LoadedFrames(job, window(job, frames)).run()


def _serve(connection: Connection) -> None:
    """Load each job that comes in, and run it on command; answer either with the seconds it took. None ends the process."""
    settled()
    pace = Pace()
    try:
        while (order := connection.recv()) is not None:
            begun = time.perf_counter()
            loaded = LoadedFrames(*order)
            connection.send((time.perf_counter() - begun, None))
            if connection.recv() is None:
                return
            pace.wait()
            begun = time.perf_counter()
            answer = loaded.run()
            connection.send((time.perf_counter() - begun, answer))
    except (EOFError, ConnectionError):
        # the parent has gone
        return
    except Exception as error:
        with suppress(ConnectionError):
            connection.send((0.0, described(error)))


class TimedWorker:
    """A process that runs one engine. It answers one order at a time."""

    def __init__(self, timeout: float = TIMEOUT) -> None:
        self.end, there = multiprocessing.Pipe()
        self.child = context().Process(target=_serve, args=(there,), daemon=True)
        self.child.start()
        there.close()
        self.timeout, self.gone = timeout, False

    def prepare(self, job: Job, frames: int, first: int = 0) -> None:
        """Order it to load a job and run up to frame `first`, ready for so many frames from there on."""
        # `answer` reports a process that has died meanwhile
        with suppress(ConnectionError):
            self.end.send((job, window(job, frames, first)))

    def start(self) -> None:
        """Order it to run the loaded frames."""
        with suppress(ConnectionError):
            self.end.send(START)

    def answer(self) -> tuple[float, Repeat | None] | str:
        """Return the time [s] of the last order, and a repeat once frames have run; or the reason that it will never answer."""
        try:
            if self.end.poll(self.timeout):
                spent, answer = self.end.recv()
                if not isinstance(answer, str):
                    return spent, answer
            else:
                self.child.kill()
                answer = f"no answer within {self.timeout:g} s"
        except (EOFError, ConnectionError):
            self.child.join(EXIT_TIMEOUT)
            self.child.kill()
            self.child.join()
            answer = f"its process {ended_by(self.child.exitcode or 0)}"
        self.gone = True
        return answer

    def close(self, at_once: bool = False) -> None:
        """End the process, in the middle of its work if `at_once`."""
        with suppress(ConnectionError):
            self.end.send(None)
        if not at_once:
            self.child.join(timeout=10.0)
        self.child.kill()
        self.child.join()
        self.end.close()


class TimedWorkers:
    """One process per name, started when it is first needed and again when it has ended; use as a context."""

    def __init__(self, timeout: float = TIMEOUT) -> None:
        self.timeout = timeout
        self.taken: dict[str, TimedWorker] = {}

    def __enter__(self) -> Self:
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None) -> None:
        for worker in self.taken.values():
            worker.close(at_once=kind is not None)

    def at(self, name: str) -> TimedWorker:
        """Return the process of that name."""
        if name in self.taken and self.taken[name].gone:
            self.taken.pop(name).close()
        if name not in self.taken:
            self.taken[name] = TimedWorker(self.timeout)
        return self.taken[name]
