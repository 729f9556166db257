"""Charts of lines: error against frame time of all settings of a scene, and figures over the time of a scene."""

import math
from collections.abc import Mapping, Sequence

import numpy as np
import pandas as pd

from reports.charts import marks
from reports.charts.marks import LENGTH_LABEL, TIME_LABEL, Spec, layer, name, number
from reports.reading.load import Array
from runfiles.engines import main_runs, run_label

FLOOR = 1e-7
"""Least error that is told from none [m]."""
ENDS = (2.5e-8, 0.3)
"""Ends of the axis of errors [m]: below FLOOR, so that names of dots lie above the axis; the upper one is for settings that do
not follow their user."""
APART: Spec = {"labelOverlap": "greedy", "labelSeparation": 6}
"""Of an axis: labels that would come nearer than this [px] are left out."""

POINTS = 300
"""Most points of a line over time: as many as a chart is wide, over two."""

DASHES = ([1, 0], [5, 3], [2, 2], [8, 3, 2, 3])
"""Lines of the first preset of an engine in short tables ("tuned", where it has one), its second, third and any further one."""


def error_against_time(names: Sequence[str]) -> Spec:
    """Return the chart of settings; the page fills in the datasets points and limit."""
    colour = marks.by_engine(names)
    axis = marks.BARE | {"title": "frame time", "labelExpr": TIME_LABEL, "tickCount": 4, **APART}
    x = number("time", scale={"type": "log", "nice": False, "padding": 40}, axis=axis)
    text = f"datum.value > 0.2 ? 'does not follow' : datum.value < 2e-7 ? '≤ 0.1 µm' : {LENGTH_LABEL}"
    ticks = {"values": [*(10.0**k for k in range(-7, 0)), ENDS[1]], "labelExpr": text}
    scale = {"type": "log", "domain": list(ENDS), "clamp": True}
    y = number("place", scale=scale, axis=marks.BARE | ticks | {"title": "largest error"})
    both = {"x": x, "y": y}
    inked = both | {"color": colour}
    dots = {
        "tooltip": marks.tooltip(name="setting", text="largest error", which="of", when="frame time", state="bodies"),
        "stroke": colour, "fill": {"condition": {"test": "datum.asleep", "value": "transparent"}, **colour},
        "size": {"condition": {"test": "datum.preset", "value": 95}, "value": 42},
    }
    layers = [
        {"data": {"name": "limit"}} | layer("rule", {"y": number("place")}, strokeDash=[4, 3], color="@alarm"),
        layer("line", inked | {"detail": name("ladder"), "order": number("time")}, strokeWidth=1.4, opacity=0.55),
        layer("text", inked | {"text": name("short")}, align="left", dx=7, dy=-8, fontSize=10.5),
        layer("point", both | dots, opacity=0.9, cursor="pointer", strokeWidth=1.6),
    ]
    described = "Largest error against frame time, a dot per setting of each engine."
    return marks.chart(described, 292, layers, datasets={"points": [], "limit": []}, data={"name": "points"})


def obtained(table: pd.DataFrame, law: str, dashed: Mapping[str, Sequence[int]]) -> Spec:
    """Return the coefficients of a law that the bodies of ``dashed`` runs show, against the stated ones.

    Bars span shapes and steps.
    """
    own, order = table[table.law == law], list(dashed)
    shift = {run: 0.012 * (k - 0.5 * (len(order) - 1)) for k, run in enumerate(order)}
    values = [
        {
            "x": row.stated + shift[row.run], "stated": f"{row.stated:g}", "low": row.low, "high": row.high, "middle": row.middle,
            "engine": row.run.partition("/")[0], "label": run_label(row.run), "run": row.run,
            "text": f"{row.middle:.3f}", "range": f"{row.low:.3f} to {row.high:.3f}",
        }
        for row in own[own.run.isin(order)].itertuples()
    ]
    top = max([1.05, *(value["high"] for value in values)])
    axes = [marks.BARE | {"title": title, "tickCount": 5, "grid": True} for title in ("stated", "obtained")]
    x = number("x", axis=axes[0], scale={"domain": [-0.06, 1.06], "nice": False})
    y = number("middle", axis=axes[1], scale={"domain": [0.0, min(top, 2.0)], "clamp": True})
    colour = marks.by_engine(list(dict.fromkeys(run.partition("/")[0] for run in order)))
    tip = marks.tooltip(label="engine", stated="stated", text="obtained", range="range")
    both = {"x": x, "color": colour, "tooltip": tip, "strokeDash": _dash(dashed)}
    same = {"data": {"values": [{"x": 0.0, "middle": 0.0}, {"x": 1.0, "middle": 1.0}]}}
    layers = [
        same | layer("line", {"x": x, "y": y}, color="@muted", strokeWidth=1),
        layer("rule", both | {"y": y | {"field": "low"}, "y2": {"field": "high"}}, strokeWidth=2, opacity=0.55),
        layer("point", both | {"y": y}, filled=True, size=34),
    ]
    return marks.chart(f"Coefficients of {law} obtained, against the stated ones.", 200, layers, values)


def over_time(
    lines: Mapping[str, tuple[Array, Array]], dashed: Mapping[str, Sequence[int]], unit: str, described: str,
    floor: float | None = None,
) -> Spec:
    """Return lines over the time of a scene, by "engine/preset": times [s] and values, ``dashed`` lines of all charts.

    The axis is logarithmic from ``floor`` on, where there is one. The page makes the data of the columns in `usermeta`: a row
    per point would be most of the page.
    """
    columns = {}
    for run, (times, values) in lines.items():
        indices = [k for k in _shown_indices(values) if math.isfinite(values[k])]
        columns[run] = {
            "engine": run.partition("/")[0], "label": run_label(run), "t": [float(f"{times[k]:.5g}") for k in indices],
            "v": [float(f"{values[k] if floor is None else max(values[k], floor):.4g}") for k in indices],
        }
    axis = marks.BARE | APART | {"tickCount": 5}
    if unit in ("m", "us"):
        axis["labelExpr"] = LENGTH_LABEL if unit == "m" else TIME_LABEL
    if floor is not None:
        axis["labelExpr"] = f"datum.value <= {floor!r} * 1.01 ? '0' : {axis.get('labelExpr', 'datum.label')}"
    scale: Spec = {"zero": True} if floor is None else {"type": "log", "clamp": True, "domainMin": floor}
    encoding = {
        "x": number("t", axis=marks.BARE | APART | {"title": "time [s]"}, scale={"nice": False}),
        "y": number("v", axis=axis, scale=scale),
        "color": marks.by_engine(list(dict.fromkeys(run.partition("/")[0] for run in lines))),
        "detail": name("run"), "strokeDash": _dash(dashed),
        "tooltip": [
            name("label", title="engine"), number("t", title="time [s]"),
            number("v", title=f"value [{unit}]" if unit else "value"),
        ],
    }
    now = {"data": {"values": [{}]}, "transform": [{"calculate": "now", "as": "t"}]}
    cursor = now | layer("rule", {"x": number("t")}, color="@alarm")
    layers = [layer("line", encoding, strokeWidth=1.3, interpolate="monotone"), cursor]
    data, params = {"name": "lines"}, [{"name": "now", "value": 0}]
    return marks.chart(described, 150, layers, data=data, usermeta={"lines": columns}, params=params)


def dashes(runs: Sequence[str]) -> dict[str, Sequence[int]]:
    """Return the dashes of the line of each run, those of short tables first: the same on every page, whatever runs it has."""
    order = list(dict.fromkeys([*main_runs(), *runs]))
    engines = [run.partition("/")[0] for run in order]
    return {run: DASHES[min(engines[:k].count(engines[k]), 3)] for k, run in enumerate(order) if run in runs}


def _dash(dashed: Mapping[str, Sequence[int]]) -> Spec:
    """Return the channel of dashed lines by run."""
    return name("run", legend=None, scale={"domain": list(dashed), "range": [list(one) for one in dashed.values()]})


def _shown_indices(values: Array) -> Sequence[int]:
    """Return the indices of at most POINTS values: the largest of each stretch, so that no peak is lost."""
    if len(values) <= POINTS:
        return range(len(values))
    edges = np.linspace(0, len(values), POINTS + 1).astype(int)
    safe = np.where(np.isnan(values), -np.inf, values)
    return [int(a + np.argmax(safe[a:b])) for a, b in zip(edges, edges[1:], strict=False) if b > a]
