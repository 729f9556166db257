"""Accuracies that a setting is asked for, how its errors are measured against them (as lengths), and which are missed."""

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from runfiles.metrics import unit

LEVELS = (1e-2, 1e-3, 1e-4, 1e-6)
"""Accuracies that are asked for [m]."""
RELATIVE: Mapping[str, float] = {"stop_distance_error_max": 0.01}
"""Errors that are a share of a way, and the length [m] of one of their units if that way is a metre: 1 % counts as 10 mm."""
FOLLOWING = ("tracker_offset_rms", "tracker_offset_rms_free")
"""How far a posture is from its user's says how an engine follows, not how accurate its contact is: it stands beside."""
FOLLOWS = LEVELS[0]
"""Offset [m] from a user in whose way nothing is, above which a setting reaches no accuracy: what is farther away than the
coarsest accuracy asked for avoids contact by not being there. Larger, and a body that stays behind by a foot's length is called
accurate to a micrometre; smaller, and what follows on a spring falls out, which is no error of contact."""


def counts(metric: str, unit: str) -> bool:
    """Whether an error can be compared with a length."""
    return metric in RELATIVE or (unit == "m" and metric not in FOLLOWING)


def length(metric: str, error: float) -> float:
    """The error as a length [m], for a metric that `counts`."""
    return error * RELATIVE.get(metric, 1.0)


def follows(offset: float) -> bool:
    """Whether a free user is followed; a scene without a user, of whose offset nothing is known (nan), has none to follow."""
    return math.isnan(offset) or offset <= FOLLOWS


def largest(entry: Mapping[str, Any], metrics: Sequence[str]) -> float:
    """The largest of those errors of a cell that count [m]; infinite where one is missing, or its user is not followed."""
    values: Mapping[str, float] = entry["values"] if entry["state"] == "measured" else {}
    if not follows(next((values[name] for name in FOLLOWING if name in values and name in metrics), math.nan)):
        return math.inf
    found = [length(name, float(values.get(name, math.inf))) for name in metrics if counts(name, unit(name))]
    return max((math.inf if math.isnan(error) else error for error in found), default=math.inf)


@dataclass(frozen=True)
class Reached:
    """The largest error [m] of one setting of an engine in a scene, and the engine's time step [s], nan where it has none."""

    scenario: str
    engine: str
    error: float
    step: float


def missing(found: Iterable[Reached], ours: str = "avatarsim") -> dict[tuple[str, str], float]:
    """(scene, engine) -> its finest step [s] so far, where none of its settings reaches one of LEVELS that `ours` reaches."""
    least: dict[tuple[str, str], float] = {}
    finest: dict[tuple[str, str], float] = {}
    for one in found:
        place = one.scenario, one.engine
        least[place] = min(least.get(place, math.inf), one.error)
        if one.step == one.step:
            finest[place] = min(finest.get(place, math.inf), one.step)
    return {
        (scene, engine): finest[scene, engine]
        for (scene, engine), error in least.items()
        if engine != ours
        and (scene, engine) in finest
        and any(least.get((scene, ours), math.inf) <= level < error for level in LEVELS)
    }
