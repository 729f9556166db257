"""In which ranked metrics of which scenes is another engine ahead of ours? Page and terminal ask here, by one rule.

Of the engines that are ranked (never the raw tracker, never another preset of our engine) the smallest finite value is best;
values that differ by no more than the registry's `same` are level; an engine that left the allowed side of a scene is passed
over in metrics that could be won by leaving; one that has no words for what a metric measures is not ranked by it. Sentences
count families: a family is a scene with its variants. Figures of a world of another size are compared as if it had size 1.
"""

import math
from collections import defaultdict
from collections.abc import Container, Iterable, Mapping
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import Protocol

from runfiles.like_for_like import TIME, Measured, asleep, sleepers, with_avatar
from runfiles.naming import BASELINE
from runfiles.ranked import RANKED, Ranked
from runfiles.sayable import Unsaid
from runfiles.timing_protocol import TAIL_FRAMES, may_rank

BEST = (
    "Best is the smallest finite value among ours and the other engines; neither the raw tracker nor another preset of our "
    "engine is ranked. Values that differ by no more than the resolution of their metric are level, times within 10 %. An "
    "engine that left the allowed side of a scene is passed over in the metrics that could be won by leaving. What an engine "
    "has no words for (under Settings: cannot say) is not ranked for it, neither for it nor against it. Times of scenes with an "
    "avatar stand side by side, without factor, rank or best: ours is kinematic, theirs has dynamics. Nor is a time ranked "
    "where what rests sleeps, in ours or another engine, in the frame that it is of, nor a 95th or 99th percentile or a slowest "
    f"frame of one repeat or of fewer than {TAIL_FRAMES} frames; medians are."
)
"""The rule in words, printed beside every table that names a best."""
POWERS: Mapping[str, int] = MappingProxyType({"m": 1, "m/s": 1, "J": 2})
"""Unit -> power of a world's size with which figures in it grow, where lengths, speeds and gravity grow with the size and times
and masses stay (`scenarios.stability.elsewhere`). What has another unit does not grow."""


class Figure(Measured, Protocol):
    """A row of results with its seed and unit, and a note that says of a time how it was taken."""

    @property
    def seed(self) -> int: ...
    @property
    def unit(self) -> str: ...
    @property
    def note(self) -> str: ...


@dataclass(frozen=True)
class Behind:
    """One metric of one scene in which `rivals` (run, value) beat our row, whose `value` stands here, all at size 1; `factor` is
    ours over theirs, infinite where theirs is 0 or ours is no number; `severity` is finite where ours is: it orders losses."""

    row: Figure
    value: float | None
    rivals: tuple[tuple[str, float], ...]
    factor: float
    severity: float

    @property
    def best(self) -> float:
        """The value that the rivals have."""
        return self.rivals[0][1]


@dataclass(frozen=True)
class Compared:
    """What was ranked: `pairs` of (scene, metric) in which ours and another engine stand, and those of them in which we are
    behind, each in the seed in which we are furthest behind; `silent`: engine and preset -> pairs that do not judge it, because
    it has no words for what they measure; `beside`: pairs of frame times of scenes with an avatar, which rank nothing, and
    whether another engine takes less time there; `asleep`: those of frames in which what rests sleeps in some engine;
    `few`: those of too few frames or repeats to rank, and whether another engine takes less time there."""

    pairs: frozenset[tuple[str, str]]
    behind: tuple[Behind, ...]
    silent: Mapping[str, frozenset[tuple[str, str]]] = field(default_factory=dict)
    beside: Mapping[tuple[str, str], bool] = field(default_factory=dict)
    asleep: frozenset[tuple[str, str]] = frozenset()
    few: Mapping[tuple[str, str], bool] = field(default_factory=dict)


def at_size_1(value: float | None, unit: str, scale: float) -> float | None:
    """A figure of a world of another size as if it had size 1."""
    return None if value is None else value / scale ** POWERS.get(unit, 0)


def at_size(value: float | None, unit: str, scale: float) -> float | None:
    """A figure at size 1 as a world of size `scale` shows it."""
    return None if value is None else value * scale ** POWERS.get(unit, 0)


def compared(
    rows: Iterable[Figure], ours: str, unsaid: Unsaid | None = None, scales: Mapping[str, float] = MappingProxyType({}),
    told: Container[tuple[str, str]] | None = None,
) -> Compared:
    """Every ranked metric of every scene, ours against the other engines. `unsaid`: what engines have no words for; `scales`:
    scene -> size of its world, where that is not 1; `told`: (scene, run) of those that a setting tells to sleep,
    None where settings are not known."""
    rows = tuple(rows)
    avatars, sleeping = with_avatar(rows), sleepers(rows, told)
    beside: dict[tuple[str, str], bool] = {}
    few: dict[tuple[str, str], bool] = {}
    resting: set[tuple[str, str]] = set()
    grouped: dict[tuple[str, int], list[Figure]] = defaultdict(list)
    for row in rows:
        grouped[row.scenario, row.seed].append(row)
    silent: dict[str, set[tuple[str, str]]] = defaultdict(set)
    furthest: dict[tuple[str, str], Behind] = {}
    pairs: set[tuple[str, str]] = set()
    for (scene, _), own in grouped.items():
        left = {row.run for row in own if row.metric == "wrong_side_frames" and row.value is not None and not row.value <= 0.0}
        by_metric: dict[str, list[Figure]] = defaultdict(list)
        for row in own:
            if row.metric in RANKED:
                by_metric[row.metric].append(row)
        for metric, candidates in by_metric.items():
            mine = next((row for row in candidates if row.run == ours), None)
            key, theirs = (scene, metric), rivals(candidates, ours)
            for run in [run for run in theirs if unsaid is not None and unsaid.why(scene, run, metric)]:
                silent[run].add(key)
                del theirs[run]
            if mine is None or not theirs or (mine.value is None and RANKED[metric].may_lack):
                continue
            found = _behind(mine, theirs, RANKED[metric], left, scales.get(scene, 1.0))
            if metric.startswith(TIME) and scene in avatars:
                beside[key] = beside.get(key, False) or found is not None
                continue
            if metric.startswith(TIME) and asleep(sleeping.get(scene, {}), metric.removeprefix(TIME)):
                resting.add(key)
                continue
            thin = {row.run for row in candidates if not may_rank(metric, row.note)}
            if ours in thin or thin.issuperset(theirs):
                few[key] = few.get(key, False) or found is not None
                continue
            if thin:
                theirs = {run: value for run, value in theirs.items() if run not in thin}
                found = _behind(mine, theirs, RANKED[metric], left, scales.get(scene, 1.0))
            pairs.add(key)
            if found is not None and (key not in furthest or furthest[key].severity < found.severity):
                furthest[key] = found
    quiet = {run: frozenset(keys) for run, keys in silent.items()}
    return Compared(frozenset(pairs), tuple(furthest.values()), quiet, beside, frozenset(resting), few)


def rivals(rows: Iterable[Figure], ours: str) -> dict[str, float]:
    """Values of the other engines by run; neither the raw tracker nor another preset of our engine is one."""
    aside = {BASELINE, _engine(ours)}
    return {row.run: row.value for row in rows if _engine(row.run) not in aside and row.value is not None}


def _behind(row: Figure, measured: Mapping[str, float], rule: Ranked, left: set[str], scale: float) -> Behind | None:
    """How far `row` is behind the best of those `measured`, all at size 1; None if it is level or better. `left` are runs that
    left the scene, which are passed over where that could win; `scale` the size of its world."""
    own, power = at_size_1(row.value, row.unit, scale), scale ** POWERS.get(row.unit, 0)
    theirs = {run: value / power for run, value in measured.items()}
    # a figure that ours has not got, or that is no number, is worse than any
    mine = own if own is not None and math.isfinite(own) else math.inf
    ahead = {run: value for run, value in theirs.items() if rule.less(value, mine) and not (rule.stays_inside and run in left)}
    if not ahead:
        return None
    least = min(ahead.values())
    best = tuple((run, value) for run, value in ahead.items() if value == least)
    base = max(least, rule.same)
    factor, severity = mine / least if least > 0.0 else math.inf, mine / base if base > 0.0 else math.inf
    return Behind(row, own, best, factor, severity)


def _size(one: Behind) -> float:
    """Our figure; what is no number is larger than any."""
    return one.value if one.value is not None and math.isfinite(one.value) else math.inf


def _engine(run: str) -> str:
    """The engine of "engine/preset"."""
    return run.partition("/")[0]


@dataclass(frozen=True)
class Lost:
    """One metric in which ours is behind in a family: in how many of its scenes that were ranked, and the worst of them."""

    family: str
    worst: Behind
    scenes: int
    of: int


@dataclass(frozen=True)
class MetricLosses:
    """One ranked metric: in how many families it was ranked, where ours is behind, the largest factor first, and of these figures
    of ours the `largest`, which need not have the largest factor; None where ours is behind nowhere."""

    metric: str
    families: int
    lost: tuple[Lost, ...]
    largest: Behind | None = None

    @property
    def said(self) -> str:
        """"3 of 41 families"."""
        return f"{len(self.lost)} of {self.families} {'family' if self.families == 1 else 'families'}"


def by_family(found: Compared, family_of: Mapping[str, str]) -> tuple[MetricLosses, ...]:
    """An entry per metric that was ranked anywhere, in the registry's order; scenes without a family are their own."""
    behind: dict[tuple[str, str], list[Behind]] = defaultdict(list)
    for one in found.behind:
        behind[one.row.metric, family_of.get(one.row.scenario, one.row.scenario)].append(one)
    sizes: dict[str, dict[str, int]] = defaultdict(lambda: defaultdict(int))
    for scene, metric in found.pairs:
        sizes[metric][family_of.get(scene, scene)] += 1
    made = []
    for metric in (name for name in RANKED if name in sizes):
        lost = [
            Lost(family, max(own, key=lambda one: one.severity), len(own), size)
            for family, size in sorted(sizes[metric].items()) if (own := behind.get((metric, family)))
        ]
        lost.sort(key=lambda one: -one.worst.severity)
        all_lost = [one for family in sizes[metric] for one in behind.get((metric, family), ())]
        made.append(MetricLosses(metric, len(sizes[metric]), tuple(lost), max(all_lost, key=_size, default=None)))
    return tuple(made)


@dataclass(frozen=True)
class Aside:
    """One frame time that ranks nothing in some families: in so many with an avatar, in `less` of which another engine takes less
    time; in so many in which what rests sleeps in its frame; and in so many of too few frames or repeats, in `less_of_few` of
    which another engine takes less time."""

    avatar: int
    less: int
    asleep: int
    few: int
    less_of_few: int


def aside(found: Compared, family_of: Mapping[str, str], metric: str) -> Aside:
    """What is set aside of one frame time, counted in families."""
    def families(scenes: Iterable[str]) -> int:
        return len({family_of.get(scene, scene) for scene in scenes})

    here = {scene: less for (scene, name), less in found.beside.items() if name == metric}
    return Aside(families(here), families(scene for scene, less in here.items() if less),
                 families(scene for scene, name in found.asleep if name == metric),
                 families(scene for scene, name in found.few if name == metric),
                 families(scene for (scene, name), less in found.few.items() if name == metric and less))
