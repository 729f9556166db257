"""Which figures of other engines want an explanation, and which have one. Reports read it here: they know no engine."""

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from types import MappingProxyType

from reference.explained import EXPLAINED, Explanation
from reference.explained import LARGE as LARGE
from scenarios.behind import Figure, at_size_1
from scenarios.engines import BASELINE, GATED

ASKED = ("residual_overlap_max", "tracker_offset_rms_free")
"""Metrics in metres that a reader sees: how deep something is in something else, how far a link is from a target that is free."""


@dataclass(frozen=True)
class Large:
    """One row whose `value`, at size 1, is above LARGE or no number, and why; None while that is not known."""

    row: Figure
    why: Explanation | None
    value: float

    @property
    def said(self) -> str:
        """The explanation as a sentence that begins with its cause."""
        return "not yet explained" if self.why is None else f"{self.why.cause.value}: {self.why.sentence}"


def large(rows: Iterable[Figure], scales: Mapping[str, float] = MappingProxyType({})) -> tuple[Large, ...]:
    """Every figure of another engine above LARGE, the largest first; what has no explanation stands before what has one. A world
    of another size (`scales`: scene -> size) counts as if it had size 1: a thousand times as large, it leads no list for that."""
    aside = {BASELINE, GATED[0]}
    found = [
        Large(row, EXPLAINED.get((row.scenario, row.run)), value) for row in rows
        if row.metric in ASKED and row.run.partition("/")[0] not in aside
        and (value := at_size_1(row.value, row.unit, scales.get(row.scenario, 1.0))) is not None and not value <= LARGE
    ]
    return tuple(sorted(found, key=lambda one: (one.why is not None, -_size(one.value))))


def _size(value: float) -> float:
    return value if math.isfinite(value) else math.inf
