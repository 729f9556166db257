"""Expectations of a scenario: entries of one kind under one key, and measures of each of them."""

from collections.abc import Callable
from functools import update_wrapper
from typing import TypeVar

import numpy as np

from avatarsim.scene.scene import Scene
from runfiles.record import Recording
from scenarios.measure.value import Missing, Value, Values, measure
from scenarios.scenario import Scenario

Kind = TypeVar("Kind")
Of = Callable[[Recording, Scene, Kind], Values]
Measure = Callable[[Recording, Scenario, Scene], Values]


def expected(scenario: Scenario, key: str, kind: type[Kind]) -> tuple[Kind, ...]:
    """Return all entries of `kind` under `expects[key]`; empty when there are none."""
    listed = scenario.expects.get(key, ())
    return tuple(entry for entry in listed if isinstance(entry, kind)) if isinstance(listed, tuple | list) else ()


def for_each(key: str, kind: type[Kind]) -> Callable[[Of[Kind]], Measure]:
    """Make a measure of a function that measures one entry: the `worst` figures over all entries of `kind` in `expects[key]`."""

    def made(function: Of[Kind]) -> Measure:
        def over_all(recording: Recording, scenario: Scenario, scene: Scene) -> Values:
            by_metric: dict[str, list[Value]] = {}
            for entry in expected(scenario, key, kind):
                for metric, value in function(recording, scene, entry).items():
                    by_metric.setdefault(metric, []).append(value)
            return {metric: worst(values) for metric, values in by_metric.items()}

        update_wrapper(over_all, function)
        # its parameters are its own, by which it is called
        del over_all.__wrapped__  # type: ignore[attr-defined]
        return measure(over_all)

    return made


def worst(values: list[Value]) -> Value:
    """Return the largest number, nan where one is; a value missing by the engine's fault is worse, and one for which the scene
    gives no occasion is skipped."""
    numbers = [value for value in values if not isinstance(value, Missing)]
    missing = sorted((value for value in values if isinstance(value, Missing)), key=lambda value: value.fault == "scene")
    if missing and not (numbers and missing[0].fault == "scene"):
        return missing[0]
    # np.max keeps nan, which max() may lose
    return float(np.max(numbers))
