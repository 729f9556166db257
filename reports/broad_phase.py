"""Sweep and prune in the report: reads what its benchmark left in the run's folder, draws it and puts it in words."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from reports.files import lines
from reports.wording import MOST_FACTOR, count, factor, figures, listed

ROWS = "broad_phase.csv"
OURS = "sweep and prune"
FAST = "all fast"
"""The motion for which nothing is claimed: every object leaves its place every few frames."""
FLAT = 2.0
"""Largest figure per object over the smallest, up to which growth is called flat."""


@dataclass(frozen=True)
class Point:
    """Time [us] and memory [bytes] per object at one number of objects; `right` if the pairs were those of trying all."""

    objects: int
    us: float
    held: float
    right: bool


@dataclass(frozen=True)
class Line:
    """One kernel in one layout and motion, by number of objects."""

    layout: str
    motion: str
    kernel: str
    points: tuple[Point, ...]

    @property
    def name(self) -> str:
        """What it is called in a sentence."""
        return f"{self.layout}, {self.motion}"

    @property
    def time_growth(self) -> float:
        """Largest time per object over the smallest; inf if one was too short to be measured."""
        return _growth([point.us for point in self.points])

    @property
    def memory_growth(self) -> float:
        """Largest memory per object over the smallest."""
        return _growth([point.held for point in self.points])

    @property
    def flat(self) -> bool:
        """Whether both are flat."""
        return self.time_growth <= FLAT and self.memory_growth <= FLAT


@dataclass(frozen=True)
class BroadPhase:
    """All lines of a run."""

    lines: tuple[Line, ...]

    @property
    def ours(self) -> tuple[Line, ...]:
        """Those of our kernel for which flatness is claimed."""
        return tuple(line for line in self.lines if line.kernel == OURS and line.motion != FAST)


def _growth(values: Sequence[float]) -> float:
    low, high = min(values), max(values)
    return high / low if low > 0.0 and high < math.inf else math.inf


def load(run_dir: Path) -> BroadPhase | None:
    """The file of a run; None when the benchmark was not run. Raises InvalidFile for a file that is damaged."""
    path = run_dir / ROWS
    if not path.exists():
        return None
    found: dict[tuple[str, str, str], list[Point]] = {}
    for key, point in lines(path, lambda row: ((row["layout"], row["motion"], row["kernel"]), _point(row))):
        found.setdefault(key, []).append(point)
    return BroadPhase(tuple(Line(*key, tuple(sorted(p, key=lambda point: point.objects))) for key, p in found.items()))


def _point(row: Mapping[str, str]) -> Point:
    return Point(
        int(row["objects"]), float(row["us_per_object_p50"]), float(row["bytes_per_object"]), row["found_is_twin"] == "True"
    )


def times(growth: float) -> str:
    """A growth in words."""
    return f"×{figures(growth)}" if growth <= MOST_FACTOR else factor(growth)


def conclusion(broad: BroadPhase) -> str:
    """What to conclude, losses first."""
    wrong = tuple(dict.fromkeys(f"{line.name}, {line.kernel}" for line in broad.lines if not all(p.right for p in line.points)))
    parts = [f"Other pairs than by trying all: {listed(wrong)}."] if wrong else []
    ours = broad.ours
    if not ours:
        return " ".join([*parts, "Nothing was measured."])
    sizes = [point.objects for line in ours for point in line.points]
    span = f"from {min(sizes):,} to {max(sizes):,} objects"
    lost = tuple(line for line in ours if not line.flat)
    if lost:
        named = listed(tuple(
            f"{line.name} (time {times(line.time_growth)}, memory {times(line.memory_growth)})" for line in lost
        ))
        parts.append(f"Per object, {span}, {len(lost)} of {count(len(ours), 'case')} grow by more than {FLAT:g}: {named}.")
    else:
        worst = max(ours, key=lambda line: line.time_growth)
        memory = max(line.memory_growth for line in ours)
        parts.append(
            f"Per object, {span}, time grows by {figures(worst.time_growth)} at most ({worst.name}) and memory by "
            f"{figures(memory)}: flat within {FLAT:g} in all {count(len(ours), 'case')}."
        )
    return " ".join(parts)
