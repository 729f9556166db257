"""Hash of the sources that a kernel is compiled from: the name of the folder in which its compiled code is kept.

Why not numba's own cache: numba stamps a compiled function with the content of *its own* file only. Edit a callee in another file
and the callers still run the old code. Here the folder of a file's kernels is named by a hash of that file, of everything in this
package and its own that it imports, directly or not, and of the versions and flags that shape the machine code. So an edit
recompiles exactly the code that could have changed. For that to hold a kernel imports, at the top of its file or under
TYPE_CHECKING, every module whose kernels, constants or named tuples it uses. How entries are kept is the matter of
`jit/cache.py`, where of `jit/places.py`.
"""

import functools
import hashlib
import re
import sys
from pathlib import Path

import numba
import numpy as np

from avatarsim.jit.tested_versions import installed

ROOT = Path(__file__).resolve().parents[1]
"""The package's own folder."""

FLAGS = (
    "DISABLE_JIT", "BOUNDSCHECK", "DEBUGINFO_DEFAULT", "DEBUG_JIT", "DEBUG_NRT", "EXTEND_VARIABLE_LIFETIMES",
    "LLVM_REFPRUNE_FLAGS", "LLVM_REFPRUNE_PASS", "LOOP_VECTORIZE", "OPT", "SLP_VECTORIZE", "USING_SVML",
)
"""numba settings that change the machine code; the processor is in the name of each entry instead."""

SHAPING = ("jit/kernel.py", "jit/source_hash.py", "jit/linking.py", "jit/compiler_passes.py")
"""Files that shape the machine code of every kernel."""

_IMPORT = re.compile(r"^\s*(?:from|import)\s+(\w+(?:\.\w+)*)\b", re.MULTILINE)
_RELATIVE_IMPORT = re.compile(r"^\s*from\s+\.", re.MULTILINE)


@functools.cache
def kernel_folder(source: str) -> Path:
    """Return the folder for the compiled kernels of one source file, within any place where kernels are kept."""
    path = Path(source).resolve().with_suffix("")
    parts = (ROOT.name, *path.relative_to(ROOT).parts) if path.is_relative_to(ROOT) else path.parts[-3:]
    return Path(".".join(parts)) / source_hash(source)


@functools.cache
def source_hash(source: str) -> str:
    """Return the hash of one file, of all it imports from this package and its own (directly or not), and of `compiled_by`."""
    digest = hashlib.sha256("\n".join(compiled_by()).encode())
    for name, path in sorted((_place(path), path) for path in _closure(Path(source).resolve())):
        digest.update(f"\n{name}\n".encode() + _content(path))
    return digest.hexdigest()[:20]


def compiled_by() -> list[str]:
    """Return versions and settings that machine code, or the Python objects that are kept with it, depend on."""
    # Any build of a Python of this minor version runs the same code, and any patch of numpy has its types in the same modules.
    python, numpy = [sys.implementation.cache_tag or "", getattr(sys, "abiflags", "")], np.__version__.split(".")[:2]
    return [*python, *numpy, *installed().values(), *(f"{flag}={getattr(numba.config, flag)}" for flag in FLAGS)]


def _place(path: Path) -> str:
    """Return the path of a file within the package, wherever that is; of a file elsewhere its name."""
    return path.relative_to(ROOT).as_posix() if path.is_relative_to(ROOT) else path.name


def _closure(source: Path) -> set[Path]:
    """Return ``source`` and every file of this package and of its own that it can reach through imports."""
    found, waiting = {ROOT / name for name in SHAPING}, [source]
    while waiting:
        path = waiting.pop()
        if path not in found:
            found.add(path)
            waiting += _imported(path)
    return found


@functools.cache
def _content(source: Path) -> bytes:
    """Return the digest of a file's bytes; read once, although dozens of others import it."""
    return hashlib.sha256(source.read_bytes()).digest()


@functools.cache
def _imported(source: Path) -> tuple[Path, ...]:
    """Return files of this package, and of the neighbouring one of ``source``, in its import lines; a folder means all files."""
    text = source.read_text(encoding="utf-8")
    # kernels of the harness are next to the package
    own = source.relative_to(ROOT.parent).parts[0] if source.is_relative_to(ROOT.parent) else ROOT.name
    names = {name for name in _IMPORT.findall(text) if name.partition(".")[0] in (ROOT.name, own)}
    names |= {ROOT.name} if _RELATIVE_IMPORT.search(text) else set()
    return tuple(path for name in names for path in _files_of(name))


@functools.cache
def _files_of(module: str) -> list[Path]:
    path = ROOT.parent.joinpath(*module.split("."))
    if path.is_dir():
        return sorted(path.rglob("*.py"))
    # A name in a docstring may look like an import and lead nowhere.
    return [path.with_suffix(".py")] if path.with_suffix(".py").is_file() else []
