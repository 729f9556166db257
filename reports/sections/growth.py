"""Frame time against the number of links and of avatars, from what `scenarios.growth` left in the run: lines, charts, words."""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import altair as alt
import numpy as np

from reports.drawing.charts import Panel
from reports.drawing.marks import FONT, HEIGHT, WIDTH
from reports.drawing.palette import GRID, MUTED, Stroke, strokes
from reports.drawing.picture import picture
from reports.words.wording import limit, listed, quantity
from runfiles.csv_rows import lines, number

ROWS = "growth.csv"
OURS = "avatarsim/default"
FRAME = 1e6 / 60.0
"""Time of a frame at 60 Hz [us]."""


@dataclass(frozen=True)
class Point:
    """One engine at one size: frame time [us], median and p95; nan with the reason in `note`."""

    grows: str
    mode: str
    size: int
    links: int
    run: str
    p50: float
    p95: float
    note: str


@dataclass(frozen=True)
class Growth:
    """All points of a run."""

    points: tuple[Point, ...]

    @property
    def runs(self) -> tuple[str, ...]:
        """Engines and presets in the order of the file."""
        return tuple(dict.fromkeys(point.run for point in self.points))

    def line(self, grows: str, mode: str, run: str) -> tuple[Point, ...]:
        """The timed points of one engine, smallest first."""
        found = (p for p in self.points if (p.grows, p.mode, p.run) == (grows, mode, run) and p.p50 > 0.0)
        return tuple(sorted(found, key=lambda point: point.size))


def load(run_dir: Path) -> Growth | None:
    """The file of a run; None when there is none. Raises InvalidFile for a file that is damaged."""
    found = lines(run_dir / ROWS, _point)
    return Growth(found) if found else None


def _point(row: Mapping[str, str]) -> Point:
    size, links = int(row["size"]), int(row["links"])
    return Point(row["grows"], row["mode"], size, links, row["run"], number(row["p50"]), number(row["p95"]), row["note"])


def power(points: tuple[Point, ...]) -> float:
    """The power of the size with which the median grows: slope through the logarithms; nan with fewer than two points."""
    if len(points) < 2:
        return math.nan
    return float(np.polyfit(np.log([p.size for p in points]), np.log([p.p50 for p in points]), 1)[0])


def steepest(points: tuple[Point, ...]) -> float:
    """The largest power between two neighbouring sizes."""
    pairs = zip(points, points[1:], strict=False)
    return max((math.log(b.p50 / a.p50) / math.log(b.size / a.size) for a, b in pairs), default=math.nan)


def conclusion(growth: Growth) -> str:
    """What to conclude, losses first: where ours grows faster than in proportion, and where another engine is faster."""
    kinds = tuple(dict.fromkeys((p.grows, p.mode) for p in growth.points))
    steep, slower, said = [], [], []
    for grows, mode in kinds:
        ours = growth.line(grows, mode, OURS)
        if not ours:
            continue
        ends = (f"{quantity(end.p50, 'us')} at {end.size}" for end in (ours[0], ours[-1]))
        said.append(f"{grows}, {mode}: {', '.join(ends)}")
        if steepest(ours) > 1.0:
            steep.append(f"{grows}, {mode} (power {power(ours):.2f} over all, {steepest(ours):.2f} at its steepest)")
        for run in growth.runs:
            for theirs in growth.line(grows, mode, run):
                here = [p for p in ours if p.size == theirs.size and theirs.p50 < p.p50]
                slower += [f"{run} with {theirs.size} {grows}, {mode}" for _ in here]
    if not said:
        return "Nothing was measured."
    fast = f"Faster than in proportion, ours grows with {listed(tuple(steep))}."
    parts = [fast if steep else "Ours grows at most in proportion."]
    parts += [f"Faster than ours: {listed(tuple(slower))}."] if slower else []
    return " ".join([*parts, *limits_of_impulses(growth), f"Ours, {'; '.join(said)}."])


def limits_of_impulses(growth: Growth) -> list[str]:
    """Up to how many contacts impulses, one after the other, keep up with 60 frames a second, for each kind of pile."""
    said = []
    for mode in dict.fromkeys(p.mode for p in growth.points if p.grows == "contacts"):
        ours = growth.line("contacts", mode, OURS)
        late = [p for p in ours if p.p95 > FRAME]
        if late:
            kept = [p.size for p in ours if p.size < late[0].size]
            before = f"{max(kept)} contacts keep up with 60 frames a second" if kept else "none keep up"
            said.append(f"{mode}: {before}, {late[0].size} do not (p95 {quantity(late[0].p95, 'us')})")
        elif ours:
            said.append(f"{mode}: {ours[-1].size} contacts keep up with 60 frames a second (p95 {quantity(ours[-1].p95, 'us')})")
    if not said:
        return []
    return [f"Contacts solved one impulse after the other, {'; '.join(said)}. Where they do not keep up, many bodies in motion "
            "depend on one another, and a solver for all of them at once is the right tool."]


def panels(growth: Growth) -> list[Panel]:
    """A panel for links and one for avatars, in each mode."""
    inks, made = strokes(growth.runs), list[Panel]()
    for grows, mode in dict.fromkeys((p.grows, p.mode) for p in growth.points):
        dots: list[dict[str, object]] = [
            {"run": run, "size": p.size, "us": float(f"{p.p50:.4g}")}
            for run in growth.runs for p in growth.line(grows, mode, run)
        ]
        if dots:
            said = "; ".join(f"{run} grows with the power {power(growth.line(grows, mode, run)):.2f}" for run in growth.runs
                             if len(growth.line(grows, mode, run)) > 1)
            text = f"Median frame time against number of {grows}, {mode}. {said}."
            made.append(Panel(f"{grows}, {mode}", picture(_spec(growth, dots, inks), text, f"g{len(made)}"), f"{said}."))
    return made


def _spec(growth: Growth, dots: list[dict[str, object]], inks: Mapping[str, Stroke]) -> dict[str, object]:
    """Logarithmic both ways, one scale of time for all panels."""
    values = [p.p50 for p in growth.points if p.p50 > 0.0]
    low, high = math.floor(math.log10(min(values))), math.ceil(math.log10(max(values)))
    names = ",".join(f"'{k}':'{limit(10.0**k, 'us')}'" for k in range(low, high + 1))
    sizes = sorted({float(str(dot["size"])) for dot in dots})
    colours = alt.Scale(domain=list(inks), range=[ink.light for ink in inks.values()])
    dashes = alt.Scale(domain=list(inks), range=[list(ink.dash) for ink in inks.values()])
    chart = alt.Chart({"values": dots}).mark_line(point=True, strokeWidth=1.5).encode(
        x=alt.X("size:Q", title=None, scale=alt.Scale(type="log", domain=[sizes[0], sizes[-1]]),
                axis=alt.Axis(values=sizes, format="d", grid=False)),
        y=alt.Y("us:Q", title=None, scale=alt.Scale(type="log", domain=[10.0**low, 10.0**high]), axis=alt.Axis(
            values=[10.0**k for k in range(low, high + 1)], labelExpr=f"{{{names}}}[round(log(datum.value)/log(10))]")),
        color=alt.Color("run:N", legend=None, scale=colours), strokeDash=alt.StrokeDash("run:N", legend=None, scale=dashes),
    ).properties(width=WIDTH, height=HEIGHT, background="transparent").configure(
        font=FONT, padding={"left": 4, "top": 2, "right": 10, "bottom": 2}, view=alt.ViewConfig(stroke=None)
    ).configure_axis(labelColor=MUTED[0], gridColor=GRID[0], domain=False, tickColor=GRID[0], labelFontSize=10, tickSize=3)
    return dict(chart.to_dict())


def section(growth: Growth) -> dict[str, object]:
    """What a page needs for its section."""
    return {"growth_panels": panels(growth), "growth_conclusion": conclusion(growth), "growth_inks": strokes(growth.runs)}
