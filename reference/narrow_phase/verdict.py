"""Cell by cell: are we as fast as we say, against the fastest of those that are right there? Two comparisons of equals.

Within: our query inside compiled code, against a library's time less what its call from Python costs, or against what a
library does for all pairs in one call. This decides whether a cell holds. Called: one call from Python per query on both
sides; shown beside it, and decides only where the call is all that could be measured of the rivals.
"""

from collections.abc import Iterable, Mapping
from collections.abc import Sequence as Many
from dataclasses import dataclass

import numpy as np

from reference.narrow_phase.cells import Cell
from reference.narrow_phase.rows import Row

OURS, OURS_PLACED, OURS_CALLED, LIBRARY = "ours", "ours+place", "ours/call", "avatarsim"

ALLOWED = {"cold": 1.0, "coherent": 0.5}
"""Largest share of the rival's time that ours may take: cold no slower, coherent at most half."""

RESOLVED = 0.25
"""Least share of a call's cost that is left as a figure once that cost has been taken off. Below, it is the difference of two
noisy numbers and says nothing: the library is then compared as called only. What MuJoCo computes there in next to no time,
its mj_collision computes in C as well, where nothing has to be taken off."""


@dataclass(frozen=True)
class Judged:
    """One cell and mode. Ratios are ours / rival; nan, and the rival empty, where no other was right.

    ratio_placed is `ratio` with the world vertices of both shapes computed within our time.
    """

    shape_a: str
    shape_b: str
    regime: str
    mode: str
    allowed: float
    ours_us: float
    rival: str
    rival_us: float
    ratio: float
    ratio_placed: float
    ours_called_us: float
    rival_called: str
    rival_called_us: float
    ratio_called: float
    ours_right: bool
    held: bool

    @property
    def worst(self) -> float:
        """The ratio that decides as a multiple of what is allowed; above 1 is lost. inf if ours is not even right."""
        if not self.ours_right:
            return np.inf
        return self.decisive / self.allowed if self.decisive == self.decisive else 0.0

    @property
    def decisive(self) -> float:
        """The ratio that decides: within, or called where no rival can be compared within; nan without any rival."""
        return self.ratio if self.rival else self.ratio_called

    @property
    def cell(self) -> Cell:
        """Where."""
        return Cell(self.shape_a, self.shape_b, self.regime)


def call_costs(rows: Iterable[Row]) -> dict[tuple[str, str], float]:
    """(engine, mode) -> what a call from Python costs [us], median of all cells."""
    found: dict[tuple[str, str], list[float]] = {}
    for row in rows:
        if row.call_us == row.call_us:
            found.setdefault((row.engine, row.mode), []).append(row.call_us)
    return {key: float(np.median(times)) for key, times in found.items()}


def judged(rows: Many[Row]) -> list[Judged]:
    """Every cell and mode, worst first."""
    groups: dict[tuple[str, ...], list[Row]] = {}
    for row in rows:
        groups.setdefault((*row.cell, row.mode), []).append(row)
    return sorted((_judged(group) for group in groups.values()), key=lambda one: -one.worst)


def _judged(group: list[Row]) -> Judged:
    first = group[0]
    by_name = {row.engine: row for row in group}
    ours, called = by_name.get(OURS), by_name.get(OURS_CALLED)
    rivals = [row for row in group if row.library != LIBRARY and row.right and row.us_p50 > 0.0]
    inside = {row.engine: row.us_p50 for row in rivals if not row.per_call}
    inside |= {r.engine: r.us_p50 - r.call_us for r in rivals if r.per_call and r.us_p50 - r.call_us >= RESOLVED * r.call_us}
    outside = {row.engine: row.us_p50 for row in rivals if row.per_call}
    rival, rival_us = _fastest(inside)
    rival_called, rival_called_us = _fastest(outside)
    ours_us, placed_us, called_us = (row.us_p50 if row else np.nan for row in (ours, by_name.get(OURS_PLACED), called))
    ratio, ratio_called = ours_us / rival_us, called_us / rival_called_us
    allowed = ALLOWED[first.mode]
    right = bool(ours and called and ours.right and called.right)
    decisive = ratio if rival else ratio_called
    # without a rival nothing can be lost; nan beside a rival is a missing figure of ours, and lost
    within_limits = not (rival or rival_called) or decisive <= allowed
    return Judged(
        *first.cell, first.mode, allowed, ours_us, rival, rival_us, ratio, placed_us / rival_us, called_us, rival_called,
        rival_called_us, ratio_called, right, right and within_limits,
    )


def _fastest(times: Mapping[str, float]) -> tuple[str, float]:
    """Name and time of the fastest; ("", nan) without any."""
    name = min(times, key=lambda key: times[key], default="")
    return name, times.get(name, np.nan)
