"""Worse is worse beyond what can be told apart; times count only between runs of one host."""

from collections.abc import Callable
from pathlib import Path

import pytest

from reports.reading.load import load
from reports.summaries.diff import Changes, diff

Json = dict[str, object]
Write = Callable[[object], Path]


def compared(run_dir: Write, results: Json, metric: str, value: object, **provenance: object) -> Changes:
    """The run against itself with one number of ours in arm_wall changed."""
    rows, told = results["rows"], results["provenance"]
    assert isinstance(rows, list) and isinstance(told, dict)
    ours = [r["metric"] == metric and r["scenario"] == "arm_wall" and r["engine"] == "avatarsim" for r in rows]
    new = [row | {"value": value} if own else row for row, own in zip(rows, ours, strict=True)]
    return diff(load(run_dir(results)), load(run_dir(results | {"rows": new, "series": {}, "provenance": told | provenance})))


def test_a_run_is_no_worse_than_itself(run_dir: Write, results: Json) -> None:
    found = compared(run_dir, results, "none", 0.0)
    assert (found.worse, found.better, found.no_times) == ((), (), "")


@pytest.mark.parametrize(("metric", "value", "worse", "better"), [
    ("residual_overlap_max", 4e-7, 1, 0), ("residual_overlap_max", 2e-7, 0, 1), ("residual_overlap_max", "NaN", 1, 0),
    ("residual_overlap_max", None, 1, 0), ("overlap_frames", 0.04, 0, 0), ("frame_time_p50", 36.0, 0, 0),
    ("frame_time_p50", 45.0, 1, 0), ("frame_time_p50", 20.0, 0, 1),
])
def test_changes(run_dir: Write, results: Json, metric: str, value: object, worse: int, better: int) -> None:
    found = compared(run_dir, results, metric, value)
    assert (len(found.worse), len(found.better)) == (worse, better)


def test_times_of_another_host_are_left_out_and_said(run_dir: Write, results: Json) -> None:
    found = compared(run_dir, results, "frame_time_p50", 900.0, cpu="Abacus 10")
    assert found.worse == () and "hosts differ in cpu" in found.text()


def test_a_run_that_vanished_is_named(run_dir: Write, results: Json) -> None:
    rows = results["rows"]
    assert isinstance(rows, list)
    less = results | {"rows": [row for row in rows if row["engine"] != "pybullet"]}
    found = diff(load(run_dir(results)), load(run_dir(less)))
    assert "arm_wall  pybullet/default" in found.only_old and found.only_new == ()


def test_a_slower_median_that_the_frames_do_not_bear_out_is_noise(run_dir: Write, results: Json) -> None:
    """The rows say a third slower; whether that counts depends on the frames behind them."""
    rows, series = results["rows"], results["series"]
    assert isinstance(rows, list) and isinstance(series, dict)
    slower = [row | {"value": 42.0} if row["metric"] == "frame_time_p50" and row["scenario"] == "arm_wall" and
              row["engine"] == "avatarsim" else row for row in rows]
    old = load(run_dir(results))
    for factors, worse in (((1.35, 1.35), 1), ((0.5, 2.2), 0)):
        times = [31.0 * factors[(k // 50) % 2] for k in range(200)]
        own = series["arm_wall"] | {"avatarsim/default": {"overlap_m": [0.0], "frame_time_us": times}}
        found = diff(old, load(run_dir(results | {"rows": slower, "series": series | {"arm_wall": own}})))
        assert len(found.worse) == worse
        assert not worse or "(×1.35 to ×1.35)" in found.text()


def test_frames_of_the_engine_alone_say_nothing_of_a_median_with_python_round_it(run_dir: Write, results: Json) -> None:
    rows = results["rows"]
    assert isinstance(rows, list)
    called = rows[0] | {"metric": "frame_time_python_p50", "unit": "us", "bound": None, "status": "info"}
    old, new = (load(run_dir(results | {"rows": [*rows, called | {"value": value}]})) for value in (31.0, 93.0))
    found = diff(old, new)
    assert len(found.worse) == 1 and "no frames to tell the noise from" in found.text()
