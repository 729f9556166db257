"""What we lose is what the terminal says that we lose, and nobody who is no rival is named as one."""

import math
from collections.abc import Callable
from pathlib import Path

import pytest

from reports.behind import behind
from reports.load import Row, load
from scenarios.results import Row as TerminalRow
from scenarios.table import COLUMNS, lines, losing

Json = dict[str, object]
Write = Callable[[object], Path]
OURS = "avatarsim/default"


def row(run: str, metric: str, value: float | None, seed: int = 0) -> Row:
    engine, preset = run.split("/")
    return Row("s", engine, preset, seed, 1, metric, value, "", None, None, "info", "")


def terminal(rows: list[Row]) -> int:
    """How many losses the terminal prints for the same rows."""
    theirs = [TerminalRow(r.scenario, r.engine, r.preset, r.seed, r.frames, r.metric, r.value, r.unit, r.bound, r.ceiling,
                          "info", r.note) for r in rows]
    return len(losing(lines(theirs), frozenset({("avatarsim", "default")})))


@pytest.mark.parametrize("metric", [column.metric for column in COLUMNS if column.same is not None])
@pytest.mark.parametrize("share", [-0.5, 0.5, 1.5])
@pytest.mark.parametrize("mine", [0.7, None, math.nan])
def test_page_and_terminal_agree(metric: str, share: float, mine: float | None) -> None:
    """Theirs is better by a share of what counts as equal, beside a tracker and another preset that are better by far."""
    same = next(column.same for column in COLUMNS if column.metric == metric) or 1e-9
    rows = [row(OURS, metric, mine), row("mujoco/tuned", metric, 0.7 - share * same),
            row("tracker/default", metric, 0.0), row("avatarsim/paper", metric, 0.0)]
    found = behind(rows, OURS)
    assert len(found) == terminal(rows)
    assert all(run == "mujoco/tuned" for lost in found for run, _ in lost.rivals)


def test_one_bad_seed_is_a_loss_and_the_worst_one_is_told() -> None:
    rows = [row(run, "frame_time_p50", value, seed) for seed, times in enumerate(((2.0, 1.0), (9.0, 3.0), (5.0, 6.0)))
            for run, value in zip((OURS, "mujoco/tuned"), times, strict=True)]
    (found,) = behind(rows, OURS)
    assert (found.row.seed, found.factor) == (1, 3.0)


def test_whoever_left_the_room_is_named_as_such_and_only_if_nobody_inside_is_ahead() -> None:
    rows = [row(OURS, "residual_overlap_max", 1e-3), row("a/b", "residual_overlap_max", 0.0),
            row("a/b", "wrong_side_frames", 4.0)]
    (found,) = behind(rows, OURS)
    assert found.outside
    (found,) = behind([*rows, row("c/d", "residual_overlap_max", 1e-4)], OURS)
    assert not found.outside and found.rivals == (("c/d", 1e-4),)


def test_a_figure_that_is_no_number_is_shown_with_an_infinite_factor(run_dir: Write, results: Json) -> None:
    from reports.summary import summary
    from reports.verdict import verdict

    rows = results["rows"]
    assert isinstance(rows, list)
    own = [r | ({"value": "NaN"} if r["engine"] == "avatarsim" and r["metric"] == "frame_time_p50" else {}) for r in rows]
    found = load(run_dir(results | {"rows": own}))
    assert "NaN (×∞)" in summary(found, verdict(found))
