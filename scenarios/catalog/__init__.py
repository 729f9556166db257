"""Catalogue: all scenes by name. One file per scene, found on disk: each exports SCENARIO or SCENARIOS."""

from functools import cache
from importlib import import_module
from pkgutil import walk_packages
from types import MappingProxyType

from avatarsim.errors import InvalidInput, UnknownName
from scenarios import own_scenes
from scenarios.scenario import Scenario


@cache
def _collected() -> MappingProxyType[str, Scenario]:
    by_name: dict[str, Scenario] = {}
    for module in sorted(walk_packages(__path__, f"{__name__}."), key=lambda info: info.name):
        if module.ispkg:
            continue
        exports = import_module(module.name)
        several = getattr(exports, "SCENARIOS", None)
        for scenario in several if several is not None else (exports.SCENARIO,):
            if scenario.name in by_name:
                raise InvalidInput("name of a scenario", scenario.name, "names that occur once only")
            by_name[scenario.name] = scenario
    return MappingProxyType(dict(sorted(by_name.items())))


def scenarios() -> dict[str, Scenario]:
    """Return every scenario by name, sorted, none of them built; where a user brings scenes, these alone."""
    return own_scenes.scenarios() or dict(_collected())


def get(name: str) -> Scenario:
    """Return the scenario called `name`; UnknownName lists those that exist."""
    known = scenarios()
    if name not in known:
        raise UnknownName("scenario", name, known)
    return known[name]
