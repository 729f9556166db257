"""Sweep and prune in the report: reads what its benchmark left in the run's folder, draws it and puts it in words.

The charts of sweep and prune: time per object over the number of objects, a panel per layout, and memory.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import altair as alt

from reports.drawing.charts import Panel
from reports.drawing.marks import FONT, HEIGHT, WIDTH
from reports.drawing.palette import GRID, MUTED, Stroke, strokes
from reports.drawing.picture import picture
from reports.words.wording import MOST_FACTOR, count, factor, figures, limit, listed, quantity
from runfiles.csv_rows import lines

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


def label(line: Line) -> str:
    """Our kernel goes by the motion, the others by their names: they are measured in one motion only."""
    return line.motion if line.kernel == OURS else f"{line.kernel}, {line.motion}"


def inks(broad: BroadPhase) -> dict[str, Stroke]:
    """A stroke per label: ours in our colour, a dash per motion, the others in colours of their own."""
    labels = list(dict.fromkeys((line.kernel, label(line)) for line in broad.lines))
    ours = strokes(f"avatarsim/{name}" for kernel, name in labels if kernel == OURS)
    others = strokes(f"{kernel}/default" for kernel, _ in labels if kernel != OURS)
    return {name: ours[f"avatarsim/{name}"] if kernel == OURS else others[f"{kernel}/default"] for kernel, name in labels}


def panels(broad: BroadPhase) -> list[Panel]:
    """One panel per layout, then one of memory."""
    made: list[Panel] = []
    for layout in dict.fromkeys(line.layout for line in broad.lines):
        lines = [line for line in broad.lines if line.layout == layout]
        dots: list[dict[str, object]] = [
            {"line": label(line), "objects": point.objects, "us": float(f"{point.us:.4g}")}
            for line in lines for point in line.points if point.us > 0.0
        ]
        if dots:
            ours = [line for line in broad.ours if line.layout == layout]
            said = "; ".join(f"{line.motion} {times(line.time_growth)}" for line in ours)
            said = f"Largest time per object over smallest, {FLAT:g} allowed: {said or 'not measured'}."
            ends = listed(tuple(
                f"{label(line)} {quantity(line.points[0].us, 'us')} at {line.points[0].objects:,}, "
                f"{quantity(line.points[-1].us, 'us')} at {line.points[-1].objects:,}" for line in lines
            ), 99)
            text = f"{layout}. Time per object: {ends}. {said}"
            made.append(Panel(layout, picture(_spec(broad, dots, "us"), text, f"b{len(made)}"), said))
    return made + ([memory_panel(broad)] if made else [])


def memory_panel(broad: BroadPhase) -> Panel:
    """Memory per object of every kernel, which neither layout nor motion changes."""
    lines = list({line.kernel: line for line in reversed(broad.lines)}.values())[::-1]
    dots: list[dict[str, object]] = [
        {"line": label(line), "objects": point.objects, "held": float(f"{point.held:.4g}")}
        for line in lines for point in line.points if point.held > 0.0
    ]
    ours = max((line.memory_growth for line in broad.ours), default=math.inf)
    said = f"Largest memory per object over smallest, {FLAT:g} allowed: {times(ours) if broad.ours else 'not measured'}."
    ends = listed(tuple(
        f"{line.kernel} {figures(line.points[0].held)} bytes at {line.points[0].objects:,}, "
        f"{figures(line.points[-1].held)} bytes at {line.points[-1].objects:,}" for line in lines
    ), 99)
    return Panel("memory", picture(_spec(broad, dots, "held"), f"Memory per object: {ends}. {said}", "bm"), said)


def _decades(values: Sequence[float], unit: str) -> tuple[list[float], str]:
    """Powers of ten around all values, and the expression that names them."""
    low, high = math.floor(math.log10(min(values))), math.ceil(math.log10(max(values)))
    said = {k: limit(10.0**k, unit) if unit == "us" else f"{10.0 ** (k % 3):g} {('B', 'kB', 'MB', 'GB')[k // 3]}"
            for k in range(low, high + 1)}
    names = ",".join(f"'{k}':'{name}'" for k, name in said.items())
    return [10.0**k for k in said], f"{{{names}}}[round(log(datum.value)/log(10))]"


def _spec(broad: BroadPhase, dots: list[dict[str, object]], what: str) -> dict[str, object]:
    """``what``: "us", with one scale for the panels of all layouts, or "held"."""
    ink = inks(broad)
    values = [getattr(point, what) for line in broad.lines for point in line.points if getattr(point, what) > 0.0]
    sizes = sorted({point.objects for line in broad.lines for point in line.points})
    ticks, names = _decades(values, what)
    axis = alt.Axis(values=ticks, labelExpr=names)
    domain = list(ink)
    chart = alt.Chart({"values": dots}).mark_line(point=True, strokeWidth=1.5).encode(
        x=alt.X("objects:Q", title=None, scale=alt.Scale(type="log", domain=[sizes[0], sizes[-1]]),
                axis=alt.Axis(values=sizes, format=",", grid=False)),
        y=alt.Y(f"{what}:Q", title=None, scale=alt.Scale(type="log", domain=[ticks[0], ticks[-1]]), axis=axis),
        color=alt.Color("line:N", legend=None, scale=alt.Scale(domain=domain, range=[ink[name].light for name in domain])),
        strokeDash=alt.StrokeDash(
            "line:N", legend=None, scale=alt.Scale(domain=domain, range=[list(ink[name].dash) for name in domain])
        ),
    ).properties(width=WIDTH, height=HEIGHT, background="transparent").configure(
        font=FONT, padding={"left": 4, "top": 2, "right": 10, "bottom": 2}, view=alt.ViewConfig(stroke=None)
    ).configure_axis(labelColor=MUTED[0], gridColor=GRID[0], domain=False, tickColor=GRID[0], labelFontSize=10, tickSize=3)
    return dict(chart.to_dict())


def section(broad: BroadPhase) -> dict[str, object]:
    """What a page needs for its section: the sentence, the panels, and the strokes for the legend."""
    return {"broad_conclusion": conclusion(broad), "broad_panels": panels(broad), "broad_inks": inks(broad)}
