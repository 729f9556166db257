"""Ratios to another preset: the same motion beside the same, worst first, and rounding never a multiple of rounding."""

import math

import pytest

from scenarios.posture_table.ratios import HEAD, lines, ratio
from tests.scenarios.posture_table.runs_by_hand import run


def figures(offset: float, angle: float) -> dict[str, float]:
    return {"tracker_offset_rms": offset, "tracker_angle_rms": angle}


def test_a_ratio_of_rounding_is_one() -> None:
    assert ratio(3e-9, 1e-12) == 1.0 and ratio(2e-3, 1e-3) == 2.0 and ratio(1e-3, 0.0) == pytest.approx(1e3)
    assert math.isnan(ratio(math.nan, 1.0)) and math.isnan(ratio(1.0, math.nan))


def test_each_run_stands_beside_the_same_motion_of_the_other_preset_worst_first() -> None:
    found = list(lines([
        run("a", figures=figures(0.1, 2.0), times=[10.0, 10.0]), run("a", "ik", figures=figures(0.2, 1.0), times=[30.0, 30.0]),
        run("b", seed=1, figures=figures(0.1, 2.0)), run("b", "ik", seed=1, figures=figures(0.1, 8.0)),
        run("b", "ik", seed=2, figures=figures(9.0, 9.0)),
    ], "avatarsim/default"))
    assert found == [HEAD, ("avatarsim/ik", "b --seed 1", "1", "4", "-", "-"), ("avatarsim/ik", "a", "2", "0.5", "3", "3")]


def test_a_hand_without_joints_has_no_angle_to_compare() -> None:
    hand = {"tracker_offset_rms": 0.1}
    found = list(lines([run("a", figures=hand), run("a", "ik", figures=hand)], "avatarsim/default"))
    assert found[1] == ("avatarsim/ik", "a", "1", "-", "-", "-")
