"""Which frame times rank engines: none of a scene with an avatar, and none of a frame in which what rests sleeps.

Our avatar is kinematic and that of other engines has dynamics, so that their times stand side by side. What rests sleeps in our
engine by itself, in the others where a setting tells them to; a time of such a frame says how much rests. From half of the frames
on this is the median frame, from 95 % on that of the 95th percentile, from 99 % on that of the 99th.
"""

from collections.abc import Container, Iterable, Mapping
from types import MappingProxyType
from typing import Protocol

from runfiles.naming import SLEEPS_UNASKED

AVATAR = "tracker_offset_rms"
"""A metric that every scene with an avatar has, and no other."""
RESTING = "resting_frames"
"""Metric: share [%] of the timed frames in which nothing moves."""
TIME = "frame_time_"
"""How the names of all frame times begin."""
SLEEPING = "sleeping"
"""Preset that is told to sleep."""
SHARES: Mapping[str, float] = MappingProxyType({"p50": 50.0, "p95": 95.0, "p99": 99.0})
"""What a time is called after TIME -> share of resting frames [%] from which on it is the time of a frame at rest."""


class Measured(Protocol):
    """A row of results, fresh or read from a file."""

    @property
    def scenario(self) -> str: ...
    @property
    def run(self) -> str: ...
    @property
    def metric(self) -> str: ...
    @property
    def value(self) -> float | None: ...


def with_avatar(rows: Iterable[Measured]) -> frozenset[str]:
    """Names of the scenes that have an avatar."""
    return frozenset(row.scenario for row in rows if row.metric == AVATAR)


def sleepers(rows: Iterable[Measured], told: Container[tuple[str, str]] | None = None) -> Mapping[str, Mapping[str, float]]:
    """Scene -> engine and preset that sleeps when all rests -> share of resting frames [%], the largest of its seeds. `told`:
    (scene, run) of those that a setting tells to sleep; where settings are not known, the preset of that name is."""
    found: dict[str, dict[str, float]] = {}
    for row in rows:
        engine, _, preset = row.run.partition("/")
        sleeps = engine in SLEEPS_UNASKED or (preset == SLEEPING if told is None else (row.scenario, row.run) in told)
        if row.metric == RESTING and row.value is not None and sleeps:
            own = found.setdefault(row.scenario, {})
            own[row.run] = max(own.get(row.run, 0.0), row.value)
    return found


def asleep(sleeping: Mapping[str, float], time: str) -> tuple[str, ...]:
    """Those of the `sleeping` runs of one scene that sleep in the frame which a time, a key of SHARES, is of."""
    share = SHARES.get(time)
    return () if share is None else tuple(run for run, rests in sleeping.items() if rests >= share)
