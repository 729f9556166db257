"""Version guard for numba and llvmlite, whose private parts the kernels' compiler builds on and which change without notice."""

import warnings
from collections.abc import Iterator
from contextlib import contextmanager

import llvmlite
import numba

from avatarsim.errors import UnsupportedVersion

TESTED = {"numba": (0, 68), "llvmlite": (0, 50)}
"""Minor versions that the test suite runs with; pyproject.toml lets no later ones be installed."""


def installed() -> dict[str, str]:
    """Version of each package that is guarded."""
    return {"numba": numba.__version__, "llvmlite": llvmlite.__version__}


def untested() -> list[str]:
    """Packages of another minor version than the tested one, with both; empty if there are none."""
    return [
        f"{package} {version} (tested: {'.'.join(map(str, TESTED[package]))})"
        for package, version in installed().items()
        if version.split(".")[:2] != [str(number) for number in TESTED[package]]
    ]


def remedy() -> str:
    """What installs the tested versions."""
    return "pip install " + " ".join(f"'{package}=={'.'.join(map(str, minor))}.*'" for package, minor in TESTED.items())


def warn_if_untested() -> None:
    """Warn that the kernels were never tested with what is installed."""
    if found := untested():
        warnings.warn(f"avatarsim is not tested with {', '.join(found)}; if it fails: {remedy()}", RuntimeWarning, stacklevel=2)


@contextmanager
def explained() -> Iterator[None]:
    """Turn the failure to find a private part of an untested version into an UnsupportedVersion with the remedy."""
    try:
        yield
    except (ImportError, AttributeError) as error:
        found = untested()
        if not found:
            raise
        raise UnsupportedVersion(f"avatarsim cannot run with {', '.join(found)} ({error}): {remedy()}") from error
