"""Rows of a setting: its errors, its times, and the reason where one is missing."""

import math

import pytest

from scenarios.studies.settings.cell import Cell
from scenarios.studies.settings.grid import Setting
from scenarios.studies.settings.rows import rows_of

CELL = Cell("thin_wall_hand", Setting("mujoco", "tuned dt=1/60", "tuned", {"dt": 1 / 60}))
METRICS = ("residual_overlap_max", "wrong_side_frames")


def entry(state: str = "measured", note: str = "", **values: float) -> dict[str, object]:
    return {"state": state, "note": note, "values": values, "missing": {}, "frames": 3}


def test_a_measured_cell_has_a_row_per_error_and_time() -> None:
    found = {**entry(residual_overlap_max=1e-4, wrong_side_frames=0.0, not_finite_frames=0.0), "step": 1 / 60}
    timed = {"p50": 20.0, "p95": 25.0, "p99": None, "rests": 50.0, "note": "3 x 180 frames"}
    rows = {row.metric: row for row in rows_of(CELL, METRICS, found, timed)}
    figures = {name: row.value for name, row in rows.items()}
    assert figures == {
        "residual_overlap_max": 1e-4, "wrong_side_frames": 0.0, "not_finite_frames": 0.0, "time_step": 1 / 60,
        "frame_time_p50": 20.0, "frame_time_p95": 25.0, "resting_frames": 50.0,
    }
    one = rows["frame_time_p50"]
    assert (one.preset, one.change, one.note, one.frames) == ("tuned", "tuned dt=1/60", "3 x 180 frames", 3)
    assert one.options == 'mujoco."tuned.dt=1_60" = {preset = "tuned", dt = 0.016666666666666666}'


@pytest.mark.parametrize("state", ["crashed", "not-measured"])
def test_a_cell_without_figures_is_one_row(state: str) -> None:
    [row] = rows_of(CELL, METRICS, entry(state, "it died"), None)
    assert (row.metric, row.status, row.note, row.value) == ("run", state, "it died", None)


def test_missing_figure_and_untimed_cell_have_reasons() -> None:
    found = {**entry(residual_overlap_max=math.nan, not_finite_frames=3.0), "missing": {"wrong_side_frames": "no region"}}
    rows = {row.metric: row for row in rows_of(CELL, METRICS, found, {"p50": None, "note": "it died"})}
    assert (rows["wrong_side_frames"].value, rows["wrong_side_frames"].note) == (None, "no region")
    assert (rows["frame_time_p50"].value, rows["frame_time_p50"].note) == (None, "it died")


def test_an_error_that_the_engine_cannot_express_has_no_figure() -> None:
    found = {**entry(residual_overlap_max=0.0, course_error_max=0.4), "unsupported": {"virtual coupling": "no spring"}}
    rows = {row.metric: row for row in rows_of(CELL, ("residual_overlap_max", "course_error_max"), found, None)}
    assert rows["residual_overlap_max"].value == 0.0
    assert (rows["course_error_max"].value, rows["course_error_max"].status) == (None, "cannot-say")
