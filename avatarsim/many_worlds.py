"""Many worlds a frame further in one call, on several threads: data parallelism over independent simulations.

Python reads the samples of a portion of the worlds, one kernel call passes their frames without Python's global lock
(`stages`), and Python makes their records. Meanwhile another thread does the same with another portion: as long as kernels
take longer than Python, two threads are nearly twice as fast as one. Which thread passes a world changes no bit of it.
"""

import os
from collections.abc import Iterator, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor, wait
from functools import cache
from typing import TypeVar

import numpy as np

from avatarsim.engine import FrameRecord
from avatarsim.errors import AvatarsimError, EngineInUse, InvalidInput, WorldsFailed
from avatarsim.frame import Frames
from avatarsim.jit.layout import Index
from avatarsim.scene.checks import as_number
from avatarsim.scene.moving import Pose
from avatarsim.scene.tracker import TrackerSample
from avatarsim.simulator import AvatarsimEngine, frame_time
from avatarsim.stages import COLUMNS, STATUS, pass_frames

T = TypeVar("T")

PORTION = 32
"""Most worlds in one kernel call. Fewer: threads hand the lock to and fro more often, which shows where frames are short; more:
the last portion keeps one of them longer."""

MOST_THREADS = 1024
"""Most threads that may be requested: more than processors only wait for one another."""

PORTIONS = 2
"""Least portions for each thread, if there are worlds enough: with one each, no thread's Python runs during another's kernel."""


def advance_many(
    engines: Sequence[AvatarsimEngine], samples: Sequence[TrackerSample | None], dt: float, threads: int | None = None,
    moving: Sequence[Mapping[str, Pose]] | None = None,
) -> tuple[FrameRecord, ...]:
    """Advance many engines by one rendered frame, each with its own sample: bit for bit as `engine.advance(sample, dt)`.

    engines  engines that have loaded scenes, equal or not, each of them once
    samples  as many samples, in the same order; None where tracking is lost
    dt       [s] time of the frame, above 0 and at most 1
    threads  number that run at once, 1 to 1024; by default one per processor that this process may use. Where frames are so
             short that their records take longer, further threads win little. Frames of method `paper`, recorded ones and those
             whose stages are timed are passed one after the other
    moving   poses of moving bodies of each engine, as `engine.advance` takes them

    Returns the records, in the order of the engines; the first call of a process reads its kernel from disk. Raises InvalidInput
    for arguments that do not fit together, before any world has advanced. A world that fails (a sample that does not fit, an
    engine that is in use or has no scene) does not keep the others: all that can advance do, then WorldsFailed names those that
    did not, with their errors, and holds the records of the others.
    """
    engines = _listed("engines for many worlds", engines, "a sequence of AvatarsimEngine")
    samples = _listed("samples for many worlds", samples, "a sequence of TrackerSample")
    given = None if moving is None else _listed("poses of moving bodies for many worlds", moving, "a sequence of mappings")
    _require(engines, samples, threads, given)
    frame_time(dt)
    count = len(engines)
    many = min(_processors() if threads is None else int(threads), max(count, 1))
    size = max(1, min(PORTION, count // (PORTIONS * many)))
    call = _Call(engines, samples, float(dt), given)
    # every thread takes the next portion, so that none waits while there is one
    portions = iter([range(first, min(first + size, count)) for first in range(0, count, size)])
    if many == 1:
        call.work(portions)
    else:
        others = [_pool(os.getpid()).submit(call.work, portions) for _ in range(many - 1)]
        try:
            call.work(portions)
        finally:
            # a thread that has not begun by now would find nothing to do
            begun = [other for other in others if not other.cancel()]
            wait(begun)
        for other in begun:
            other.result()
    if call.errors:
        raise WorldsFailed(call.errors, call.records)
    return tuple(record for record in call.records if record is not None)


@cache
def _pool(process: int) -> ThreadPoolExecutor:
    """Return the waiting threads of this process: to start one takes as long as some frames. A fork gets its own."""
    return ThreadPoolExecutor(MOST_THREADS, f"avatarsim-{process}")


def _processors() -> int:
    """Return processors that this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def _listed(thing: str, given: Sequence[T], valid: str) -> tuple[T, ...]:
    """Return the items of a sequence as a list of its own: the caller may change a list while other threads are at work."""
    try:
        if isinstance(given, Sequence | np.ndarray):
            return tuple(given)
    except (TypeError, ValueError):
        # an array without an axis, memory that was released
        pass
    raise InvalidInput(thing, given, valid)


def _require(
    engines: Sequence[AvatarsimEngine], samples: Sequence[TrackerSample | None], threads: int | None,
    moving: Sequence[object] | None,
) -> None:
    """Raise InvalidInput where the arguments do not fit together."""
    for thing, given in (("samples", samples), ("mappings of moving bodies", moving)):
        if given is not None and len(given) != len(engines):
            raise InvalidInput(f"number of {thing} for many worlds", len(given), f"{len(engines)}, as many as engines")
    places: dict[int, int] = {}
    for place, engine in enumerate(engines):
        if not isinstance(engine, AvatarsimEngine):
            raise InvalidInput(f"engine {place} of many worlds", engine, "an AvatarsimEngine")
        if (first := places.setdefault(id(engine), place)) != place:
            raise InvalidInput(f"engine {place} of many worlds", f"the same as engine {first}", "each engine once")
    if threads is not None and not (1 <= as_number(threads) <= MOST_THREADS and as_number(threads) == int(threads)):
        raise InvalidInput("number of threads", threads, f"a whole number from 1 to {MOST_THREADS}, or None: one per processor")


class _Call:
    """One call of `advance_many`: its input, and its results, by the places of the worlds.

    It does in portions the work of `AvatarsimEngine.advance` for one world, and so uses parts of that which are not public.
    """

    def __init__(
        self, engines: Sequence[AvatarsimEngine], samples: Sequence[TrackerSample | None], dt: float,
        moving: Sequence[Mapping[str, Pose]] | None,
    ) -> None:
        self.engines, self.samples, self.dt, self.moving = engines, samples, dt, moving
        self.records: list[FrameRecord | None] = [None] * len(engines)
        self.errors: dict[int, AvatarsimError] = {}

    def work(self, portions: Iterator[range]) -> None:
        """Advance the worlds of one portion after another, until there are no more."""
        for portion in portions:
            self.advance(portion)

    def advance(self, portion: range) -> None:
        """Advance the worlds of a portion."""
        acquired: list[AvatarsimEngine] = []
        try:
            begun: list[tuple[int, AvatarsimEngine, Frames]] = []
            jobs = np.empty((len(portion), COLUMNS), dtype=np.int64)
            for place in portion:
                engine = self.engines[place]
                if not engine._turn.acquire(False):
                    self.errors[place] = EngineInUse()
                    continue
                acquired.append(engine)
                try:
                    frames, sample = engine._running(), self.samples[place]
                    if frames.moves or self.moving or sample is None or frames.is_lost:
                        sample = frames.completed(sample, (self.moving[place] if self.moving else None) or {})
                    if frames.in_one_call:
                        jobs[len(begun)] = frames.begin(sample)
                        begun.append((place, engine, frames))
                    else:
                        self.records[place] = engine._advance(sample, self.dt)
                except AvatarsimError as error:
                    self.errors[place] = error
            if begun:
                self._pass(begun, jobs[: len(begun)])
        finally:
            for engine in acquired:
                engine._turn.release()

    def _pass(self, begun: list[tuple[int, AvatarsimEngine, Frames]], jobs: Index) -> None:
        """Pass the frames of worlds that have begun them, and make their records."""
        pass_frames(jobs, self.dt)
        for (place, engine, frames), outcome in zip(begun, jobs[:, STATUS:].tolist(), strict=True):
            try:
                frames.end(self.dt, outcome)
                self.records[place] = engine._record(frames.counts(), frames.statuses(), ())
            except AvatarsimError as error:
                self.errors[place] = error
