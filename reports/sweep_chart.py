"""The charts of the sweep: error against time per scene, a front per engine, and lines at 60 and 30 frames per second."""

import math
from collections.abc import Mapping, Sequence

import altair as alt

from reports.charts import Panel
from reports.conclusions import FRAME_30_HZ, FRAME_60_HZ
from reports.marks import FONT, HEIGHT, WIDTH
from reports.palette import ALARM, GRID, MUTED, Stroke, strokes
from reports.picture import picture
from reports.sweep import OURS, Point, Rivalry, Sweep, conclusion
from reports.wording import count, limit, listed, quantity

LEAST = 0.3
"""Where an error of exactly nothing is drawn, as a share of the smallest one that counts, in units that count whole things."""


def inks(sweep: Sweep) -> dict[str, Stroke]:
    """A stroke per engine."""
    found = strokes(f"{engine}/default" for engine in sweep.engines)
    return {run.split("/")[0]: stroke for run, stroke in found.items()}


def panels(sweep: Sweep) -> list[Panel]:
    """One panel per scene and error, those that lose first."""
    times = [p.p50 for p in sweep.points if p.p50 > 0.0]
    if not times:
        return []
    made = list[Panel]()
    for rivalry in sweep.rivalries:
        if any(p.p50 > 0.0 and p.floored == p.floored for p in rivalry.points):
            text = f"{rivalry.scenario}. {rivalry.metric} against median frame time. {_front_words(rivalry)}"
            spec = _spec(rivalry, inks(sweep), times)
            title = f"{rivalry.scenario}: {rivalry.metric.removesuffix('_max').replace('_', ' ')}"
            made.append(Panel(title, picture(spec, text, f"w{len(made)}"), _said(rivalry)))
    return made


def _front_words(rivalry: Rivalry) -> str:
    said = tuple(f"{p.run} {quantity(p.error, p.unit)} in {quantity(p.p50, 'us')}" for p in rivalry.front)
    return f"On the front: {listed(said, 9)}."


def _said(rivalry: Rivalry) -> str:
    ours = rivalry.ours
    mine = "" if ours is None else f" Ours: {quantity(ours.error, ours.unit)} in {quantity(ours.p50, 'us')}."
    spoilt = f" Crosses: {listed(tuple(f'{p.run} ({p.state})' for p in rivalry.spoilt), 3)}." if rivalry.spoilt else ""
    return f"Outcome: {rivalry.said}.{mine}{spoilt}"


def _drawn(point: Point, floor: float) -> float:
    return max(point.floored, floor)


def _spec(rivalry: Rivalry, ink: Mapping[str, Stroke], times: Sequence[float]) -> dict[str, object]:
    """Logarithmic both ways; time on one scale for all panels, error on the scene's own, the floor being what counts as none."""
    usable = [p for p in rivalry.points if p.p50 > 0.0 and p.floored == p.floored]
    floor = rivalry.points[0].reached or LEAST
    low = math.floor(math.log10(floor) + 1e-9)
    high = max(math.ceil(math.log10(max(_drawn(p, floor) for p in usable)) + 1e-9), low + 1)
    left, right = math.floor(math.log10(min(times))), math.ceil(math.log10(max(*times, 1.2 * FRAME_30_HZ)))
    dots = [
        {"engine": p.engine, "us": float(f"{p.p50:.4g}"), "error": float(f"{_drawn(p, floor):.4g}"), "size": _size(p)}
        for p in usable
    ]
    steps = [
        {"engine": engine, "us": float(f"{us:.4g}"), "error": float(f"{error:.4g}"), "k": k}
        for engine in ink for k, (us, error) in enumerate(_front(usable, engine, floor, 10.0**right))
    ]
    crosses = [
        {"engine": p.engine, "us": p.p50 if p.p50 > 0.0 else 10.0**right, "error": 10.0**high} for p in rivalry.spoilt
    ]
    colour = alt.Color("engine:N", legend=None, scale=alt.Scale(domain=list(ink), range=[s.light for s in ink.values()]))
    x = alt.X("us:Q", title=None, scale=alt.Scale(type="log", domain=[10.0**left, 10.0**right], clamp=True), axis=alt.Axis(
        values=[10.0**k for k in range(left, right + 1)], labelExpr=_names(range(left, right + 1), "us", ""), grid=False))
    every = max(1, (high - low + 3) // 4)
    ticks = range(low, high + 1, every)
    y = alt.Y("error:Q", title=None, scale=alt.Scale(type="log", domain=[10.0**low, 10.0**high], clamp=True), axis=alt.Axis(
        values=[10.0**k for k in ticks], labelExpr=_names(ticks, rivalry.unit, "≤ ")))
    layers = [
        alt.Chart({"values": [{"us": FRAME_60_HZ}, {"us": FRAME_30_HZ}]}).mark_rule(
            color=ALARM[0], strokeDash=[4, 3], strokeWidth=1).encode(x="us:Q"),
        alt.Chart({"values": steps}).mark_line(interpolate="step-after", strokeWidth=1.4, opacity=0.7).encode(
            x=x, y=y, color=colour, order="k:Q"),
        alt.Chart({"values": dots}).mark_point(filled=True, opacity=0.85).encode(
            x=x, y=y, color=colour, size=alt.Size("size:Q", scale=None)),
        alt.Chart({"values": crosses}).mark_point(shape="cross", size=36, angle=45, filled=True).encode(x=x, y=y, color=colour),
    ]
    chart = alt.layer(*layers).properties(width=WIDTH, height=HEIGHT, background="transparent").configure(
        font=FONT, padding={"left": 4, "top": 4, "right": 12, "bottom": 2}, view=alt.ViewConfig(stroke=None)
    ).configure_axis(labelColor=MUTED[0], gridColor=GRID[0], domain=False, tickColor=GRID[0], labelFontSize=10, tickSize=3)
    return dict(chart.to_dict())


def _size(point: Point) -> int:
    """Ours as it comes out of the box is the largest dot; presets are larger than what was turned."""
    return 90 if (point.engine, point.setting) == OURS else 34 if " " not in point.setting else 16


def _names(powers: Sequence[int] | range, unit: str, first: str) -> str:
    """A Vega expression that says powers of ten in a unit, the first of them with a word before it."""
    said = ",".join(f"'{k}':'{first if k == powers[0] else ''}{limit(10.0**k, unit)}'" for k in powers)
    return f"{{{said}}}[round(log(datum.value)/log(10))]"


def _front(points: Sequence[Point], engine: str, floor: float, end: float) -> list[tuple[float, float]]:
    """The front of one engine as corners of a staircase, out to the longest time."""
    own = sorted((p.p50, _drawn(p, floor)) for p in points if p.engine == engine and p.front)
    return [*own, (end, own[-1][1])] if own else []


def section(sweep: Sweep) -> dict[str, object]:
    """What the section is made of."""
    lost = sum(r.lost for r in sweep.rivalries)
    return {
        "sweep_conclusion": conclusion(sweep), "sweep_panels": panels(sweep), "sweep_inks": inks(sweep),
        "sweep_lost": f"{lost} of {count(len(sweep.rivalries), 'row')} lost",
    }
