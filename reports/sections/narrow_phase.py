"""The narrow phase in the report: reads what the benchmark of single queries left in the run's folder, and puts it in words.

The chart of the narrow phase: a row per cell, a dot per library, time per query on a logarithmic axis.
"""

import csv
import io
import math
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import altair as alt

from avatarsim.errors import InvalidFile
from avatarsim.files import read_json, read_text
from reports.drawing.charts import Panel
from reports.drawing.marks import FONT
from reports.drawing.palette import GRID, MUTED, TEXT, Stroke, strokes
from reports.drawing.picture import picture
from reports.words.wording import count, figures, limit, listed, quantity
from runfiles.csv_rows import DAMAGED, WHOLE

FILES = ROWS, VERDICTS, ABOUT = "narrow_phase.csv", "narrow_phase_cells.csv", "narrow_phase.json"
MODES = ("cold", "coherent")
OURS = "avatarsim"
# Losses named in the sentence above the chart; the table has them all.
FIRST_LOSSES = 4


@dataclass(frozen=True)
class Figure:
    """One contender in one cell: median time [us] per query, NaN if there is none, and whether every answer was right."""

    us: float
    spread: tuple[float, float]
    error: float
    right: bool
    note: str


@dataclass(frozen=True)
class CellLine:
    """One cell of one mode: our verdict and all figures, by contender."""

    name: str
    held: bool
    ratio: float
    allowed: float
    rival: str
    rival_us: float
    ours_us: float
    ratio_called: float
    ratio_placed: float
    figures: Mapping[str, Figure]


@dataclass(frozen=True)
class Exactness:
    """How far a contender is from the exact answer, over all cells: cells right, shares of queries, largest error [m]."""

    engine: str
    right: int
    cells: int
    over: tuple[float, float]
    unanswered: float
    largest: float


@dataclass(frozen=True)
class Contender:
    """One contender in its own words; a setting is (name, value, reason)."""

    name: str
    what: str
    settings: tuple[tuple[str, str, str], ...]


@dataclass(frozen=True)
class NarrowPhase:
    """All of it. `lines`: mode -> cells, lost ones first; `absent`: contender -> why it is not there; `about`: what else the JSON
    file holds, as it is."""

    lines: Mapping[str, tuple[CellLine, ...]]
    engines: tuple[str, ...]
    libraries: Mapping[str, str]
    exactness: tuple[Exactness, ...]
    contenders: tuple[Contender, ...]
    absent: Mapping[str, str]
    about: Mapping[str, object]


def load(run_dir: Path) -> NarrowPhase | None:
    """The files of a run; None when the benchmark was not run. Raises InvalidFile for files that are damaged."""
    if not (run_dir / ROWS).exists():
        return None
    try:
        rows, verdicts = _table(run_dir / ROWS), _table(run_dir / VERDICTS)
        about: Any = read_json(run_dir / ABOUT, str(run_dir / ABOUT), WHOLE)
        contenders = tuple(_contender(one) for one in about["engines"])
        absent = {str(name): str(why) for name, why in about["absent"].items()}
        engines = tuple(dict.fromkeys(row["engine"] for row in rows))
        found: dict[tuple[str, ...], dict[str, Figure]] = {}
        for row in rows:
            found.setdefault(_where(row), {})[row["engine"]] = _figure(row)
        lines = {mode: tuple(_line(one, found[_where(one)]) for one in verdicts if one["mode"] == mode) for mode in MODES}
        exact = tuple(one for engine in engines if (one := _exactness(engine, [r for r in rows if r["engine"] == engine])))
        libraries = {row["engine"]: row["library"] for row in rows}
        return NarrowPhase(lines, engines, libraries, exact, contenders, absent, dict(about))
    except DAMAGED as error:
        raise InvalidFile(f"{ROWS}, {VERDICTS} or {ABOUT} in {run_dir}", f"{type(error).__name__}: {error}",
                          "whole files of one run of the benchmark") from error


def _contender(one: Any) -> Contender:
    settings = tuple((str(name), str(value), str(reason)) for name, (value, reason) in one["settings"].items())
    return Contender(str(one["name"]), str(one["what"]), settings)


def _table(path: Path) -> list[dict[str, str]]:
    return list(csv.DictReader(io.StringIO(read_text(path, str(path), WHOLE), newline="")))


def _where(row: Mapping[str, str]) -> tuple[str, ...]:
    return row["shape_a"], row["shape_b"], row["regime"], row["mode"]


def _figure(row: Mapping[str, str]) -> Figure:
    error = float(row["max_error_m"])
    return Figure(
        float(row["us_p50"]), (float(row["us_p25"]), float(row["us_p75"])), error, float(row["share_over_1e-06"]) == 0.0,
        row["note"],
    )


def _line(one: Mapping[str, str], figures_: Mapping[str, Figure]) -> CellLine:
    within = bool(one["rival"])
    return CellLine(
        f"{one['shape_a']}-{one['shape_b']} {one['regime']}", one["held"] == "True",
        float(one["ratio" if within else "ratio_called"]), float(one["allowed"]),
        one["rival"] if within else one["rival_called"], float(one["rival_us" if within else "rival_called_us"]),
        float(one["ours_us" if within else "ours_called_us"]), float(one["ratio_called"]), float(one["ratio_placed"]),
        figures_,
    )


def _exactness(engine: str, rows: list[dict[str, str]]) -> Exactness | None:
    judged = [(int(row["judged"]), row) for row in rows if int(row["judged"])]
    total = sum(many for many, _ in judged)
    if not total:
        return None

    def share(name: str) -> float:
        return sum(many * float(row[name]) for many, row in judged) / total

    errors = [float(row["max_error_m"]) for _, row in judged]
    return Exactness(
        engine, sum(float(row["share_over_1e-06"]) == 0.0 for _, row in judged), len(judged),
        (share("share_over_1e-06"), share("share_over_0.0001")), share("unanswered"),
        max((error for error in errors if math.isfinite(error)), default=math.inf),
    )


def conclusion(narrow: NarrowPhase) -> str:
    """What to conclude, losses first."""
    parts = []
    for mode in MODES:
        lines = narrow.lines[mode]
        lost = [line for line in lines if not line.held]
        if lost:
            named = listed(tuple(f"{line.name} ({factor(line)})" for line in lost), FIRST_LOSSES)
            parts.append(f"{mode.capitalize()}, we lose {len(lost)} of {count(len(lines), 'cell')}: {named}.")
        elif lines:
            parts.append(f"{mode.capitalize()}, all {count(len(lines), 'cell')} hold.")
        if lines:
            placed, called = (sum(ratio <= line.allowed for line, ratio in zip(lines, ratios, strict=True)) for ratios in (
                [line.ratio_placed for line in lines], [line.ratio_called for line in lines]))
            parts.append(f"With our world vertices computed within the time {placed} hold, with a call from Python per query on "
                         f"both sides {called}.")
    return " ".join(parts) or "Nothing was measured."


def factor(line: CellLine) -> str:
    """Our time against the rival's, in words."""
    if math.isnan(line.ratio):
        return "no rival" if not line.rival else "no figure of ours"
    return f"{figures(line.ratio)} of {line.rival}'s time, allowed {line.allowed:g}"


def start_up(narrow: NarrowPhase) -> tuple[str, ...]:
    """Sentences on compiling and starting; none when neither was measured."""
    found = narrow.about.get("start_up")
    if not isinstance(found, Mapping):
        return ()
    said = []
    for key, what in (("compile", "First compile of the collide room from an empty cache, in two processes"),
                      ("start", "Cached start of the whole engine, from interpreter to first frame")):
        seconds, goal = found.get(f"{key}_s"), found.get(f"{key}_goal_s")
        if isinstance(seconds, int | float) and isinstance(goal, int | float):
            outcome, worked = "held" if seconds < goal else "missed", found.get(f"{key}_cpu_s")
            work = f" ({figures(worked)} s of the processor)" if isinstance(worked, int | float) else ""
            said.append(f"{what}: {figures(seconds)} s{work}; the goal of {goal:g} s is {outcome}.")
        else:
            said.append(f"{what}: not measured{': ' + str(found['note']) if found.get('note') else ''}.")
    return tuple(said)


def call_costs(narrow: NarrowPhase) -> str:
    """What a call from Python costs, contender by contender, and the harness; "" when the file has neither."""
    calls, harness = narrow.about.get("call_us"), narrow.about.get("harness_us")
    said = []
    if isinstance(calls, list) and calls:
        listed_calls = [f"{one['engine']} {quantity(float(one['us']), 'us')} ({one['mode']})" for one in calls]
        said.append(f"A call from Python that computes next to nothing (two spheres) takes: {listed(tuple(listed_calls), 99)}.")
    if isinstance(harness, Mapping):
        said.append(
            f"The harness's own clock and loop, {quantity(float(harness['clock_and_loop']), 'us')} per query, are in every "
            "figure of a call per query and subtracted from none."
        )
    return " ".join(said)


# Height of a row and width of the plotting area [px].
ROW, WIDTH = 13, 300
# The contender that stands for us.
OUR_FIGURE = "ours"


def inks(narrow: NarrowPhase) -> dict[str, Stroke]:
    """A stroke per library, ours first."""
    found = strokes(dict.fromkeys(f"{library}/default" for library in (OURS, *narrow.libraries.values())))
    return {run.split("/")[0]: stroke for run, stroke in found.items()}


def fastest_right(line: CellLine, narrow: NarrowPhase) -> dict[str, float]:
    """Library -> time [us] of its fastest contender that was right in the cell, as measured; ours is the one within a call."""
    found: dict[str, float] = {}
    for engine, figure in line.figures.items():
        library = narrow.libraries[engine]
        ranked = figure.right and figure.us > 0.0 and (library != OURS or engine == OUR_FIGURE)
        if ranked and figure.us < found.get(library, math.inf):
            found[library] = figure.us
    return found


def panels(narrow: NarrowPhase) -> list[Panel]:
    """One panel per mode that has cells."""
    made: list[Panel] = []
    for mode in MODES:
        lines = narrow.lines[mode]
        dots = [
            {"cell": line.name, "library": library, "us": float(f"{us:.4g}")}
            for line in lines for library, us in fastest_right(line, narrow).items()
        ]
        if dots:
            lost = sum(not line.held for line in lines)
            slower = "more than the time" if lines[0].allowed == 1.0 else f"more than {lines[0].allowed:g} of the time"
            said = f"In {lost} of {count(len(lines), 'cell')} ours takes {slower} of the fastest that is right, calls taken off."
            first = lines[0]
            text = f"{mode}. Microseconds per query in {len(lines)} cells. {said} First: {first.name}, ours " \
                   f"{quantity(first.ours_us, 'us')}, {first.rival} {quantity(first.rival_us, 'us')}."
            made.append(Panel(mode, picture(_spec(narrow, lines, dots), text, f"n{len(made)}"), said))
    return made


def _spec(narrow: NarrowPhase, lines: tuple[CellLine, ...], dots: list[dict[str, object]]) -> dict[str, object]:
    ink = inks(narrow)
    times = [float(str(dot["us"])) for dot in dots]
    low, high = 10.0 ** math.floor(math.log10(min(times))), 10.0 ** math.ceil(math.log10(max(times)))
    ticks = [10.0**k for k in range(round(math.log10(low)), round(math.log10(high)) + 1)]
    names = ",".join(f"'{round(math.log10(t))}':'{limit(t, 'us')}'" for t in ticks)
    axis = alt.Axis(values=ticks, labelExpr=f"{{{names}}}[round(log(datum.value)/log(10))]", orient="top")
    colour = alt.Color(
        "library:N", legend=None, scale=alt.Scale(domain=list(ink), range=[stroke.light for stroke in ink.values()])
    )
    row = alt.Y(
        "cell:N", title=None, sort=[line.name for line in lines],
        axis=alt.Axis(grid=True, labelColor=TEXT[0], ticks=False, labelLimit=200),
    )
    x = alt.X("us:Q", title=None, scale=alt.Scale(type="log", domain=[low, high]), axis=axis)
    chart = alt.Chart({"values": dots}).mark_circle(size=42, opacity=1).encode(x=x, y=row, color=colour).properties(
        width=WIDTH, height=ROW * len(lines), background="transparent"
    ).configure(font=FONT, padding={"left": 4, "top": 2, "right": 10, "bottom": 2}, view=alt.ViewConfig(stroke=None))
    chart = chart.configure_axis(
        labelColor=MUTED[0], gridColor=GRID[0], domain=False, tickColor=GRID[0], labelFontSize=10, tickSize=3
    )
    return dict(chart.to_dict())
