"""The one JIT decorator of the engine, and where its compiled code is kept.

Why these options:

- ``cache=True``: compiling the whole frame takes tens of seconds, loading it a few tens of milliseconds.
- ``error_model="numpy"``: a division by zero gives inf or nan, which the kernels test for; Python's model
  adds a branch and an exception path to every division.
- ``fastmath=False``: fast maths may assume that nan does not exist, and then no test for nan holds.
- ``_nrt=False``: with reference counting on, numba counts every array of every tuple handed from kernel to
  kernel, which doubles the time of the narrow phase. The price: **a kernel allocates nothing**; scratch
  memory is made once, outside.

Why not numba's own cache folder: numba stamps a compiled function with the content of *its own* file only.
Edit a callee in another file and the callers go on running the old code. Here the folder of a file's kernels
is named by a hash of that file, of everything in this package that it imports, directly or not, and of the
versions and flags that shape the machine code. So an edit recompiles exactly what could have changed. For
that to hold a kernel imports, at the top of its file or under TYPE_CHECKING, every module whose kernels,
constants or named tuples it uses.
"""

import functools
import hashlib
import os
import re
import shutil
import sys
import tempfile
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any, TypeVar, cast

import llvmlite
import numba

from avatarsim.linking import KernelDispatcher

# numba makes its settings at run time; its annotations know neither them nor the option `_nrt`.
config: Any = numba.config
njit: Any = numba.njit

Function = TypeVar("Function", bound=Callable[..., object])

OPTIONS = {"error_model": "numpy", "fastmath": False, "_nrt": False, "boundscheck": None, "no_cfunc_wrapper": True}
"""numba's options, as explained above; the wrapper for calls from C, which nobody makes, is left out."""

ROOT = Path(__file__).resolve().parent
"""The package's own folder."""

VERSIONS_KEPT = 3
"""Compiled versions kept per source file. Fewer: going back and forth between two edits compiles each time;
more: disk."""

FLAGS = ("DISABLE_JIT", "BOUNDSCHECK", "DEBUGINFO_DEFAULT", "OPT", "CPU_NAME", "CPU_FEATURES")
"""numba settings that change the machine code but are not in numba's own key."""

_IMPORT = re.compile(rf"^\s*(?:from|import)\s+({ROOT.name}(?:\.\w+)*)\b", re.MULTILINE)
_RELATIVE_IMPORT = re.compile(r"^\s*from\s+\.", re.MULTILINE)


def kernel(function: Function) -> Function:
    """Compile ``function`` at its first call, or load it from the cache; no effect under NUMBA_DISABLE_JIT=1.

    The result is typed as the function itself, so kernels are checked like any Python function.
    """
    folder = None if config.DISABLE_JIT else cache_folder(function.__code__.co_filename)
    if folder is None:
        return cast(Function, njit(**OPTIONS)(function))
    return cast(Function, KernelDispatcher(function, {"nopython": True, **OPTIONS}, folder))


@functools.cache
def cache_folder(source: str) -> Path | None:
    """Return the folder for the compiled kernels of one source file; None if none can be written to."""
    if not Path(source).is_file():  # typed at a prompt
        return None
    name, digest = ".".join(Path(source).with_suffix("").parts[-3:]), source_hash(source)
    for base in _bases():
        folder = base / name / digest
        try:
            folder.mkdir(parents=True, exist_ok=True)
            os.utime(folder)
            tempfile.TemporaryFile(dir=folder).close()
        except OSError:
            continue
        _prune(folder)
        return folder
    return None


def source_hash(source: str) -> str:
    """Hash of one file, of all it imports from this package (directly or not), and of versions and flags."""
    flags = [f"{flag}={getattr(config, flag)}" for flag in FLAGS]
    state = [sys.version, numba.__version__, llvmlite.__version__, *flags]
    digest = hashlib.sha256("\n".join(state).encode())
    for path in sorted(_closure(Path(source).resolve())):
        digest.update(f"\n{path}\n".encode() + _content(path))
    return digest.hexdigest()[:20]


def _closure(source: Path) -> set[Path]:
    """Return ``source`` and every file of this package that it can reach through imports."""
    found, waiting = {ROOT / name for name in ("kernel.py", "linking.py", "compiler_passes.py", "kernel_library.py")}, [source]
    while waiting:
        path = waiting.pop()
        if path not in found:
            found.add(path)
            waiting += _imported(path)
    return found


@functools.cache
def _content(source: Path) -> bytes:
    """Digest of a file's bytes; read once, although dozens of others import it."""
    return hashlib.sha256(source.read_bytes()).digest()


@functools.cache
def _imported(source: Path) -> tuple[Path, ...]:
    """Files of this package named in the import lines of ``source``; a folder stands for all that is in
    it."""
    text = source.read_text(encoding="utf-8")
    names = set(_IMPORT.findall(text)) | ({ROOT.name} if _RELATIVE_IMPORT.search(text) else set())
    return tuple(path for name in names for path in _files_of(name))


def _files_of(module: str) -> list[Path]:
    path = ROOT.joinpath(*module.split(".")[1:])
    if path.is_dir():
        return sorted(path.rglob("*.py"))
    # A name in a docstring may look like an import and lead nowhere.
    return [path.with_suffix(".py")] if path.with_suffix(".py").is_file() else []


def _bases() -> Iterator[Path]:
    """Places for the cache, best first. The shared temporary folder only if nobody else can have written into
    ours."""
    for variable in ("NUMBA_CACHE_DIR", "XDG_CACHE_HOME"):
        if os.environ.get(variable):
            yield Path(os.environ[variable]) / "avatarsim-kernels"
    home = Path(os.path.expanduser("~"))
    if home.is_absolute():
        yield home / ".cache" / "avatarsim-kernels"
    user = os.getuid() if hasattr(os, "getuid") else 0
    shared = Path(tempfile.gettempdir()) / f"avatarsim-kernels-{user}"
    try:
        shared.mkdir(mode=0o700, exist_ok=True)
        if not shared.is_symlink() and shared.stat().st_uid == user and not shared.stat().st_mode & 0o022:
            yield shared
    except OSError:
        pass


def _prune(newest: Path) -> None:
    """Remove all but the newest compiled versions beside ``newest``; another process may be doing the
    same."""
    try:
        versions = sorted(newest.parent.iterdir(), key=lambda version: version.stat().st_mtime, reverse=True)
    except OSError:
        return
    for version in versions[VERSIONS_KEPT:]:
        if version != newest:
            shutil.rmtree(version, ignore_errors=True)
