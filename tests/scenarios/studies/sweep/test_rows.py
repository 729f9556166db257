"""Rows from entries: what was measured, what was not, and which settings are on which front."""

import math
from dataclasses import replace

import pytest

from runfiles.csv_rows import csv_text
from scenarios.studies.sweep.cell import Cell
from scenarios.studies.sweep.grid import Setting
from scenarios.studies.sweep.rows import Row, floored, rows_of, table, with_fronts

CELL = Cell("thin_wall_hand", Setting("mujoco", "tuned dt=1/60", "tuned"))
METRICS = ("residual_overlap_max", "wrong_side_frames")


def entry(state: str = "measured", note: str = "", **values: float) -> dict[str, object]:
    return {"state": state, "note": note, "values": values, "missing": {}}


def test_a_measured_cell_has_a_row_per_error() -> None:
    found = entry(residual_overlap_max=1e-4, wrong_side_frames=0.0, not_finite_frames=0.0)
    first, second = rows_of(CELL, METRICS, found, {"p50": 20.0, "p99": 30.0, "note": ""})
    assert (first.error, first.p50, first.p99, first.state, first.unit) == (1e-4, 20.0, 30.0, "measured", "m")
    assert second.error == 0.0 and second.unit == "frames"


def test_a_row_says_what_its_time_stands_on_and_how_to_ask_for_it_again() -> None:
    timed = {"p50": 20.0, "p99": None, "repeats": 3, "frames": 180, "note": ""}
    row, _ = rows_of(CELL, METRICS, entry(residual_overlap_max=1e-4, wrong_side_frames=0.0), timed)
    assert (row.repeats, row.frames, row.base) == (3, 180, "tuned") and math.isnan(row.p99)
    assert row.options == "--engine mujoco --preset tuned"
    untimed, _ = rows_of(CELL, METRICS, entry(residual_overlap_max=1e-4, wrong_side_frames=0.0), None)
    assert (untimed.repeats, untimed.frames) == (0, 0)


def test_who_went_through_the_wall_has_no_accuracy_but_the_count_of_it() -> None:
    found = entry(residual_overlap_max=0.0, wrong_side_frames=39.0, not_finite_frames=0.0)
    overlap, side = rows_of(CELL, METRICS, found, {"p50": 1.0, "p99": 1.0, "note": ""})
    assert overlap.state == "wrong-side" and side.state == "measured" and math.isnan(floored(overlap)) and floored(side) == 39.0


@pytest.mark.parametrize(("found", "state", "said"), [
    (entry("crashed", "it died"), "crashed", "it died"), (None, "not-measured", "not run yet"),
    (entry(residual_overlap_max=math.nan, wrong_side_frames=0.0, not_finite_frames=3.0), "not-finite", ""),
    ({**entry(not_finite_frames=0.0), "missing": dict.fromkeys(METRICS, "no judge")}, "not-measured", "no judge"),
])
def test_what_cannot_be_a_point_is_kept_as_what_it_is(found: dict[str, object] | None, state: str, said: str) -> None:
    rows = rows_of(CELL, METRICS, found, None)
    assert len(rows) == 2 and rows[0].state == state and said in rows[0].note and math.isnan(rows[0].p50)


def test_an_error_that_the_engine_has_no_words_for_is_none_and_says_why() -> None:
    found = {**entry(residual_overlap_max=0.0, course_error_max=0.4), "cannot_say": {"virtual coupling": "no spring"}}
    overlap, course = rows_of(CELL, ("residual_overlap_max", "course_error_max"), found, {"p50": 1.0, "note": ""})
    assert overlap.state == "measured" and overlap.p50 == course.p50 == 1.0
    assert course.state == "cannot-say" and "virtual coupling" in course.note and math.isnan(course.error)


def test_a_row_says_whether_what_rests_sleeps_and_how_its_frames_differ() -> None:
    timed = {"p50": 5.0, "p95": 9.0, "rests": 0.5, "moving": 8.0, "at_rest": 4.0, "note": ""}
    found = {**entry(residual_overlap_max=0.0), "step": 0.01}
    awake, asleep = (
        rows_of(Cell("stack_ten", Setting(engine, name, name.partition(" ")[0], options)), METRICS[:1], found, timed)[0]
        for engine, name, options in (("mujoco", "tuned", {}), ("mujoco", "tuned sleep=true", {"sleep": True}))
    )
    assert (awake.sleeps, asleep.sleeps, awake.step) == (0, 1, 0.01)
    assert (awake.p95, awake.rests, awake.moving, awake.at_rest) == (9.0, 0.5, 8.0, 4.0)
    assert [rows_of(Cell(scene, Setting("avatarsim", "default", "default")), METRICS[:1], found, timed)[0].sleeps
            for scene in ("stack_ten", "thin_wall_hand")] == [1, 0]


def test_errors_that_do_not_apply_have_no_row() -> None:
    assert [row.metric for row in rows_of(CELL, (*METRICS, "drift_max"), entry(residual_overlap_max=0.0), None)] == [METRICS[0]]


def row(engine: str, setting: str, error: float, p50: float, state: str = "measured") -> Row:
    return Row("s", engine, setting, "residual_overlap_max", "m", error, p50, 2.0 * p50, state, "", 1e-6, "")


def test_fronts_of_all_and_of_each() -> None:
    rows = [
        row("a", "1", 0.0, 10.0), row("a", "2", 1e-9, 9.0), row("a", "3", 1e-3, 20.0), row("b", "1", 1e-4, 30.0),
        row("b", "2", 1e-5, 60.0), row("b", "3", 1e-3, 5.0, "wrong-side"), row("b", "4", math.nan, 1.0, "crashed"),
    ]
    # 1e-9 m counts as none, so the faster of the first two alone is on the front
    assert [found.front for found in with_fronts(rows)] == ["", "all", "", "own", "own", "", ""]
    assert [found.front for found in with_fronts([*rows, replace(rows[4], scenario="t")])][-1] == "all"


def test_the_file_and_the_table() -> None:
    rows = with_fronts([row("a", "1", 0.0, 10.0), row("b", "1", math.nan, math.nan, "crashed"), row("b", "2", 1.0, math.nan)])
    assert csv_text(rows, Row).splitlines()[1:3] == [
        "s,a,1,residual_overlap_max,m,0,10,20,measured,all,1e-06,,,,0,0,,,,,,0,,0,,",
        "s,b,1,residual_overlap_max,m,,,,crashed,,1e-06,,,,0,0,,,,,,0,,0,,",
    ]
    text = table(rows)
    assert "no point: b/1: crashed" in text and "not timed: b/2" in text and "0.0100 ms" in text
