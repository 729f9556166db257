"""Progress of compiling on demand: one line at once when the first kernel is compiled, and a bar on a terminal."""

import sys
from collections.abc import Iterator
from contextlib import contextmanager, suppress

from avatarsim.console import Progress, say_once

ANNOUNCED = (
    "compiling the engine's kernels, once for this version and machine: one to two minutes; `python -m avatarsim compile` does it"
    " ahead, and faster"
)
"""What is said at the first kernel that a program has to wait for."""


class FirstCompile:
    """Says on standard error that kernels are being compiled although a program waits for them.

    Compiles are nested, since a kernel is compiled when the first one that calls it is.
    """

    def __init__(self) -> None:
        self.silent = False
        self.declared = self.compiled = self._depth = 0
        self._progress: Progress | None = None

    def begin(self, module: str) -> None:
        """A kernel of a module is about to be compiled; those outside this package are few, and not announced."""
        if self.silent or not module.startswith("avatarsim."):
            return
        say_once("first compile", ANNOUNCED)
        self.compiled += 1
        # The stream may be closed, or its terminal gone; that must not stop a compile.
        with suppress(OSError, ValueError):
            if self._progress is None and sys.stderr is not None and sys.stderr.isatty():
                self._progress = Progress("compiling", sys.stderr)
            if self._progress is not None:
                # Which of the kernels a scene calls is known only at its end: most scenes call fewer than all.
                share = min(self.compiled / max(self.declared, 1), 1.0)
                self._progress.step(share, f"kernel {self.compiled} of at most {max(self.declared, self.compiled)}")

    @contextmanager
    def nested(self) -> Iterator[None]:
        """A block in which a kernel is looked for and perhaps compiled; at the end of the outermost one the bar goes."""
        self._depth += 1
        try:
            yield
        finally:
            self._depth -= 1
            if self._depth == 0 and self._progress is not None:
                with suppress(OSError, ValueError):
                    self._progress.erase()


FIRST_COMPILE = FirstCompile()
"""That of this process; silent where progress is shown by other means."""
