"""Charts of cells: hard cases by engine, effects by scene; and bars of losses."""

import math
from collections.abc import Sequence

import pandas as pd

from reports.charts.marks import Spec, tooltip
from reports.tables.figures import quantity
from reports.tables.run import Run
from runfiles.engines import run_label
from runfiles.metrics import label

EFFECTS = {
    "dynamics": "dynamics",
    "restitution": "restitution",
    "friction": "friction",
    "continuous": "continuous collision",
    "gyroscopic": "gyroscopic torque",
    "sleeping": "sleeping",
    "overlap_removal": "overlap removal",
    "coupling": "coupling",
    "self_contact": "self contact",
    "limits": "joint limits",
    "reach_cones": "reach cones",
}
"""Effects in the order of the chart, and their names."""

LINE = 12
"""Height of a line of a column's name [px]."""

FAINT = 0.05
"""Share of a frame below which a cost is noise."""


def grid(
    values: Sequence[Spec],
    columns: Sequence[str],
    rows: Sequence[str],
    fill: Spec,
    tip: Sequence[Spec],
    described: str,
    height: int,
) -> Spec:
    """Return a chart of cells with the fields column, row, text, shade and bright (flag: light text)."""
    x = {
        "field": "column",
        "type": "nominal",
        "sort": list(columns),
        "scale": {"domain": list(columns)},
        "axis": {
            "orient": "top",
            "title": None,
            "labelAngle": 0,
            "domain": False,
            "ticks": False,
            "labelLineHeight": LINE,
            "labelExpr": "split(datum.value, ' ')",
            "labelFontSize": 10.5,
            "labelBaseline": "top",
            "labelPadding": 6 + LINE * max((len(one.split()) for one in columns), default=1),
        },
    }
    y = {
        "field": "row",
        "type": "nominal",
        "sort": list(rows),
        "scale": {"domain": list(rows)},
        "axis": {"title": None, "domain": False, "ticks": False, "labelPadding": 8, "labelLimit": 190},
    }
    return {
        "width": "container",
        "height": height * max(len(rows), 1),
        "description": described,
        "data": {"values": list(values)},
        "encoding": {"x": x, "y": y},
        "layer": [
            {
                "mark": {"type": "rect", "stroke": "@paper", "strokeWidth": 2, "cornerRadius": 3},
                "encoding": {"fill": fill, "tooltip": list(tip)},
            },
            {
                "mark": {"type": "text", "fontSize": 11, "tooltip": None},
                "encoding": {
                    "text": {"field": "text", "type": "nominal"},
                    "color": {"condition": {"test": "datum.bright", "value": "#ffffff"}, "value": "@ink"},
                },
            },
        ],
    }


def hard_cases(run: Run, cases: pd.DataFrame) -> Spec:
    """Return hard case by engine: the drift after a nudge, or how often an engine left its region."""
    shown = [name for name in run.runs if name in set(cases.run)]
    values = []
    for row in cases[cases.run.isin(shown)].itertuples():
        lost = int(row.left) + int(row.not_finite)
        text = f"✕ {lost} of {row.trials}" if lost else quantity(row.drift, "m", 2) if row.trials else "–"
        values.append(
            {
                "column": run_label(row.run),
                "row": row.case,
                "text": text,
                "lost": lost > 0,
                "shade": -7.0 if math.isnan(row.drift) else math.log10(max(row.drift, 1e-7)),
                "bright": lost > 0 or row.drift > 5e-3,
                "trials": str(row.trials),
                "finite": str(row.not_finite),
                "left": str(row.left),
                "overlap": quantity(row.overlap, "m") if row.overlap == row.overlap else "–",
                "energy": quantity(row.energy, "J") if row.energy == row.energy else "–",
            }
        )
    order = cases[cases.run == run.gated].sort_values("drift", ascending=False, na_position="first").case.tolist()
    fill = {
        "condition": {"test": "datum.lost", "value": "@alarm"},
        "field": "shade",
        "type": "quantitative",
        "legend": None,
        "scale": {"domain": [-4.5, -0.5], "range": ["@low", "@high"], "clamp": True},
    }
    tip = tooltip(
        row="case",
        column="engine",
        text="drift",
        trials="trials",
        finite="not finite",
        left="left its region",
        overlap="overlap, largest",
        energy="energy gain, largest",
    )
    return grid(values, [run_label(name) for name in shown], order, fill, tip, "Drift after a nudge, hard case by engine.", 29)


def effects(table: pd.DataFrame) -> Spec:
    """Return effect by scene: the share of the frame that an effect takes; empty where it is not simulated."""
    scenes, values = list(dict.fromkeys(table.scenario)), []
    for row in table[table.effect.isin(EFFECTS)].itertuples():
        saves = row.share < -FAINT
        lacking = ", ".join(map(label, row.broken)) or "nothing measured"
        text = (
            "< 5 %"
            if abs(row.share) <= FAINT
            else f"{100.0 * row.share / (1.0 - row.share):.0f} %"
            if saves
            else f"{100.0 * row.share:.0f} %"
        )
        values.append(
            {
                "column": row.scenario.replace("_", " "),
                "row": EFFECTS[row.effect],
                "text": text,
                "shade": max(row.share, 0.0),
                "saves": saves,
                "bright": row.share > 0.4,
                "present": quantity(row.with_us, "us"),
                "absent": quantity(row.without_us, "us"),
                "broken": lacking,
            }
        )
    fill = {
        "condition": {"test": "datum.saves", "value": "@gain"},
        "field": "shade",
        "type": "quantitative",
        "legend": None,
        "scale": {"domain": [0, 1], "range": ["@low", "@high"], "clamp": True},
    }
    tip = tooltip(column="scene", row="effect", present="frame with it", absent="frame without it", broken="worse without it")
    rows = [name for effect, name in EFFECTS.items() if effect in set(table.effect)]
    return grid(
        values, [one.replace("_", " ") for one in scenes], rows, fill, tip, "Share of the frame that each effect takes.", 26
    )


def bars(losses: pd.DataFrame) -> Spec:
    """Return for each metric the share of scenes in which another engine is better."""
    lost = losses[losses.lost > 0]
    values = [
        {
            "label": row.label,
            "share": row.share,
            "text": f"{row.lost} of {row.scenes}",
            "scene": row.scene,
            "run": row.run,
            "own": quantity(row.own, row.unit),
            "best": quantity(row.best, row.unit),
        }
        for row in lost.itertuples()
    ]
    y = {
        "field": "label",
        "type": "nominal",
        "sort": None,
        "axis": {"title": None, "domain": False, "ticks": False, "labelLimit": 230, "labelPadding": 8},
    }
    x = {
        "field": "share",
        "type": "quantitative",
        "scale": {"domain": [0, 1.12]},
        "axis": {"title": None, "format": "%", "values": [0, 0.25, 0.5, 0.75, 1], "domain": False, "tickSize": 0},
    }
    tip = tooltip(label="measure", text="scenes", scene="widest in", own="avatarsim", best="best", run="of")
    return {
        "width": "container",
        "height": 19 * max(len(values), 1),
        "data": {"values": values},
        "encoding": {"y": y, "tooltip": tip},
        "description": "Share of scenes in which another engine is better, by measure.",
        "layer": [
            {
                "mark": {
                    "type": "bar",
                    "height": 12,
                    "cornerRadiusEnd": 2,
                    "color": "@muted",
                    "cursor": "pointer",
                    "opacity": 0.75,
                },
                "encoding": {"x": x},
            },
            {
                "mark": {"type": "text", "align": "left", "dx": 5, "fontSize": 11, "color": "@muted"},
                "encoding": {"x": x, "text": {"field": "text", "type": "nominal"}},
            },
        ],
    }
