"""Time and calls per stage of a frame. Off, it costs one count per stage."""

from collections.abc import Mapping
from time import perf_counter_ns
from types import TracebackType
from typing import ClassVar

STAGES = ("coupling", "posture", "motion")
"""The stages of a frame that are timed apart."""


class Stage:
    """Counts the calls of one stage since it was made, and its nanoseconds since the frame began when `timing`."""

    ASSIGNED: ClassVar[tuple[str, ...]] = ("calls", "ns", "_start")
    WRITTEN: ClassVar[tuple[str, ...]] = ()
    KEPT: ClassVar[tuple[str, ...]] = ()
    WORKING: ClassVar[tuple[str, ...]] = ()

    def __init__(self, timing: bool) -> None:
        self.timing, self.calls, self.ns, self._start = timing, 0, 0, 0

    def ranges(self) -> Mapping[str, tuple[int, int]]:
        """Nothing: a clock is no part of the world."""
        return {}

    def __enter__(self) -> None:
        self.calls += 1
        if self.timing:
            self._start = perf_counter_ns()

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None) -> None:
        if self.timing:
            self.ns += perf_counter_ns() - self._start


class StageClock:
    """One `Stage` per name."""

    def __init__(self, timing: bool) -> None:
        self.timing = timing
        self.stages = {name: Stage(timing) for name in STAGES}

    def frame(self) -> None:
        """Begin a frame: forget the last one's times."""
        for stage in self.stages.values():
            stage.ns = 0

    def stage(self, name: str) -> Stage:
        """The stage, to be used in a `with`."""
        return self.stages[name]

    @property
    def calls(self) -> dict[str, int]:
        """Calls per stage since the clock was made."""
        return {name: stage.calls for name, stage in self.stages.items()}

    @property
    def ns(self) -> dict[str, int]:
        """Nanoseconds per stage of this frame, zero for those that were not called; empty unless timing."""
        return {name: stage.ns for name, stage in self.stages.items()} if self.timing else {}
