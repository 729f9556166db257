"""Progress of a pass or a study: a bar on a terminal, elsewhere a line at the end and one every few minutes."""

import time
from types import TracebackType
from typing import Self, TextIO

from tqdm import tqdm

INTERVAL = 300.0
"""Longest time [s] without a line where there is no terminal: logs of CI stay short, and hosts do not take a run for dead."""


class Progress:
    """Count the steps of one pass; use as a context.

    A `part` of a longer task has no line at its end where there is no terminal.
    """

    def __init__(self, name: str, total: int, stream: TextIO, part: bool = False) -> None:
        self.name, self.total, self.stream, self.part = name, total, stream, part
        self.done, self.begun = 0, time.monotonic()
        self.printed, self.quiet = self.begun, not stream.isatty()
        self.bar = tqdm(total=total, desc=name, file=stream, unit="run", dynamic_ncols=True, disable=self.quiet)

    def __enter__(self) -> Self:
        return self

    def step(self, label: str) -> None:
        """Count one more, of that label."""
        self.done += 1
        self.bar.set_postfix_str(label)
        self.bar.update()
        if self.quiet and time.monotonic() - self.printed > INTERVAL:
            self._print()

    def _print(self) -> None:
        self.printed = time.monotonic()
        print_done(self.name, f"{self.done}/{self.total}", self.printed - self.begun, self.stream)

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None) -> None:
        self.bar.close()
        if self.quiet and not self.part:
            self._print()


def print_done(name: str, count: str, seconds: float, stream: TextIO) -> None:
    """Print the line of a pass or study: its name, how much of it is done, and the time since it began."""
    print(f"{name:<12} {count:<10} {round(seconds) // 60}:{round(seconds) % 60:02d}", file=stream, flush=True)
