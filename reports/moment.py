"""Argmax of what a run kept over time: the moment of a replay at which a figure of one engine in one scene is largest."""

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from reports.kept import Array, Drawn, Shown
from reports.load import Results, Series
from reports.moments import states_of_metrics

OVERLAPS = ("residual_overlap_max", "residual_overlap_p95", "residual_overlap_mean")
TIMES = ("frame_time_p95", "frame_time_p99", "frame_time_max")
"""Metrics of which a run keeps a number per state, and per timed frame: what belongs to the largest is the moment to look at."""

WAITS = ("waiting", "planning")
"""Counts of frames in which an avatar is held off its user and no path is known; a wait is broken by neither's becoming the
other."""


@dataclass(frozen=True)
class Instants:
    """Of one run in one scene the times [s] at which figures are largest, by metric, and its longest wait: (length, begin) [s],
    None where it never waits."""

    at: Mapping[str, float] = field(default_factory=dict)
    wait: tuple[float, float] | None = None


def instants(one: Shown, scene: Drawn | None) -> Instants:
    """Those that a recording tells."""
    names = [] if scene is None else scene.names_of_links(one.raw_positions.shape[1])
    states = states_of_metrics(one, names, () if scene is None else scene.parents)
    return Instants({metric: float(one.times[state]) for metric, state in states.items()}, _longest_wait(one))


def _longest_wait(one: Shown) -> tuple[float, float] | None:
    """Of the stretches of frames in which an avatar waits, or a path for it is sought, the longest: how long it is and when it
    begins [s]."""
    counted = [np.asarray(one.counts[name]) > 0 for name in WAITS if len(one.counts.get(name, ())) == len(one.times)]
    if len(one.times) < 2 or not np.any(counted):
        return None
    edges = np.flatnonzero(np.diff(np.concatenate([[False], np.any(counted, axis=0), [False]])))
    begins, ends = edges[::2], edges[1::2]
    longest = int(np.argmax(ends - begins))
    dt = float(one.times[1] - one.times[0])
    return dt * int(ends[longest] - begins[longest]), float(one.times[begins[longest]])


def address(time: float) -> str:
    """"#t=0.341667": the part of a page's address that leads to a time [s]."""
    return f"#t={time:.6g}"


def moment(results: Results, scene: str, run: str, metric: str, known: Mapping[str, Instants] | None = None) -> str:
    """The address of the time at which a figure of `run` is largest: by what is `known` of ours in each scene, else by the series
    that the run kept; "" for other metrics and where neither has it."""
    time = known[scene].at.get(metric) if known and scene in known else None
    if time is not None:
        return address(time)
    dt = results.frame_times.get(scene)
    series = results.series.get(scene, {}).get(run)
    if dt is None or series is None:
        return ""
    values, first = _values(series, metric)
    return address(dt * (first + int(np.nanargmax(values)))) if np.isfinite(values).any() else ""


def _values(series: Series, metric: str) -> tuple[Array, int]:
    """The series behind a metric and the number of its first frame: overlap has the state of the start, times have not."""
    if metric in OVERLAPS:
        return series.overlap, 0
    return (series.frame_time, 1) if metric in TIMES else (np.empty(0), 0)
