"""Constraint margins: of each kind of bound how many scenes have it, the largest figure, and what is nearest to failing.

Below that the bounds that are loose: a bound that a figure stays a thousand times below promises little of what was measured.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from statistics import mode

from reports.deciding.verdict import LOOKS, PROMISED, Verdict
from reports.reading.load import Row
from reports.words.metric_words import words
from reports.words.wording import count, limit, quantity

LOOSE = 1e-3
"""Share of a bound below which the figure of a scene makes it loose. Larger names bounds that hold by a safe margin; smaller
leaves out some that say next to nothing."""


@dataclass(frozen=True)
class Kind:
    """All bounds of the gate on one metric: `rows` are our figures that have one."""

    metric: str
    rows: tuple[Row, ...]

    @property
    def scenes(self) -> int:
        """How many scenes have the bound."""
        return len({row.scenario for row in self.rows})

    @property
    def above(self) -> int:
        """In how many of them the figure is above the bound, waived or not."""
        return len({row.scenario for row in self.rows if _share(row) > 1.0})

    @property
    def held_said(self) -> str:
        """"all", or in how many scenes the bound holds."""
        return "all" if not self.above else f"{self.scenes - self.above:,}"

    @property
    def loose(self) -> int:
        """In how many of them less than a thousandth of the bound was measured; a bound of 0 cannot be loose."""
        return len({row.scenario for row in self.rows if row.bound and _share(row) < LOOSE})

    @property
    def bound(self) -> str:
        """"1 µm", or from the tightest to the widest."""
        found, unit = [row.bound for row in self.rows if row.bound is not None], self.rows[0].unit
        return " to ".join(dict.fromkeys((limit(min(found), unit), limit(max(found), unit))))

    @property
    def largest(self) -> Row:
        """The largest figure; what is no number is larger than any."""
        return max(self.rows, key=_value)

    @property
    def nearest(self) -> Row:
        """The figure that is nearest to its bound, or farthest above it."""
        return max(self.rows, key=_share)

    @property
    def nearest_said(self) -> str:
        """"98 % (hand_grasp)", "0 in all"."""
        share = _share(self.nearest)
        if share == 0.0:
            return "0 in all"
        size = f"less than {100.0 * LOOSE:g} %" if share < LOOSE else f"{100.0 * share:.2g} %" if share <= 1.0 else "above it"
        return f"{size} ({self.nearest.scenario})"


def _value(row: Row) -> float:
    return row.value if row.value is not None and math.isfinite(row.value) else math.inf


def _share(row: Row) -> float:
    """A figure over its bound; 0 where both are 0."""
    value, bound = _value(row), row.bound or 0.0
    return value / bound if bound > 0.0 else math.inf if value > 0.0 else 0.0


def kinds(verdict: Verdict) -> tuple[Kind, ...]:
    """Every metric with a bound of the gate: first what is promised everywhere, then those that most scenes have."""
    found: dict[str, list[Row]] = {}
    for row in (*verdict.failed, *verdict.waived, *verdict.passed):
        if row.bound is not None:
            found.setdefault(row.metric, []).append(row)
    made = [Kind(metric, tuple(rows)) for metric, rows in found.items()]
    first = list(PROMISED)
    return tuple(sorted(made, key=lambda one: (first.index(one.metric) if one.metric in first else len(first), -one.scenes)))


def promised(found: Sequence[Kind]) -> str:
    """What is promised everywhere, in numbers; "" where nothing of it was measured."""
    said = []
    for one in (kind for kind in found if kind.metric in PROMISED):
        kept = count(one.scenes, "scene") if not one.above else f"{one.held_said} of {count(one.scenes, 'scene')}"
        text = f"{words(one.metric)} {one.bound} at most, in {kept}"
        if one.largest.value:
            text += f", largest {quantity(one.largest.value, one.largest.unit)}, nearest to its bound {one.nearest_said}"
        said.append(text if one.largest.value else f"{text}, 0 in all")
    return f"Promised everywhere: {'; '.join(said)}." if said else ""


def wider(found: Sequence[Kind]) -> str:
    """Figures of how motion looks that are held by a bound wider than most scenes have, and would not be by theirs; "" without
    any."""
    said = []
    for one in (kind for kind in found if kind.metric in LOOKS):
        usual = mode([row.bound for row in one.rows if row.bound is not None])
        rows = [row for row in one.rows if row.bound is not None and usual < row.bound and usual < _value(row) <= row.bound]
        said += [f"{words(one.metric)} in {row.scenario}: {quantity(row.value, row.unit)}, bound {limit(row.bound, row.unit)}, "
                 f"wider than the {limit(usual, row.unit)} of other scenes" for row in rows]
    return f"Of how motion looks, held by a wider bound alone: {'; '.join(said)}." if said else ""


def loose(found: Sequence[Kind]) -> str:
    """How many bounds on physics our figure stays a thousand times below, the one of the largest number with its
    figure; "" where there is none. How motion looks has a list of its own."""
    physics = [one for one in found if one.metric not in LOOKS]
    every, wide = sum(one.scenes for one in physics), sum(one.loose for one in physics)
    if not wide:
        return ""
    rows = [row for one in physics for row in one.rows if row.bound and _share(row) < LOOSE]
    most = max(rows, key=lambda row: row.bound or 0.0)
    return (f"Loose, of the bounds on physics: of {every:,} less than a thousandth was measured in {wide:,}, which the column "
            f"counts; the largest number among them is {limit(most.bound, most.unit)} for {words(most.metric)} in "
            f"{most.scenario}, measured {quantity(most.value, most.unit)}.")
