"""Ranked moments: for each measure the worst frames of one preset, at most one in half a second of a run, to be looked at."""

from collections.abc import Callable, Iterator, Sequence

import numpy as np

from scenarios.measure.posture.smoothness import CALM
from scenarios.posture_table.runs import Seen
from scenarios.posture_table.series import Array, Series
from scenarios.scenario import RENDERED

APART = round(CALM / RENDERED)
"""Least number of frames between two moments of one run that are listed: nearer, they are one event."""
MEASURES: tuple[tuple[str, str, float, Callable[[Series], Array]], ...] = (
    ("overlap", "m", 1.0, lambda s: s.overlap),
    ("excess of limits", "deg", 1.0, lambda s: s.limits),
    ("wrong side", "", 1.0, lambda s: s.wrong),
    ("reversal while shaking in contact", "mm", 1e3, lambda s: s.reversal * s.shakes * s.contact),
    ("reversal in contact", "mm", 1e3, lambda s: s.reversal * s.contact),
    ("third difference beyond the target's", "mm", 1e3, lambda s: s.jerk),
    ("turn beyond the user's", "deg", 1.0, lambda s: s.turn),
    ("root's way beyond the user's", "m", 1.0, lambda s: s.way),
    ("farthest link, target free for half a second", "m", 1.0, lambda s: s.farthest * s.owed),
    ("farthest link without a status", "m", 1.0, lambda s: s.farthest * s.silent),
    ("offset in contact", "mm", 1e3, lambda s: s.offset * s.contact),
    ("angle in contact", "deg", 1.0, lambda s: s.angle * s.contact),
)
"""What is listed, its unit, the factor to it, and the series."""


def peaks(values: Array, most: int) -> list[int]:
    """Places of at most `most` of the largest values above 0, APART from each other, largest first; what is no number is larger
    than all."""
    left = np.where(np.isnan(values), np.inf, values)
    found: list[int] = []
    while len(found) < most and left.size and left.max() > 0.0:
        k = int(left.argmax())
        found.append(k)
        left[max(0, k - APART + 1) : k + APART] = 0.0
    return found


def worst(runs: Sequence[Seen], most: int) -> Iterator[str]:
    """A line per measure and one per moment of it; nothing of measures that are 0 throughout."""
    every = [(name, unit, factor, [(run, of(run.series)) for run in runs if run.series is not None])
             for name, unit, factor, of in MEASURES]
    every.append(("frame time", "us", 1.0, [(run, run.times) for run in runs if run.times.size]))
    for name, unit, factor, each in every:
        listed = [(values[k], run.where, k + 1) for run, values in each for k in peaks(values, most)]
        listed.sort(key=lambda one: -np.inf if np.isnan(one[0]) else -one[0])
        if listed:
            yield f"- {name}" + (f" [{unit}]" if unit else "")
        yield from (f"  - {factor * value:.4g}: {where} frame {frame}" for value, where, frame in listed[:most])


