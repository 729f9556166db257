"""Progress and remaining time of a compilation, from the cache folder alone.

Every compiled kernel is a file on disk, and the kernels of the package are known from importing it. Files of an earlier
compilation count as done.
"""

import sys
import time
from collections.abc import Callable

from avatarsim.jit import places
from avatarsim.jit.cache import SUFFIX
from avatarsim.jit.kernel import ROOT
from avatarsim.jit.linking import KernelDispatcher


def kernels() -> list[KernelDispatcher]:
    """Every kernel that a module of the package holds; nearly all are compiled for one signature, so there are as many files."""
    modules = [module for name, module in sys.modules.items() if name.startswith(f"{ROOT.name}.")]
    held = [one for module in modules for one in vars(module).values() if isinstance(one, KernelDispatcher)]
    return list({id(one): one for one in held}.values())


class Compiled:
    """The kernels of the package, and how many of them are compiled by now."""

    def __init__(self, clock: Callable[[], float] = time.monotonic) -> None:
        found = kernels()
        self.clock = clock
        self.total, self.folders = len(found), {one.folder for one in found}
        self.kept, self.begun = self.done(), clock()

    def done(self) -> int:
        """Kernels on disk, at most as many as there are."""
        bases = set(places.current().read) | {place for place in [places.current().write] if place is not None}
        kept = {(folder, path.name) for base in bases for folder in self.folders for path in (base / folder).glob(f"*{SUFFIX}")}
        return min(len(kept), self.total)

    def left(self, done: int) -> float:
        """[s] until all are done if it goes on as it went; infinite at first."""
        new = done - self.kept
        return (self.total - done) * (self.clock() - self.begun) / new if new else float("inf")

    def told(self, done: int) -> str:
        """So many of so many, and the time that is left; not before a tenth is done, for the first ones say little."""
        told = f"{done} of {self.total} kernels"
        tells = done - self.kept >= self.total // 10 and done < self.total
        return f"{told}, about {self.left(done):.0f} s left" if tells else told
