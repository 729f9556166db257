"""Catalogue: all scenes by name. One file per scene, found on disk: each exports SCENARIO or SCENARIOS."""

from functools import cache
from importlib import import_module
from pkgutil import walk_packages
from types import MappingProxyType

from avatarsim.errors import InvalidInput, UnknownName
from scenarios import own_scenes
from scenarios.scenario import Scenario


@cache
def _found() -> MappingProxyType[str, Scenario]:
    found: dict[str, Scenario] = {}
    for module in sorted(walk_packages(__path__, f"{__name__}."), key=lambda info: info.name):
        if module.ispkg:
            continue
        exports = import_module(module.name)
        several = getattr(exports, "SCENARIOS", None)
        for scenario in several if several is not None else (exports.SCENARIO,):
            if scenario.name in found:
                raise InvalidInput("name of a scenario", scenario.name, "names that occur once only")
            found[scenario.name] = scenario
    return MappingProxyType(dict(sorted(found.items())))


def scenarios() -> dict[str, Scenario]:
    """Return every scenario by name, sorted, none of them built; where a user brings scenes, these alone."""
    return own_scenes.scenarios() or dict(_found())


def get(name: str) -> Scenario:
    """Return the scenario called `name`; UnknownName lists those that exist."""
    found = scenarios()
    if name not in found:
        raise UnknownName("scenario", name, found)
    return found[name]
