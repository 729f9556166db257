"""Search path of the compiled kernels: the folders that this process reads them from, and the one in which it keeps new ones."""

import os
import re
import shutil
import time
from collections import Counter
from collections.abc import Iterable
from contextlib import suppress
from pathlib import Path

from avatarsim.console import warn_once
from avatarsim.errors import AvatarsimError
from avatarsim.files import PART, bases, is_readable, is_writable

NAME = "avatarsim-kernels"
"""Name of the folder of compiled kernels wherever it lies."""

SUFFIX = ".kernel"
"""End of the names of entries."""

VARIABLE = "NUMBA_CACHE_DIR"
"""numba's own variable for a cache folder is respected for kernels, too."""

SHIPPED = Path(__file__).resolve().parent.parent / NAME
"""Kernels that a wheel carries. They lie with the sources, so they are trusted as these are."""

MOST_DAYS = 60.0
"""[days] since the last use after which compiled kernels are removed. Less: a checkout that rests for a holiday compiles again;
more: kernels of sources that are gone stay longer. MOST_BYTES holds in any case."""

MOST_BYTES = 1_000_000_000
"""Total size [bytes] of a folder of compiled kernels above which those that were not used for longest are removed. One set of
sources, Python and flags takes 20 MB, so some 50 sets fit; with less they evict one another sooner."""

DAY = 86_400.0
"""[s] a day. The time of use is written down no more often than that: a start touches 140 folders, but seldom."""


_VERSION = re.compile(r"[0-9a-f]{20}")
"""Name of the folder of one version of a source file's kernels: its digest. Nothing else is ever removed."""


class CannotKeep(AvatarsimError):
    """Compiled kernels cannot be kept although they were compiled for that."""


class Places:
    """Folders of compiled kernels, chosen at their first use.

    `only` names the one folder to read from and to keep in, instead of the user's; with `required`, failing to keep a kernel
    raises CannotKeep instead of being reported once.
    """

    def __init__(self, only: Path | None = None, required: bool = False) -> None:
        self.only, self.required = only, required
        self._read: tuple[Path, ...] | None = None
        self._write: list[Path | None] = []
        self._used: set[Path] = set()

    @property
    def read(self) -> tuple[Path, ...]:
        """Return folders to read from, best first."""
        if self._read is None:
            found = [base for base in self._bases() if is_readable(base)]
            self._read = (*found, SHIPPED) if self.only is None else tuple(found)
        return self._read

    @property
    def write(self) -> Path | None:
        """Return the folder to keep in; None if there is none, which is reported once."""
        if not self._write:
            tried = self._bases()
            self._write.append(next((base for base in tried if is_writable(base)), None))
            if self._write[0] is None:
                self._cannot_keep(f"no folder can be written to (tried {', '.join(map(str, tried)) or 'none'})")
            else:
                self._read = None
                prune(self._write[0])
        return self._write[0]

    def keep_no_more(self, error: OSError) -> None:
        """Keep nothing from here on: the folder cannot take more."""
        place = self._write[0] if self._write else None
        self._write = [None]
        self._cannot_keep(f"{place or 'the folder'} cannot be written to: {error.strerror or error}")

    def use(self, folder: Path) -> None:
        """Note on disk that a folder of one source file's kernels is in use."""
        if folder not in self._used:
            self._used.add(folder)
            # The folder may belong to the administrator, or lie on a disk that may only be read.
            with suppress(OSError):
                if time.time() - folder.stat().st_mtime > DAY:
                    os.utime(folder)

    def _bases(self) -> list[Path]:
        return bases(NAME, VARIABLE) if self.only is None else [self.only]

    def _cannot_keep(self, why: str) -> None:
        if self.required:
            raise CannotKeep(f"compiled kernels cannot be kept: {why}")
        warn_once("keep", f"compiled kernels cannot be kept, so each start compiles them again: {why}")


def prune(base: Path) -> None:
    """Remove the kernels of source files that were not used for MOST_DAYS, then those used longest ago until the rest is at most
    MOST_BYTES; another process may be doing the same."""
    now = time.time()
    sized = sorted(_sets(base), key=lambda one: one[0], reverse=True)
    total = 0
    for used, size, folder in sized:
        total += size
        if now - used > MOST_DAYS * DAY or total > MOST_BYTES:
            shutil.rmtree(folder, ignore_errors=True)
            with suppress(OSError):
                folder.parent.rmdir()


def _sets(base: Path) -> list[tuple[float, int, Path]]:
    """Return (time of last use, size [bytes], folder) of each version of each source file's kernels; files that a killed process
    left half-written a day ago are removed."""
    found = []
    for folder in (Path(version) for source in entries(base) for version in entries(source)):
        if not _VERSION.fullmatch(folder.name):
            continue
        size = 0
        with suppress(OSError):
            used = folder.stat().st_mtime
            for file in os.scandir(folder):
                status = file.stat(follow_symlinks=False)
                size += status.st_size
                if file.name.endswith(PART) and time.time() - status.st_mtime > DAY:
                    os.unlink(file.path)
            found.append((used, size, folder))
    return found


def entries(folder: str | Path) -> list[str]:
    """Return the paths of what lies in a folder; none if there is no such folder, which another process may just have removed."""
    try:
        return [entry.path for entry in os.scandir(folder)]
    except OSError:
        return []


PLACES = Places()
"""The folders of this process."""


def use_places(places: Places) -> None:
    """Read and keep kernels elsewhere from here on."""
    global PLACES
    PLACES = places


def current() -> Places:
    """Return the folders in force."""
    return PLACES


def kept_kernels(folder: Path) -> Counter[str]:
    """Return entries of each kernel of one source file, by the kernel's name, in all folders that are read."""
    paths = [path for base in current().read for path in entries(base / folder)]
    files = {os.path.basename(path) for path in paths if path.endswith(SUFFIX)}
    return Counter(file.rpartition("-")[0] for file in files)


def missing(kernels: Iterable[tuple[Path, str]]) -> int:
    """Return how many of `kernels`, each the folder of its source file and its name, have no entry in any folder that is read."""
    wanted = set(kernels)
    kept = {folder: kept_kernels(folder) for folder, _ in wanted}
    return sum(1 for folder, name in wanted if name not in kept[folder])
