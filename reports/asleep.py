"""Which engines sleep in the frame that a time is of? Such a time says how much rests, and no factor is made of it.

What rests sleeps in our engine by itself, in the others where a setting tells them to. From half of the frames on it does so
in the median frame, from 95 % on in that of the 95th percentile.
"""

from collections.abc import Mapping
from types import MappingProxyType

from reports.load import Results
from scenarios.sweep.grid import STEPLESS

RESTING = "resting_frames"
"""Metric: share [%] of the timed frames in which nothing moves."""
SHARES: Mapping[str, float] = MappingProxyType({"p50": 50.0, "p95": 95.0})
"""Column of a time -> share of resting frames [%] from which on it is the time of a frame at rest."""


def sleepers(results: Results) -> Mapping[str, Mapping[str, float]]:
    """Scene -> engine and preset that sleeps when all rests -> share of resting frames [%], the largest of its seeds."""
    told = {(note.scenario, note.run) for note in results.engines if note.settings.get("sleep", ("", ""))[0] == "true"}
    found: dict[str, dict[str, float]] = {}
    for row in results.rows:
        sleeps = row.engine in STEPLESS or (row.scenario, row.run) in told
        if row.metric == RESTING and row.value is not None and sleeps:
            own = found.setdefault(row.scenario, {})
            own[row.run] = max(own.get(row.run, 0.0), row.value)
    return found


def asleep(sleeping: Mapping[str, float], column: str) -> tuple[str, ...]:
    """Those of the `sleeping` runs of one scene that sleep in the frame which a column of times stands for."""
    share = SHARES.get(column)
    return () if share is None else tuple(run for run, rests in sleeping.items() if rests >= share)
