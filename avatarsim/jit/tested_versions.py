"""Version guard for numba and llvmlite, whose private parts the kernels' compiler builds on and which change without notice."""

import importlib
import warnings
from collections.abc import Iterator
from contextlib import contextmanager

import llvmlite
import numba

from avatarsim.errors import UnsupportedVersion
from avatarsim.jit.packages import TESTED

PRIVATE = {
    "numba.core": ("cgutils", "compiler", "sigutils"),
    "numba.core.codegen": ("JITCodeLibrary", "get_host_cpu_features"),
    "numba.core.compiler": ("CompileResult", "compile_result"),
    "numba.core.compiler_lock": ("global_compiler_lock",),
    "numba.core.registry": ("CPUDispatcher",),
    "numba.core.serialize": ("dumps",),
    "numba.core.typing.templates": ("AttributeTemplate",),
}
"""Private parts of numba that the package uses."""


def installed() -> dict[str, str]:
    """Return the version of each package that is guarded."""
    return {"numba": numba.__version__, "llvmlite": llvmlite.__version__}


def untested() -> list[str]:
    """Return packages of another minor version than the tested one, with both; empty if there are none."""
    return [
        f"{package} {version} (tested: {'.'.join(map(str, TESTED[package]))})"
        for package, version in installed().items()
        if version.split(".")[:2] != [str(number) for number in TESTED[package]]
    ]


def remedy() -> str:
    """Return the command that installs the tested versions."""
    return "pip install " + " ".join(f"'{package}=={'.'.join(map(str, minor))}.*'" for package, minor in TESTED.items())


def missing() -> list[str]:
    """Return private parts that the installed numba does not have."""
    found = []
    for module, names in PRIVATE.items():
        try:
            parts = importlib.import_module(module)
        except ImportError:
            found.append(module)
        else:
            found += [f"{module}.{name}" for name in names if not hasattr(parts, name)]
    return found


@contextmanager
def guarded() -> Iterator[None]:
    """Guard a block that imports private parts: warn of an untested version; if it lacks any of them, or the block fails, raise
    UnsupportedVersion with the remedy."""
    if not (found := untested()):
        yield
        return
    if lacking := missing():
        raise _unsupported(found, f"no {', '.join(lacking)}")
    warnings.warn(f"avatarsim is not tested with {', '.join(found)}; if it fails: {remedy()}", RuntimeWarning, stacklevel=3)
    try:
        yield
    except (ImportError, AttributeError) as error:
        raise _unsupported(found, str(error)) from error


def _unsupported(found: list[str], why: str) -> UnsupportedVersion:
    return UnsupportedVersion(f"avatarsim cannot run with {', '.join(found)} ({why}): {remedy()}")
