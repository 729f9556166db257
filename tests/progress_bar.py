"""Progress of a long test, on the error stream."""

import sys
from collections.abc import Iterable, Iterator
from typing import TypeVar

from tqdm import tqdm

Step = TypeVar("Step")

SELDOM = 30.0
"""Seconds between two states of the bar in a file, where none replaces the one before it: often, and the log is a bar."""
OFTEN = 0.1
"""The same on a terminal [s]: seldom, and it looks stuck."""


def bar(total: int, unit: str) -> "tqdm[None]":
    """Return a bar of so many steps, smoothed as they differ in length."""
    pause = OFTEN if sys.stderr.isatty() else SELDOM
    return tqdm(total=total, unit=unit, unit_scale=True, smoothing=0.05, mininterval=pause, maxinterval=pause)


def told(steps: Iterable[Step], total: int, unit: str) -> Iterator[Step]:
    """Yield the steps, of which each moves a bar."""
    with bar(total, unit) as shown:
        for step in steps:
            yield step
            shown.update()
