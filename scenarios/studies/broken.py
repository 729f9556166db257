"""Bounds that a run broke, of scenes and motions that are drawn by a seed."""

import math
from importlib import import_module

from scenarios.job import Outcome
from scenarios.measure.value import Missing
from scenarios.run.gate import bounds_of


def figure(outcome: Outcome, metric: str) -> float:
    """Return the figure of a metric; nan where there is none."""
    value = outcome.values.get(metric)
    return value if isinstance(value, float) else math.nan


def broken(outcome: Outcome) -> dict[str, str]:
    """Return a sentence for each metric whose bound the run broke.

    A figure that is missing or no number breaks its bound, unless the scene gave no occasion for it.
    """
    job, found = outcome.job, dict[str, str]()
    for metric, bound in bounds_of(import_module(job.catalogue).get(job.scenario)).items():
        value = outcome.values.get(metric)
        if not (isinstance(value, Missing) and value.fault == "scene") and not bound.holds(figure(outcome, metric)):
            found[metric] = f"{job.scenario} --seed {job.seed}: {metric} {figure(outcome, metric):.4g} (at most {bound.limit:g})"
    return found
