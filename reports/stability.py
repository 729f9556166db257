"""The hard cases under changes that should not matter, from what `scenarios.stability` left in the run: lines, charts, words."""

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from statistics import median

from reports.files import lines, number
from reports.stability_chart import panels
from reports.wording import count, listed, quantity

ROWS, LONG, SLICE = "stability.csv", "long", "slice"
COMMAND = "make stability"
OURS = "avatarsim/default"
SURVIVED, BAD, UNASKED = "survived", "not a number", ("cannot say", "not measured")
SLACK = 1.05
"""Differences of less than 5 % are no loss."""


@dataclass(frozen=True)
class Trial:
    """One engine in one case under one change. Lengths [m] and energies [J] in a world of size 1; `moved` from its plain end;
    `form` is SLICE in what a comparison tried, `scale` the size of the world that was simulated."""

    case: str
    run: str
    kind: str
    level: str
    start: float
    state: str
    overlap: float
    energy: float
    moved: float
    form: str = LONG
    scale: float = 1.0
    note: str = ""


@dataclass(frozen=True)
class Figure:
    """What is compared: name, unit, the least that counts as a loss, and how it is had from some trials of one engine."""

    name: str
    unit: str
    seen: float
    of: Callable[[tuple[Trial, ...]], float]


@dataclass(frozen=True)
class Line:
    """One figure under one kind of change: a value per engine and preset, and whether another engine's is better than ours.
    `asked`: whether ours was, which a change of the solver's step cannot be."""

    kind: str
    figure: Figure
    values: Mapping[str, float]
    asked: bool = True

    @property
    def best(self) -> float:
        """The least of all others; nan without others."""
        return min((v for run, v in self.values.items() if not run.startswith("avatarsim/") and v == v), default=math.nan)

    @property
    def lost(self) -> bool:
        """Whether ours is worse than another engine's by more than rounding; a figure that ours has not is lost as well."""
        ours = self.values.get(OURS, math.nan)
        if math.isnan(self.best) or not self.asked:
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

    @property
    def cases(self) -> tuple[str, ...]:
        """Cases in the order of the file."""
        return tuple(dict.fromkeys(trial.case for trial in self.trials))

    @property
    def is_slice(self) -> bool:
        """Whether the rows are those of the slice that a comparison tries, not of the long form."""
        return all(trial.form == SLICE for trial in self.trials)

    def levels(self, kind: str) -> tuple[str, ...]:
        """What was tried of one kind of change."""
        return tuple(dict.fromkeys(trial.level for trial in self.trials if trial.kind == kind))

    def all_of(self, run: str) -> tuple[Trial, ...]:
        """The trials of one engine that say anything, of the kinds of change that ours was asked under: what is compared over
        all must be the same for all."""
        kinds = [kind for kind in self.kinds if self.asked(OURS, kind)] or self.kinds
        return tuple(trial for kind in kinds for trial in self.asked(run, kind))

    def asked(self, run: str, kind: str) -> tuple[Trial, ...]:
        """The trials of one engine under one kind of change that say anything."""
        return tuple(t for t in self.trials if t.run == run and t.kind == kind and t.state not in UNASKED)


def load(run_dir: Path) -> Stability | None:
    """The file of a run; None when there is none. Raises InvalidFile for a file that is damaged."""
    found = lines(run_dir / ROWS, _trial)
    return Stability(found) if found else None


def _trial(row: Mapping[str, str]) -> Trial:
    overlap, energy, moved = (number(row[name]) for name in ("overlap", "energy", "moved"))
    # a file from before there was a slice holds the long form
    form = row.get("form") or LONG
    return Trial(
        row["case"], row["run"], row["kind"], row["level"], number(row["start"]), row["state"], overlap, energy, moved, form,
        number(row["scale"]), row.get("note") or "",
    )


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
        Line(kind, figure, {run: figure.of(found.asked(run, kind)) for run in found.runs}, bool(found.asked(OURS, kind)))
        for kind in found.kinds for figure in FIGURES
    ]
    # the plain trial is where it is by definition, and a line without a number says nothing
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


@dataclass(frozen=True)
class Standing:
    """One engine and preset over all its trials: how many it had and got through, and a figure per name in TOLD; `simulated` [m]
    is its deepest overlap in the world as it was simulated, which the promise is about."""

    run: str
    tried: int
    survived: int
    values: Mapping[str, float]
    simulated: float


TOLD = ("deepest overlap", "largest gain of energy", "end moved, median", "end moved, most")
"""Figures of the short table, after the count of trials."""
BETTER = {
    "trials lost": "loses fewer trials", "deepest overlap": "overlaps less", "largest gain of energy": "gains less energy",
    "end moved, median": "spreads less in the median", "end moved, most": "spreads less at most",
}
"""What the engine that is ahead of ours in a figure does."""


def standings(found: Stability) -> tuple[Standing, ...]:
    """A line per engine and preset that was tried, ours first."""
    made = []
    for run in found.runs:
        own = found.all_of(run)
        if own:
            # the plain end is what the others are held against, and no part of the spread
            changed = tuple(trial for trial in own if trial.kind != "plain")
            values = {f.name: f.of(changed if f.name.startswith("end moved") else own) for f in FIGURES}
            deepest = _known([trial.overlap * trial.scale for trial in own], max)
            made.append(Standing(run, len(own), sum(trial.state == SURVIVED for trial in own), values, deepest))
    return tuple(made)


def behind(found: Stability) -> tuple[str, ...]:
    """Where another engine stands better than ours over all trials: figure by figure, by the best of them."""
    standing = {line.run: line for line in standings(found)}
    said = []
    for figure in FIGURES:
        line = Line("all", figure, {run: own.values[figure.name] for run, own in standing.items()})
        if figure.name in BETTER and OURS in standing and line.lost:
            best = next(run for run, value in line.values.items() if not run.startswith("avatarsim/") and value == line.best)
            said.append(f"{best} {BETTER[figure.name]} ({cell(line, best)} against {cell(line, OURS)})")
    return tuple(said)


def answer(found: Stability) -> str:
    """One sentence on whether hard cases stay numerically stable in our engine; losses stand before it."""
    own = next((line for line in standings(found) if line.run == OURS), None)
    if own is None:
        return f"{OURS} was not tried, so this run does not say whether hard cases stay stable."
    bad = sum(trial.state == BAD for trial in found.all_of(OURS))
    ends = "none of them with a value that is no number" if not bad else f"{bad} of them with a value that is no number"
    energy = _told(own, "largest gain of energy", "J")
    word = "Hard cases stay stable" if own.survived == own.tried else "Hard cases do not all stay stable"
    return (
        f"{word}: {OURS} gets through {own.survived} of {count(own.tried, 'trial')}, {ends}, overlaps by at most "
        f"{quantity(None if math.isnan(own.simulated) else own.simulated, 'm')} as simulated "
        f"({_told(own, 'deepest overlap', 'm')} at size 1) and gains at most {energy} in a frame; a change moves its end by "
        f"{_told(own, 'end moved, median', 'm')} in the median, {_told(own, 'end moved, most', 'm')} at most."
    )


SEEN_GAIN = 1.0
"""Energy [J] that nothing gives: a kilogram thrown up by a hand's breadth."""


def little_said(found: Stability) -> str:
    """Which engines survive everything and gain energy all the same, so that surviving says little; "" where none does."""
    told = [f"{line.run} gains {_told(line, 'largest gain of energy', 'J')}" for line in standings(found)
            if line.survived == line.tried and line.values["largest gain of energy"] > SEEN_GAIN]
    return f"To survive says little by itself: {'; '.join(told)} in a frame and survives all." if told else ""


@dataclass(frozen=True)
class Lost:
    """The trials that one engine lost of one case: under which changes, of how many, and why."""

    case: str
    run: str
    lost: int
    tried: int
    changes: tuple[str, ...]
    reasons: tuple[str, ...]


def lost_trials(found: Stability) -> tuple[Lost, ...]:
    """Case by case and engine by engine what was lost, ours first; empty where nothing was."""
    made = []
    for run in found.runs:
        own = found.all_of(run)
        for case in found.cases:
            tried_ = [trial for trial in own if trial.case == case]
            lost = [trial for trial in tried_ if trial.state != SURVIVED]
            if lost:
                changes = tuple(dict.fromkeys(f"{trial.kind} {trial.level}" for trial in lost))
                reasons = tuple(dict.fromkeys(": ".join(filter(None, (trial.state, trial.note))) for trial in lost))
                made.append(Lost(case, run, len(lost), len(tried_), changes, reasons))
    return tuple(made)


def _told(line: Standing, name: str, unit: str) -> str:
    value = line.values[name]
    return quantity(None if math.isnan(value) else value, unit)


def conclusion(found: Stability) -> str:
    """What to conclude, losses first."""
    lost = behind(found)
    first = f"Another engine stands better than ours: {'; '.join(lost)}." if lost else \
        "No other engine stands better than ours in any of these figures."
    chaos = spread(found, OURS)
    then = f" A start that is off moves its end, in the median, from {chaos}." if chaos else ""
    return f"{first} {answer(found)}{then}"


def tried(found: Stability) -> str:
    """Which cases and changes the rows are of, and which command made them."""
    changes = [f"{kind} ({listed(found.levels(kind), 4)})" for kind in found.kinds if kind != "plain"]
    what = f"{count(len(found.cases), 'case')} ({listed(found.cases, 12)}), each as it is and under {'; '.join(changes)}"
    return f"In this run, a slice: {what}." if found.is_slice else f"The long form, by {COMMAND}: {what}."


def cell(line: Line, run: str) -> str:
    """A figure in its unit; a dash where there is none."""
    value = line.values[run]
    return quantity(None if math.isnan(value) else value, line.figure.unit)


def section(found: Stability) -> dict[str, object]:
    """What a page needs for its section."""
    made = table(found)
    values = {(line.figure.name, line.kind, run): value for line in made for run, value in line.values.items()}
    units = {figure.name: figure.unit for figure in FIGURES}
    return {
        "stability_lines": made, "stability_cell": cell, "stability_conclusion": conclusion(found),
        "stability_standings": standings(found), "stability_told": [(name, units[name]) for name in TOLD],
        "stability_figure": _told, "stability_tried": tried(found), "stability_slice": found.is_slice,
        "stability_lost": lost_trials(found), "stability_little": little_said(found),
        "stability_panels": panels(values, found.runs, found.kinds, units),
    }
