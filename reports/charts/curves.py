"""Charts of lines: error against frame time of all settings of a scene, and figures over the time of a scene."""

import math
from collections.abc import Mapping, Sequence

import numpy as np

from reports.charts.marks import LENGTH_LABEL, TIME_LABEL, Spec, by_engine, tooltip
from reports.reading.load import Array
from runfiles.engines import run_label

FLOOR = 1e-7
"""Least error on the axis [m]."""

POINTS = 300
"""Most points of a line over time: as many as a chart is wide, over two."""


def error_against_time(names: Sequence[str]) -> Spec:
    """Return the chart of settings; the page fills in the datasets points and limit."""
    colour = by_engine(names)
    x = {
        "field": "time",
        "type": "quantitative",
        "scale": {"type": "log", "nice": False, "padding": 18},
        "axis": {
            "title": "frame time",
            "labelExpr": TIME_LABEL,
            "tickCount": 4,
            "tickSize": 0,
            "domain": False,
            "labelOverlap": "greedy",
        },
    }
    y = {
        "field": "place",
        "type": "quantitative",
        "scale": {"type": "log", "domain": [FLOOR, 0.3], "clamp": True},
        "axis": {
            "title": "largest error",
            "values": [10.0**k for k in range(-7, 0)],
            "tickSize": 0,
            "domain": False,
            "labelExpr": f"datum.value < 2e-7 ? '≤ 0.1 µm' : {LENGTH_LABEL}",
        },
    }
    tip = tooltip(name="setting", text="largest error", which="of", when="frame time", state="bodies")
    lines = {
        "mark": {"type": "line", "strokeWidth": 1.4, "opacity": 0.55},
        "encoding": {
            "x": x,
            "y": y,
            "color": colour,
            "detail": {"field": "ladder", "type": "nominal"},
            "order": {"field": "time", "type": "quantitative"},
        },
    }
    dots = {
        "mark": {"type": "point", "opacity": 0.9, "cursor": "pointer", "strokeWidth": 1.6},
        "encoding": {
            "x": x,
            "y": y,
            "stroke": colour,
            "tooltip": tip,
            "fill": {"condition": {"test": "datum.asleep", "value": "transparent"}, **colour},
            "size": {"condition": {"test": "datum.preset", "value": 95}, "value": 42},
        },
    }
    words = {
        "mark": {"type": "text", "align": "left", "dx": 7, "dy": -8, "fontSize": 10.5},
        "encoding": {"x": x, "y": y, "color": colour, "text": {"field": "short", "type": "nominal"}},
    }
    limit = {
        "data": {"name": "limit"},
        "mark": {"type": "rule", "strokeDash": [4, 3], "color": "@alarm"},
        "encoding": {"y": {"field": "place", "type": "quantitative"}},
    }
    return {
        "width": "container",
        "height": 292,
        "description": "Largest error against frame time, a dot per setting of each engine.",
        "datasets": {"points": [], "limit": []},
        "data": {"name": "points"},
        "layer": [limit, lines, words, dots],
    }


def over_time(lines: Mapping[str, tuple[Array, Array]], unit: str, described: str, floor: float | None = None) -> Spec:
    """Return lines over the time of a scene, by "engine/preset": times [s] and values; logarithmic from ``floor`` on."""
    names, values = list(dict.fromkeys(run.partition("/")[0] for run in lines)), []
    for run, (times, found) in lines.items():
        for k in _kept(found):
            value = float(found[k])
            if math.isfinite(value):
                values.append(
                    {
                        "t": float(times[k]),
                        "v": value if floor is None else max(value, floor),
                        "engine": run.partition("/")[0],
                        "label": run_label(run),
                        "run": run,
                    }
                )
    axis: Spec = {"title": None, "domain": False, "tickSize": 0, "tickCount": 5}
    if unit in ("m", "us"):
        axis["labelExpr"] = LENGTH_LABEL if unit == "m" else TIME_LABEL
    if floor is not None:
        axis["labelExpr"] = f"datum.value <= {floor!r} * 1.01 ? '0' : {axis.get('labelExpr', 'datum.label')}"
    scale: Spec = {"zero": True} if floor is None else {"type": "log", "clamp": True, "domainMin": floor}
    return {
        "width": "container",
        "height": 150,
        "description": described,
        "data": {"values": values},
        "params": [{"name": "now", "value": 0}],
        "layer": [
            {
                "mark": {"type": "line", "strokeWidth": 1.3, "interpolate": "monotone"},
                "encoding": {
                    "x": {
                        "field": "t",
                        "type": "quantitative",
                        "axis": {"title": "time [s]", "domain": False, "tickSize": 0},
                        "scale": {"nice": False},
                    },
                    "y": {"field": "v", "type": "quantitative", "axis": axis, "scale": scale},
                    "color": by_engine(names),
                    "detail": {"field": "run", "type": "nominal"},
                    "strokeDash": _dashes(list(lines)),
                    "tooltip": [
                        {"field": "label", "type": "nominal", "title": "engine"},
                        {"field": "t", "type": "quantitative", "title": "time [s]"},
                        {"field": "v", "type": "quantitative", "title": f"value [{unit}]" if unit else "value"},
                    ],
                },
            },
            {
                "data": {"values": [{}]},
                "mark": {"type": "rule", "color": "@alarm"},
                "transform": [{"calculate": "now", "as": "t"}],
                "encoding": {"x": {"field": "t", "type": "quantitative"}},
            },
        ],
    }


def _dashes(runs: Sequence[str]) -> Spec:
    """First preset of each engine solid, the next ones dashed."""
    seen: dict[str, int] = {}
    dashes = []
    for run in runs:
        engine = run.partition("/")[0]
        dashes.append([[1, 0], [5, 3], [2, 2], [8, 3, 2, 3]][min(seen.get(engine, 0), 3)])
        seen[engine] = seen.get(engine, 0) + 1
    return {"field": "run", "type": "nominal", "legend": None, "scale": {"domain": list(runs), "range": dashes}}


def _kept(values: Array) -> Sequence[int]:
    """Indices of at most POINTS values: the largest of each stretch, so that no peak is lost."""
    if len(values) <= POINTS:
        return range(len(values))
    edges = np.linspace(0, len(values), POINTS + 1).astype(int)
    safe = np.where(np.isnan(values), -np.inf, values)
    return [int(a + np.argmax(safe[a:b])) for a, b in zip(edges, edges[1:], strict=False) if b > a]
