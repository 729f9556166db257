"""What samples say together."""

import math
from dataclasses import replace

import pytest

from runfiles.csv_rows import csv_text
from scenarios.nearest.frames import Sample
from scenarios.nearest.summary import summarised, table

ONE = Sample("scene", 3, 0.2, 0.02, 0.1, 0.015, 0.05, 0.02, 0.1, 10, 9)


def test_a_scene_is_the_root_mean_square_of_its_frames() -> None:
    found = summarised([ONE, replace(ONE, offset=0.04)])
    assert found.offset == pytest.approx(math.sqrt((0.02**2 + 0.04**2) / 2))
    assert found.times[0] == pytest.approx(found.offset / 0.015) and found.times[1] == 2.0
    assert (found.frames, found.lost, found.near_offset, found.near_angle) == (2, 0, 0.5, 1.0)
    assert not found.within and summarised([ONE]).within
    assert summarised([ONE]).distance == pytest.approx(math.hypot(0.02, 0.2 * 0.1))


def test_frames_without_a_nearest_posture_are_counted_and_left_out() -> None:
    lost = replace(ONE, nearest_offset=math.nan, nearest_angle=math.nan)
    found = summarised([ONE, lost])
    assert (found.frames, found.lost) == (2, 1) and found.offset == ONE.offset
    # with none left nothing is promised
    assert not summarised([lost]).within


def test_something_over_nothing_is_not_within() -> None:
    assert summarised([replace(ONE, angle=0.001, nearest_angle=0.0)]).times[1] == math.inf
    # a root at rest is where its user's is, to rounding
    assert summarised([replace(ONE, offset=3e-17, nearest_offset=1e-17)]).times[0] == 1.0
    assert summarised([replace(ONE, angle=0.0, nearest_angle=0.0)]).within


def test_who_is_nearer_than_any_free_posture_is_named() -> None:
    beyond = replace(ONE, scenario="beyond", offset=0.01, angle=0.05)
    found = summarised([beyond])
    assert found.too_near and not summarised([ONE]).too_near and not summarised([replace(ONE, nearest_offset=math.nan)]).too_near
    said = "any posture found that is free and within limits, offset and angle together: beyond (0.78)"
    assert said in table([found], [])
    # an offset that is less alone, at the price of the angle, is a posture like others
    assert not summarised([replace(ONE, offset=0.01, angle=0.2)]).too_near
    assert "nearer than any" not in table([summarised([ONE])], [])


def test_the_table_names_the_worst_first_and_the_file_has_all_samples() -> None:
    far = replace(ONE, scenario="far", offset=0.5)
    text = table([summarised([ONE]), summarised([far])], ["empty"])
    assert text.index("far ") < text.index("\nscene  ", 200) and "OVER" in text and "within 2 times in 1 of 2 scenes" in text
    assert text.endswith("empty")
    lines = csv_text([ONE, far], Sample).splitlines()
    assert len(lines) == 3 and lines[0].startswith("scenario,frame,arm,offset") and lines[1].startswith("scene,3,0.2,0.02,0.1")
