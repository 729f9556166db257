"""Which times of engines are compared, like for like: one rule for sentence, bold figure, factor and performance profile."""

import math
from collections.abc import Iterable, Mapping
from enum import Enum
from typing import Protocol

from reports.reading.load import Results
from runfiles import like_for_like
from runfiles.like_for_like import RESTING, SHARES, asleep
from runfiles.ranked import TIME

LEVEL = TIME
"""Share by which times may differ and count as level: medians of the same frames in two processes differ by up to 3 %, those
of two runs by up to 10 %. Larger hides a difference that comes back in every run; smaller ranks the weather of a machine."""


class Point(Protocol):
    """Times [us] of one setting in one scene: median, 95th percentile (of few frames the slowest), median of frames in
    motion (nan where these are not told from frames at rest); whether what rests sleeps in its median frame, and in that of its
    tail; whether the scene
    has an avatar."""

    @property
    def p50(self) -> float: ...
    @property
    def tail(self) -> float: ...
    @property
    def moving(self) -> float: ...
    @property
    def slowest(self) -> float: ...
    @property
    def is_asleep(self) -> bool: ...
    @property
    def sleeps_through(self) -> bool: ...
    @property
    def avatar(self) -> bool: ...


class Basis(Enum):
    """Which time of a frame is compared in a scene."""

    MEDIAN = "the median of all frames"
    MOVING = "the median of frames in motion"
    TAIL = ("the 95th percentile (of fewer than 200 frames the slowest), a frame in motion: in the median frame what rests "
            "sleeps in one engine at least")
    SLOWEST = ("the slowest frame: in 95 of 100 frames what rests sleeps in one engine at least, so that no percentile is of a "
               "frame in motion")


def basis_of(points: Iterable[Point]) -> Basis:
    """The time that all `points` of one scene are compared by: of frames in motion where all tell them from frames at rest, the
    95th percentile where any sleeps in its median frame, the slowest where any sleeps in that percentile too, else the median."""
    timed = [point for point in points if point.p50 > 0.0]
    if timed and all(point.moving == point.moving for point in timed):
        return Basis.MOVING
    if timed and any(point.sleeps_through for point in timed) and all(point.slowest == point.slowest for point in timed):
        return Basis.SLOWEST
    return Basis.TAIL if any(point.is_asleep for point in timed) else Basis.MEDIAN


def time_by(point: Point, basis: Basis) -> float:
    """That time [us]; nan where the point has none."""
    return {Basis.MEDIAN: point.p50, Basis.MOVING: point.moving, Basis.TAIL: point.tail,
            Basis.SLOWEST: point.slowest}[basis]


def level(one: float, other: float) -> bool:
    """Whether two times count as equal; never where one is missing."""
    return abs(one - other) <= LEVEL * min(one, other)


def is_more(one: float, other: float) -> bool:
    """Whether the first of two times is the larger, and not level; never where one is missing."""
    return one > other and not level(one, other)


def factor(point: Point, base: Point, basis: Basis) -> float:
    """How many times the time of `base` a frame of `point` takes; nan where there is an avatar, or where one of the two sleeps in
    the median frame and frames in motion have no median of their own."""
    if point.avatar or base.avatar or basis in (Basis.TAIL, Basis.SLOWEST):
        return math.nan
    of = time_by(base, basis)
    return time_by(point, basis) / of if of > 0.0 else math.nan


__all__ = ["RESTING", "SHARES", "asleep", "sleepers", "told"]


def told(results: Results) -> frozenset[tuple[str, str]]:
    """(scene, engine and preset) of those that a setting tells to sleep."""
    return frozenset((note.scenario, note.run) for note in results.engines if note.settings.get("sleep", ("", ""))[0] == "true")


def sleepers(results: Results) -> Mapping[str, Mapping[str, float]]:
    """Scene -> engine and preset that sleeps when all rests -> share of resting frames [%], the largest of its seeds."""
    return like_for_like.sleepers(results.rows, told(results))
