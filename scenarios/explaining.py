"""Which figures of other engines want an explanation, and which have one. Reports read it here: they know no engine."""

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from types import MappingProxyType

from reference.explained import DEPTH, EXCESS, OFFSET, Explanation, explanation
from reference.explained import LARGE as LARGE
from reference.explained import LARGE_ANGLE as LARGE_ANGLE
from scenarios.behind import Figure, at_size_1
from scenarios.engines import BASELINE, GATED
from scenarios.variants import base_of

ASKED = (DEPTH, OFFSET)
"""Metrics in metres that a reader sees: how deep something is in something else, how far a link is from a target that is free."""
BOUNDS = {DEPTH: LARGE, OFFSET: LARGE, EXCESS: LARGE_ANGLE}
"""Every metric of which large figures are explained, and what is large, in its own unit."""
SAME = 0.01
"""Share by which a variant of a preset may differ from it and still have its explanation: its settings are the same but for those
that the row is about. Larger would hand on the cause of a figure that has another one."""


@dataclass(frozen=True)
class Large:
    """One row whose `value`, at size 1, is above its bound or no number, and why; None while that is not known."""

    row: Figure
    why: Explanation | None
    value: float

    @property
    def said(self) -> str:
        """The explanation as a sentence that begins with its cause."""
        return "not yet explained" if self.why is None else f"{self.why.cause.value}: {self.why.sentence}"


def large(rows: Iterable[Figure], scales: Mapping[str, float] = MappingProxyType({})) -> tuple[Large, ...]:
    """Every figure of another engine above its bound, lengths before angles and the largest first; what has no explanation stands
    before what has one. A world of another size (`scales`: scene -> size) counts as if it had size 1: a thousand times as large,
    it leads no list for that."""
    aside = {BASELINE, GATED[0]}
    asked = [row for row in rows if row.metric in BOUNDS and row.run.partition("/")[0] not in aside and row.value is not None]
    values = {(row.scenario, row.seed, row.metric, row.run): row.value for row in asked}
    found = [
        Large(row, _why(row, values), value) for row in asked
        if (value := at_size_1(row.value, row.unit, scales.get(row.scenario, 1.0))) is not None
        and not value <= BOUNDS[row.metric]
    ]
    return tuple(sorted(found, key=lambda one: (one.why is not None, one.row.metric == EXCESS, -_size(one.value))))


def briefly(scene: str, run: str) -> str:
    """Why joints of a run go beyond their limits in a scene, in a few words; "" where no rule has them."""
    found = explanation(scene, run, EXCESS)
    return found.brief if found is not None else ""


def _why(row: Figure, values: dict[tuple[str, int, str, str], float | None]) -> Explanation | None:
    """The rule of its own run, or of the preset that its run is a variant of where that has the same value."""
    found, base = explanation(row.scenario, row.run, row.metric), base_of(row.run)
    if found is not None or not base:
        return found
    other = values.get((row.scenario, row.seed, row.metric, base))
    same = other is not None and row.value is not None and (
        abs(row.value - other) <= SAME * abs(other) or math.isnan(row.value) and math.isnan(other))
    return explanation(row.scenario, base, row.metric) if same else None


def _size(value: float) -> float:
    return value if math.isfinite(value) else math.inf
