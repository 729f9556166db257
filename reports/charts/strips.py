"""Strip charts: a dot per scene, a row per engine, filled where the figure compares engines."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

from reports.charts import marks
from reports.charts.marks import Spec, layer, name, number
from reports.tables.figures import quantity
from reports.tables.run import Run
from runfiles.engines import run_label
from runfiles.metrics import METRICS

ROW = 24
"""Height of a row [px]."""
SLOW = 2e3
"""Frame time [us] above which a frame is slow beside rendering."""


@dataclass(frozen=True)
class Strip:
    """A strip chart.

    title, subtitle
    metric     on the axis
    low, high  ends of the axis; dots outside lie on them
    ticks      labels of the axis by value
    rules      values of dashed lines, and their labels
    """

    title: str
    subtitle: str
    metric: str
    low: float
    high: float
    ticks: Mapping[float, str]
    rules: tuple[tuple[float, str], ...] = ()


STRIPS: Mapping[str, Strip] = {
    "overlap": Strip("Overlap left", "deepest, per scene", "residual_overlap_max", 1e-9, 1.0,
                     {1e-9: "0", 1e-6: "1 µm", 1e-3: "1 mm", 1.0: "1 m"}, ((1e-6, "limit"),)),
    "bounce": Strip("Bounce error", "rebound speed ratio", "restitution_error_max", 1e-7, 1.0,
                    {1e-7: "0", 1e-5: "10⁻⁵", 1e-3: "0.001", 1e-1: "0.1"}),
    "limits": Strip("Beyond joint limits", "largest angle", "joint_limit_excess_max", 1e-3, 200.0,
                    {1e-3: "0°", 0.1: "0.1°", 1.0: "1°", 10.0: "10°", 100.0: "100°"}),
    "time": Strip("Frame time", "95th percentile", "frame_time_p95", 0.1, 1e5,
                  {0.1: "0.1 µs", 10.0: "10 µs", 1e3: "1 ms", 1e5: "0.1 s"}, ((SLOW, "2 ms "), (1e6 / 90.0, "90 Hz"))),
}
"""The four quantities that the comparison is about."""


def strips(run: Run) -> Mapping[str, Strip]:
    """Return the four charts of a run, that of times with the metric that compares its engines."""
    time = STRIPS["time"]
    return STRIPS if run.frame_time == time.metric else {
        **STRIPS, "time": replace(time, subtitle="median", metric=run.frame_time)
    }


def strip(run: Run, chart: Strip, described: str, named: bool = True) -> Spec:
    """Return the chart of a run; ``named``: with the names of the engines."""
    order = [run_label(one) for one in run.runs]
    axis = marks.BARE | {"values": list(chart.ticks), "labelExpr": marks.labels(chart.ticks), "grid": True, "labelPadding": 6}
    x = number("value", axis=axis, scale={"type": "log", "domain": [chart.low, chart.high], "clamp": True})
    y = marks.names_in_order("label", order, labelPadding=10, labelLimit=160, labels=named)
    colour = marks.by_engine(list(dict.fromkeys(one.partition("/")[0] for one in run.runs)))
    dots = layer(
        "point",
        {
            "x": x, "y": y, "yOffset": number("place", scale={"domain": [-1.9, 1.9]}), "stroke": colour,
            "tooltip": marks.tooltip(scene="scene", label="engine", text=METRICS[chart.metric].label, why="comparable"),
            "fill": {"condition": {"test": "datum.even", **colour}, "value": "transparent"},
            "opacity": {"condition": {"test": "near == '' || datum.scene == near", "value": 0.65}, "value": 0.1},
        },
        size=34, strokeWidth=1.1, cursor="pointer",
    )
    median = layer("tick", {"x": x | {"field": "middle"}, "y": y, "color": colour}, thickness=3, size=24, tooltip=None) | {
        "transform": [
            {"filter": "datum.counted"},
            {"aggregate": [{"op": "median", "field": "value", "as": "middle"}], "groupby": ["label", "engine"]},
        ]
    }
    layers = [dots, median, *_rules(chart.rules)]
    return marks.chart(described, ROW * len(order), layers, _dots(run, chart), params=[{"name": "near", "value": ""}])


def _dots(run: Run, chart: Strip) -> list[Spec]:
    """Return the values of a chart, one for each figure of its metric."""
    rows, typical, unit = run.main_rows(chart.metric), run.typical(chart.metric), METRICS[chart.metric].unit
    counted = set(typical.run[typical.counted])
    return [
        {
            "scene": row.scenario, "engine": row.engine, "label": run_label(row.run),
            "value": chart.high if row.value != row.value else min(max(row.value, chart.low), chart.high),
            "text": quantity(row.value, unit),
            "even": row.even, "counted": bool(row.even and row.run in counted),
            "why": "; ".join(filter(None, ("yes" if row.even else "no", row.why, row.by and f"preset {row.by}"))),
            "place": marks.place_of(row.scenario),
        }
        for row in rows.itertuples()
    ]


def _rules(rules: Sequence[tuple[float, str]]) -> list[Spec]:
    """Return dashed lines with their labels above; an invisible label keeps all charts at one height."""
    values = [{"at": value, "text": text, "left": k + 1 < len(rules)} for k, (value, text) in enumerate(rules or [(1.0, " ")])]
    data, x = {"data": {"values": values}}, number("at")
    label = {"x": x, "y": {"value": 0}, "text": name("text")}
    return [
        data | layer("rule", {"x": x}, strokeDash=[4, 3], color="@alarm", opacity=1 if rules else 0),
        *(
            data | layer("text", label, baseline="bottom", align=align, dy=-3, fontSize=11, color="@alarm")
            | {"transform": [{"filter": f"datum.left == {test}"}]}
            for align, test in (("right", "true"), ("center" if len(rules) < 2 else "left", "false"))
        ),
    ]
