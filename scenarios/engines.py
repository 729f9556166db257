"""Engines by name: four that the project knows, and whatever joined through the entry-point group."""

from importlib import import_module, metadata

from avatarsim.engine import Engine
from avatarsim.errors import InvalidInput, MissingPackage, UnknownName

GROUP = "avatarsim.engines"
"""Entry-point group through which other engines join: a class that is constructed without arguments."""
BUILT_IN = {
    "avatarsim": "avatarsim.simulator:AvatarsimEngine",
    "mujoco": "reference.in_mujoco.engine:MujocoEngine",
    "pybullet": "reference.in_pybullet.engine:PybulletEngine",
    "tracker": "reference.raw_tracker:RawTracker",
}
GATED = ("avatarsim", "default")
"""The engine and preset that carry bounds unless `check --engine` names another."""
BASELINE = "tracker"
"""The engine without contact handling: its overlap is how large the problem is."""
EXTRA = "compare"
"""The extra that brings the packages of the engines we compare with."""


def known() -> dict[str, str]:
    """Every engine that can be asked for: name -> "module:class", ours first, then in order of name.

    An entry point may not take the name of an engine that is built in."""
    joined = {entry.name: entry.value for entry in metadata.entry_points(group=GROUP)}
    return {**BUILT_IN, **{name: joined[name] for name in sorted(joined) if name not in BUILT_IN}}


def opened(name: str) -> Engine:
    """A fresh engine. Raises UnknownName, MissingPackage when it needs a package that is not installed, and ImportError when a
    module of its own is missing."""
    paths = known()
    if name not in paths:
        raise UnknownName("engine", name, paths)
    module, _, attribute = paths[name].partition(":")
    try:
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
