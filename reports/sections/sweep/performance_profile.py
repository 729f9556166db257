"""Performance profiles (Dolan and More, Math. Program. 91, 2002): share of scenes solved within a factor of the fastest."""

import math
from collections.abc import Mapping

from reports.deciding.alike import level as level_times
from reports.sections.sweep.cheapest import Table
from reports.words.wording import count, limit, listed
from runfiles.accuracy import LEVELS

Steps = tuple[tuple[float, float], ...]
"""Corners (factor, share) of a staircase that rises from left to right: from this factor on, the share is so large."""


def profile(times: Mapping[str, Mapping[str, float]]) -> dict[str, Steps]:
    """engine -> scene -> time, nan or absent where it does not solve the scene; any unit. The first corner of each engine is at
    factor 1. A scene that no engine solves counts as unsolved for all."""
    scenes = {scene for own in times.values() for scene in own}
    best = {scene: min((own[scene] for own in times.values() if own.get(scene, math.nan) > 0.0), default=math.nan)
            for scene in scenes}
    found = {}
    for engine, own in times.items():
        factors = sorted(_over(time, best[scene]) for scene, time in own.items() if time > 0.0)
        corners = {1.0: 0.0}
        for k, factor in enumerate(factors):
            corners[factor] = (k + 1) / len(scenes)
        found[engine] = tuple(corners.items())
    return found


def _over(time: float, best: float) -> float:
    """The factor to the fastest; 1 where the two are level."""
    return 1.0 if level_times(time, best) else time / best


def profiles(table: Table, level: float) -> dict[str, Steps]:
    """The profile of every engine at an accuracy [m], one of LEVELS, each scene with the cheapest setting of the engine there; a
    scene whose errors one of them cannot say is left out, and so is one with an avatar. Times are those by which the scene
    compares: the same that make a figure bold and a case lost."""
    index = LEVELS.index(level)
    return profile({
        engine: {block.scenario: block.time(engine, index) for block in table.compared} for engine in table.engines
    })


def share_at(steps: Steps, factor: float) -> float:
    """The share of scenes that is solved within `factor` of the fastest."""
    return max((share for at, share in steps if at <= factor), default=0.0)


def sentence(found: Mapping[str, Steps], level: float, scenes: int, unsaid: Mapping[str, int] | None = None) -> str:
    """Which engine is fastest how often and solves how much, the engine with most solved scenes first; `unsaid`: engine -> in how
    many scenes that it does not solve a finer step that might was not measured."""
    order = sorted(found, key=lambda engine: (-found[engine][-1][1], -share_at(found[engine], 1.0)))
    said = tuple(
        f"{engine} {round(found[engine][-1][1] * scenes)} (fastest in {round(share_at(found[engine], 1.0) * scenes)})"
        for engine in order
    )
    missing = tuple(f"{engine} in {number}" for engine, number in (unsaid or {}).items())
    rest = f" Not said, as steps that might reach it were not measured: {listed(missing, len(missing))}." if missing else ""
    return (f"Of {count(scenes, 'scene')} without an avatar, {limit(level, 'm')} is reached by a setting measured in: "
            f"{listed(said, len(said))}.{rest}")
