"""Worst moments: largest first, apart from one another, no number before all, and none of what is 0 throughout."""

import math

import numpy as np

from scenarios.posture_table.moments import APART, peaks, worst
from tests.scenarios.posture_table.runs_by_hand import run


def test_peaks_are_largest_first_and_one_event_is_listed_once() -> None:
    values = np.zeros(4 * APART)
    values[[10, 10 + APART - 1, 10 + APART, 3 * APART]] = [9.0, 8.0, 5.0, 7.0]
    assert peaks(values, 3) == [10, 3 * APART, 10 + APART] and peaks(values, 1) == [10]
    assert peaks(values, 9) == [10, 3 * APART, 10 + APART]


def test_what_is_no_number_comes_first_and_nothing_comes_of_nothing() -> None:
    values = np.zeros(3 * APART)
    values[[2, 2 * APART]] = [4.0, math.nan]
    assert peaks(values, 2) == [2 * APART, 2]
    assert peaks(np.zeros(5), 2) == [] and peaks(np.zeros(0), 2) == []


def test_moments_of_all_runs_are_ranked_by_measure_with_scene_and_frame() -> None:
    still = [0.0] * 4
    found = list(worst([
        run("a", turn=[0, 20.0, 0, 0], silent=still), run("b", seed=3, turn=[0, 0, 10.0, 30.0]),
        run("c", turn=[-1.0] * 4, times=[1, 1, 5, 1]),
    ], 2))
    assert found == [
        "- turn beyond the user's [deg]", "  - 30: b --seed 3 frame 4", "  - 20: a frame 2",
        "- frame time [us]", "  - 5: c frame 3",
    ]


def test_a_posture_that_is_no_number_is_the_worst_of_all_runs() -> None:
    found = list(worst([run("a", way=[0, 3.0, 0, 0]), run("b", way=[0, 0, math.nan, 0])], 1))
    assert found[1:] == ["  - nan: b frame 3"]
