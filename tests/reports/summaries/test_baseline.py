"""A run is no worse than its own baseline; what is worse by more than another machine explains is found."""

from collections.abc import Callable
from pathlib import Path

import pytest

from avatarsim.errors import InvalidFile
from reports.__main__ import COMMITTED, main
from reports.reading.load import load
from reports.summaries import baseline
from reports.summaries.diff import diff

Json = dict[str, object]
Write = Callable[[object], Path]


def changed(results: Json, metric: str, value: object) -> Json:
    rows = results["rows"]
    assert isinstance(rows, list)
    ours = [r["metric"] == metric and r["scenario"] == "arm_wall" and r["engine"] == "avatarsim" for r in rows]
    return results | {"rows": [row | {"value": value} if own else row for row, own in zip(rows, ours, strict=True)]}


@pytest.mark.parametrize(("metric", "value", "worse", "better"), [
    ("none", 0.0, 0, 0), ("residual_overlap_max", 9e-7, 0, 0), ("residual_overlap_max", 2e-6, 1, 0),
    ("residual_overlap_max", "NaN", 1, 0), ("residual_overlap_max", None, 1, 0), ("frame_time_p50", 1e6, 0, 0),
    ("tracker_offset_rms_free", 2.05e-3, 0, 0), ("tracker_offset_rms_free", 2.4e-3, 1, 0),
    ("tracker_offset_rms_free", 1e-3, 0, 1),
])
def test_what_counts(run_dir: Write, results: Json, tmp_path: Path, metric: str, value: object, worse: int, better: int) -> None:
    path = tmp_path / "kept.csv"
    assert main(["baseline", str(run_dir(results)), "--to", str(path)]) == 0
    found = diff(baseline.load(path), load(run_dir(changed(results, metric, value))))
    assert (len(found.worse), len(found.better), found.only_new) == (worse, better, ())


def test_the_file_holds_our_accuracy_and_nothing_else(run_dir: Write, results: Json) -> None:
    written = baseline.text(load(run_dir(results)))
    assert "arm_wall,avatarsim/default,residual_overlap_max,m,3e-07\n" in written
    assert "mujoco" not in written and "frame_time" not in written


@pytest.mark.parametrize("content", ["", "scenario,run,metric,unit,value\n", "scenario,run\na,b\n",
                                     "scenario,run,metric,unit,value\na,b/c,residual_overlap_max,m,\n"])
def test_a_damaged_baseline_is_said_to_be_damaged(tmp_path: Path, content: str) -> None:
    (tmp_path / "kept.csv").write_text(content)
    with pytest.raises(InvalidFile, match=r"kept\.csv"):
        baseline.load(tmp_path / "kept.csv")
    assert main(["diff", str(tmp_path / "kept.csv"), str(tmp_path)]) == 2


def test_the_committed_baseline_keeps_the_promise() -> None:
    rows = baseline.load(COMMITTED).rows
    overlap = [row.value for row in rows if row.metric == "residual_overlap_max"]
    assert len(overlap) > 50 and all(value is not None and value <= 1e-6 for value in overlap)
