"""Accuracy of settings: errors as lengths, the levels that they are compared with, and the levels that an engine misses."""

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from runfiles.metrics import unit

LEVELS = (1e-2, 1e-3, 1e-4, 1e-6)
"""Accuracies [m] that a sweep compares engines at."""
RELATIVE: Mapping[str, float] = {"stop_distance_error_max": 0.01}
"""Errors that are a share of a way, and the length [m] of one of their units if that way is a metre: 1 % counts as 10 mm."""
FOLLOWING = ("tracker_offset_rms", "tracker_offset_rms_free")
"""Distances of a posture from its user's, which are no errors of contact."""
FOLLOWS = LEVELS[0]
"""Offset [m] from a user with a free way above which a setting reaches no accuracy. Larger, and a body that stays behind by a
foot's length is called accurate to a micrometre; smaller, and a body on a spring is excluded, which is no error of contact."""


def counts(metric: str) -> bool:
    """Return whether an error can be compared with a length."""
    return metric in RELATIVE or (unit(metric) == "m" and metric not in FOLLOWING)


def lengths(values: Mapping[str, float]) -> dict[str, float]:
    """Return the errors that count as lengths [m] by metric."""
    return {name: value * RELATIVE.get(name, 1.0) for name, value in values.items() if counts(name)}


def follows(offset: float) -> bool:
    """Return whether a free user is followed; a scene without a user has an offset of nan."""
    return math.isnan(offset) or offset <= FOLLOWS


def largest(entry: Mapping[str, Any], metrics: Sequence[str]) -> float:
    """Return the largest error [m] of a cell that counts; infinite where one is missing, or its user is not followed."""
    values: Mapping[str, float] = entry["values"] if entry["state"] == "measured" else {}
    if not follows(next((values[name] for name in FOLLOWING if name in values and name in metrics), math.nan)):
        return math.inf
    errors = lengths({name: float(values.get(name, math.inf)) for name in metrics}).values()
    return max((math.inf if math.isnan(error) else error for error in errors), default=math.inf)


@dataclass(frozen=True)
class Reached:
    """The largest error [m] of one setting of an engine in a scene, and the engine's time step [s], nan where it has none."""

    scenario: str
    engine: str
    error: float
    step: float


def missing(reached: Iterable[Reached], own: str = "avatarsim") -> dict[tuple[str, str], float]:
    """Return (scene, engine) -> its finest step [s] where none of its settings reaches one of LEVELS that ``own`` reaches."""
    least: dict[tuple[str, str], float] = {}
    finest: dict[tuple[str, str], float] = {}
    for one in reached:
        place = one.scenario, one.engine
        least[place] = min(least.get(place, math.inf), one.error)
        finest[place] = min(finest.get(place, math.inf), math.inf if math.isnan(one.step) else one.step)

    def is_worse(place: tuple[str, str]) -> bool:
        return any(least.get((place[0], own), math.inf) <= level < least[place] for level in LEVELS)

    return {place: step for place, step in finest.items() if place[1] != own and step < math.inf and is_worse(place)}
