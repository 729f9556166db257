"""Engines by name: those that `reference/*/about.toml` describe, and those that join through the entry-point group."""

import os
from collections.abc import Iterator
from contextlib import contextmanager, nullcontext
from importlib import import_module
from multiprocessing import parent_process

from avatarsim.engine import Engine
from avatarsim.errors import InvalidInput, MissingPackage, UnknownName
from runfiles.engines import EXTRA as EXTRA
from runfiles.engines import about, engines, joined

BUILT_IN = {one.name: one.adapter for one in engines().values()}


class Flagged:
    """Engines whose facts set a flag, those that joined included: `name in Flagged("sleeps")`."""

    def __init__(self, flag: str) -> None:
        self._flag = flag

    def __contains__(self, name: str) -> bool:
        return bool(getattr(about(name), self._flag))


TIDY = Flagged("reuses_process")
"""Engines that leave nothing behind in their process. The timing pass compares the state hashes of runs that others went before
with those of runs that had other ones before them."""
STEPPED = Flagged("has_time_step")
"""Engines with a step of their own, by an option "dt"."""


def known() -> dict[str, str]:
    """Return all engines, name -> "module:class": the gated one first, those that joined last, in order of name.

    An entry point may not take the name of an engine that is built in."""
    return {**BUILT_IN, **{name: adapter for name, adapter in sorted(joined().items()) if name not in BUILT_IN}}


def known_presets(name: str) -> tuple[str, ...]:
    """Return the presets of an engine that cannot be opened: those of its facts, the default first."""
    return tuple(sorted(about(name).presets, key=lambda preset: preset != "default"))


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
        raise MissingPackage(error.name or module, about(name).extra, f"engine {name}") from error
    if not isinstance(made, Engine):
        valid = "a class with every part of avatarsim.engine.Engine"
        raise InvalidInput(f"engine {name} ({paths[name]})", type(made).__name__, valid)
    return made
