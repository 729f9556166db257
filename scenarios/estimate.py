"""How far a pass has come, and how long the rest will take if it goes on like this."""

import time
from typing import TextIO


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
