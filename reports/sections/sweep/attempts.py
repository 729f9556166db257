"""One setting in one scene with all its errors that are lengths at once, and the time by which its scene compares."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

from reports.deciding.alike import Basis, basis_of, time_by
from reports.sections.sweep.points import Point
from runfiles.accuracy import FOLLOWING, counts, follows
from runfiles.accuracy import length as as_length


def length(point: Point) -> float:
    """The error as a length [m], for a metric that `counts`; nan where the setting has no accuracy."""
    return as_length(point.metric, point.error) if point.state == "measured" else math.nan


@dataclass(frozen=True)
class Attempt:
    """One setting in one scene: the largest of its errors [m], the time of a frame [us] by which its scene compares, its offset
    from the tracker [m]; nan where there is none. `any_point` is one of its points."""

    any_point: Point
    error: float
    time: float
    offset: float

    @property
    def measured(self) -> bool:
        """Whether it has both an accuracy and a time."""
        return math.isfinite(self.error) and math.isfinite(self.time) and self.time > 0.0

    def reaches(self, level: float) -> bool:
        """Whether every error is at most `level` [m]; never for what was not measured, or does not follow a free user."""
        return self.measured and self.error <= level and follows(self.offset)

    @property
    def strays(self) -> bool:
        """Whether it was measured and stays farther from a free user than any accuracy that is asked for."""
        return self.measured and not follows(self.offset)


def bases_of(points: Sequence[Point]) -> dict[str, Basis]:
    """Scene -> the time that its settings are compared by."""
    return {scene: basis_of([point for point in points if point.scenario == scene])
            for scene in dict.fromkeys(point.scenario for point in points)}


def attempts(points: Sequence[Point]) -> tuple[Attempt, ...]:
    """One entry per scene and setting that has an error which is a length; an error that is missing spoils the others. A setting
    that has no words for one of them was not tried."""
    bases = bases_of(points)
    groups: dict[tuple[str, str], list[Point]] = {}
    for point in points:
        groups.setdefault((point.scenario, point.run), []).append(point)
    found = []
    for group in groups.values():
        if any(point.state == "cannot-say" for point in group):
            continue
        lengths = [length(point) for point in group if counts(point.metric, point.unit)]
        if lengths:
            worst = math.nan if any(math.isnan(value) for value in lengths) else max(lengths)
            offset = next((p.error for p in group if p.metric in FOLLOWING and p.state == "measured"), math.nan)
            found.append(Attempt(group[0], worst, time_by(group[0], bases[group[0].scenario]), offset))
    return tuple(found)
