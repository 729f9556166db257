"""The marks, axes and limits of each kind of chart, as Vega-Lite without data: lines over frames, and spans per engine.

The named data sets that a panel has to bring: `lines`, `gaps`, `ceiling` for lines over frames; `spans` for spans; `dots` and
`medians` for one chart of all scenes.
"""

import math
from collections.abc import Iterable, Mapping, Sequence

import altair as alt

from reports.deciding.conclusions import FRAME_60_HZ, OVERLAP_BOUND
from reports.drawing.palette import ALARM, GRID, MUTED, TEXT, Stroke
from reports.words.wording import limit

# The logarithmic axis of overlap ends here [m]; what is smaller, zero included, is drawn on the floor.
OVERLAP_FLOOR, OVERLAP_TOP = 1e-9, 1.0
# Size of a panel's plotting area [px].
WIDTH, HEIGHT = 330, 150
# Width [px] of the plotting area of a chart that stands alone in its section.
STRIPS = 620
FONT = "sans-serif"


def overlap_axis() -> tuple[alt.Scale, alt.Axis]:
    """The same logarithmic axis of length for all panels, the bound's label in the colour of limits."""
    names = "{'-9':'≤ 1 nm','-6':'1 µm','-3':'1 mm','0':'1 m'}[round(log(datum.value)/log(10))]"
    red = alt.condition(f"abs(datum.value / {OVERLAP_BOUND} - 1) < 0.1", alt.value(ALARM[0]), alt.value(MUTED[0]))
    axis = alt.Axis(values=[1e-9, 1e-6, 1e-3, 1.0], labelExpr=names, labelColor=red)
    return alt.Scale(type="log", domain=[OVERLAP_FLOOR, OVERLAP_TOP], clamp=True), axis


def time_axis(times: Iterable[float]) -> tuple[alt.Scale, alt.Axis, float, float]:
    """(scale, axis, lowest, highest) [us]: whole decades below, wide enough for the 60 Hz line above."""
    usable = [value for value in times if math.isfinite(value) and value > 0.0]
    low = 10.0 ** math.floor(math.log10(min(usable, default=10.0)))
    high = max(2.0 * FRAME_60_HZ, 1.05 * max(usable, default=10.0))
    ticks = [10.0**k for k in range(round(math.log10(low)), math.floor(math.log10(high)) + 1)]
    names = ",".join(f"'{round(math.log10(t))}':'{limit(t, 'us')}'" for t in ticks)
    axis = alt.Axis(values=ticks, labelExpr=f"{{{names}}}[round(log(datum.value)/log(10))]")
    return alt.Scale(type="log", domain=[low, high], clamp=True), axis, low, high


def _colour(strokes: Mapping[str, Stroke]) -> alt.Color:
    scale = alt.Scale(domain=list(strokes), range=[stroke.light for stroke in strokes.values()])
    return alt.Color("run:N", scale=scale, legend=None)


def _dash(strokes: Mapping[str, Stroke]) -> alt.StrokeDash:
    scale = alt.Scale(domain=list(strokes), range=[list(stroke.dash) for stroke in strokes.values()])
    return alt.StrokeDash("run:N", scale=scale, legend=None)


def _frame_of(layers: Sequence[alt.Chart]) -> dict[str, object]:
    """The specification of layered marks in the page's style, without data."""
    chart = alt.layer(*layers).properties(width=WIDTH, height=HEIGHT, background="transparent").configure(
        font=FONT, padding={"left": 10, "top": 2, "right": 4, "bottom": 2}, view=alt.ViewConfig(stroke=None),
    ).configure_axis(
        labelColor=MUTED[0], titleColor=MUTED[0], gridColor=GRID[0], domainColor=GRID[0], tickColor=GRID[0],
        labelFontSize=10, titleFontSize=10, titleFontWeight="normal", tickSize=3, domain=False,
    )
    return dict(chart.to_dict())


def _limits(limits: Mapping[str, float], channel: str, scale: alt.Scale) -> list[alt.Chart]:
    """Dashed lines with a word at their end, along the other direction than `channel`."""
    data = {"values": [{"value": value} for value in limits.values()]}
    where = alt.Y("value:Q", scale=scale) if channel == "y" else alt.X("value:Q", scale=scale)
    layers = [alt.Chart(data).mark_rule(color=ALARM[0], strokeDash=[4, 3], strokeWidth=1).encode(**{channel: where})]
    for index, (word, value) in enumerate(limits.items()):
        # Two limits stand close together: the first word goes below or left of its line, the second above or right.
        text = alt.Chart({"values": [{"value": value, "word": word}]}).mark_text(
            color=ALARM[0], fontSize=9, align="right" if channel == "y" or index == 0 else "left",
            baseline="bottom" if channel == "x" or index > 0 else "top", dy=-2 if channel == "x" or index > 0 else 3,
            dx=0 if channel == "y" else 2 if index == 0 else -2,
        )
        other = {"x": alt.value(WIDTH)} if channel == "y" else {"y": alt.value(0)}
        layers.append(text.encode(text="word:N", **{channel: where}, **other))
    return layers


def over_time(
    strokes: Mapping[str, Stroke], scale: alt.Scale, axis: alt.Axis, limits: Mapping[str, float]
) -> dict[str, object]:
    """Lines over frames, the `limits` (word -> value) dashed, gaps in the data as crosses; needs lines, gaps, ceiling."""
    x = alt.X("frame:Q", title="frame", axis=alt.Axis(grid=False, tickCount=5), scale=alt.Scale(nice=False))
    y = alt.Y("value:Q", title=None, scale=scale, axis=axis)
    line = alt.Chart(alt.NamedData("lines")).mark_line(strokeWidth=1.6, strokeJoin="round", interpolate="step-after")
    gap = alt.Chart(alt.NamedData("gaps")).mark_point(shape="cross", size=30, angle=45, filled=True)
    ceiling = alt.Chart(alt.NamedData("ceiling")).mark_rule(color=MUTED[0], strokeDash=[1, 3], strokeWidth=1.2)
    colour = _colour(strokes)
    return _frame_of([
        *_limits(limits, "y", scale), ceiling.encode(y=alt.Y("value:Q", scale=scale)),
        line.encode(x=x, y=y, color=colour, strokeDash=_dash(strokes)),
        gap.encode(x=x, y=y, color=colour),
    ])


def spans(
    strokes: Mapping[str, Stroke], scale: alt.Scale, axis: alt.Axis, limits: Mapping[str, float]
) -> dict[str, object]:
    """One bar per run from p50 to the last that there is, with a mark at each of p50, p95, p99; needs spans."""
    data, colour = alt.NamedData("spans"), _colour(strokes)
    y = alt.Y("run:N", title=None, sort=list(strokes), axis=alt.Axis(grid=False, labelColor=TEXT[0], ticks=False))
    bar = alt.Chart(data).mark_rule(strokeWidth=3, opacity=0.45).encode(y=y, x2="last:Q", color=colour)
    layers = [bar.encode(x=alt.X("p50:Q", title=None, scale=scale, axis=axis))]
    for name, mark in (
        ("p50", alt.Chart(data).mark_circle(size=55, opacity=1)),
        ("p95", alt.Chart(data).mark_tick(thickness=2.5, height=11, opacity=1)),
        ("p99", alt.Chart(data).mark_tick(thickness=1.2, height=7, opacity=1)),
    ):
        layers.append(mark.encode(y=y, x=alt.X(f"{name}:Q", title=None, scale=scale, axis=axis), color=colour))
    return _frame_of([*_limits(limits, "x", scale), *layers])


def strips(
    data: Mapping[str, object], strokes: Mapping[str, Stroke], scale: alt.Scale, axis: alt.Axis, limits: Mapping[str, float],
) -> dict[str, object]:
    """A dot per value in a row per run, a tick at each row's median; `data` holds `dots` and `medians`, (run, value) each."""
    colour = _colour(strokes)
    runs = [run for run in strokes if any(row["run"] == run for row in _list(data["medians"]))]
    y = alt.Y("run:N", title=None, sort=runs, axis=alt.Axis(grid=False, labelColor=TEXT[0], labelPadding=9, ticks=False))
    x = alt.X("value:Q", title=None, scale=scale, axis=axis)
    dots = alt.Chart(alt.NamedData("dots")).mark_circle(size=26, opacity=0.42).encode(x=x, y=y, color=colour)
    ticks = alt.Chart(alt.NamedData("medians")).mark_tick(thickness=2.5, height=15, opacity=1).encode(x=x, y=y, color=colour)
    frame = _frame_of([*_limits(limits, "x", scale), dots, ticks])
    held = frame.get("datasets")
    datasets = (dict(held) if isinstance(held, dict) else {}) | dict(data)
    return frame | {"datasets": datasets, "width": STRIPS, "height": 22 * len(runs)}


def _list(found: object) -> Sequence[Mapping[str, object]]:
    return found if isinstance(found, list) else []
