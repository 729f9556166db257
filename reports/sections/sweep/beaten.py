"""Presets that a setting of their own sweep beats: in time and in every error that counts at once."""

from collections.abc import Sequence
from dataclasses import dataclass

from reports.deciding.alike import is_more
from reports.sections.sweep.attempts import Attempt, attempts
from reports.sections.sweep.points import OURS, Point, Sweep
from reports.words.wording import count
from runfiles.accuracy import LEVELS, counts, follows

BEST = {OURS[0]: OURS[1]}
"""Engine -> the preset that is meant to be its best, where that is not called TUNED."""
TUNED = "tuned"


@dataclass(frozen=True)
class Beaten:
    """One preset in one scene and the fastest setting of its engine that is faster and in no error that counts worse. `closer`
    if it is as near to a free user too."""

    preset: Attempt
    by: Attempt

    @property
    def closer(self) -> bool:
        """Whether the setting is as near to its user, or there is none."""
        return not self.by.offset > max(self.preset.offset, LEVELS[-1])


def beaten(sweep: Sweep) -> tuple[Beaten, ...]:
    """Scene by scene, where it happens; a setting that does not follow a free user beats nothing."""
    tried, errors = attempts(sweep.points), _errors(sweep.points)
    found = []
    for preset in tried:
        point = preset.any_point
        if point.setting != BEST.get(point.engine, TUNED) or not preset.measured:
            continue
        rivals = [
            other for other in tried
            if other.measured and follows(other.offset) and is_more(preset.time, other.time)
            and (other.any_point.scenario, other.any_point.engine) == (point.scenario, point.engine)
            and all(errors[other.any_point.scenario, other.any_point.run].get(metric, float("inf")) <= error
                    for metric, error in errors[point.scenario, point.run].items())
        ]
        if rivals:
            found.append(Beaten(preset, min(rivals, key=lambda other: (not Beaten(preset, other).closer, other.time))))
    return tuple(found)


def _errors(points: Sequence[Point]) -> dict[tuple[str, str], dict[str, float]]:
    """(scene, run) -> metric -> the error, or what counts as none where that is less, of errors that count."""
    found: dict[tuple[str, str], dict[str, float]] = {}
    for point in points:
        if counts(point.metric, point.unit) and point.floored == point.floored:
            found.setdefault((point.scenario, point.run), {})[point.metric] = point.floored
    return found


def sentence(found: Sequence[Beaten]) -> str:
    """How often it happens."""
    if not found:
        return ("No tuned preset is beaten in time and every error that counts at once by a setting of its own sweep that was "
                "measured here.")
    closer = sum(one.closer for one in found)
    runs = [one.preset.any_point.run for one in found]
    each = ", ".join(f"{run} in {count(runs.count(run), 'scene')}" for run in dict.fromkeys(runs))
    return (f"Beaten in time and in every error that counts at once by a setting of their own sweep: {each}; {closer} of "
            f"{len(found)} by one that is as near to a free user too")
