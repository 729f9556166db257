"""Progress of a pass on the error stream: a bar on a terminal, elsewhere a line at the end and one every few minutes."""

import time
from types import TracebackType
from typing import Self, TextIO

from tqdm import tqdm

INTERVAL = 300.0
"""Longest time [s] without a line where there is no terminal: logs of CI stay short, and hosts do not take a run for dead."""


class Progress:
    """Count the steps of one pass; use as a context."""

    def __init__(self, name: str, total: int, stream: TextIO) -> None:
        self.name, self.total, self.stream = name, total, stream
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
        minutes, seconds = divmod(round(self.printed - self.begun), 60)
        print(f"{self.name:<12} {self.done}/{self.total}  {minutes}:{seconds:02d}", file=self.stream, flush=True)

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None) -> None:
        self.bar.close()
        if self.quiet:
            self._print()
