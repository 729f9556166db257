"""Changes between two runs: accuracy beyond rounding, frame times beyond their noise."""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
import pandas as pd

from reports.reading.load import Series
from reports.tables.run import Run
from runfiles.metrics import METRICS, RANKED
from runfiles.naming import CROWD_PREFIX, UNSEEN_PREFIX

TIME_FACTOR = 1.25
"""Change of a frame time that counts. Smaller: two runs of one commit differ; larger: slow changes go unseen."""

SAME = 1e-6
"""Relative change of a figure that counts as none: above rounding on one machine."""

ELSEWHERE = 0.05
"""The same against the committed baseline, which was measured on another machine."""

HOST = ("cpu", "cpus", "platform", "python")
"""Entries of the provenance that must agree before times are compared."""

PERCENTILES: Mapping[str, float] = {"frame_time_p50": 50.0, "frame_time_p95": 95.0}
"""Metrics of times that are compared. A slowest frame is noise."""

RESAMPLES, BLOCK, CERTAINTY = 500, 10, 99.0
"""Bootstrap over frames: resamples, neighbouring frames drawn together, and percent of the resamples in the interval."""

COLUMNS = ("scenario", "run", "metric", "unit", "old", "new", "verdict", "low", "high")
KEYS = ["scenario", "run", "metric"]


@dataclass(frozen=True, eq=False)
class Changes:
    """Differences from an earlier run.

    table     columns scenario, run, metric, unit, old, new, verdict ("worse", "better"), and low, high: the interval of the ratio
              of a time. Worse rows first
    gone      "scene engine/preset" of the earlier run only
    added     of the later run only
    no_times  reason why times were not compared, "" where they were
    since     name of the earlier run
    """

    table: pd.DataFrame
    gone: tuple[str, ...]
    added: tuple[str, ...]
    no_times: str
    since: str

    def count(self, verdict: str) -> int:
        """Number of rows with a verdict."""
        return int((self.table.verdict == verdict).sum())

    def of(self, run: str) -> "Changes":
        """The changes of one engine and preset."""
        return Changes(self.table[self.table.run == run], self.gone, self.added, self.no_times, self.since)


def seeded(scene: str) -> bool:
    """Return whether the content of a scene changes with the commit."""
    return scene.startswith((CROWD_PREFIX, UNSEEN_PREFIX))


def figures(run: Run) -> pd.DataFrame:
    """Return the worst value over seeds of every ranked metric, by scene, run and metric; NaN becomes infinite."""
    rows = run.rows[run.rows.metric.isin(RANKED) & run.rows.measured & ~run.rows.scenario.map(seeded).astype(bool)]
    values = rows.assign(value=rows.value.fillna(math.inf))
    return values.groupby(KEYS, sort=False).agg(value=("value", "max"), unit=("unit", "first")).reset_index()


def changes(old: Run, new: Run) -> Changes:
    """Compare two runs."""
    no_times = _why_no_times(old.results.provenance, new.results.provenance)
    before, after = figures(old), figures(new)
    compared = set(PERCENTILES) if not no_times else set()
    timed = [name for name in RANKED if name.startswith("frame_time_") and name not in compared]
    before, after = (one[~one.metric.isin(timed)] for one in (before, after))
    runs_before, runs_after = (set(map(" ".join, zip(one.scenario, one.run, strict=True))) for one in (before, after))
    both = before.merge(after, on=KEYS, how="left", suffixes=("_old", "_new"))
    present = pd.Series([f"{a} {b}" in runs_after for a, b in zip(both.scenario, both.run, strict=True)], index=both.index)
    both = both[both.value_new.notna() | present]
    found = [line for row in both.itertuples() if (line := _line(row, old, new, both)) is not None]
    table = pd.DataFrame(found, columns=COLUMNS).sort_values(["verdict", "scenario"], ascending=[False, True], kind="stable")
    return Changes(
        table.reset_index(drop=True),
        tuple(sorted(runs_before - runs_after)),
        tuple(sorted(runs_after - runs_before)),
        no_times,
        old.name,
    )


def against_baseline(baseline: pd.DataFrame, run: Run, name: str) -> Changes:
    """Compare watched metrics with the committed baseline, a frame with the columns scenario, run, metric, unit and value."""
    after = figures(run)
    both = baseline.merge(after[after.run == run.gated], on=KEYS, how="left", suffixes=("_old", "_new"))
    both = both[both.scenario.isin(after.scenario)]
    found = []
    for row in both.itertuples():
        metric = METRICS.get(str(row.metric))
        level = 0.0 if metric is None or metric.level is None else metric.level
        verdict = "worse" if math.isnan(row.value_new) else _verdict(row.value_old, row.value_new, level, ELSEWHERE)
        if verdict:
            found.append(
                (row.scenario, row.run, row.metric, row.unit_old, row.value_old, row.value_new, verdict, math.nan, math.nan)
            )
    table = pd.DataFrame(found, columns=COLUMNS).sort_values(["verdict", "scenario"], ascending=[False, True], kind="stable")
    gone = sorted(set(baseline.scenario) - set(after.scenario))
    return Changes(table.reset_index(drop=True), tuple(gone), (), "the baseline has no times", name)


def _line(row: Any, old: Run, new: Run, both: pd.DataFrame) -> tuple[object, ...] | None:
    """One row of the table; None where nothing changed."""
    a, b = float(row.value_old), float(row.value_new)
    scene, run, metric = str(row.scenario), str(row.run), str(row.metric)
    unit, low, high = str(row.unit_old), math.nan, math.nan
    if math.isnan(b):
        return scene, run, metric, unit, a, b, "worse", low, high
    if metric not in PERCENTILES:
        level = METRICS[metric].level or 0.0
        verdict = _verdict(a, b, max(1e-3 * level, min(level, 1e-2 * max(a, b))), SAME)
    else:
        found = interval(
            old.results.series.get(scene, {}).get(run), new.results.series.get(scene, {}).get(run), PERCENTILES[metric]
        )
        verdict = ""
        if found is not None:
            # a loaded machine slows all engines of a scene: divide by their common factor
            shared = _shared(both, scene, run, metric)
            low, high = (end / shared for end in found)
            plain = b / a if a > 0.0 else math.inf
            least, most = sorted((plain, plain / shared))
            verdict = (
                "worse" if least > TIME_FACTOR and low > 1.0 else "better" if most * TIME_FACTOR < 1.0 and high < 1.0 else ""
            )
    return (scene, run, metric, unit, a, b, verdict, low, high) if verdict else None


def _verdict(old: float, new: float, level: float, share: float) -> str:
    margin = level + share * min(old, new)
    return "worse" if new > old + margin else "better" if old > new + margin else ""


def _shared(both: pd.DataFrame, scene: str, run: str, metric: str) -> float:
    """Median ratio of the times of the other engines in a scene; 1 without others."""
    engine = run.partition("/")[0] + "/"
    others = both[(both.scenario == scene) & (both.metric == metric) & ~both.run.str.startswith(engine) & (both.value_old > 0.0)]
    ratio = float((others.value_new / others.value_old).median()) if len(others) else 1.0
    return ratio if math.isfinite(ratio) and ratio > 0.0 else 1.0


def interval(old: Series | None, new: Series | None, percent: float, seed: int = 0) -> tuple[float, float] | None:
    """Return the bootstrap interval of the ratio new / old of a percentile of frame times; None with too few frames.

    Frames are drawn in blocks, the same ones of both runs: frame k is the same instant of the scene.
    """
    if old is None or new is None:
        return None
    frames = min(old.frame_time.size, new.frame_time.size)
    a, b = old.frame_time[:frames], new.frame_time[:frames]
    sound = np.isfinite(a) & np.isfinite(b) & (a > 0.0)
    a, b = a[sound], b[sound]
    if a.size < 3 * BLOCK:
        return None
    starts = np.random.default_rng(seed).integers(0, a.size - BLOCK + 1, size=(RESAMPLES, a.size // BLOCK))
    chosen = (starts[..., None] + np.arange(BLOCK)).reshape(RESAMPLES, -1)
    ratios = np.percentile(b[chosen], percent, axis=1) / np.percentile(a[chosen], percent, axis=1)
    tail = 0.5 * (100.0 - CERTAINTY)
    return float(np.percentile(ratios, tail)), float(np.percentile(ratios, 100.0 - tail))


def _why_no_times(old: Mapping[str, object], new: Mapping[str, object]) -> str:
    known = [name for name in HOST if name in old or name in new]
    differing = [name for name in known if old.get(name) != new.get(name)]
    if not known or differing:
        return "the hosts differ in " + ", ".join(differing or HOST)
    return ""
