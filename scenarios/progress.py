"""How far a pass has come: a bar on a terminal, plain lines elsewhere, always on the error stream."""

import time
from types import TracebackType
from typing import Any, Self, TextIO


class Progress:
    """Counts steps of one pass. Without tqdm, or without a terminal, each step is a line."""

    def __init__(self, name: str, total: int, stream: TextIO) -> None:
        self.name, self.total, self.stream = name, total, stream
        self.done, self.begun = 0, time.monotonic()
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
            return
        seconds = time.monotonic() - self.begun
        print(f"{self.name} {self.done}/{self.total} {seconds:5.1f} s  {what}", file=self.stream, flush=True)

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None) -> None:
        if self.bar is not None:
            self.bar.close()
