"""Engines by name: four that the project knows, and whatever joined through the entry-point group."""

import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager, nullcontext
from functools import cache
from importlib import import_module, metadata
from multiprocessing import parent_process

from avatarsim.engine import Engine
from avatarsim.errors import InvalidInput, MissingPackage, UnknownName
from runfiles.naming import BASELINE

GROUP = "avatarsim.engines"
"""Entry-point group through which other engines join: a class that is constructed without arguments."""
BUILT_IN = {
    "avatarsim": "avatarsim.simulator:AvatarsimEngine",
    "mujoco": "reference.in_mujoco.engine:MujocoEngine",
    "pybullet": "reference.in_pybullet.engine:PybulletEngine",
    "tracker": "reference.raw_tracker:RawTracker",
}
TIDY = ("avatarsim", "mujoco", "pybullet", BASELINE)
"""Engines that leave nothing behind in their process: one serves for many runs. The timing pass compares the state hashes of runs
that others went before with those of runs that had other ones before them. PyBullet's contactBreakingThreshold, which belongs to
the process and not to a world, and its time step, which outlives a reset, are set at each load."""
STEPPED = ("mujoco", "pybullet")
"""Engines with a step of their own, by an option "dt". Ours has none but the frame, which is cut instead."""
PRESETS = {"mujoco": ("default", "tuned"), "pybullet": ("default", "tuned")}
"""Presets of engines whose package may be missing, so that every row that is missing then can be named."""
EXTRA = "compare"
"""The extra that brings the packages of the engines we compare with."""


def known() -> dict[str, str]:
    """Every engine that can be asked for: name -> "module:class", ours first, then in order of name.

    An entry point may not take the name of an engine that is built in."""
    joined = _joined(tuple(sys.path))
    return {**BUILT_IN, **{name: joined[name] for name in sorted(joined) if name not in BUILT_IN}}


@cache
def _joined(path: tuple[str, ...]) -> dict[str, str]:
    """The entry points of every package on a path: looked for once, since every package there is asked."""
    return {entry.name: entry.value for entry in metadata.entry_points(group=GROUP)}


@contextmanager
def hushed() -> Iterator[None]:
    """Drop what is written to both streams, by C too: one engine greets on the error stream, amid the progress."""
    kept = [os.dup(1), os.dup(2)]
    nowhere = os.open(os.devnull, os.O_WRONLY)
    try:
        os.dup2(nowhere, 1)
        os.dup2(nowhere, 2)
        yield
    finally:
        for stream, copy in enumerate(kept, 1):
            os.dup2(copy, stream)
            os.close(copy)
        os.close(nowhere)


def opened(name: str) -> Engine:
    """A fresh engine. Raises UnknownName, MissingPackage when it needs a package that is not installed, and ImportError when a
    module of its own is missing."""
    # entry points of all installed packages are read only for an engine that is not built in, since that takes a while
    paths = BUILT_IN if name in BUILT_IN else known()
    if name not in paths:
        raise UnknownName("engine", name, paths)
    module, _, attribute = paths[name].partition(":")
    try:
        # only in processes of the harness, and never what an engine that joined complains of
        with hushed() if name in BUILT_IN and parent_process() is not None else nullcontext():
            made = getattr(import_module(module), attribute)()
    except ImportError as error:
        if (error.name or module).partition(".")[0] == module.partition(".")[0]:
            # a hole in the engine itself is a fault, which no installing mends
            raise
        raise MissingPackage(error.name or module, EXTRA, f"engine {name}") from error
    if not isinstance(made, Engine):
        valid = "a class with every part of avatarsim.engine.Engine"
        raise InvalidInput(f"engine {name} ({paths[name]})", type(made).__name__, valid)
    return made
