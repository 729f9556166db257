"""Changes between two runs: accuracy beyond rounding, frame times beyond their noise."""

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
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
              of a time beside those of the other engines. Worse rows first, of them times last, then the gated engine first
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
        """Return the number of rows with a verdict."""
        return int((self.table.verdict == verdict).sum())

    def of(self, run: str) -> "Changes":
        """Return the changes of one engine and preset."""
        return replace(self, table=self.table[self.table.run == run])


def figures(run: Run) -> pd.DataFrame:
    """Return the worst value over seeds of every ranked metric, by scene, run and metric; NaN becomes infinite.

    Scenes whose content changes with the commit are left out.
    """
    seeded = run.rows.scenario.str.startswith((CROWD_PREFIX, UNSEEN_PREFIX))
    rows = run.rows[run.rows.metric.isin(RANKED) & run.rows.measured & ~seeded]
    values = rows.assign(value=rows.value.fillna(math.inf))
    return values.groupby(KEYS, sort=False).agg(value=("value", "max"), unit=("unit", "first")).reset_index()


def changes(old: Run, new: Run) -> Changes:
    """Compare two runs."""
    no_times = _why_no_times(old.results.provenance, new.results.provenance)
    timed = [name for name in RANKED if name.startswith("frame_time_") and (no_times or name not in PERCENTILES)]
    before, after = (rows[~rows.metric.isin(timed)] for rows in map(figures, (old, new)))
    runs_before, runs_after = (set(rows.scenario + " " + rows.run) for rows in (before, after))
    both = before.merge(after, on=KEYS, how="left", suffixes=("_old", "_new"))
    both = both[both.value_new.notna() | (both.scenario + " " + both.run).isin(runs_after)]

    def judged(row: Any) -> tuple[str, float, float]:
        if row.metric in PERCENTILES and not math.isnan(row.value_new):
            return _of_time(row, old, new, both)
        level = METRICS[row.metric].level or 0.0
        return _verdict(row, max(1e-3 * level, min(level, 1e-2 * max(row.value_old, row.value_new))), SAME), math.nan, math.nan

    gone, added = (tuple(sorted(one)) for one in (runs_before - runs_after, runs_after - runs_before))
    return Changes(_table(both, judged, new.gated), gone, added, no_times, old.name)


def against_baseline(baseline: pd.DataFrame, run: Run, name: str) -> Changes:
    """Compare watched metrics with the committed baseline, a frame with the columns scenario, run, metric, unit and value."""
    after = figures(run)
    both = baseline.merge(after[after.run == run.gated], on=KEYS, how="left", suffixes=("_old", "_new"))

    def judged(row: Any) -> tuple[str, float, float]:
        level = METRICS[row.metric].level if row.metric in METRICS else 0.0
        return _verdict(row, level or 0.0, ELSEWHERE), math.nan, math.nan

    gone = tuple(sorted(set(baseline.scenario) - set(after.scenario)))
    table = _table(both[both.scenario.isin(after.scenario)], judged, run.gated)
    return Changes(table, gone, (), "the baseline has no times", name)


def _table(both: pd.DataFrame, judged: Callable[[Any], tuple[str, float, float]], gated: str) -> pd.DataFrame:
    """Return the rows that ``judged`` gives a verdict, with the interval of a time."""
    records = []
    for row in both.itertuples():
        verdict, *interval_of_ratio = judged(row)
        if verdict:
            figures_of_row = (row.unit_old, float(row.value_old), float(row.value_new))
            records.append((row.scenario, row.run, row.metric, *figures_of_row, verdict, *interval_of_ratio))
    table = pd.DataFrame(records, columns=COLUMNS)
    # a list that is cut keeps what is worse, and accuracy before times, of which a busy machine changes many
    table = table.assign(timed=table.metric.isin(PERCENTILES), others=table.run != gated).sort_values(
        ["verdict", "timed", "others", "scenario"], ascending=[False, True, True, True], kind="stable"
    )
    return table[list(COLUMNS)].reset_index(drop=True)


def _verdict(row: Any, level: float, share: float) -> str:
    """Compare two figures; a missing one is worse."""
    old, new = float(row.value_old), float(row.value_new)
    margin = level + share * min(old, new)
    return "worse" if math.isnan(new) or new > old + margin else "better" if old > new + margin else ""


def _of_time(row: Any, old: Run, new: Run, both: pd.DataFrame) -> tuple[str, float, float]:
    """Compare two times: return the verdict, and the interval of their ratio."""
    before, after = (run.results.series.get(row.scenario, {}).get(row.run) for run in (old, new))
    ratio = interval(before, after, PERCENTILES[row.metric])
    if ratio is None:
        return "", math.nan, math.nan
    # a loaded machine slows all engines of a scene: divide by their common factor
    shared = _shared(both, row)
    low, high = (end / shared for end in ratio)
    plain = row.value_new / row.value_old if row.value_old > 0.0 else math.inf
    least, most = sorted((plain, plain / shared))
    worse, better = least > TIME_FACTOR and low > 1.0, most * TIME_FACTOR < 1.0 and high < 1.0
    return "worse" if worse else "better" if better else "", low, high


def _shared(both: pd.DataFrame, row: Any) -> float:
    """Return the median ratio of the times of the other engines in a scene; 1 without others."""
    own = both.run.str.startswith(row.run.partition("/")[0] + "/")
    others = both[(both.scenario == row.scenario) & (both.metric == row.metric) & ~own & (both.value_old > 0.0)]
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
