"""Charts of cells: hard cases by engine, effects by scene; and bars of losses."""

import math
from collections import Counter
from collections.abc import Sequence
from itertools import groupby

import pandas as pd

from avatarsim.scene.effects import CALLS, KEPT
from reports.charts import marks
from reports.charts.marks import Spec, layer, name, number
from reports.tables.figures import quantity
from reports.tables.run import Run
from runfiles.engines import about, run_label
from runfiles.metrics import label

NAMES = {"limits": "joint limits", "continuous": "continuous collision", "gyroscopic": "gyroscopic torque"}
EFFECTS = {
    call.effect: (NAMES.get(call.effect, call.effect.replace("_", " ")), f"{call.part}: {call.why}")
    for call in CALLS if call.effect not in KEPT
}
"""Effects in the order of the chart: their names, and the part of a scene that they are for."""
LINE = 12
"""Height of a line of a column's name [px]."""
CASES_HEIGHT = 290
"""Height of the cells of hard cases [px]: that of the chart beside; few cases have higher cells."""
COLUMNS = 5
"""Columns of hard cases whose text fits; of more runs the first of each engine has one."""
FAINT = 0.05
"""Share of a frame below which a cost is noise."""


def grid(
    values: Sequence[Spec], columns: Sequence[str], rows: Sequence[str], fill: Spec, tip: Sequence[Spec], described: str,
    height: int,
) -> Spec:
    """Return a chart of cells with the fields column, row, text, shade, bright (flag: light text) and lost (flag: text in the
    page's colour)."""
    padding = 6 + LINE * max((len(one.split()) for one in columns), default=1)
    x = marks.names_in_order(
        "column", columns, orient="top", labelAngle=0, labelLineHeight=LINE, labelExpr="split(datum.value, ' ')",
        labelFontSize=10.5, labelBaseline="top", labelPadding=padding,
    )
    y = marks.names_in_order("row", rows, labelPadding=8, labelLimit=190)
    lost, bright = {"test": "datum.lost", "value": "@paper"}, {"test": "datum.bright", "value": "#ffffff"}
    ink = {"condition": [lost, bright], "value": "@ink"}
    layers = [
        layer("rect", {"fill": fill}, stroke="@paper", strokeWidth=2, cornerRadius=3),
        layer("text", {"text": name("text"), "color": ink}, fontSize=11),
    ]
    return marks.chart(described, height * max(len(rows), 1), layers, values, encoding={"x": x, "y": y, "tooltip": list(tip)})


def hard_cases(run: Run, cases: pd.DataFrame) -> Spec:
    """Return hard case by engine: the drift after a nudge, or how often an engine left its region."""
    shown, values = [one for one in run.runs if one in set(cases.run)], []
    if len(shown) > COLUMNS:
        # runs of an engine follow one another, the first of its presets first
        shown = [next(group) for _, group in groupby(shown, key=lambda one: one.partition("/")[0])]
    for row in cases[cases.run.isin(shown)].itertuples():
        lost = int(row.left) + int(row.not_finite)
        values.append({
            "column": run_label(row.run), "row": row.case, "lost": lost > 0, "bright": lost > 0 or row.drift > 5e-3,
            "text": f"✕ {lost} of {row.trials}" if lost else quantity(row.drift, "m", 2) if row.trials else "–",
            "shade": -7.0 if math.isnan(row.drift) else math.log10(min(max(row.drift, 1e-7), 1e7)),
            "trials": str(row.trials), "finite": str(row.not_finite), "left": str(row.left),
            "overlap": quantity(row.overlap, "m") if row.overlap == row.overlap else "–",
            "energy": quantity(row.energy, "J") if row.energy == row.energy else "–",
        })
    order = cases[cases.run == run.gated].sort_values("drift", ascending=False, na_position="first").case.tolist()
    tip = marks.tooltip(
        row="case", column="engine", text="drift", trials="trials", finite="not finite", left="left its region",
        overlap="overlap, largest", energy="energy gain, largest",
    )
    fill, described = marks.shades(-4.5, -0.5, "datum.lost", "@alarm"), "Drift after a nudge, hard case by engine."
    height = min(max(CASES_HEIGHT // max(len(order), 1), 29), 48)
    return grid(values, [run_label(one) for one in shown], order, fill, tip, described, height)


def effects(table: pd.DataFrame) -> Spec:
    """Return effect by scene: the share of the frame that an effect takes; empty where it is not simulated."""
    values = [
        {
            "column": row.scenario.replace("_", " "), "row": EFFECTS[row.effect][0], "does": EFFECTS[row.effect][1],
            "text": _cost(row.share),
            "shade": max(row.share, 0.0), "saves": row.share < -FAINT, "bright": row.share > 0.4,
            "present": quantity(row.with_us, "us"), "absent": quantity(row.without_us, "us"),
            "broken": ", ".join(map(label, row.broken)) or "nothing measured",
        }
        for row in table[table.effect.isin(EFFECTS)].itertuples()
    ]
    tip = marks.tooltip(
        column="scene", row="effect", does="for", present="frame with it", absent="frame without it", broken="worse without it"
    )
    rows = [title for effect, (title, _) in EFFECTS.items() if effect in set(table.effect)]
    columns = [one.replace("_", " ") for one in dict.fromkeys(table.scenario)]
    fill, described = marks.shades(0, 1, "datum.saves", "@gain"), "Share of the frame that each effect takes."
    return grid(values, columns, rows, fill, tip, described, 26)


def _cost(share: float) -> str:
    """Return a share of the frame in percent; where the effect saves time, the share of the frame without it that is saved."""
    if abs(share) <= FAINT:
        return "< 5 %"
    return f"{100.0 * share:.0f} %" if share > 0.0 else f"−{100.0 * share / (share - 1.0):.0f} %"


def bars(losses: pd.DataFrame) -> Spec:
    """Return for each metric the number of scenes in which another engine is better, by the engine that is best there.

    The metric of the page's list is the signal `chosen`.
    """
    values = [
        {
            "metric": row.metric, "label": row.label, "engine": engine, "best": about(engine).label, "count": count,
            "lost": row.lost, "text": f"{row.lost} of {row.scenes}", "is_first": k == 0,
        }
        for row in losses[losses.lost > 0].itertuples()
        for k, (engine, count) in enumerate(sorted(Counter(one.run.partition("/")[0] for one in row.each).items()))
    ]
    y = name("label", sort=None, axis=marks.NAMES | {"labelLimit": 230, "labelPadding": 8})
    axis = marks.BARE | {"tickCount": 5, "format": "d", "title": "scenes"}
    most = max((1.4 * value["lost"] for value in values), default=1.0)
    scale, engines = {"domain": [0, most], "nice": False}, list(dict.fromkeys(value["engine"] for value in values))
    tip = marks.tooltip(label="measure", best="best engine", count="in scenes", text="of all engines")
    bar = {
        "x": number("count", scale=scale, axis=axis), "color": marks.by_engine(engines),
        "opacity": {"condition": {"test": "datum.metric == chosen", "value": 1}, "value": 0.6},
    }
    layers = [
        layer("bar", bar, height=13, cursor="pointer"),
        {"transform": [{"filter": "datum.is_first"}]}
        | layer("text", {"x": number("lost"), "text": name("text")}, align="left", dx=5, color="@muted", cursor="pointer"),
    ]
    described = "Scenes in which another engine is better, by measure and best engine."
    height, params = 19 * max(len({one["label"] for one in values}), 1), [{"name": "chosen", "value": ""}]
    return marks.chart(described, height, layers, values, encoding={"y": y, "tooltip": tip}, params=params)
