"""Provenance of figures: a hash of this package's sources, and the versions of the packages that can change a figure."""

import hashlib
import multiprocessing
import platform
import sys
from collections.abc import Iterable
from functools import cache
from importlib import metadata
from pathlib import Path

from avatarsim.jit.packages import TESTED
from avatarsim.version import VERSION

PACKAGE = Path(__file__).resolve().parents[1]
"""The folder of this package."""

FIGURES = ("numpy", *TESTED, "scipy")
"""Distributions besides this one whose versions can change a figure."""

SAME = ("code", "python", "versions", "folder")
"""Properties that must be equal in processes for equal bytes."""


def digest_of(root: Path, folders: Iterable[str]) -> str:
    """Return sixteen hexadecimal digits of every source file in `folders` of `root`."""
    digest = hashlib.blake2b(digest_size=8)
    for room in folders:
        for path in sorted((root / room).rglob("*.py")):
            digest.update(str(path.relative_to(root)).encode() + b"\0" + path.read_bytes() + b"\0")
    return digest.hexdigest()


@cache
def code_hash() -> str:
    """Return `digest_of` this package at the first call: the code that runs is the code that was read then."""
    return digest_of(PACKAGE.parent, (PACKAGE.name,))


@cache
def version(package: str) -> str | None:
    """Return the version of an installed distribution, None when there is none."""
    try:
        return metadata.version(package)
    except metadata.PackageNotFoundError:
        return None


def versions(more: Iterable[str] = ()) -> dict[str, str | None]:
    """Return versions of this package, of the packages that can change its figures, and of `more`."""
    return {"avatarsim": VERSION, **{name: version(name) for name in (*FIGURES, *more)}}


def cpu() -> str:
    """Return the processor's name where the system provides it."""
    table = Path("/proc/cpuinfo")
    if sys.platform == "linux" and table.exists():
        for line in table.read_text(encoding="utf-8", errors="replace").splitlines():
            if line.startswith("model name"):
                return line.split(":", 1)[1].strip()
    return platform.processor() or platform.machine()


def about(folder: Path) -> dict[str, object]:
    """Return the environment of this process, and the folder at a path by its number in the file system's table; None: none."""
    try:
        seen: int | None = folder.stat().st_ino
    except OSError:
        seen = None
    return {
        "code": code_hash(), "python": platform.python_version(), "versions": versions(), "folder": (str(folder), seen),
        "cpu": cpu(), "daemon": multiprocessing.current_process().daemon,
    }
