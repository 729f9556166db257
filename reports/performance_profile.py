"""Performance profiles (Dolan and More, Math. Program. 91, 2002): share of scenes solved within a factor of the fastest."""

import math
from collections.abc import Mapping

from reports.cheapest import Block, Table
from reports.wording import count, limit, listed
from scenarios.sweep.accuracy import LEVELS

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
        factors = sorted(time / best[scene] for scene, time in own.items() if time > 0.0)
        corners = {1.0: 0.0}
        for k, factor in enumerate(factors):
            corners[factor] = (k + 1) / len(scenes)
        found[engine] = tuple(corners.items())
    return found


def profiles(table: Table, level: float) -> dict[str, Steps]:
    """The profile of every engine at an accuracy [m], one of LEVELS, each scene with the cheapest setting of the engine there; a
    scene whose errors one of them cannot say is left out."""
    index = LEVELS.index(level)
    times = {block.scenario: alike(block, index) for block in table.compared}
    return profile({engine: {scene: own.get(engine, math.nan) for scene, own in times.items()} for engine in table.engines})


def alike(block: Block, level: int) -> dict[str, float]:
    """engine -> time [us] of its cheapest setting at the level with that index, the same for all: the median of frames in motion
    where all tell them apart, the 95th percentile where one sleeps in its median frame and another does not, else the median."""
    chosen = {line.engine: line.cells[level].attempt for line in block.lines}
    points = {engine: attempt.any_point for engine, attempt in chosen.items() if attempt is not None}
    if points and all(point.moving == point.moving for point in points.values()):
        return {engine: point.moving for engine, point in points.items()}
    if len({point.is_asleep for point in points.values()}) > 1:
        return {engine: point.p95 for engine, point in points.items()}
    return {engine: point.p50 for engine, point in points.items()}


def share_at(steps: Steps, factor: float) -> float:
    """The share of scenes that is solved within `factor` of the fastest."""
    return max((share for at, share in steps if at <= factor), default=0.0)


def sentence(found: Mapping[str, Steps], level: float, scenes: int) -> str:
    """Which engine is fastest how often and solves how much, the engine with most solved scenes first."""
    order = sorted(found, key=lambda engine: (-found[engine][-1][1], -share_at(found[engine], 1.0)))
    said = tuple(
        f"{engine} {round(found[engine][-1][1] * scenes)} (fastest in {round(share_at(found[engine], 1.0) * scenes)})"
        for engine in order
    )
    return f"Of {count(scenes, 'scene')}, {limit(level, 'm')} is reached by a setting measured in: {listed(said, len(said))}."
