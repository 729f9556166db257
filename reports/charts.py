"""The three kinds of chart, each drawn as one small panel per scene. A panel is a static picture and a sentence.

Altair builds each kind once, as a frame without data; a panel is that frame with its own numbers (building and checking
a specification costs more than drawing it).
"""

import copy
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import altair as alt
import numpy as np

from reports.conclusions import (
    FRAME_30_HZ,
    FRAME_60_HZ,
    OVERLAP_BOUND,
    overlap_sentence,
    overlap_text,
    time_sentence,
)
from reports.columns import worst
from reports.load import Array, Results, Series
from reports.palette import ALARM, GRID, MUTED, TEXT, Stroke
from reports.picture import picture
from reports.wording import quantity

# Points per line at most: more do not fit the width of a panel. Each point is the largest of its group of frames,
# so that no spike is lost.
MOST_POINTS = 160
# The logarithmic axis of overlap ends here [m]; what is smaller, zero included, is drawn on the floor.
OVERLAP_FLOOR, OVERLAP_TOP = 1e-9, 1.0
WIDTH, HEIGHT = 330, 150
FONT = "sans-serif"
Percentiles = tuple[float, float, float]


@dataclass(frozen=True)
class Panel:
    """One scene of one chart: an SVG (text alternative inside) and the sentence that says what to conclude."""

    scene: str
    svg: str
    conclusion: str


def peaks(values: Array, most: int = MOST_POINTS) -> tuple[Array, Array, Array]:
    """(frame, largest finite value, whether a value in the group is missing) for at most `most` groups, each (groups,)."""
    groups = np.array_split(np.arange(values.size), min(most, values.size)) if values.size else []
    frames = np.array([group[0] for group in groups], dtype=np.float64)
    broken = np.array([not np.isfinite(values[group]).all() for group in groups], dtype=np.float64)
    largest = np.array([np.max(values[g][np.isfinite(values[g])], initial=-math.inf) for g in groups], dtype=np.float64)
    return frames, largest, broken


def _points(runs: Mapping[str, Array], floor: float, top: float) -> tuple[list[dict[str, object]], list[dict[str, object]]]:
    lines, gaps = [], []
    for run, values in runs.items():
        for frame, value, broken in zip(*peaks(values), strict=True):
            if math.isfinite(value):
                lines.append({"run": run, "frame": int(frame), "value": float(f"{min(max(value, floor), top):.4g}")})
            if broken:
                gaps.append({"run": run, "frame": int(frame), "value": top})
    return lines, gaps


def _colour(strokes: Mapping[str, Stroke]) -> alt.Color:
    scale = alt.Scale(domain=list(strokes), range=[stroke.light for stroke in strokes.values()])
    return alt.Color("run:N", scale=scale, legend=None)


def _dash(strokes: Mapping[str, Stroke]) -> alt.StrokeDash:
    scale = alt.Scale(domain=list(strokes), range=[list(stroke.dash) for stroke in strokes.values()])
    return alt.StrokeDash("run:N", scale=scale, legend=None)


def _frame_of(layers: Sequence[alt.Chart]) -> dict[str, object]:
    """The specification of layered marks in the page's style, without data."""
    chart = alt.layer(*layers).properties(width=WIDTH, height=HEIGHT, background="transparent").configure(
        font=FONT, padding=2, view=alt.ViewConfig(stroke=None),
    ).configure_axis(
        labelColor=MUTED[0], titleColor=MUTED[0], gridColor=GRID[0], domainColor=GRID[0], tickColor=GRID[0],
        labelFontSize=10, titleFontSize=10, titleFontWeight="normal", tickSize=3, domain=False,
    )
    return dict(chart.to_dict())


def _limits(values: Mapping[str, float], channel: str, scale: alt.Scale) -> list[alt.Chart]:
    """Dashed lines with a word at their end, along the other direction than `channel`."""
    data = alt.Data(values=[{"value": value, "word": word} for word, value in values.items()])
    rule = alt.Chart(data).mark_rule(color=ALARM[0], strokeDash=[4, 3], strokeWidth=1)
    text = alt.Chart(data)
    if channel == "y":
        where = alt.Y("value:Q", scale=scale)
        words = text.mark_text(color=ALARM[0], align="right", baseline="bottom", fontSize=9, dy=-1)
        return [rule.encode(y=where), words.encode(y=where, x=alt.value(WIDTH), text="word:N")]
    along = alt.X("value:Q", scale=scale)
    words = text.mark_text(color=ALARM[0], align="center", baseline="bottom", fontSize=9, dy=-2)
    return [rule.encode(x=along), words.encode(x=along, y=alt.value(0), text="word:N")]


def _over_time(
    strokes: Mapping[str, Stroke], scale: alt.Scale, axis: alt.Axis, limits: Mapping[str, float]
) -> dict[str, object]:
    x = alt.X("frame:Q", title="frame", axis=alt.Axis(grid=False, tickCount=5), scale=alt.Scale(nice=False))
    y = alt.Y("value:Q", title=None, scale=scale, axis=axis)
    line = alt.Chart(alt.NamedData("lines")).mark_line(strokeWidth=1.6, strokeJoin="round", interpolate="step-after")
    gap = alt.Chart(alt.NamedData("gaps")).mark_point(shape="cross", size=30, angle=45, filled=True)
    colour = _colour(strokes)
    return _frame_of([
        *_limits(limits, "y", scale), line.encode(x=x, y=y, color=colour, strokeDash=_dash(strokes)),
        gap.encode(x=x, y=y, color=colour),
    ])


def overlap_panels(results: Results, strokes: Mapping[str, Stroke], order: Sequence[str]) -> list[Panel]:
    """Residual overlap over time, one panel per scene that has a series."""
    scale = alt.Scale(type="log", domain=[OVERLAP_FLOOR, OVERLAP_TOP], clamp=True)
    names = "{'-9':'≤ 1 nm','-6':'1 µm','-3':'1 mm','0':'1 m'}[round(log(datum.value)/log(10))]"
    axis = alt.Axis(values=[1e-9, 1e-6, 1e-3, 1.0], labelExpr=names)
    frame = _over_time(strokes, scale, axis, {"bound": OVERLAP_BOUND})
    panels = []
    for scene in order:
        runs = _back_to_front({k: s for k, s in results.series.get(scene, {}).items() if s.overlap.size})
        if runs:
            lines, gaps = _points({run: s.overlap for run, s in runs.items()}, OVERLAP_FLOOR, OVERLAP_TOP)
            spec = frame | {"datasets": _datasets(frame) | {"lines": lines, "gaps": gaps}}
            text = f"{scene}. {overlap_text(results.series[scene])}"
            panels.append(Panel(scene, picture(spec, text, f"o{len(panels)}"), overlap_sentence(results.series[scene])))
    return panels


def _datasets(frame: Mapping[str, object]) -> dict[str, object]:
    held = frame.get("datasets")
    return dict(held) if isinstance(held, dict) else {}


def _back_to_front(runs: Mapping[str, Series]) -> dict[str, Series]:
    """The raw tracker first, so that the engines are drawn over it."""
    return dict(sorted(runs.items(), key=lambda item: not item[0].startswith("tracker/")))


def time_percentiles(results: Results) -> dict[str, dict[str, Percentiles]]:
    """p50, p95, p99 [us] per scene and run: from the rows, and where a row is missing from the series; NaN if neither has it."""
    found: dict[str, dict[str, Percentiles]] = {}
    for scene in results.scenes():
        rows = [row for row in results.rows if row.scenario == scene]
        for run in dict.fromkeys(row.run for row in rows):
            series = results.series.get(scene, {}).get(run)
            timed = series.frame_time[np.isfinite(series.frame_time)] if series else np.empty(0)
            three = []
            for percent in (50, 95, 99):
                row = worst([r for r in rows if r.run == run and r.metric == f"frame_time_p{percent}"])
                fallback = float(np.percentile(timed, percent)) if timed.size else math.nan
                three.append(fallback if row is None or row.value is None else row.value)
            if any(math.isfinite(value) and value > 0.0 for value in three):
                found.setdefault(scene, {})[run] = (three[0], three[1], three[2])
    return found


def _time_scale(found: Mapping[str, Mapping[str, Percentiles]], results: Results) -> tuple[alt.Scale, alt.Axis, float, float]:
    """One logarithmic axis for all panels, whole decades, wide enough for the 30 Hz line."""
    values = [v for runs in found.values() for three in runs.values() for v in three]
    values += [float(v) for runs in results.series.values() for s in runs.values() for v in s.frame_time]
    usable = [v for v in values if math.isfinite(v) and v > 0.0]
    low = 10.0 ** math.floor(math.log10(min(usable, default=10.0)))
    high = max(2.0 * FRAME_30_HZ, 1.05 * max(usable, default=10.0))
    ticks = [10.0**k for k in range(round(math.log10(low)), math.floor(math.log10(high)) + 1)]
    names = ",".join(f"'{round(math.log10(t))}':'{quantity(t, 'us')}'" for t in ticks)
    axis = alt.Axis(values=ticks, labelExpr=f"{{{names}}}[round(log(datum.value)/log(10))]")
    return alt.Scale(type="log", domain=[low, high], clamp=True), axis, low, high


def time_panels(results: Results, strokes: Mapping[str, Stroke], order: Sequence[str]) -> tuple[list[Panel], list[Panel]]:
    """(percentiles per engine, frame time over frames), one panel per scene in which frames were timed."""
    found = time_percentiles(results)
    scale, axis, low, high = _time_scale(found, results)
    budgets = {"60 Hz": FRAME_60_HZ, "30 Hz": FRAME_30_HZ}
    spread, course = _spread(strokes, scale, axis, budgets), _over_time(strokes, scale, axis, budgets)
    spreads, courses = [], []
    for scene in order:
        runs = found.get(scene, {})
        if runs:
            rows = [_span(run, three, low) for run, three in runs.items()]
            spec = copy.deepcopy(spread) | {"datasets": _datasets(spread) | {"spans": rows}, "height": 20 * len(rows)}
            said = "; ".join(f"{run}: {', '.join(quantity(v, 'us') for v in three)}" for run, three in runs.items())
            text = f"{scene}. Frame time p50, p95, p99. {said}."
            spreads.append(Panel(scene, picture(spec, text, f"s{len(spreads)}"), time_sentence(runs)))
        series = {run: s.frame_time for run, s in results.series.get(scene, {}).items() if s.frame_time.size}
        if series:
            lines, gaps = _points(series, low, high)
            spec = course | {"datasets": _datasets(course) | {"lines": lines, "gaps": gaps}}
            text, said = _course_words(scene, series)
            courses.append(Panel(scene, picture(spec, text, f"c{len(courses)}"), said))
    return spreads, courses


def _span(run: str, three: Percentiles, low: float) -> dict[str, object]:
    names = ("p50", "p95", "p99")
    return {"run": run} | {n: max(v, low) if math.isfinite(v) else None for n, v in zip(names, three, strict=True)}


def _spread(
    strokes: Mapping[str, Stroke], scale: alt.Scale, axis: alt.Axis, limits: Mapping[str, float]
) -> dict[str, object]:
    data, colour = alt.NamedData("spans"), _colour(strokes)
    y = alt.Y("run:N", title=None, sort=list(strokes), axis=alt.Axis(grid=False, labelColor=TEXT[0], ticks=False))
    bar = alt.Chart(data).mark_rule(strokeWidth=3, opacity=0.45).encode(y=y, x2="p99:Q", color=colour)
    layers = [bar.encode(x=alt.X("p50:Q", title=None, scale=scale, axis=axis))]
    for name, mark in (
        ("p50", alt.Chart(data).mark_circle(size=55, opacity=1)),
        ("p95", alt.Chart(data).mark_tick(thickness=2.5, height=11, opacity=1)),
        ("p99", alt.Chart(data).mark_tick(thickness=1.2, height=7, opacity=1)),
    ):
        layers.append(mark.encode(y=y, x=alt.X(f"{name}:Q", title=None, scale=scale, axis=axis), color=colour))
    return _frame_of([*_limits(limits, "x", scale), *layers])


def _course_words(scene: str, series: Mapping[str, Array]) -> tuple[str, str]:
    """(text alternative, conclusion) of one panel of frame times over frames."""
    finite = {run: v[np.isfinite(v)] for run, v in series.items() if np.isfinite(v).any()}
    if not finite:
        return f"{scene}. No finite frame time.", "No frame time here is a finite number."
    ratios = {run: float(np.max(v) / np.median(v)) for run, v in finite.items() if np.median(v) > 0.0}
    said = "; ".join(f"{run}: median {quantity(float(np.median(v)), 'us')}, slowest {quantity(float(np.max(v)), 'us')} "
                     f"in frame {int(np.nanargmax(series[run]))}" for run, v in finite.items())
    calm = min(ratios, key=lambda run: ratios[run], default="")
    wild = max(ratios, key=lambda run: ratios[run], default="")
    conclusion = "" if not ratios else f"The slowest frame of {wild} takes {ratios[wild]:.3g} times its median"
    conclusion += f"; {calm} is the steadiest with {ratios[calm]:.3g} times." if len(ratios) > 1 else "." if ratios else ""
    return f"{scene}. Frame time over frames. {said}.", conclusion or "Every frame time here is zero."
