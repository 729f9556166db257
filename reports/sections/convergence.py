"""Self-convergence: what `scenarios sweep` found of each engine beside its own finest run, in scenes without a closed form."""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import numpy as np

from reports.words.wording import count, figures, listed, quantity
from runfiles.csv_rows import lines, number

ROWS = "convergence.csv"
OURS = "avatarsim/default"
CONSISTENT = 1e-3
"""Distance [m] from the finest run, at the smallest step compared, up to which an engine counts as consistent: a millimetre
cannot be seen."""
RIGHT, WITHIN = 1e-6, 1e-6
"""Overlap [m] and angle beyond the limits [deg] up to which the finest run itself counts as right, as in the catalogue."""


@dataclass(frozen=True)
class Step:
    """One engine at one step: distance from its own finest run [m], root mean square and largest; overlap [m], angle beyond
    limits [deg], and distance from our own finest run [m]; nan with the reason in `note`."""

    scenario: str
    run: str
    rate: int
    off: float
    off_max: float
    overlap: float
    beyond: float
    from_ours: float
    note: str


@dataclass(frozen=True)
class Course:
    """One engine and preset in one scene: its steps, coarsest first, and the finest run they are compared with."""

    scenario: str
    run: str
    steps: tuple[Step, ...]
    finest: Step

    @cached_property
    def order(self) -> float:
        """The power of the step with which the distance falls; nan with fewer than two steps."""
        points = [(math.log(1.0 / s.rate), math.log(s.off)) for s in self.steps if s.off > 0.0]
        if len(points) < 2:
            return math.nan
        x, y = np.array(points).T
        return float(np.polyfit(x, y, 1)[0])

    @property
    def consistent(self) -> bool:
        """Whether the smallest step compared ends within a millimetre of the finest run."""
        return bool(self.steps) and self.steps[-1].off <= CONSISTENT

    @property
    def right(self) -> bool:
        """Whether the finest run overlaps nothing and keeps the limits."""
        return self.finest.overlap <= RIGHT and self.finest.beyond <= WITHIN

    @property
    def said(self) -> str:
        """Both in words."""
        if self.finest.note:
            return f"no finest run: {self.finest.note}"
        return f"{'consistent' if self.consistent else 'not consistent'}, {'right' if self.right else 'not right'}"


@dataclass(frozen=True)
class Converging:
    """All courses of a run."""

    courses: tuple[Course, ...]

    @property
    def rates(self) -> tuple[int, ...]:
        """Steps per second that are compared, coarsest first."""
        return tuple(sorted({step.rate for course in self.courses for step in course.steps}))


def load(run_dir: Path) -> Converging | None:
    """The file of a run; None when there is none. Raises InvalidFile for a file that is damaged."""
    found = lines(run_dir / ROWS, _step)
    groups: dict[tuple[str, str], list[Step]] = {}
    for step in found:
        groups.setdefault((step.scenario, step.run), []).append(step)
    courses = []
    for (scene, run), steps in groups.items():
        *coarse, finest = sorted(steps, key=lambda step: step.rate)
        courses.append(Course(scene, run, tuple(coarse), finest))
    # what fails first, ours first among equals
    courses.sort(key=lambda c: (c.scenario, c.consistent and c.right, c.run != OURS))
    return Converging(tuple(courses)) if courses else None


def _step(row: Mapping[str, str]) -> Step:
    run, rate = f"{row['engine']}/{row['preset']}", int(row["rate"])
    off, most, overlap, beyond, apart = (number(row[name]) for name in ("off", "off_max", "overlap", "beyond", "from_ours"))
    return Step(row["scenario"], run, rate, off, most, overlap, beyond, apart, row["note"])


def conclusion(converging: Converging) -> str:
    """Which engines are consistent, which are right, ours first where it fails."""
    ours = [course for course in converging.courses if course.run == OURS]
    parts = []
    for what, word in (("consistent", "approaches its own finest run"), ("right", "ends without overlap and within limits")):
        lost = tuple(
            f"{c.scenario} ({quantity(c.steps[-1].off if c.steps else math.nan, 'm')})" if what == "consistent" else c.scenario
            for c in ours if not getattr(c, what)
        )
        rest = f", not in {listed(lost)}" if lost else ""
        parts.append(f"Ours {word} in {len(ours) - len(lost)} of {count(len(ours), 'scene')}{rest}.")
    wrong = tuple(f"{c.run} in {c.scenario}" for c in converging.courses if c.run != OURS and c.consistent and not c.right)
    if wrong:
        parts.append(f"Consistent and not right, so that smaller steps do not help: {listed(wrong)}.")
    return " ".join(parts)


def order_words(course: Course) -> str:
    """The order of convergence in words."""
    return "—" if math.isnan(course.order) else figures(course.order)


def section(converging: Converging) -> dict[str, object]:
    """What the part of the section is made of."""
    return {"convergence_conclusion": conclusion(converging), "convergence_order": order_words}
