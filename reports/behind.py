"""Where another engine is ahead of ours: the terminal's rule, applied to rows, so that page and terminal name the same losses."""

import math
from collections import defaultdict
from collections.abc import Iterable
from dataclasses import dataclass

from reports.columns import COLUMNS, truth_metric
from reports.load import Row
from reports.tables import RAW_TRACKER, engine_of

# Measures without a column that are ranked all the same, with the difference below which two values are equal: the terminal
# ranks both, and a restitution error need not be the one truth that a scene's column shows.
UNSEEN = {"still_frames": 0.5, "restitution_error_max": 1e-4}


@dataclass(frozen=True)
class Behind:
    """One measure of one scene in which `rivals` (run, value) beat our row; `factor` is ours over theirs, infinite where ours
    is no number. `outside` if every rival ahead of us left the allowed side of the scene."""

    row: Row
    rivals: tuple[tuple[str, float], ...]
    factor: float
    outside: bool


def behind(rows: Iterable[Row], ours: str) -> tuple[Behind, ...]:
    """Each scene and measure in which we are behind, in the seed in which we are furthest behind."""
    grouped: dict[tuple[str, int], list[Row]] = defaultdict(list)
    for row in rows:
        grouped[row.scenario, row.seed].append(row)
    furthest: dict[tuple[str, str], Behind] = {}
    for (scene, _), own in grouped.items():
        for found in _behind(own, ours):
            key = (scene, found.row.metric)
            if key not in furthest or furthest[key].factor < found.factor:
                furthest[key] = found
    return tuple(furthest.values())


def _behind(rows: list[Row], ours: str) -> list[Behind]:
    """The same for the rows of one scene and seed."""
    left = {row.run for row in rows if row.metric == "wrong_side_frames" and row.value is not None and not row.value <= 0.0}
    aside = {RAW_TRACKER, engine_of(ours)}
    found = []
    for row in (row for row in rows if row.run == ours):
        ranked = _ranked(row.metric, rows)
        if ranked is None:
            continue
        same, floor, stays_inside = ranked
        # a figure that ours has not got, or that is no number, is worse than any
        mine = row.value if row.value is not None and math.isfinite(row.value) else math.inf
        ahead = {r.run: r.value for r in rows if r.metric == row.metric and engine_of(r.run) not in aside
                 and r.value is not None and r.value < mine - same}
        inside = {run: value for run, value in ahead.items() if not (stays_inside and run in left)}
        if ahead:
            least = min((inside or ahead).values())
            rivals = tuple((run, value) for run, value in (inside or ahead).items() if value == least)
            base = max(least, floor)
            found.append(Behind(row, rivals, mine / base if base > 0.0 else math.inf, not inside))
    return found


def _ranked(metric: str, rows: list[Row]) -> tuple[float, float, bool] | None:
    """(difference that counts as none, floor of ratios, whether leaving the room disqualifies); None if not ranked."""
    for column in COLUMNS:
        if column.takes(metric) and (column.key != "truth" or metric == truth_metric(rows)):
            return column.same, column.floor, column.stays_inside
    return (UNSEEN[metric], UNSEEN[metric], False) if metric in UNSEEN else None
