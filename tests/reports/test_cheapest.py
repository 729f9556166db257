"""The cheapest setting per scene, engine and accuracy: ties, missing figures, what reaches nothing, and what is said first."""

import math

import pytest

from reports.cheapest import LEVELS, Attempt, at_level, attempts, cheapest, sentence, table
from reports.sweep import Point, Sweep

MM = LEVELS.index(1e-3)


def point(run: str, error: float, p50: float, scene: str = "wall", metric: str = "residual_overlap_max", unit: str = "m",
          state: str = "measured") -> Point:
    engine, setting = run.split("/", 1)
    base = setting.partition(" ")[0]
    return Point(scene, engine, setting, metric, unit, error, p50, math.nan, state, "", 1e-6, "", base, f"options of {setting}")


def tried(*points: Point) -> tuple[Attempt, ...]:
    return attempts(points)


def test_the_fastest_that_is_accurate_enough() -> None:
    found = tried(point("m/tuned", 1e-5, 90.0), point("m/tuned dt=1/60", 5e-3, 10.0), point("m/tuned dt=1/240", 9e-4, 30.0))
    assert [one.any_point.setting if one else None for one in (cheapest(found, level) for level in LEVELS)] == [
        "tuned dt=1/60", "tuned dt=1/240", "tuned", None]
    assert cheapest(tried(point("m/tuned", 1e-3, 5.0)), 1e-3) is not None and cheapest((), 1e-3) is None


def test_times_that_are_not_told_apart_name_the_preset_then_the_more_accurate() -> None:
    turned, preset = point("m/tuned dt=1/60", 1e-7, 10.0), point("m/tuned", 1e-4, 10.2)
    assert cheapest(tried(turned, preset), 1e-3) == tried(preset)[0]
    better, worse = point("m/tuned b=1", 1e-7, 10.2), point("m/tuned a=1", 1e-4, 10.0)
    assert cheapest(tried(worse, better), 1e-3) == tried(better)[0]
    none, less = point("m/default", 2.5e-7, 10.0), point("m/paper", 2.4e-7, 9.9)
    assert cheapest(tried(less, none), 1e-3) == tried(none)[0]
    same = point("m/tuned b=1", 1e-4, 10.0)
    assert cheapest(tried(same, worse), 1e-3) == tried(worse)[0]
    assert cheapest(tried(worse, point("m/tuned", 1e-4, 11.0)), 1e-3) == tried(worse)[0]


@pytest.mark.parametrize("spoilt", [
    point("m/tuned", math.nan, 1.0), point("m/tuned", 0.0, math.nan), point("m/tuned", 0.0, 1.0, state="wrong-side"),
    point("m/tuned", 0.0, 1.0, state="not-finite"), point("m/tuned", 0.0, 0.0), point("m/tuned", math.inf, 1.0),
])
def test_what_has_no_accuracy_or_no_time_reaches_nothing(spoilt: Point) -> None:
    assert all(cheapest(tried(spoilt), level) is None for level in LEVELS)


def test_all_errors_of_a_scene_have_to_be_small_and_a_missing_one_spoils_the_others() -> None:
    overlap, apex = point("m/tuned", 0.0, 5.0), point("m/tuned", 2e-3, 5.0, metric="apex_error_max")
    (both,) = tried(overlap, apex)
    assert both.error == 2e-3 and not both.reaches(1e-3) and both.reaches(1e-2)
    (half,) = tried(overlap, point("m/tuned", math.nan, 5.0, metric="apex_error_max", state="not-measured"))
    assert not half.reaches(1e-2)


def test_one_percent_of_a_way_counts_as_ten_millimetres_and_other_units_not_at_all() -> None:
    (way,) = tried(point("m/tuned", 1.0, 5.0, metric="stop_distance_error_max", unit="%"))
    assert way.error == pytest.approx(1e-2)
    assert tried(point("m/tuned", 1.0, 5.0, metric="velocity_error_max", unit="m/s")) == ()


def test_the_offset_from_the_tracker_stands_beside_and_decides_nothing() -> None:
    (found,) = tried(point("m/tuned", 0.0, 5.0), point("m/tuned", 0.3, 5.0, metric="tracker_offset_rms_free"))
    assert found.error == 0.0 and found.offset == 0.3
    assert tried(point("m/tuned", 0.3, 5.0, metric="tracker_offset_rms_free")) == ()


def test_the_table_has_a_line_per_engine_with_factors_to_the_fastest() -> None:
    found = table(Sweep((
        point("avatarsim/default", 0.0, 10.0), point("mujoco/tuned", 5e-4, 25.0), point("mujoco/default", 5e-3, 5.0),
        point("pybullet/tuned", 2e-2, 1.0), point("pybullet/default", 1e-9, 1.0, state="crashed"),
    )))
    (block,) = found.blocks
    assert [line.engine for line in block.lines] == ["avatarsim", "mujoco", "pybullet"]
    assert block.metrics == ("residual_overlap_max",)
    ours, mujoco, pybullet = block.lines
    assert [cell.factor for cell in ours.cells[:2]] == [2.0, 1.0]
    assert mujoco.cells[0].factor == 1.0 and mujoco.cells[MM].factor == 2.5
    assert all(cell.attempt is None and math.isnan(cell.factor) for cell in pybullet.cells)
    assert (pybullet.tried, pybullet.least) == (1, 2e-2)
    said = at_level(block, 1e-3, found.engines)
    assert said == "At most 1 mm: avatarsim 10.0 µs (default), mujoco 25.0 µs (tuned), pybullet not (at best 20.0 mm)."


def test_what_is_lost_is_said_first() -> None:
    found = table(Sweep((
        point("avatarsim/default", 0.0, 10.0), point("mujoco/tuned", 5e-4, 8.0),
        point("avatarsim/default", 5e-3, 10.0, "drop"), point("mujoco/tuned", 1e-9, 40.0, "drop"),
    )))
    said = sentence(found)
    assert said.startswith("A rival is cheaper than ours in 5 of 8 cases (scene × accuracy): wall at 10 mm (mujoco 8.00 µs, ours")
    assert "drop at 1 mm (mujoco 40.0 µs, ours does not reach it)" in said and "×4.0 (drop at 10 mm, mujoco)" in said
    assert "Only ours reaches the accuracy in 2 cases." in said


def test_nothing_lost_and_nothing_reached_are_said_too() -> None:
    won = sentence(table(Sweep((point("avatarsim/default", 5e-4, 10.0), point("mujoco/tuned", 5e-4, 20.0)))))
    assert won.startswith("In none of 4 cases") and "No setting of any engine reaches wall at 100 µm, wall at 1 µm." in won
    assert sentence(table(Sweep((point("m/x", 1.0, 1.0, metric="spin_error_max", unit="rad/s"),)))).startswith("No error of this")
