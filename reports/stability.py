"""The hard cases under changes that should not matter, from what `scenarios.stability` left in the run: lines, charts, words."""

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from statistics import median

from reports.files import lines, number
from reports.stability_chart import panels
from reports.wording import count, listed, quantity

ROWS = "stability.csv"
OURS = "avatarsim/default"
SURVIVED, BAD, UNASKED = "survived", "not a number", ("cannot say", "not measured")
SLACK = 1.05
"""Differences of less than 5 % are no loss."""


@dataclass(frozen=True)
class Trial:
    """One engine in one case under one change. Lengths [m] and energies [J] in a world of size 1; `moved` from its plain end."""

    case: str
    run: str
    kind: str
    level: str
    start: float
    state: str
    overlap: float
    energy: float
    moved: float


@dataclass(frozen=True)
class Figure:
    """What is compared: name, unit, the least that counts as a loss, and how it is had from some trials of one engine."""

    name: str
    unit: str
    seen: float
    of: Callable[[tuple[Trial, ...]], float]


@dataclass(frozen=True)
class Line:
    """One figure under one kind of change: a value per engine and preset, and whether somebody else's is better than ours."""

    kind: str
    figure: Figure
    values: Mapping[str, float]

    @property
    def best(self) -> float:
        """The least of all others; nan without others."""
        return min((v for run, v in self.values.items() if not run.startswith("avatarsim/") and v == v), default=math.nan)

    @property
    def lost(self) -> bool:
        """Whether ours is worse than somebody's by more than rounding; a figure that ours has not is lost as well."""
        ours = self.values.get(OURS, math.nan)
        if math.isnan(self.best):
            return False
        return not ours <= max(SLACK * self.best, self.figure.seen)


@dataclass(frozen=True)
class Stability:
    """All trials of a run."""

    trials: tuple[Trial, ...]

    @property
    def runs(self) -> tuple[str, ...]:
        """Engines and presets, ours first, then in the order of the file."""
        return tuple(sorted(dict.fromkeys(trial.run for trial in self.trials), key=lambda run: run != OURS))

    @property
    def kinds(self) -> tuple[str, ...]:
        """Kinds of change in the order of the file."""
        return tuple(dict.fromkeys(trial.kind for trial in self.trials))

    def asked(self, run: str, kind: str) -> tuple[Trial, ...]:
        """The trials of one engine under one kind of change that say anything."""
        return tuple(t for t in self.trials if t.run == run and t.kind == kind and t.state not in UNASKED)


def load(run_dir: Path) -> Stability | None:
    """The file of a run; None when there is none. Raises InvalidFile for a file that is damaged."""
    found = lines(run_dir / ROWS, _trial)
    return Stability(found) if found else None


def _trial(row: Mapping[str, str]) -> Trial:
    figures = [number(row[name]) for name in ("overlap", "energy", "moved")]
    return Trial(row["case"], row["run"], row["kind"], row["level"], number(row["start"]), row["state"], *figures)


def _share(trials: tuple[Trial, ...]) -> float:
    return 100.0 * sum(trial.state != SURVIVED for trial in trials) / len(trials) if trials else math.nan


def _known(values: list[float], chosen: Callable[[list[float]], float]) -> float:
    """`chosen` of those that are numbers; nan without any."""
    real = [value for value in values if not math.isnan(value)]
    return chosen(real) if real else math.nan


FIGURES = (
    Figure("trials lost", "%", 0.0, _share),
    Figure("not a number", "%", 0.0, lambda t: 100.0 * sum(x.state == BAD for x in t) / len(t) if t else math.nan),
    Figure("deepest overlap", "m", 1e-6, lambda t: _known([x.overlap for x in t], max)),
    Figure("largest gain of energy", "J", 1e-9, lambda t: _known([x.energy for x in t], max)),
    Figure("end moved, median", "m", 1e-6, lambda t: _known([x.moved for x in t], median)),
    Figure("end moved, most", "m", 1e-6, lambda t: _known([x.moved for x in t], max)),
)


def table(found: Stability) -> tuple[Line, ...]:
    """A line per kind of change and figure, those that ours loses first."""
    made = [
        Line(kind, figure, {run: figure.of(found.asked(run, kind)) for run in found.runs})
        for kind in found.kinds for figure in FIGURES
    ]
    # nobody can move away from the plain end by the plain trial, nor say anything where nobody has a number
    told = [line for line in made if any(v == v for v in line.values.values()) and not (
        line.kind == "plain" and line.figure.name.startswith("end moved"))]
    return tuple(sorted(told, key=lambda line: not line.lost))


def spread(found: Stability, run: str) -> str:
    """How far ends spread for how small a change of the start: the median over all cases, per step."""
    steps: dict[float, list[float]] = {}
    for trial in found.asked(run, "start"):
        steps.setdefault(trial.start, []).append(trial.moved)
    said = [f"{quantity(start, 'm')} to {quantity(_known(moved, median), 'm')}" for start, moved in sorted(steps.items())]
    return ", ".join(said)


def conclusion(found: Stability) -> str:
    """What to conclude, losses first."""
    made = table(found)
    lost = tuple(f"{line.figure.name} ({line.kind})" for line in made if line.lost)
    parts = [f"Somebody is better than ours in {len(lost)} of {count(len(made), 'row')}: {listed(lost, 8)}." if lost
             else f"Ours is best, or level, in all of {count(len(made), 'row')}."]
    for run in found.runs:
        own = [trial for kind in found.kinds for trial in found.asked(run, kind)]
        if own:
            lived, bad = sum(t.state == SURVIVED for t in own), sum(t.state == BAD for t in own)
            parts.append(f"{run} gets through {lived} of {len(own)} trials" + (f", {bad} end in no number." if bad else "."))
    parts += [f"A start that is off moves the end of {run}, in the median, from {said}." for run in found.runs[:1]
              if (said := spread(found, run))]
    return " ".join(parts)


def cell(line: Line, run: str) -> str:
    """A figure in its unit; a dash where there is none."""
    value = line.values[run]
    return quantity(None if math.isnan(value) else value, line.figure.unit)


def section(found: Stability) -> dict[str, object]:
    """What a page needs for its section."""
    made = table(found)
    values = {(line.figure.name, line.kind, run): value for line in made for run, value in line.values.items()}
    return {
        "stability_lines": made, "stability_cell": cell, "stability_conclusion": conclusion(found),
        "stability_panels": panels(values, found.runs, found.kinds, {figure.name: figure.unit for figure in FIGURES}),
    }
