"""The cheapest setting of every engine that reaches an accuracy, scene by scene: what a frame costs, and the options to copy."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

from reports.sweep import OURS, Point, Sweep
from reports.wording import count, limit, listed, quantity, ratio

LEVELS = (1e-2, 1e-3, 1e-4, 1e-6)
"""Accuracies that are asked for [m]."""
PROFILED = (1e-3, 1e-6)
"""Those of them that have a performance profile."""
RELATIVE: Mapping[str, float] = {"stop_distance_error_max": 0.01}
"""Errors that are a share of a way, and the length [m] of one of their units if that way is a metre: 1 % counts as 10 mm."""
NOISE = 0.03
"""Share by which medians of the same frames differ from one process to the next: nearer times of an engine are not told apart,
and the simplest of such settings is named. Smaller, and the name changes from run to run."""
FOLLOWING = ("tracker_offset_rms", "tracker_offset_rms_free")
"""How far a posture is from its user's says how an engine follows, not how accurate it is: it stands beside the cell."""


def length(point: Point) -> float:
    """The error as a length [m], for a metric that `counts`; nan where the setting has no accuracy."""
    if point.state != "measured":
        return math.nan
    return point.error * RELATIVE.get(point.metric, 1.0)


def counts(metric: str, unit: str) -> bool:
    """Whether an error can be compared with a length."""
    return metric in RELATIVE or (unit == "m" and metric not in FOLLOWING)


@dataclass(frozen=True)
class Attempt:
    """One setting in one scene: the largest of its errors [m], its median frame time [us], its offset from the tracker [m]; nan
    where there is none. `any_point` is one of its points."""

    any_point: Point
    error: float
    p50: float
    offset: float

    @property
    def measured(self) -> bool:
        """Whether it has both an accuracy and a time."""
        return math.isfinite(self.error) and math.isfinite(self.p50) and self.p50 > 0.0

    def reaches(self, level: float) -> bool:
        """Whether every error is at most `level` [m]; never for what was not measured."""
        return self.measured and self.error <= level


def attempts(points: Sequence[Point]) -> tuple[Attempt, ...]:
    """One entry per scene and setting that has an error which is a length; an error that is missing spoils the others."""
    groups: dict[tuple[str, str], list[Point]] = {}
    for point in points:
        groups.setdefault((point.scenario, point.run), []).append(point)
    found = []
    for group in groups.values():
        lengths = [length(point) for point in group if counts(point.metric, point.unit)]
        if lengths:
            worst = math.nan if any(math.isnan(value) for value in lengths) else max(lengths)
            offset = next((p.error for p in group if p.metric in FOLLOWING and p.state == "measured"), math.nan)
            found.append(Attempt(group[0], worst, group[0].p50, offset))
    return tuple(found)


def cheapest(tried: Sequence[Attempt], level: float) -> Attempt | None:
    """The fastest that reaches `level` [m]; of those within NOISE of it a preset before what was turned, then the more accurate,
    then the first by name. Errors below the finest of LEVELS are not told apart either."""
    able = [attempt for attempt in tried if attempt.reaches(level)]
    least = min((attempt.p50 for attempt in able), default=math.nan)
    near = [attempt for attempt in able if attempt.p50 <= (1.0 + NOISE) * least]
    return min(near, key=lambda a: (not a.any_point.is_preset, max(a.error, LEVELS[-1]), a.any_point.setting), default=None)


@dataclass(frozen=True)
class Cell:
    """The cheapest setting of one engine at one accuracy; `factor`: its time over that of the fastest engine, nan if none."""

    attempt: Attempt | None
    factor: float


@dataclass(frozen=True)
class Line:
    """One engine in one scene: a cell per level; `tried` settings were measured, the least error among them is `least` [m]."""

    engine: str
    cells: tuple[Cell, ...]
    tried: int
    least: float


@dataclass(frozen=True)
class Block:
    """One scene with the errors that count in it, a line per engine."""

    scenario: str
    metrics: tuple[str, ...]
    lines: tuple[Line, ...]

    def time(self, engine: str, level: int) -> float:
        """Time [us] of an engine's cheapest setting at the level with that index; nan where it reaches it with none."""
        for line in self.lines:
            if line.engine == engine and (attempt := line.cells[level].attempt) is not None:
                return attempt.p50
        return math.nan


@dataclass(frozen=True)
class Table:
    """All scenes of a sweep that have an error which is a length."""

    blocks: tuple[Block, ...]
    engines: tuple[str, ...]

    @cached_property
    def pairs(self) -> tuple[tuple[Block, int, float, str, float], ...]:
        """(block, level, our time, fastest rival, its time) of every scene and level; nan and "" where nothing reaches it."""
        found = []
        for block in self.blocks:
            for level in range(len(LEVELS)):
                rivals = [(block.time(engine, level), engine) for engine in self.engines if engine != OURS[0]]
                best = min((entry for entry in rivals if entry[0] == entry[0]), default=(math.nan, ""))
                found.append((block, level, block.time(OURS[0], level), best[1], best[0]))
        return tuple(found)

    @property
    def lost(self) -> tuple[tuple[Block, int, float, str, float], ...]:
        """Pairs in which a rival is cheaper, or reaches what ours does not."""
        return tuple(pair for pair in self.pairs if pair[4] == pair[4] and not pair[2] <= pair[4])


def table(sweep: Sweep) -> Table:
    """The table of a sweep: scenes in the order of the file."""
    tried = attempts(sweep.points)
    blocks = []
    for scenario in dict.fromkeys(attempt.any_point.scenario for attempt in tried):
        here = [attempt for attempt in tried if attempt.any_point.scenario == scenario]
        metrics = dict.fromkeys(p.metric for p in sweep.points if p.scenario == scenario and counts(p.metric, p.unit))
        own = {engine: [a for a in here if a.any_point.engine == engine] for engine in sweep.engines}
        named = {level: [found for mine in own.values() if (found := cheapest(mine, level))] for level in LEVELS}
        best = [min((attempt.p50 for attempt in named[level]), default=math.nan) for level in LEVELS]
        blocks.append(Block(scenario, tuple(metrics), tuple(_line(engine, own[engine], best) for engine in own if own[engine])))
    return Table(tuple(blocks), sweep.engines)


def _line(engine: str, tried: Sequence[Attempt], best: Sequence[float]) -> Line:
    cells = []
    for level, least in zip(LEVELS, best, strict=True):
        found = cheapest(tried, level)
        cells.append(Cell(found, math.nan if found is None else found.p50 / least))
    measured = [attempt.error for attempt in tried if attempt.measured]
    return Line(engine, tuple(cells), len(measured), min(measured, default=math.nan))


def sentence(found: Table) -> str:
    """Where a rival is cheaper than ours first, then where neither or only ours reaches, then by how much ours is cheaper."""
    if not found.blocks:
        return "No error of this sweep is a length: there is no cheapest setting to name."
    parts, lost = [], found.lost
    total = len(found.pairs)
    if lost:
        said = tuple(
            f"{block.scenario} at {limit(LEVELS[level], 'm')} ({engine} {quantity(time, 'us')}, ours "
            f"{quantity(ours, 'us') if ours == ours else 'does not reach it'})" for block, level, ours, engine, time in lost
        )
        parts.append(f"A rival is cheaper than ours in {len(lost)} of {count(total, 'case')} (scene × accuracy): {listed(said)}.")
    else:
        parts.append(f"In none of {count(total, 'case')} (scene × accuracy) is any setting of a rival cheaper than all of ours.")
    neither = [pair for pair in found.pairs if pair[2] != pair[2] and pair[4] != pair[4]]
    if neither:
        said = tuple(f"{block.scenario} at {limit(LEVELS[level], 'm')}" for block, level, *_ in neither)
        parts.append(f"No setting of any engine reaches {listed(said)}.")
    alone = [pair for pair in found.pairs if pair[2] == pair[2] and pair[4] != pair[4]]
    if alone:
        parts.append(f"Only ours reaches the accuracy in {count(len(alone), 'case')}.")
    won = [(pair[4] / pair[2], pair) for pair in found.pairs if pair[2] <= pair[4]]
    if won:
        (low, near), (high, far) = min(won, key=lambda e: e[0]), max(won, key=lambda e: e[0])
        parts.append(
            f"Where both reach it, the cheapest rival takes {ratio(low) if low > 1.0 else 'as long'} ({_where(near)}) to "
            f"{ratio(high)} ({_where(far)}) of our time."
        )
    return " ".join(parts)


def _where(pair: tuple[Block, int, float, str, float]) -> str:
    return f"{pair[0].scenario} at {limit(LEVELS[pair[1]], 'm')}, {pair[3]}"


def at_level(block: Block, level: float, engines: Sequence[str]) -> str:
    """One sentence: the time of every engine's cheapest setting at `level` [m], fastest first, and which engines have none."""
    index = LEVELS.index(level)
    lines = sorted(block.lines, key=lambda line: (math.isnan(block.time(line.engine, index)), block.time(line.engine, index)))
    said = []
    for line in (line for line in lines if line.engine in engines):
        attempt = line.cells[index].attempt
        if attempt is not None:
            said.append(f"{line.engine} {quantity(attempt.p50, 'us')} ({attempt.any_point.setting})")
        else:
            least = "nothing measured" if math.isnan(line.least) else f"at best {quantity(line.least, 'm')}"
            said.append(f"{line.engine} not ({least})")
    return f"At most {limit(level, 'm')}: {', '.join(said)}."
