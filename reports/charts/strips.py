"""Strip charts: a dot per scene, a row per engine, filled where the figure compares engines."""

from collections.abc import Mapping
from dataclasses import dataclass

from reports.charts.marks import Spec, by_engine, labels, place_of, tooltip
from reports.tables.figures import quantity
from reports.tables.run import Run
from runfiles.engines import run_label
from runfiles.metrics import METRICS

ROW = 24
"""Height of a row [px]."""


@dataclass(frozen=True)
class Strip:
    """A strip chart.

    metric  on the axis
    low, high  ends of the axis; dots outside lie on them
    ticks   labels of the axis by value
    rule    value of a dashed line, and its label; None without
    """

    metric: str
    low: float
    high: float
    ticks: Mapping[float, str]
    rule: tuple[float, str] | None = None


STRIPS: Mapping[str, Strip] = {
    "overlap": Strip("residual_overlap_max", 1e-9, 1.0, {1e-9: "0", 1e-6: "1 µm", 1e-3: "1 mm", 1.0: "1 m"}, (1e-6, "limit")),
    "bounce": Strip("restitution_error_max", 1e-7, 1.0, {1e-7: "0", 1e-5: "10⁻⁵", 1e-3: "0.001", 1e-1: "0.1"}),
    "limits": Strip("joint_limit_excess_max", 1e-3, 200.0, {1e-3: "0°", 0.1: "0.1°", 1.0: "1°", 10.0: "10°", 100.0: "100°"}),
    "time": Strip("frame_time_p95", 0.1, 2e4, {0.1: "0.1 µs", 10.0: "10 µs", 1e3: "1 ms"}, (1e6 / 90.0, "90 Hz")),
}
"""The four quantities that the comparison is about."""

TITLES: Mapping[str, tuple[str, str]] = {
    "overlap": ("Overlap left", "deepest, per scene"),
    "bounce": ("Bounce error", "rebound speed ratio"),
    "limits": ("Beyond joint limits", "largest angle"),
    "time": ("Frame time", "95th percentile"),
}
"""Title and subtitle of each."""


def strip(run: Run, chart: Strip, described: str, named: bool = True) -> Spec:
    """Return the chart of a run; ``named``: with the names of the engines."""
    rows = run.rows[(run.rows.metric == chart.metric) & run.rows.run.isin(run.runs) & run.rows.measured]
    unit, dots = METRICS[chart.metric].unit, []
    shares = rows.groupby("run").even.mean()
    for row in rows.itertuples():
        value = chart.high if row.value != row.value else min(max(row.value, chart.low), chart.high)
        dots.append(
            {
                "scene": row.scenario,
                "engine": row.engine,
                "label": run_label(row.run),
                "value": value,
                "text": "NaN" if row.value != row.value else quantity(row.value, unit),
                "even": row.even,
                "counted": bool(row.even and shares[row.run] >= 0.5),
                "why": f"yes; {row.why}" if row.even and row.why else row.why or "yes",
                "place": place_of(row.scenario),
            }
        )
    order = [run_label(name) for name in run.runs]
    axis = {
        "values": list(chart.ticks),
        "labelExpr": labels(chart.ticks),
        "title": None,
        "domain": False,
        "tickSize": 0,
        "grid": True,
        "labelPadding": 6,
    }
    x = {
        "field": "value",
        "type": "quantitative",
        "axis": axis,
        "scale": {"type": "log", "domain": [chart.low, chart.high], "clamp": True},
    }
    y = {
        "field": "label",
        "type": "nominal",
        "sort": order,
        "scale": {"domain": order},
        "axis": {"title": None, "domain": False, "ticks": False, "labelPadding": 10, "labelLimit": 160, "labels": named},
    }
    colour = by_engine(list(dict.fromkeys(name.partition("/")[0] for name in run.runs)))
    off = {"field": "place", "type": "quantitative", "scale": {"domain": [-1.9, 1.9]}}
    tip = tooltip(scene="scene", label="engine", text=METRICS[chart.metric].label, why="comparable")
    dot = {
        "mark": {"type": "point", "size": 34, "strokeWidth": 1.1, "cursor": "pointer"},
        "encoding": {
            "x": x,
            "y": y,
            "yOffset": off,
            "stroke": colour,
            "tooltip": tip,
            "fill": {"condition": {"test": "datum.even", **colour}, "value": "transparent"},
            "opacity": {"condition": {"test": "near == '' || datum.scene == near", "value": 0.65}, "value": 0.1},
        },
    }
    median = {
        "transform": [
            {"filter": "datum.counted"},
            {"aggregate": [{"op": "median", "field": "value", "as": "middle"}], "groupby": ["label", "engine"]},
        ],
        "mark": {"type": "tick", "thickness": 3, "size": 24, "tooltip": None},
        "encoding": {"x": {**x, "field": "middle"}, "y": y, "color": colour},
    }
    layers = [dot, median, *_rule(chart.rule)]
    return {
        "width": "container",
        "height": ROW * len(order),
        "description": described,
        "params": [{"name": "near", "value": ""}],
        "data": {"values": dots},
        "layer": layers,
    }


def _rule(rule: tuple[float, str] | None) -> list[Spec]:
    """A dashed line with its label above; an invisible label keeps all charts at one height."""
    value, text = rule or (1.0, " ")
    data, x = {"values": [{"at": value, "text": text}]}, {"field": "at", "type": "quantitative"}
    return [
        {
            "data": data,
            "mark": {"type": "rule", "strokeDash": [4, 3], "color": "@alarm", "opacity": 1 if rule else 0},
            "encoding": {"x": x},
        },
        {
            "data": data,
            "mark": {"type": "text", "baseline": "bottom", "dy": -3, "fontSize": 11, "color": "@alarm"},
            "encoding": {"x": x, "y": {"value": 0}, "text": {"field": "text", "type": "nominal"}},
        },
    ]
