"""Argmax of a kept series: the moment of a replay at which a figure of one engine in one scene is largest."""

import numpy as np

from reports.load import Array, Results, Series

OVERLAPS = ("residual_overlap_max", "residual_overlap_p95", "residual_overlap_mean")
TIMES = ("frame_time_p95", "frame_time_p99", "frame_time_max")
"""Metrics of which a run keeps a number per state, and per timed frame: what belongs to the largest is the moment to look at."""


def moment(results: Results, scene: str, run: str, metric: str) -> str:
    """"#t=0.3417", the time [s] for the address of a scene's page; "" for other metrics and where no series was kept."""
    dt = results.frame_times.get(scene)
    series = results.series.get(scene, {}).get(run)
    if dt is None or series is None:
        return ""
    values, first = _values(series, metric)
    return f"#t={dt * (first + int(np.nanargmax(values))):.4g}" if np.isfinite(values).any() else ""


def _values(series: Series, metric: str) -> tuple[Array, int]:
    """The series behind a metric and the number of its first frame: overlap has the state of the start, times have not."""
    if metric in OVERLAPS:
        return series.overlap, 0
    return (series.frame_time, 1) if metric in TIMES else (np.empty(0), 0)
