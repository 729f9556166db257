"""What got better or worse between two runs: accuracy absolutely, time only on the same host and beyond its noise."""

import math
from collections.abc import Mapping
from dataclasses import dataclass

from reports.deciding.columns import COLUMNS, worst
from reports.reading.load import Results, Row, Series
from reports.sections.unseen import changes_with_commits
from reports.summaries.baseline import BASELINE
from reports.summaries.noise import interval
from reports.words.wording import quantity
from runfiles.naming import CROWD_PREFIX

TIME_NOISE = 1.25
"""Two runs on one host differ by this factor in frame time without any change in the code; smaller changes say nothing."""
SAME = 1e-6
"""Relative change below which an accuracy measure counts as unchanged: far below any change that matters, above rounding."""
ELSEWHERE = 0.05
"""The same against the committed baseline, which was measured on another machine: other processors round otherwise, and what
follows a motion for minutes then ends elsewhere. What the verdict table counts as equal is equal as well."""
HOST = ("cpu", "cpus", "platform", "python")
"""What must agree in provenance before times are compared."""
PERCENTILES = {"frame_time_p50": 50.0, "frame_time_p95": 95.0, "frame_time_max": 100.0}
"""Percentile of a run's frame times that a metric is. Without an entry its noise is unknown: `frame_time_python_p50` is of calls
from Python, and a run keeps the frame times of the engine alone."""
Key = tuple[str, str, str]


@dataclass(frozen=True)
class Change:
    """One measure of one run that differs; `old` or `new` is None where only the other run has a number; `beside` says how sure
    it is, "" where nothing is to be said."""

    scenario: str
    run: str
    metric: str
    unit: str
    old: float | None
    new: float | None
    beside: str = ""

    def line(self) -> str:
        """The change as one line of text."""
        told = f"{quantity(self.old, self.unit)} -> {quantity(self.new, self.unit)}"
        return f"{self.scenario}  {self.run}  {self.metric}: {told}{self.beside}"


@dataclass(frozen=True)
class Changes:
    """All changes, and why times were left out ("" if they were compared)."""

    worse: tuple[Change, ...]
    better: tuple[Change, ...]
    only_old: tuple[str, ...]
    only_new: tuple[str, ...]
    no_times: str

    def text(self) -> str:
        """The whole comparison; what got worse stands first."""
        lines = [f"worse {len(self.worse)}, better {len(self.better)}"]
        for name, changes in (("worse", self.worse), ("better", self.better)):
            lines += [f"{name:<7}{change.line()}" for change in changes]
        lines += [f"gone   {name}" for name in self.only_old] + [f"new    {name}" for name in self.only_new]
        return "\n".join([*lines, self.no_times] if self.no_times else lines)


def diff(old: Results, new: Results) -> Changes:
    """Compare the metrics of the verdict table, run by run. A number that is gone or no longer finite is worse."""
    no_times = _why_no_times(old.provenance, new.provenance)
    loose = bool(old.provenance.get(BASELINE))
    before, after = _numbers(old), _numbers(new)
    worse, better = [], []
    for key in before:
        if key not in after or (no_times and before[key].unit == "us"):
            continue
        a, b = before[key], after[key]
        direction, beside = _direction(a, b, loose), ""
        if direction and a.unit == "us":
            direction, beside = _sure(direction, _series(old, key), _series(new, key), key[2])
        change = Change(key[0], key[1], key[2], b.unit or a.unit, a.value, b.value, beside)
        if direction > 0:
            worse.append(change)
        elif direction < 0:
            better.append(change)
    # crowds have the commit's seed in their names
    runs_before, runs_after = ({f"{r.scenario}  {r.run}" for r in results.rows if not r.scenario.startswith(CROWD_PREFIX)}
                               for results in (old, new))
    gone = [Change(k[0], k[1], k[2], before[k].unit, before[k].value, None) for k in before
            if k not in after and f"{k[0]}  {k[1]}" in runs_after and before[k].value is not None]
    return Changes(
        tuple(worse + [c for c in gone if not (no_times and c.unit == "us")]), tuple(better),
        tuple(sorted(runs_before - runs_after)), () if loose else tuple(sorted(runs_after - runs_before)), no_times,
    )


def _numbers(results: Results) -> Mapping[Key, Row]:
    """The worst row over seeds per scene, run and metric, for every metric that the verdict table ranks; without scenes whose
    motion is another at every commit."""
    grouped: dict[Key, list[Row]] = {}
    for row in results.rows:
        if any(column.takes(row.metric) for column in COLUMNS) and not changes_with_commits(row.scenario):
            grouped.setdefault((row.scenario, row.run, row.metric), []).append(row)
    return {key: found for key, rows in grouped.items() if (found := worst(rows))}


def _direction(old: Row, new: Row, loose: bool) -> int:
    """1 if `new` is worse, -1 if better, 0 if they are the same within what can be told apart."""
    a, b = _rank(old.value), _rank(new.value)
    if a == b:
        return 0
    column = next(column for column in COLUMNS if column.takes(old.metric))
    if loose:
        margin = column.same + ELSEWHERE * min(a, b)
        return 1 if b > a + margin else -1 if a > b + margin else 0
    a, b = max(a, column.floor), max(b, column.floor)
    factor = TIME_NOISE if old.unit == "us" else 1.0 + SAME
    return 1 if b > factor * a else -1 if a > factor * b else 0


def _rank(value: float | None) -> float:
    return value if value is not None and math.isfinite(value) else math.inf


def _series(results: Results, key: Key) -> Series | None:
    return results.series.get(key[0], {}).get(key[1])


def _sure(direction: int, old: Series | None, new: Series | None, metric: str) -> tuple[int, str]:
    """Return `direction` if the frames confirm it, else 0; and the interval of the ratio in words.

    The slowest frame of a run counts as changed only where the slow frames all over the run have changed: one frame is noise."""
    percent = PERCENTILES.get(metric)
    found = interval(old.frame_time, new.frame_time, percent) if old and new and percent is not None else None
    if found is None:
        return direction, " (no frames to tell the noise from)"
    low, high = found
    return (direction if low > 1.0 or high < 1.0 else 0), f" (×{low:.2f} to ×{high:.2f})"


def _why_no_times(old: Mapping[str, object], new: Mapping[str, object]) -> str:
    if old.get(BASELINE):
        return ""
    known = [name for name in HOST if name in old or name in new]
    if not known:
        return "times not compared: the files do not say which host they come from"
    differing = [name for name in known if old.get(name) != new.get(name)]
    return f"times not compared: the hosts differ in {', '.join(differing)}" if differing else ""
