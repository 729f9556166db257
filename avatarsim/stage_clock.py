"""Time and calls per stage of a frame. Off, it costs one test per stage."""

from collections.abc import Iterator
from contextlib import contextmanager
from time import perf_counter_ns

STAGES = ("coupling", "posture", "separate", "motion")
"""The stages of a frame, in the order of the paper's Figure 3."""


class StageClock:
    """Counts calls of each stage since it was made, and sums nanoseconds per frame when `timing`."""

    def __init__(self, timing: bool) -> None:
        self.timing = timing
        self.calls = dict.fromkeys(STAGES, 0)
        self.ns: dict[str, int] = {}

    def frame(self) -> None:
        """Begin a frame: forget the last one's times."""
        self.ns = {}

    @contextmanager
    def stage(self, name: str) -> Iterator[None]:
        """Around one stage."""
        self.calls[name] += 1
        if not self.timing:
            yield
            return
        start = perf_counter_ns()
        try:
            yield
        finally:
            self.ns[name] = self.ns.get(name, 0) + perf_counter_ns() - start
