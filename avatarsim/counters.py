"""Instruments of a frame: time and calls per stage, and counters by name.

Off, the clock costs one count per stage; counters are unpacked only when they are read.
"""

from collections.abc import ItemsView, Iterator, Mapping, Sequence
from enum import IntEnum
from time import perf_counter_ns
from types import TracebackType
from typing import ClassVar

import numpy as np


class Stage(IntEnum):
    """Stages of a frame, in order (Schmidl and Lin 2004, Figure 3)."""

    POSTURE = 0
    """Lower loop: driven bodies go towards the tracker and stop where they touch."""
    MOTION = 1
    """Upper loop: simulated bodies move, and hit."""
    COUPLING = 2
    """Effect of the upper loop on avatars: impulses, poses of avatars under load, and a second solve of the posture for links
    that bodies blocked."""


class StageClock:
    """Counts the calls of one stage since it was made, and its nanoseconds since the frame began when `timing`."""

    ASSIGNED: ClassVar[tuple[str, ...]] = ("calls", "ns", "_start")
    WRITTEN: ClassVar[tuple[str, ...]] = ()

    def __init__(self, timing: bool) -> None:
        self.timing, self.calls, self.ns, self._start = timing, 0, 0, 0

    def retained_state(self) -> tuple[()]:
        """Return nothing: a clock is no part of the world."""
        return ()

    def __enter__(self) -> None:
        self.calls += 1
        if self.timing:
            self._start = perf_counter_ns()

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None) -> None:
        if self.timing:
            self.ns += perf_counter_ns() - self._start


class FrameClock:
    """One `StageClock` per stage."""

    def __init__(self, timing: bool) -> None:
        self.timing = timing
        self.stages = tuple(StageClock(timing) for _ in Stage)

    def begin(self) -> None:
        """Begin a frame: forget the last one's times."""
        if self.timing:
            for stage in self.stages:
                stage.ns = 0

    @property
    def calls(self) -> dict[str, int]:
        """Return calls per stage since the clock was made."""
        return {stage.name.lower(): self.stages[stage].calls for stage in Stage}

    @property
    def ns(self) -> dict[str, int]:
        """Return nanoseconds per stage of this frame, zero for those that were not called; empty unless timing."""
        return {stage.name.lower(): self.stages[stage].ns for stage in Stage} if self.timing else {}


WORD = np.dtype(np.int64).itemsize
"""Bytes of one number."""


class Tally(Mapping[str, int]):
    """`numbers` in the order of `names`: as integers, or as the bytes of an array of int64.

    They are kept as bytes and read on access: to fill a dictionary of them takes longer than to certify a pair, in every frame,
    and a list is one more object for Python's cyclic collector."""

    __slots__ = ("_names", "_numbers")

    def __init__(self, names: tuple[str, ...] = (), numbers: Sequence[int] | bytes = b"") -> None:
        self._names = names
        self._numbers = numbers if isinstance(numbers, bytes) else np.array(numbers, dtype=np.int64).tobytes()

    def __getitem__(self, name: str) -> int:
        if name not in self._names:
            raise KeyError(name)
        return self._all()[self._names.index(name)]

    def __iter__(self) -> Iterator[str]:
        return iter(self._names)

    def __len__(self) -> int:
        return len(self._names)

    def __repr__(self) -> str:
        return repr(dict(self.items()))

    def _all(self) -> memoryview:
        return memoryview(self._numbers).cast("q")

    def items(self) -> ItemsView[str, int]:
        """Return names and numbers, in their order."""
        return dict(zip(self._names, self._all(), strict=True)).items()

    def joined_with(self, other: "Tally", names: tuple[str, ...]) -> "Tally":
        """Return both; `names` are those of this one, then of the other: a caller in every frame has put them together once."""
        return Tally(names, self._numbers + other._numbers)
