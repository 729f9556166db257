"""Tuned beside default parameters, both in our rig: in which figures are the settings that we chose worse than default?"""

import math
from collections import Counter
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from statistics import median

from reports.deciding.columns import COLUMNS
from reports.deciding.tables import RAW_TRACKER, Block, Cell, Line, engine_of, left_room
from reports.reading.load import EngineNote
from reports.words.metric_words import words
from reports.words.wording import MISSING, count, quantity

DEFAULT, TUNED = "default", "tuned"
"""The two presets of another engine."""
TIMED = "us"
"""The unit of columns that tell time: what is tuned may cost more, and only how much is told."""
BY_KIND = ("Its steps are chosen per kind of scene and not per scene: under Accuracy against time, the list that begins with "
           "\"Beaten\" has the scenes of the sweep in which another setting, such as a coarser step, is as good for less time.")
"""What follows any rule by which settings are tuned."""


@dataclass(frozen=True)
class Figure:
    """One figure of one scene, larger with the tuned settings than with the defaults; as text, and by how many times, infinite
    where the default's is 0; `severity` orders them, and is finite where the figure is."""

    scene: str
    measure: str
    default: str
    tuned: str
    factor: float
    severity: float


@dataclass(frozen=True)
class Tuning:
    """One engine: how many figures both presets have, in how many the tuned one is better, in which it is worse, largest factor
    first; median of its frame time over the default's, nan where neither was timed."""

    engine: str
    compared: int
    better: int
    worse: tuple[Figure, ...]
    times: float


def tunings(shown: Sequence[Block], ours: str) -> tuple[Tuning, ...]:
    """An entry per other engine that ran with both presets."""
    runs = dict.fromkeys(engine_of(line.run) for block in shown for line in block.lines)
    found = (_tuning(engine, shown) for engine in runs if engine not in (RAW_TRACKER, engine_of(ours)))
    return tuple(tuning for tuning in found if tuning.compared)


def _tuning(engine: str, shown: Sequence[Block]) -> Tuning:
    compared, better, worse, times = 0, 0, list[Figure](), list[float]()
    for block, default, tuned in _pairs(engine, shown):
        for column, before, after in zip(COLUMNS, default.cells, tuned.cells, strict=True):
            if column.unit == TIMED:
                if column.key == "p50" and before.value and after.value:
                    times.append(after.value / before.value)
                continue
            # of a run that left the room nothing else is told: neither that it overlaps less for it, nor that it overlaps at all
            aside = column.stays_inside and any(left_room([each.row for each in line.cells]) for line in (default, tuned))
            if aside or not (before.row or before.word) or not (after.row or after.word):
                continue
            compared += 1
            first, second = _worth(before), _worth(after)
            better += first > second + column.same
            if second > first + column.same:
                measure = column.title if column.key != "truth" or block.truth is None else words(block.truth)
                times_as_large = second / first if first > 0.0 else math.inf
                worse.append(Figure(block.scene, measure, _said(before), _said(after), times_as_large,
                                    second / max(first, column.floor)))
    worse.sort(key=lambda figure: -figure.severity)
    return Tuning(engine, compared, better, tuple(worse), median(times) if times else math.nan)


def _pairs(engine: str, shown: Sequence[Block]) -> Iterator[tuple[Block, Line, Line]]:
    for block in shown:
        lines = {line.run: line for line in block.lines}
        if f"{engine}/{DEFAULT}" in lines and f"{engine}/{TUNED}" in lines:
            yield block, lines[f"{engine}/{DEFAULT}"], lines[f"{engine}/{TUNED}"]


def _worth(cell: Cell) -> float:
    """The figure; what is no number is worse than any."""
    return cell.value if cell.value is not None and math.isfinite(cell.value) else math.inf


def _said(cell: Cell) -> str:
    if cell.row is None:
        return cell.word
    return quantity(cell.value, cell.row.unit) if cell.value is not None else cell.row.note or cell.word or MISSING


def sentence(tuning: Tuning) -> str:
    """What to conclude of one engine, losses first."""
    said = f"{tuning.engine}: tuned is worse than default in {len(tuning.worse)} of {count(tuning.compared, 'figure')}"
    if tuning.worse:
        (measure, most), = Counter(figure.measure for figure in tuning.worse).most_common(1)
        said += f" ({most} of them {measure})"
    said += f" and better in {tuning.better}"
    return said + ("." if math.isnan(tuning.times) else f"; its median frame takes {tuning.times:.3g} times as long.")


def aims(notes: Iterable[EngineNote], engine: str) -> str:
    """What the tuned settings of an engine optimise and what is better in something else, as it said; "" if it did not."""
    said = next((note.settings for note in notes if note.run == f"{engine}/{TUNED}"), {})
    optimises, better = said.get("optimises"), said.get("better elsewhere")
    parts = [f"{engine}/{TUNED} optimises {optimises[0]}. {BY_KIND}"] if optimises else []
    return " ".join([*parts, f"Better in something else: {better[0]}."] if better else parts)
