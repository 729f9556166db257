"""A run equals its own baseline; differences larger than those between machines are found."""

from collections.abc import Callable
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from reports import BASELINE
from reports.summaries import baseline
from reports.tables.changes import against_baseline
from reports.tables.run import Run
from runfiles.metrics import METRICS
from tests.reports.small_runs import MUJOCO, OURS, OVERLAP, figure, run_of

Json = dict[str, object]
Write = Callable[[object], Path]
WATCHED = [name for name, one in METRICS.items() if one.watched]


def kept(run: Run, path: Path) -> Path:
    """Write the baseline of a run."""
    path.write_text(baseline.text(run), encoding="utf-8")
    return path


@given(st.lists(st.floats(0.0, 1e3), min_size=len(WATCHED), max_size=len(WATCHED)))
def test_a_run_is_equal_to_its_own_baseline(tmp_path_factory: pytest.TempPathFactory, values: list[float]) -> None:
    run = run_of([figure("a", OURS, name, value) for name, value in zip(WATCHED, values, strict=True)])
    table = baseline.load(kept(run, tmp_path_factory.mktemp("kept") / "kept.csv"))
    assert dict(zip(table.metric, table.value, strict=True)) == pytest.approx(dict(zip(WATCHED, values, strict=True)), rel=6e-3)
    found = against_baseline(table, run, "kept")
    assert found.table.empty and found.gone == ()


def test_file_holds_only_watched_figures_of_the_gated_engine(tmp_path: Path) -> None:
    metrics = (*WATCHED, "frame_time_p50", "residual_overlap_mean")
    rows = [figure("a", run, name, 1.0) for run in (OURS, MUJOCO) for name in metrics]
    table = baseline.load(kept(run_of([*rows, figure("unseen_a", OURS, OVERLAP, 1.0)]), tmp_path / "kept.csv"))
    assert set(table.run) == {OURS} and set(table.metric) == set(WATCHED) and set(table.scenario) == {"a"}


@pytest.mark.parametrize("value", [float("nan"), float("inf"), None])
def test_what_is_no_number_is_never_committed(value: float | None, tmp_path: Path) -> None:
    run = run_of([figure("a", OURS, OVERLAP, 0.0), figure("b", OURS, OVERLAP, value)])
    assert baseline.load(kept(run, tmp_path / "kept.csv")).scenario.tolist() == ["a"]


def test_the_committed_baseline_keeps_the_promise() -> None:
    table = baseline.load(BASELINE)
    overlap = table[table.metric == OVERLAP].value
    assert len(overlap) > 50 and (overlap <= 1e-6).all()
    assert set(table.metric) <= set(METRICS) and not table.duplicated(["scenario", "run", "metric"]).any()
