"""The cheapest setting per scene, engine and accuracy: ties, missing figures, what reaches nothing, and what is said first."""

import math
from dataclasses import replace

import pytest

from reports.deciding.alike import LEVEL, Basis, basis_of, factor, is_more, level
from reports.sections.sweep.attempts import Attempt, attempts
from reports.sections.sweep.cheapest import asleep as asleep_cases
from reports.sections.sweep.cheapest import astray, at_level, cheapest, sentence, silence, table
from reports.sections.sweep.performance_profile import profiles
from reports.sections.sweep.points import Point, Sweep
from runfiles.accuracy import FOLLOWS, LEVELS

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


def test_what_stays_far_from_a_free_user_reaches_no_accuracy_and_is_said() -> None:
    far = (point("m/tuned", 0.0, 5.0), point("m/tuned", 1.01 * FOLLOWS, 5.0, metric="tracker_offset_rms_free"))
    near = (point("m/tuned", 0.0, 5.0), point("m/tuned", 0.99 * FOLLOWS, 5.0, metric="tracker_offset_rms_free"))
    assert all(cheapest(tried(*far), level) is None and cheapest(tried(*near), level) is not None for level in LEVELS)
    found = table(Sweep((point("avatarsim/default", 0.0, 10.0), *far)))
    said, listed = astray(found)
    assert "farther than 10 mm from a user" in said and "1 setting" in said and listed == [("wall", "m/tuned 10.1 mm")]
    rival = found.blocks[0].lines[1]
    assert rival.cells[0].strays == 1 and math.isnan(rival.least) and rival.tried == 1
    assert "m: none of 1 setting measured here (none of them within 10 mm of a free" in at_level(found.blocks[0], 1e-3, ("m",))
    assert astray(table(Sweep((point("avatarsim/default", 0.0, 10.0), *near)))) == ("", [])
    # a list below a caption names what strays too: the caption says why it does not count
    both = (*far, point("m/follows", 0.0231, 4.0), point("m/follows", 0.5 * FOLLOWS, 4.0, metric="tracker_offset_rms_free"))
    caption = at_level(table(Sweep((point("avatarsim/default", 0.0, 10.0), *both))).blocks[0], 1e-3, ("m",))
    assert "m: none of 2 settings measured here (at best 23.1 mm of those within 10 mm of a free user)" in caption


def test_what_an_engine_has_no_words_for_is_no_case_and_no_entry_of_the_profile() -> None:
    silent = (point("m/tuned", math.nan, 5.0, "spring", metric="course_error_max", state="cannot-say"),
              point("m/tuned", 0.0, 5.0, "spring"))
    ours = (point("avatarsim/default", 0.0, 10.0, "spring", metric="course_error_max"), point("avatarsim/default", 0.0, 10.0))
    found = table(Sweep((*ours, *silent, point("m/tuned", 0.0, 20.0))))
    assert [block.scenario for block in found.blocks] == ["spring", "wall"]
    assert [block.scenario for block in found.compared] == ["wall"] and {case.block.scenario for case in found.cases} == {"wall"}
    assert found.blocks[0].silent == ("m",) and silence(found) == [
        "spring is no case: m cannot say what counts there (distance from the closed-form course)."]
    assert profiles(found, 1e-3) == {"avatarsim": ((1.0, 1.0),), "m": ((1.0, 0.0), (2.0, 1.0))}
    # one preset without the words does not take the others' place away
    able = table(Sweep((*ours, *silent, point("m/other", 0.0, 5.0, "spring", metric="course_error_max"))))
    assert able.blocks[0].silent == () and able.blocks[0].lines[1].tried == 1


def test_a_sleeping_engine_has_no_factor_and_is_compared_in_frames_that_move() -> None:
    ours = replace(point("avatarsim/default", 0.0, 0.5), sleeps=True, rests=0.8, p95=1500.0)
    awake, asleep = replace(point("m/tuned", 0.0, 400.0), rests=0.8, p95=700.0), point("m/tuned sleep=true", 0.0, 40.0)
    asleep = replace(asleep, sleeps=True, rests=0.8, p95=640.0)
    assert basis_of((ours, awake)) is basis_of((ours, asleep)) is Basis.TAIL and basis_of((awake,)) is Basis.MEDIAN
    assert math.isnan(factor(awake, ours, Basis.TAIL)) and math.isnan(factor(asleep, ours, Basis.TAIL))
    said = sentence(table(Sweep((ours, awake))))
    assert ("a rival is cheaper in 4: wall at 10 mm, 1 mm, 100 µm, 1 µm (m/tuned 700 µs, ours 1.50 ms, in frames that move)"
            in said)
    assert "×" not in said.replace("scene ×", "")
    (said,) = asleep_cases(table(Sweep((ours, awake))))
    assert ("ours sleeps: avatarsim/default 500 ns and m/tuned 400 µs, no factor; in frames that move (95th percentile): 1.50 ms "
            "and 700 µs."
            in said)
    (both,) = asleep_cases(table(Sweep((ours, asleep))))
    assert ("wall at 100 µm and wall at 1 µm: both sleep: avatarsim/default 500 ns and m/tuned sleep=true 40.0 µs, no factor; in "
            "frames that move (95th percentile): 1.50 ms and 640 µs.") in both
    moving = replace(ours, moving=4.0, at_rest=0.4), replace(awake, moving=100.0, at_rest=410.0)
    assert basis_of(moving) is Basis.MOVING and factor(moving[1], moving[0], Basis.MOVING) == 25.0
    # before it rests for half of the frames, a median is that of a frame in motion
    before = replace(ours, rests=0.4), replace(awake, rests=0.4)
    assert basis_of(before) is Basis.MEDIAN and factor(before[1], before[0], Basis.MEDIAN) == 800.0


def test_sentence_bold_figure_and_profile_compare_the_same_time() -> None:
    ours = replace(point("avatarsim/default", 0.0, 0.5), sleeps=True, rests=0.8, p95=1500.0)
    found = table(Sweep((ours, replace(point("m/tuned", 0.0, 400.0), rests=0.8, p95=700.0))))
    lines = {line.engine: line.cells[MM] for line in found.blocks[0].lines}
    assert lines["m"].best and not lines["avatarsim"].best and len(found.lost) == len(LEVELS)
    assert profiles(found, 1e-3)["m"][0] == (1.0, 1.0) and profiles(found, 1e-3)["avatarsim"][-1] == (1500.0 / 700.0, 1.0)


def test_times_within_a_tenth_are_level() -> None:
    assert level(10.0, 10.0 * (1.0 + 0.99 * LEVEL)) and not level(10.0, 10.0 * (1.0 + 1.01 * LEVEL)) and not level(1.0, math.nan)
    assert not is_more(10.9, 10.0) and is_more(11.1, 10.0) and not is_more(math.nan, 1.0)
    found = table(Sweep((point("avatarsim/default", 0.0, 10.5), point("m/tuned", 0.0, 10.0))))
    assert not found.lost and all(line.cells[MM].best for line in found.blocks[0].lines)
    assert all(steps[0] == (1.0, 1.0) for steps in profiles(found, 1e-3).values())


def test_an_avatar_has_times_side_by_side_and_no_factor_no_bold_figure_and_no_share() -> None:
    body = (replace(point("avatarsim/default", 0.0, 10.0, "punch"), avatar=True),
            replace(point("m/tuned", 0.0, 30.0, "punch"), avatar=True))
    found = table(Sweep((*body, point("avatarsim/default", 0.0, 10.0), point("m/tuned", 0.0, 20.0))))
    punch = found.blocks[0]
    assert punch.avatar and all(not cell.best and math.isnan(cell.factor) for line in punch.lines for cell in line.cells)
    assert {case.block.scenario for case in found.cases} == {"wall"} and profiles(found, 1e-3)["m"][-1] == (2.0, 1.0)
    said = sentence(found)
    assert said.startswith("Of 4 cases without an avatar (scene × accuracy) a rival is cheaper in 0.") and "×3" not in said
    assert "times stand side by side" in said and "in none of them does a rival take less time" in said
    assert "not compared" in at_level(punch, 1e-3, found.engines)
    slower = table(Sweep((body[0], replace(body[1], p50=5.0))))
    assert "a rival takes less time, or reaches what ours does not, in 4 of them: punch at 10 mm" in sentence(slower)


def test_settings_that_were_planned_and_not_measured_are_counted() -> None:
    left = [replace(point(f"m/tuned dt=1/{rate}", math.nan, math.nan), state="not-measured") for rate in (1920, 3840)]
    tuned = replace(point("m/tuned", 5e-3, 20.0), step=1.0 / 960.0)
    found = table(Sweep((point("avatarsim/default", 0.0, 10.0), tuned, *left)))
    assert found.blocks[0].lines[1].measured == "1 setting measured here (of 3 planned)"
    said = at_level(found.blocks[0], 1e-3, found.engines)
    assert "m: not said: 2 steps of the ladder not measured, none of 1 of 3 (at best 5.00 mm)" in said
    assert "that none of the settings measured of other engines does" not in sentence(found)
    assert "none is said to miss it, in 3 cases in which steps of a rival were not measured" in sentence(found)


def test_none_is_said_to_miss_what_a_finer_step_might_reach() -> None:
    rungs = [replace(point(f"m/tuned dt=1/{rate}", error, 1e4 / rate), step=1.0 / rate)
             for rate, error in ((960, 4.42e-4), (1920, 2.21e-4), (3840, 1.11e-4))]
    ours = point("avatarsim/default", 0.0, 1.0)
    found = table(Sweep((ours, *rungs)))
    assert "reaches an accuracy that none" not in sentence(found)
    assert "none is said to miss it, in 2 cases in which steps of a rival were not measured" in sentence(found)
    said = at_level(found.blocks[0], 1e-4, found.engines)
    assert "m: not said: errors still fall at tuned 1/3840 s, the finest step measured, none of 3 (at best 111 µm)" in said
    assert found.unsaid(1e-4) == {"m": 1} and found.unsaid(1e-3) == {}
    ended = table(Sweep((ours, *rungs, replace(point("m/tuned dt=1/7680", 1.2e-4, 9.0), step=1.0 / 7680.0))))
    assert "In 2 cases ours reaches an accuracy that none of the settings measured of other engines does." in sentence(ended)
    assert ended.unsaid(1e-4) == {}
    # a factor stands while another rival that reaches it takes less time than the end of the ladder, and not if it takes more
    for time, stands in ((2.0, True), (3.0, False)):
        both = table(Sweep((ours, *rungs, point("n/tuned", 5e-5, time))))
        assert [case.asked for case in both.cases] == [True, True, stands, False] and both.unsaid(1e-4) == {"m": 1}


def test_no_factor_is_made_while_a_coarser_step_of_the_ladder_was_not_measured() -> None:
    def of(*rungs: Point) -> float:
        ours, tuned = point("avatarsim/default", 0.0, 10.0), replace(point("m/tuned", 5e-4, 40.0), step=1.0 / 960.0)
        found = table(Sweep((ours, tuned, *rungs)))
        assert ("the cheapest rival takes" in sentence(found)) is not any(r.state == "not-measured" and "/120" in r.setting
                                                                        for r in rungs)
        return next(line for line in found.blocks[0].lines if line.engine == "m").cells[MM].factor

    coarse, fine = (replace(point(f"m/tuned dt=1/{rate}", 5e-3, 5.0), step=1.0 / rate) for rate in (120, 1920))
    gone = [replace(one, error=math.nan, p50=math.nan, step=math.nan, state="not-measured") for one in (coarse, fine)]
    assert math.isnan(of(gone[0])) and of(gone[1]) == of(coarse) == 4.0, "a finer step is no cheaper one"


def test_a_caption_says_of_how_many_settings_the_cheapest_is() -> None:
    left = replace(point("m/tuned margin=0", math.nan, math.nan), state="not-measured")
    found = table(Sweep((point("avatarsim/default", 0.0, 10.0), point("m/tuned", 5e-4, 20.0), left)))
    assert "m 20.0 µs (tuned, 1 of 2)" in at_level(found.blocks[0], 1e-3, found.engines)


def test_the_offset_from_the_tracker_stands_beside() -> None:
    (found,) = tried(point("m/tuned", 0.0, 5.0), point("m/tuned", 0.003, 5.0, metric="tracker_offset_rms_free"))
    assert found.error == 0.0 and found.offset == 0.003
    assert tried(point("m/tuned", 0.3, 5.0, metric="tracker_offset_rms_free")) == ()


def test_the_table_has_a_line_per_engine_with_factors_of_our_default() -> None:
    found = table(Sweep((
        point("avatarsim/default", 0.0, 10.0), point("mujoco/tuned", 5e-4, 25.0), point("mujoco/default", 5e-3, 5.0),
        point("pybullet/tuned", 2e-2, 1.0), point("pybullet/default", 1e-9, 1.0, state="crashed"),
    )))
    (block,) = found.blocks
    assert [line.engine for line in block.lines] == ["avatarsim", "mujoco", "pybullet"]
    assert block.metrics == ("residual_overlap_max",)
    ours, mujoco, pybullet = block.lines
    assert [(cell.factor, cell.best) for cell in ours.cells[:2]] == [(1.0, False), (1.0, True)]
    assert [(cell.factor, cell.best) for cell in mujoco.cells[:2]] == [(0.5, True), (2.5, False)]
    assert all(cell.attempt is None and math.isnan(cell.factor) for cell in pybullet.cells)
    assert (pybullet.tried, pybullet.least) == (1, 2e-2)
    said = at_level(block, 1e-3, found.engines)
    assert said == ("Deepest overlap shown at most 1 mm, cheapest (measured of planned): avatarsim 10.0 µs (default, 1), mujoco "
                    "25.0 µs (tuned, 2), pybullet: none of 1 setting measured here (of 2 planned) (at best 20.0 mm).")


def test_what_is_lost_is_said_first() -> None:
    found = table(Sweep((
        point("avatarsim/default", 0.0, 10.0), point("mujoco/tuned", 5e-4, 8.0),
        point("avatarsim/default", 5e-3, 10.0, "drop"), point("mujoco/tuned", 1e-9, 40.0, "drop"),
    )))
    said = sentence(found)
    first = ("Of 8 cases without an avatar (scene × accuracy) a rival is cheaper in 5: wall at 10 mm, 1 mm (mujoco/tuned 8.00 "
             "µs, ours")
    assert said.startswith(first)
    assert "drop at 1 mm, 100 µm, 1 µm (mujoco/tuned 40.0 µs, ours does not reach it)" in said
    assert "×4.0 (drop at 10 mm, mujoco/tuned)" in said
    assert "In 2 cases ours reaches an accuracy that none of the settings measured of other engines does. Where" in said
    assert "the time of avatarsim/default" in said


def test_nothing_lost_and_nothing_reached_are_said_too() -> None:
    won = sentence(table(Sweep((point("avatarsim/default", 5e-4, 10.0), point("mujoco/tuned", 5e-4, 20.0)))))
    assert won.startswith("Of 4 cases without an avatar (scene × accuracy) a rival is cheaper in 0.")
    assert "Not reached by any setting measured here of any engine: wall at 100 µm, wall at 1 µm." in won
    assert sentence(table(Sweep((point("m/x", 1.0, 1.0, metric="spin_error_max", unit="rad/s"),)))).startswith("No error of this")


def test_where_what_rests_sleeps_through_the_tail_the_slowest_frames_are_compared() -> None:
    ours = replace(point("avatarsim/default", 0.0, 0.5), sleeps=True, rests=0.97, p95=0.6, slowest=4000.0)
    awake = replace(point("m/tuned", 0.0, 700.0), rests=0.98, p95=750.0, slowest=900.0)
    assert basis_of((ours, awake)) is Basis.SLOWEST and math.isnan(factor(awake, ours, Basis.SLOWEST))
    said = sentence(table(Sweep((ours, awake))))
    assert "wall at 10 mm, 1 mm, 100 µm, 1 µm (m/tuned 900 µs, ours 4.00 ms, in the slowest frame)" in said
    assert "in frames that move (the slowest): 4.00 ms and 900 µs." in asleep_cases(table(Sweep((ours, awake))))[0]
    # a file without slowest frames has its percentile
    assert basis_of((replace(ours, slowest=math.nan), awake)) is Basis.TAIL


def test_ours_is_one_preset_and_its_variants_in_every_statement() -> None:
    ours, paper = point("avatarsim/default", 0.0, 10.0), point("avatarsim/paper", 0.0, 5.0)
    more = point("avatarsim/paper rounds=4", 0.0, 4.0)
    found = table(Sweep((ours, paper, more, point("m/tuned", 5e-3, 7.0))))
    line = found.blocks[0].lines[0]
    assert (line.tried, line.planned) == (1, 1) and {cell.attempt.any_point.run for cell in line.cells if cell.attempt} == {
        "avatarsim/default"}
    assert "wall at 10 mm (m/tuned 7.00 µs, ours 10.0 µs)" in sentence(found) and "paper" not in sentence(found)
    turned = table(Sweep((ours, paper, point("avatarsim/default steps=1", 0.0, 8.0), point("m/tuned", 5e-3, 7.0))))
    assert "m/tuned 7.00 µs, ours avatarsim/default steps=1 8.00 µs" in sentence(turned)
