"""Step refinement: ladders of steps in which an error grows, or falls to the end, by one rule for all engines and scenes."""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

from reports.sections.sweep.attempts import Attempt
from reports.sections.sweep.points import Point, Sweep
from reports.words.wording import count, listed, quantity
from runfiles.accuracy import LEVELS, counts, follows

WORSE = 1.5
"""Times the error of the coarser step from which on the next finer one counts as worse: what is caught depends on where steps
happen to end, and errors that differ by less change with that. Smaller, and every curve is named; larger, and 9 mm that become
13.5 are not."""


@dataclass(frozen=True)
class Worse:
    """An error that grows from one step to the next finer one that was measured."""

    coarse: Point
    fine: Point

    @property
    def factor(self) -> float:
        """By how many times."""
        return self.fine.floored / self.coarse.floored

    @property
    def said(self) -> str:
        """Scene, preset and both errors."""
        steps = " to ".join(step_words(point) for point in (self.coarse, self.fine))
        errors = " to ".join(quantity(point.floored, point.unit) for point in (self.coarse, self.fine))
        return f"{self.coarse.scenario} {self.coarse.family} from {steps}: {errors}"


def step_words(point: Point) -> str:
    """"1/240 s"."""
    return f"1/{1.0 / point.step:.0f} s"


def stepped(point: Point) -> bool:
    """Whether a point is a rung: a preset whose step is known, or what differs from it in the step alone."""
    return (point.is_preset or point.setting.startswith(f"{point.base} dt=")) and point.step > 0.0


def ladders(sweep: Sweep) -> tuple[tuple[Point, ...], ...]:
    """Points that differ in nothing but the engine's step, coarsest first, two at least; errors that are lengths."""
    groups: dict[tuple[str, str, str], list[Point]] = {}
    for point in sweep.points:
        if stepped(point) and point.floored == point.floored and counts(point.metric, point.unit):
            groups.setdefault((point.scenario, point.metric, point.family), []).append(point)
    return tuple(tuple(sorted(group, key=lambda p: -p.step)) for group in groups.values() if len(group) > 1)


def worse(found: Sequence[Sequence[Point]]) -> tuple[Worse, ...]:
    """Of each ladder the largest growth from a step to the next finer one, where it is more than WORSE; largest first."""
    most = [max((Worse(a, b) for a, b in pairwise(ladder)), key=lambda one: one.factor) for ladder in found]
    return tuple(sorted((one for one in most if one.factor > WORSE), key=lambda one: -one.factor))


def falling(tried: Sequence[Attempt]) -> tuple[Attempt, ...]:
    """The finest measured step of every ladder of one engine in one scene on which the largest error still falls: below that of
    all coarser steps. Where such a step stays far from a free user, its offset has to fall too."""
    groups: dict[str, list[Attempt]] = {}
    for attempt in tried:
        if attempt.measured and stepped(attempt.any_point):
            groups.setdefault(attempt.any_point.family, []).append(attempt)
    found = list[Attempt]()
    for group in groups.values():
        *coarse, fine = sorted(group, key=lambda attempt: -attempt.any_point.step)
        if coarse and _falls(coarse, fine):
            found.append(fine)
    return tuple(found)


def _falls(coarse: Sequence[Attempt], fine: Attempt) -> bool:
    nearer = fine.error <= LEVELS[-1] or fine.error < min(attempt.error for attempt in coarse)
    return nearer and (follows(fine.offset) or fine.offset < min(attempt.offset for attempt in coarse))


def sentence(sweep: Sweep) -> str:
    """In how many ladders an error grows with a finer step, and where most; "" where there is no ladder."""
    found = ladders(sweep)
    grown = worse(found)
    if not found:
        return ""
    if not grown:
        return f"In none of {count(len(found), 'ladder')} of steps does an error grow by half with the next finer step."
    return (f"A finer step is not always better: in {len(grown)} of {count(len(found), 'ladder')} of steps an error grows by "
            f"more than half with the next finer step ({listed(tuple(one.said for one in grown), 3)}). How deep a contact is "
            "found depends on where in a step it falls, so that errors of single steps scatter.")
