"""Engines by name, built in or joined by an entry point, and the scenes that their variants run in."""

import os
import sys
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager, nullcontext
from importlib import import_module
from importlib.util import find_spec
from multiprocessing import parent_process

from avatarsim.engine import Engine
from avatarsim.errors import InvalidFile, InvalidInput, MissingPackage, UnknownName, bringing
from avatarsim.scene.joint import Ball, Hinges
from runfiles.engines import about, engines, joined
from runfiles.naming import UNSEEN_PREFIX
from scenarios.scenario import Scenario


def known() -> dict[str, str]:
    """Return all engines, name -> "module:class": the gated one first, those that joined last, in order of name.

    An entry point cannot take the name of an engine that is built in.
    """
    others = {name: adapter for name, adapter in sorted(joined().items()) if name not in engines()}
    return {name: one.adapter for name, one in engines().items()} | others


def absent() -> dict[str, str]:
    """Return the built-in engines of which a package is not installed, name -> the command that installs it."""
    missing = {}
    for name, one in engines().items():
        for package in one.packages:
            if find_spec(package) is None:
                missing[name] = one.when_missing or bringing(one.extra, package)
    return missing


def engines_to_run(names: Sequence[str]) -> list[str]:
    """Return the engines that are named, or without a name all that are installed; a line on stderr names those that are not."""
    if names:
        return list(names)
    missing = absent()
    for name, hint in missing.items():
        print(f"{about(name).label} is not installed and left out: {hint}", file=sys.stderr)
    return [name for name in known() if name not in missing]


@contextmanager
def _muted() -> Iterator[None]:
    """Drop errors printed from C, where one engine greets on import; worker processes drop other output anyway."""
    saved, nowhere = os.dup(2), os.open(os.devnull, os.O_WRONLY)
    try:
        os.dup2(nowhere, 2)
        yield
    finally:
        os.dup2(saved, 2)
        os.close(saved)
        os.close(nowhere)


def opened(name: str) -> Engine:
    """Return a fresh engine. Raises UnknownName, MissingPackage, ImportError for a missing module of the engine itself, and
    InvalidInput for a class without all parts of an engine, InvalidFile for presets in its facts that it does not have."""
    one = about(name)
    if not one.adapter:
        raise UnknownName("engine", name, known())
    module, _, attribute = one.adapter.partition(":")
    try:
        # only in worker processes, and never the messages of an engine that joined
        with _muted() if name in engines() and parent_process() is not None else nullcontext():
            made = getattr(import_module(module), attribute)()
    except ImportError as error:
        if (error.name or module).partition(".")[0] == module.partition(".")[0]:
            # a fault of the engine, which installing a package does not repair
            raise
        raise MissingPackage(error.name or module, one.extra, f"engine {name}") from error
    if not isinstance(made, Engine):
        valid = "a class with every part of avatarsim.engine.Engine"
        raise InvalidInput(f"engine {name} ({one.adapter})", type(made).__name__, valid)
    if one.path and (unknown := [preset for preset in one.presets if preset not in made.presets]):
        raise InvalidFile(f"presets in {one.path}", unknown[0], f"presets of the adapter: {', '.join(made.presets)}")
    return made


def may_sleep(scenario: Scenario) -> bool:
    """Return whether bodies are to rest, or may fall asleep in an everyday scene: avatarsim puts them to sleep by default."""
    if "rests" in scenario.expects:
        return True
    return scenario.everyday and scenario.as_run(False).build().derived_effects.sleeping


def limits_balls(scenario: Scenario) -> bool:
    """Return whether a ball joint of an avatar has limits."""
    links = scenario.as_run(False).build().links
    return any(isinstance(link.joint, Ball) and link.joint.limits is not None for link in links)


def hinges_only(scenario: Scenario) -> bool:
    """Return whether avatars move by hinges, and by no ball joint."""
    joints = [link.joint for link in scenario.as_run(False).build().links]
    return any(isinstance(joint, Hinges) for joint in joints) and not any(isinstance(joint, Ball) for joint in joints)


CONDITIONS: Mapping[str, Callable[[Scenario], bool]] = {
    "bodies may sleep": may_sleep,
    "follows recorded motion": lambda scenario: scenario.name.startswith(("mocap_", UNSEEN_PREFIX)),
    "ball joints have limits": limits_balls,
    "avatars have hinges only": hinges_only,
}
"""Conditions on a scene that `scenes` of a variant in about.toml can name."""


def takes_part(engine: str, preset: str, scenario: Scenario) -> bool:
    """Return whether a preset runs in a scenario: a variant only under its condition. Raises InvalidFile for an unknown one."""
    one = about(engine)
    if preset not in one.variants:
        return True
    condition = one.variants[preset].scenes
    if condition not in CONDITIONS:
        raise InvalidFile(f"variants.{preset}.scenes in {one.path}", condition, f"one of {', '.join(CONDITIONS)}")
    return CONDITIONS[condition](scenario)


def variants_of(engine: str, scenario: Scenario, chosen: Sequence[str]) -> list[str]:
    """Return the variants of an engine that run in a scenario, of those `chosen`; of all where none is."""
    return [name for name in about(engine).variants if (not chosen or name in chosen) and takes_part(engine, name, scenario)]
