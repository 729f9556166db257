"""Progress of compiling on demand: one line at once when the first kernel is compiled, and a bar on a terminal."""

import sys
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from avatarsim.console import Progress, warn_once
from avatarsim.jit.places import missing

SECONDS = 0.1
"""[s] of one core that a kernel takes to compile, on average over the engine, on a machine of 2024."""

PACKAGE = "avatarsim."
"""First part of the names of modules and of kernel folders whose compilation is announced."""


def announcement(count: int) -> str:
    """Return the line printed before the first kernel that a program has to wait for, when `count` kernels are not compiled."""
    return (
        f"compiling up to {count} kernels of the engine, once for this version and machine: up to {seconds(count)} s;"
        " `python -m avatarsim compile` does it ahead, on two cores"
    )


def seconds(count: int, cores: int = 1) -> int:
    """Return the time [s] that compiling `count` kernels takes, at least 1."""
    return max(1, round(SECONDS * count / cores))


class FirstCompile:
    """Notice on standard error that kernels are being compiled while a program waits for them.

    Compiles are nested, since a kernel is compiled when the first one that calls it is.
    """

    def __init__(self) -> None:
        self.silent = False
        self.declared: set[tuple[Path, str]] = set()
        """Kernels of all modules that are imported: folder of the source file, name."""
        self.compiled = self._most = self._depth = 0
        self._progress: Progress | None = None

    def begin(self, module: str) -> None:
        """Announce that a kernel of a module is about to be compiled; not for the few outside this package."""
        if self.silent or not module.startswith(PACKAGE):
            return
        if self.compiled == 0:
            # Which of the kernels a scene calls is known only at its end: most scenes call fewer than all.
            self._most = max(1, missing(self.own()))
            warn_once("first compile", announcement(self._most))
        self.compiled += 1
        # The stream may be closed, or its terminal gone; that must not stop a compile.
        with suppress(OSError, ValueError):
            if self._progress is None and sys.stderr is not None and sys.stderr.isatty():
                self._progress = Progress("compiling", sys.stderr)
            if self._progress is not None:
                most = max(self._most, self.compiled)
                self._progress.step(self.compiled / most, f"kernel {self.compiled} of at most {most}")

    def own(self) -> set[tuple[Path, str]]:
        """Return the declared kernels of the engine itself."""
        return {(folder, name) for folder, name in self.declared if folder.parts[0].startswith(PACKAGE)}

    @contextmanager
    def nested(self) -> Iterator[None]:
        """Return a block in which a kernel is looked for and perhaps compiled; at the end of the outermost one the bar goes."""
        self._depth += 1
        try:
            yield
        finally:
            self._depth -= 1
            if self._depth == 0 and self._progress is not None:
                with suppress(OSError, ValueError):
                    self._progress.erase()


FIRST_COMPILE = FirstCompile()
"""The instance of this process; silent where progress is shown by other means."""
