"""Progress of work that takes longer than a second, on the error stream: a bar on a terminal, a line now and then elsewhere."""

import time
from types import TracebackType
from typing import Self, TextIO

QUIET_FOR = 1.0
"""Seconds of work before anything is said."""
LINE_EVERY = 5.0
"""Seconds between lines where there is no terminal."""
BAR_EVERY = 0.1
"""Seconds between two drawings of the bar."""
WIDTH = 30
"""Characters of the bar."""


class Progress:
    """Says on `stream` how far `name` has come; None says nothing."""

    def __init__(self, name: str, stream: TextIO | None) -> None:
        self.name, self.stream = name, stream
        self.begun = time.monotonic()
        self.terminal = stream is not None and stream.isatty()
        self.next = self.begun + QUIET_FOR
        self.drawn = 0

    def __enter__(self) -> Self:
        return self

    @property
    def due(self) -> bool:
        """Whether `step` would write anything now: for callers for which computing the progress takes long."""
        return self.stream is not None and time.monotonic() >= self.next

    def step(self, share: float, what: str) -> None:
        """`share` from 0 to 1 is done, and `what` is being done."""
        now = time.monotonic()
        if self.stream is None or now < self.next:
            return
        self.next = now + (BAR_EVERY if self.terminal else LINE_EVERY)
        text = f"{self.name} {100.0 * share:3.0f} % {now - self.begun:5.1f} s  {what}"
        if self.terminal:
            full = round(WIDTH * share)
            text = f"[{'#' * full}{'.' * (WIDTH - full)}] {text}"
            self.stream.write("\r" + text.ljust(self.drawn))
            self.drawn = len(text)
        else:
            self.stream.write(text + "\n")
        self.stream.flush()

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None) -> None:
        self.erase()

    def erase(self) -> None:
        """Take the bar off the terminal until the next step."""
        if self.drawn and self.stream is not None:
            self.stream.write("\r" + " " * self.drawn + "\r")
            self.stream.flush()
            self.drawn = 0
