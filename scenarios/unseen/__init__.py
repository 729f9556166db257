"""Motions nothing was tuned for: recorded clips recombined by seed, in five rooms, in the last also at 90 Hz.

Their seeds change with every commit, so they have no place in the committed baseline, in ceilings, or in the catalogue.
"""

from functools import cache
from types import MappingProxyType

from avatarsim.errors import UnknownName
from runfiles.naming import UNSEEN_PREFIX as PREFIX
from scenarios.motion.resampled import at_rate
from scenarios.scenario import Scenario
from scenarios.unseen.rooms import ROOMS

__all__ = ["NAME", "PREFIX", "get", "scenarios"]

NAME = __name__
"""The module that a job names as its catalogue."""


@cache
def _collected() -> MappingProxyType[str, Scenario]:
    return MappingProxyType({scenario.name: scenario for scenario in (*ROOMS, at_rate(ROOMS[-1]))})


def scenarios() -> dict[str, Scenario]:
    """Return the scene of every room by name."""
    return dict(_collected())


def get(name: str) -> Scenario:
    """Return the scene called `name`; UnknownName lists those that exist."""
    try:
        return _collected()[name]
    except KeyError:
        raise UnknownName("scenario", name, _collected()) from None
