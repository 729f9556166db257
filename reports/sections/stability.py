"""The hard cases under changes that should not matter, from what `scenarios.stability` left in the run: lines, charts, words.

A heat map per figure: kinds of change down, engines across, the darker the worse, each cell with its figure.
"""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from statistics import median

import altair as alt

from reports.drawing.charts import Panel
from reports.drawing.marks import FONT
from reports.drawing.palette import ALARM, MUTED, TEXT
from reports.drawing.picture import picture
from reports.words.wording import count, listed, quantity
from runfiles.csv_rows import lines, number

ROWS, LONG, SLICE = "stability.csv", "long", "slice"
COMMAND = "make stability"
LARGEST = "end moved, most"
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
    each: Callable[[Trial], float] | None = None
    """The value of one trial; None for a share of trials."""

    def worst(self, trials: Sequence[Trial]) -> str:
        """The case of the largest value; "" for a share, or without a number."""
        known = [(self.each(trial), trial.case) for trial in trials] if self.each else []
        return max(((value, case) for value, case in known if value == value), default=(0.0, ""))[1]


@dataclass(frozen=True)
class Ahead:
    """An engine that is better than ours in one figure over `trials` trials, which are of `cases` cases: for a share those that
    both have, for a value those that both survived. `case` is that of our largest value, `their_case` of theirs, "" for what has
    none."""

    run: str
    theirs: float
    ours: float
    trials: int
    cases: int
    case: str
    their_case: str = ""


@dataclass(frozen=True)
class Line:
    """One figure under one kind of change: a value per engine and preset over all its trials, and those ahead of ours over the
    trials that both have: with a change that ours cannot be asked, as of the solver's step, there are none."""

    kind: str
    figure: Figure
    values: Mapping[str, float]
    ahead: tuple["Ahead", ...] = ()

    @property
    def lost(self) -> bool:
        """Whether another engine is ahead of ours."""
        return bool(self.ahead)


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

    def common(self, run: str) -> tuple[tuple[Trial, Trial], ...]:
        """Trials of ours, each with that of another engine in the same case under the same change, where both say anything."""
        theirs = {(t.case, t.kind, t.level): t for t in self.trials if t.run == run and t.state not in UNASKED}
        own = (t for t in self.trials if t.run == OURS and t.state not in UNASKED)
        return tuple((t, other) for t in own if (other := theirs.get((t.case, t.kind, t.level))) is not None)

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


def _of(name: str, unit: str, seen: float, each: Callable[[Trial], float], chosen: Callable[[list[float]], float]) -> Figure:
    return Figure(name, unit, seen, lambda t: _known([each(x) for x in t], chosen), each)


FIGURES = (
    Figure("trials lost", "%", 0.0, _share),
    Figure("not a number", "%", 0.0, lambda t: 100.0 * sum(x.state == BAD for x in t) / len(t) if t else math.nan),
    _of("deepest overlap", "m", 1e-6, lambda t: t.overlap, max),
    _of("largest gain of energy", "J", 1e-9, lambda t: t.energy, max),
    _of("end moved, median", "m", 1e-6, lambda t: t.moved, median),
    _of("end moved, most", "m", 1e-6, lambda t: t.moved, max),
)


def ahead(found: Stability, figure: Figure, kind: str = "") -> tuple[Ahead, ...]:
    """Engines that are better than ours in a figure over the trials that both have, under one kind of change or, without one,
    under all; the best first. A value (overlap, energy, spread) is compared over trials that both survived: what one that was
    lost still shows is no merit, and the loss itself counts among the trials lost. One in which theirs has no number is no part
    of it; one in which ours has none is."""
    made = []
    for run in found.runs:
        if run.startswith("avatarsim/"):
            continue
        pairs = [(own, other) for own, other in found.common(run) if not kind or own.kind == kind]
        if figure.name.startswith("end moved"):
            # the plain end is what the others are held against, and no part of the spread
            pairs = [pair for pair in pairs if pair[0].kind != "plain"]
        if figure.each is not None:
            pairs = [pair for pair in pairs if all(trial.state == SURVIVED for trial in pair)
                     and not math.isnan(figure.each(pair[1]))]
        ours, theirs = (figure.of(trials) for trials in (tuple(p[0] for p in pairs), tuple(p[1] for p in pairs)))
        if not math.isnan(theirs) and not ours <= max(SLACK * theirs, figure.seen):
            own, others = ([pair[side] for pair in pairs] for side in (0, 1))
            made.append(Ahead(run, theirs, ours, len(own), len({trial.case for trial in own}), figure.worst(own),
                              figure.worst(others)))
    return tuple(sorted(made, key=lambda one: (-one.trials, one.theirs)))


def table(found: Stability) -> tuple[Line, ...]:
    """A line per kind of change and figure, those that ours loses first."""
    made = [
        Line(kind, figure, {run: figure.of(found.asked(run, kind)) for run in found.runs}, ahead(found, figure, kind))
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
    is its deepest overlap in the world as it was simulated, which the promise is about; `cases` are those it was tried in."""

    run: str
    tried: int
    survived: int
    values: Mapping[str, float]
    simulated: float
    cases: int = 0

    def told(self, cases: int) -> str:
        """"14 of 14 (2 of 9 cases)"; the cases are left out where it has all `cases` of ours."""
        return f"{self.survived} of {self.tried}{f' ({self.cases} of {cases} cases)' if self.cases < cases else ''}"


TOLD = ("deepest overlap", "largest gain of energy", "end moved, median", LARGEST)
"""Figures of the short table, after the count of trials."""
BETTER = {
    "trials lost": "fewer trials lost", "deepest overlap": "less overlap", "largest gain of energy": "less gain of energy",
    "end moved, median": "less spread in the median", LARGEST: "less spread at most",
}
"""What the engines that are ahead of ours in a figure have."""


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
            made.append(Standing(run, len(own), sum(trial.state == SURVIVED for trial in own), values, deepest,
                                 len({trial.case for trial in own})))
    return tuple(made)


def behind(found: Stability) -> tuple[str, ...]:
    """Which engines stand better than ours, figure by figure, each over the trials that it and ours have."""
    return tuple(f"{BETTER[figure.name]} by {_each(found, figure, better)}"
                 for figure in FIGURES if figure.name in BETTER and (better := ahead(found, figure)))


def behind_by_kind(found: Stability) -> tuple[str, ...]:
    """The same under one kind of change at a time, without what is already said of all changes together."""
    said = []
    for figure in (figure for figure in FIGURES if figure.name in BETTER):
        over_all = {(one.run, one.theirs, one.ours) for one in ahead(found, figure)}
        for kind in found.kinds:
            better = [one for one in ahead(found, figure, kind) if (one.run, one.theirs, one.ours) not in over_all]
            if better:
                said.append(f"{kind}: {BETTER[figure.name]} by {_each(found, figure, better)}")
    return tuple(said)


def _each(found: Stability, figure: Figure, better: Sequence[Ahead]) -> str:
    return listed(tuple(_beside(found, figure, one) for one in better), len(better))


def _beside(found: Stability, figure: Figure, one: Ahead) -> str:
    """"mujoco/tuned (69.5 mm in painleve against 248 mm in painleve, over 80 trials that both survived)", and of how many cases
    where these are not all of ours. A share and a median are of no one case."""
    unit, cases = figure.unit, len({trial.case for trial in found.all_of(OURS)})
    few = f", of {one.cases} of {cases} cases" if one.cases < cases else ""
    both = "have" if figure.each is None else "survived"
    named = figure.name != "end moved, median"
    theirs, ours = (
        f"{quantity(None if math.isnan(value) else value, unit)}{f' in {case}' if case and named else ''}"
        for value, case in ((one.theirs, one.their_case), (one.ours, one.case)))
    return f"{one.run} ({theirs} against {ours}, over {count(one.trials, 'trial')} that both {both}{few})"


def step_said(found: Stability) -> str:
    """What the other engines have under changes that ours cannot be asked, so that the short table leaves them out."""
    only = [kind for kind in found.kinds if not found.asked(OURS, kind) and any(found.asked(run, kind) for run in found.runs)]
    if not only or not any(found.asked(OURS, kind) for kind in found.kinds):
        return ""
    overlap, moved = (next(figure for figure in FIGURES if figure.name == name) for name in ("deepest overlap", LARGEST))
    said = []
    for run in found.runs:
        own = tuple(trial for kind in only for trial in found.asked(run, kind))
        if own:
            figures = (f"{word} {quantity(None if math.isnan(value) else value, 'm')}"
                       for word, value in (("overlap", overlap.of(own)), ("spread", moved.of(own))))
            said.append(f"{run} {sum(trial.state == SURVIVED for trial in own)} of {len(own)}, {', '.join(figures)}")
    return f"Not in the table, since ours cannot be asked, is {listed(tuple(only))} (survived, worst figures): {'; '.join(said)}."


def answer(found: Stability) -> str:
    """One sentence on whether hard cases stay numerically stable in our engine; losses stand before it."""
    own = next((line for line in standings(found) if line.run == OURS), None)
    if own is None:
        return f"{OURS} was not tried, so this run does not say whether hard cases stay stable."
    bad = sum(trial.state == BAD for trial in found.all_of(OURS))
    ends = "none of them with a value that is no number" if not bad else f"{bad} of them with a value that is no number"
    energy = _told(own, "largest gain of energy", "J")
    word = "Hard cases stay stable" if own.survived == own.tried else "Hard cases do not all stay stable"
    moved = next(figure for figure in FIGURES if figure.name == LARGEST)
    where = moved.worst([trial for trial in found.all_of(OURS) if trial.kind != "plain"])
    return (
        f"{word}: {OURS} gets through {own.survived} of {count(own.tried, 'trial')}, {ends}, overlaps by at most "
        f"{quantity(None if math.isnan(own.simulated) else own.simulated, 'm')} as simulated "
        f"({_told(own, 'deepest overlap', 'm')} at size 1) and gains at most {energy} in a frame; a change moves its end by "
        f"{_told(own, 'end moved, median', 'm')} in the median, {_told(own, LARGEST, 'm')} at "
        f"most{f' ({where})' if where else ''}."
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
    """Case by case and engine by engine what was lost, ours first, under every kind of change, those that ours cannot be asked
    among them; empty where nothing was."""
    made = []
    for run in found.runs:
        own = [trial for kind in found.kinds for trial in found.asked(run, kind)]
        for case in found.cases:
            tried_ = [trial for trial in own if trial.case == case]
            lost = [trial for trial in tried_ if trial.state != SURVIVED]
            if lost:
                changes = tuple(dict.fromkeys(f"{trial.kind} {trial.level}" for trial in lost))
                reasons = tuple(dict.fromkeys(": ".join(filter(None, (trial.state, trial.note))) for trial in lost))
                made.append(Lost(case, run, len(lost), len(tried_), changes, reasons))
    return tuple(made)


def worst_ends(found: Stability) -> tuple[str, ...]:
    """Of each case the change that moves our end farthest, the farthest first: "painleve 248 mm (together, draw 2)"."""
    made = []
    for case in found.cases:
        moved = [(trial.moved, f"{trial.kind}, {trial.level}") for trial in found.all_of(OURS)
                 if trial.case == case and trial.kind != "plain" and not math.isnan(trial.moved)]
        made += [(*max(moved), case)] if moved else []
    return tuple(f"{case} {quantity(far, 'm')} ({change})" for far, change, case in sorted(made, reverse=True))


def _told(line: Standing, name: str, unit: str) -> str:
    value = line.values[name]
    return quantity(None if math.isnan(value) else value, unit)


def conclusion(found: Stability) -> str:
    """What to conclude, losses first."""
    lost = behind(found)
    first = f"On the same trials another engine stands better than ours: {'; '.join(lost)}." if lost else \
        "On the same trials no other engine stands better than ours in any of these figures."
    by_kind = behind_by_kind(found)
    kinds = f" Under one kind of change at a time, in {len(by_kind)} figures more (By kind of change, below)." if by_kind else ""
    chaos = spread(found, OURS)
    then = f" A start that is off moves its end, in the median, from {chaos}." if chaos else ""
    return f"{first}{kinds} {answer(found)}{then}"


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
        "stability_by_kind": behind_by_kind(found), "stability_step": step_said(found),
        "stability_cases": len({trial.case for trial in found.all_of(OURS)}),
        "stability_lost": lost_trials(found), "stability_little": little_said(found),
        "stability_ends": "; ".join(worst_ends(found)),
        "stability_panels": panels(values, found.runs, found.kinds, units),
    }


CELL, ROW = 54, 22
"""Width and height of a cell [px]."""
PALEST, DARKEST = 0.0, 0.6
"""Opacity of the best and of the worst cell; beyond it the figure on top could not be read."""
DECADES = 9.0
"""So many powers of ten below the worst, a cell is as pale as the best."""
Values = Mapping[tuple[str, str, str], float]


def shade(value: float, worst: float, unit: str) -> float:
    """Opacity of a cell: in proportion for shares, by powers of ten for lengths and energies."""
    if not value > 0.0 or not worst > 0.0:
        return PALEST
    if unit == "%":
        return DARKEST * value / 100.0
    return DARKEST * max(0.0, 1.0 + math.log10(value / worst) / DECADES)


def panels(values: Values, runs: Sequence[str], kinds: Sequence[str], units: Mapping[str, str]) -> list[Panel]:
    """A panel for each figure that any engine has."""
    made: list[Panel] = []
    for figure, unit in units.items():
        cells = {(kind, run): v for kind in kinds for run in runs if (v := values.get((figure, kind, run), math.nan)) == v}
        if not cells:
            continue
        worst = max(cells.values())
        kind, run = max(cells, key=lambda at: cells[at])
        said = f"Worst: {quantity(worst, unit)}, {run}, {kind}." if worst > 0.0 else "Nothing."
        dots: list[dict[str, object]] = [
            {"kind": kind, "run": run, "shade": round(shade(v, worst, unit), 3), "word": quantity(v, unit)}
            for (kind, run), v in cells.items()
        ]
        text = f"{figure} by engine and kind of change. {said}"
        made.append(Panel(figure, picture(_spec(dots, runs, kinds), text, f"st{len(made)}"), said))
    return made


def _spec(dots: list[dict[str, object]], runs: Sequence[str], kinds: Sequence[str]) -> dict[str, object]:
    slant = alt.Axis(orient="top", labelAngle=-28, labelAlign="left", ticks=False, domain=False, labelLimit=200)
    x = alt.X("run:N", sort=list(runs), title=None, axis=slant)
    y = alt.Y("kind:N", sort=list(kinds), title=None, axis=alt.Axis(ticks=False, domain=False, labelColor=TEXT[0]))
    base = alt.Chart({"values": dots}).encode(x=x, y=y)
    opacity = alt.Opacity("shade:Q", scale=None, legend=None)
    chart = alt.layer(
        base.mark_rect(color=ALARM[0], cornerRadius=2).encode(opacity=opacity),
        base.mark_text(color=TEXT[0], fontSize=9).encode(text="word:N"),
    ).properties(width=CELL * len(runs), height=ROW * len(kinds), background="transparent").configure(
        font=FONT, padding={"left": 4, "top": 2, "right": 48, "bottom": 2}, view=alt.ViewConfig(stroke=None)
    ).configure_axis(labelColor=MUTED[0], labelFontSize=10, grid=False)
    return dict(chart.to_dict())
