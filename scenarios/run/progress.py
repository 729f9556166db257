"""Progress of a pass on the error stream: a bar on a terminal, elsewhere a line at the end and one every few minutes."""

import time
from types import TracebackType
from typing import Any, Self, TextIO

QUIET = 300.0
"""Longest time [s] without a line where there is no terminal: logs of CI stay short, and hosts do not take a run for dead."""


class Progress:
    """Counts steps of one pass."""

    def __init__(self, name: str, total: int, stream: TextIO) -> None:
        self.name, self.total, self.stream = name, total, stream
        self.done, self.begun = 0, time.monotonic()
        self.told = self.begun
        self.bar: Any = None

    def __enter__(self) -> Self:
        if self.stream.isatty():
            try:
                from tqdm import tqdm
            except ImportError:
                return self
            self.bar = tqdm(total=self.total, desc=self.name, file=self.stream, unit="run", dynamic_ncols=True)
        return self

    def step(self, what: str) -> None:
        """One more done: `what`."""
        self.done += 1
        if self.bar is not None:
            self.bar.set_postfix_str(what)
            self.bar.update()
        elif time.monotonic() - self.told > QUIET:
            self._tell()

    def _tell(self) -> None:
        self.told = time.monotonic()
        print(f"{self.name:<12} {self.done}/{self.total}  {span(self.told - self.begun)}", file=self.stream, flush=True)

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None) -> None:
        if self.bar is not None:
            self.bar.close()
        else:
            self._tell()


class Estimate:
    """Counts steps of one pass and says, on a line each, what was done and when the end may be expected."""

    def __init__(self, name: str, total: int, stream: TextIO) -> None:
        self.name, self.total, self.stream = name, total, stream
        self.done, self.begun = 0, time.monotonic()

    def step(self, what: str) -> None:
        """One more done: `what`."""
        self.done += 1
        spent = time.monotonic() - self.begun
        rest = span(spent / self.done * (self.total - self.done))
        print(f"{self.name} {self.done}/{self.total} {span(spent)}, {rest} left  {what}", file=self.stream, flush=True)


def span(seconds: float) -> str:
    """Seconds as minutes and seconds."""
    whole = round(seconds)
    return f"{whole // 60}:{whole % 60:02d}"
