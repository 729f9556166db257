"""Only differences between two runs are listed."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np
import pandas as pd
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from reports.reading.load import Series
from reports.tables.changes import TIME_FACTOR, Changes, against_baseline, changes, interval
from reports.tables.run import Run
from runfiles.metrics import METRICS, RANKED
from runfiles.table import Row
from tests.reports.small_runs import BULLET, HOST, MUJOCO, OURS, OVERLAP, figure, run_of, timed

Times = Mapping[str, np.ndarray]
STEADY = [name for name in RANKED if not name.startswith("frame_time_")]


def table() -> list[Row]:
    """Return figures of three engines in three scenes, well above the level of each metric."""
    rows = [figure("a", OURS, OVERLAP, 0.0, "pass", 1e-6)]
    for k, scene in enumerate("abc"):
        for run in (OURS, MUJOCO, BULLET):
            for name in STEADY[1:4]:
                rows.append(figure(scene, run, name, (k + 2.0) * 100.0 * (METRICS[name].level or 1.0) + 1.0))
    return rows


def listed(found: Changes) -> list[tuple[str, str, str, str]]:
    """Return the scene, run, metric and verdict of each listed change."""
    rows = found.table.itertuples()
    return [(row.scenario, row.run, row.metric, row.verdict) for row in rows]


@settings(max_examples=30)
@given(st.integers(0, len(table()) - 1), st.sampled_from([1.5, 30.0, math.inf, math.nan, None]))
def test_one_planted_change_is_listed_exactly(place: int, factor: float | None) -> None:
    rows = table()
    old = rows[place]
    worse = list(rows)
    value = None if factor is None else factor * ((old.value or 0.0) + 1.0)
    worse[place] = replace(old, value=value)
    key = (old.scenario, old.run, old.metric)
    assert listed(changes(run_of(rows), run_of(worse))) == [(*key, "worse")]
    expected = [] if value is None else [(*key, "better")]
    assert listed(changes(run_of(worse), run_of(rows))) == expected


@settings(max_examples=30)
@given(st.integers(0, len(table()) - 1), st.just(0.0) | st.floats(-1e-9, 1e-9))
def test_equal_runs_and_rounding_are_no_change(place: int, share: float) -> None:
    rows = table()
    moved = [replace(row, value=(row.value or 0.0) * (1.0 + share)) if k == place else row for k, row in enumerate(rows)]
    assert listed(changes(run_of(rows), run_of(moved))) == []


def test_of_several_seeds_the_worst_counts() -> None:
    def seeds(*values: float) -> Run:
        return run_of([figure("a", OURS, OVERLAP, value, seed=seed) for seed, value in enumerate(values)])

    assert listed(changes(seeds(1e-3, 5e-3), seeds(5e-3, 1e-3))) == []
    assert listed(changes(seeds(1e-3, 5e-3), seeds(1e-3, 8e-3))) == [("a", OURS, OVERLAP, "worse")]
    # scenes that the commit draws are not compared
    drawn = [run_of([figure(scene, OURS, OVERLAP, value) for scene in ("unseen_walk", "crowd_7")]) for value in (0.0, 1.0)]
    assert listed(changes(*drawn)) == []


def test_runs_that_came_and_went_are_named() -> None:
    rows = table()
    fewer = [row for row in rows if (row.scenario, row.run) != ("b", MUJOCO)]
    gone, added = changes(run_of(rows), run_of(fewer)), changes(run_of(fewer), run_of(rows))
    assert gone.gone == added.added == (f"b {MUJOCO}",) and listed(gone) == listed(added) == []


def times_run(factors: Mapping[str, float], provenance: Mapping[str, object] = HOST, seed: int = 1) -> Run:
    """Return a run of one scene in which each engine's frame times are scaled by its factor, with independent noise."""
    rows, series = list[Row](), dict[str, Series]()
    for k, (run, factor) in enumerate(factors.items()):
        times = 30.0 * factor * np.random.default_rng([k, seed]).gamma(64.0, 1 / 64.0, 400)
        series[run] = timed(times)
        for name, percent in (("p50", 50.0), ("p95", 95.0), ("p99", 99.0), ("max", 100.0)):
            rows.append(figure("a", run, f"frame_time_{name}", float(np.percentile(times, percent))))
    return run_of(rows, {"a": series}, provenance=provenance)


EVEN = {OURS: 1.0, MUJOCO: 3.0, BULLET: 5.0}
BELOW = 1.0 + 0.7 * (TIME_FACTOR - 1.0)


@pytest.mark.parametrize(("machine", "own", "seed"), [
    (0.2, 1.0, 2), (1.0, 1.0, 2), (4.0, 1.0, 2), (1.0, BELOW, 1), (3.0, BELOW, 1), (1.0, 2.0, 2), (3.0, 2.0, 2),
])
def test_engine_slower_than_machine_and_limit_is_listed(machine: float, own: float, seed: int) -> None:
    old = times_run(EVEN)
    new = times_run({run: machine * value * (own if run == OURS else 1.0) for run, value in EVEN.items()}, seed=seed)
    expected = {("a", OURS, f"frame_time_{name}") for name in ("p50", "p95")} if own > TIME_FACTOR else set()
    found = changes(old, new)
    assert set(listed(found)) == {(*one, "worse") for one in expected}
    assert set(listed(changes(new, old))) == {(*one, "better") for one in expected}
    assert all(row.low <= own <= row.high for row in found.table.itertuples() if row.metric == "frame_time_p50")


def test_a_few_more_slow_frames_are_noise() -> None:
    def spiky(share: float) -> Run:
        times = np.full(400, 30.0)
        times[np.linspace(0, 399, round(400 * share)).astype(int)] = 300.0
        rows = [figure("a", OURS, f"frame_time_p{at}", float(np.percentile(times, at))) for at in (50, 95)]
        return run_of(rows, {"a": {OURS: timed(times)}})

    old, new = spiky(0.045), spiky(0.055)
    assert new.rows.value.max() > 5.0 * old.rows.value.max()
    assert listed(changes(old, new)) == listed(changes(new, old)) == []


@pytest.mark.parametrize("change", [{"cpu": "another"}, {"cpus": 64}, {"python": "3.12"}])
def test_times_of_two_machines_are_not_compared(change: Mapping[str, object]) -> None:
    later = times_run({**EVEN, OURS: 9.0}, {**HOST, **change})
    found = changes(times_run(EVEN), later)
    assert listed(found) == [] and next(iter(change)) in found.no_times
    assert not changes(times_run(EVEN), times_run(EVEN)).no_times and changes(times_run(EVEN, {}), times_run(EVEN, {})).no_times


@given(st.floats(0.1, 10.0), st.sampled_from([50.0, 95.0]))
def test_an_interval_of_scaled_times_is_the_factor(factor: float, percent: float) -> None:
    times = np.random.default_rng(3).gamma(4.0, 10.0, 120)
    assert interval(timed(times), timed(factor * times), percent) == pytest.approx((factor, factor))


def test_an_interval_needs_frames_of_both_runs() -> None:
    assert interval(timed([1.0] * 29), timed([1.0] * 200), 50.0) is None and interval(None, timed([1.0] * 99), 50.0) is None
    assert interval(timed([math.nan] * 99), timed([1.0] * 99), 50.0) is None


def baseline(values: Mapping[str, float], scenes: Sequence[str] = "a") -> pd.DataFrame:
    """Return a committed baseline."""
    rows = [(scene, OURS, name, METRICS[name].unit, value) for scene in scenes for name, value in values.items()]
    return pd.DataFrame(rows, columns=["scenario", "run", "metric", "unit", "value"])


OFFSET = "tracker_offset_rms_free"


@pytest.mark.parametrize(
    ("metric", "value", "verdicts"),
    [
        (OVERLAP, 3e-7, []), (OVERLAP, 9e-7, []), (OVERLAP, 2e-6, ["worse"]), (OVERLAP, math.nan, ["worse"]),
        (OFFSET, 2.05e-3, []), (OFFSET, 2.4e-3, ["worse"]), (OFFSET, 1e-3, ["better"]), (OFFSET, None, ["worse"]),
    ],
)
def test_another_machine_explains_small_differences(metric: str, value: float | None, verdicts: Sequence[str]) -> None:
    kept = {OVERLAP: 3e-7, OFFSET: 2e-3}
    run = run_of([figure("a", OURS, name, value if name == metric else kept[name]) for name in kept])
    assert [one[-1] for one in listed(against_baseline(baseline(kept), run, "baseline"))] == verdicts


def test_baseline_scenes_that_did_not_run_are_named() -> None:
    run = run_of([figure("a", OURS, OVERLAP, 0.0, "pass", 1.0), figure("b", MUJOCO, OVERLAP, 1.0)])
    found = against_baseline(baseline({OVERLAP: 0.0}, "ac"), run, "baseline")
    assert listed(found) == [] and found.gone == ("c",)
