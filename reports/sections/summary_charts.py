"""One chart for all scenes: a dot per scene and engine on a logarithmic axis, a row per engine, a tick at the median."""

import math
from collections.abc import Mapping, Sequence
from statistics import median

from reports.deciding.conclusions import FRAME_90_HZ, OVERLAP_BOUND, peak, shown_scenes
from reports.drawing.charts import Percentiles
from reports.drawing.marks import OVERLAP_FLOOR, OVERLAP_TOP, overlap_axis, strips, time_axis
from reports.drawing.palette import Stroke
from reports.drawing.picture import picture
from reports.reading.load import Results
from reports.words.wording import count, quantity

P95 = 1
"""Place of the 95th percentile among (p50, p95, p99)."""


def overlaps(results: Results, strokes: Mapping[str, Stroke], ours: str) -> str:
    """The deepest overlap of every scene that ours shows; "" for a run without series. What is no number lies at the upper
    end."""
    values: dict[str, list[float]] = {}
    for runs in shown_scenes(results, ours).values():
        for run, series in runs.items():
            if series.overlap.size:
                values.setdefault(run, []).append(peak(series.overlap))
    if not values:
        return ""
    scale, axis = overlap_axis()
    spec = strips(_rows(values, strokes, OVERLAP_FLOOR, OVERLAP_TOP), strokes, scale, axis, {"1 µm": OVERLAP_BOUND})
    return picture(spec, _text("Deepest overlap of each scene, a dot per scene.", values, "m"), "all-overlaps")


def times(found: Mapping[str, Mapping[str, Percentiles]], strokes: Mapping[str, Stroke]) -> str:
    """The frame time that 95 % of the frames stay below, of every scene; "" where nothing was timed."""
    values: dict[str, list[float]] = {}
    for runs in found.values():
        for run, percentiles in runs.items():
            if math.isfinite(percentiles[P95]) and percentiles[P95] > 0.0:
                values.setdefault(run, []).append(percentiles[P95])
    if not values:
        return ""
    scale, axis, low, high = time_axis([value for own in values.values() for value in own])
    spec = strips(_rows(values, strokes, low, high), strokes, scale, axis, {"90 Hz": FRAME_90_HZ})
    text = _text("Frame time that 95 % of the frames stay below, a dot per scene.", values, "us")
    return picture(spec, text, "all-times")


def _rows(
    values: Mapping[str, Sequence[float]], strokes: Mapping[str, Stroke], low: float, high: float,
) -> dict[str, list[dict[str, object]]]:
    """The data of the chart: every dot, and the median of each row; infinite and missing values at the upper end."""
    kept = {run: [min(max(value, low), high) if math.isfinite(value) else high for value in values[run]]
            for run in strokes if run in values}
    return {
        "dots": [{"run": run, "value": float(f"{value:.4g}")} for run, own in kept.items() for value in own],
        "medians": [{"run": run, "value": float(f"{median(own):.4g}")} for run, own in kept.items()],
    }


def _text(title: str, values: Mapping[str, Sequence[float]], unit: str) -> str:
    """The chart in words."""
    said = []
    for run, own in values.items():
        sound = [value for value in own if math.isfinite(value)]
        lost = f", {count(len(own) - len(sound), 'scene')} without a number" if len(sound) < len(own) else ""
        figures = f"median {quantity(median(sound), unit)}, largest {quantity(max(sound), unit)}" if sound else "no number"
        said.append(f"{run}: {figures} of {count(len(own), 'scene')}{lost}")
    return f"{title} {'; '.join(said)}."
