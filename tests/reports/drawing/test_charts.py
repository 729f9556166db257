"""Thinning loses no spike, every panel says what it shows, and a picture draws what the numbers are."""

import math
import re
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from reports.deciding.conclusions import overlap_summary, shown_scenes, time_sentence
from reports.drawing.charts import overlap_panels, peaks, time_panels, time_percentiles
from reports.drawing.palette import strokes
from reports.reading.load import load
from reports.sections.summary_charts import overlaps

Json = dict[str, object]
Write = Callable[[object], Path]
RUNS = ("avatarsim/default", "mujoco/default", "mujoco/tuned", "pybullet/default", "tracker/default")


@given(st.lists(st.floats(0.0, 1.0), max_size=90), st.integers(1, 40))
def test_thinning_keeps_the_largest(values: list[float], most: int) -> None:
    frames, largest, broken = peaks(np.array(values), most)
    assert frames.size == largest.size == min(most, len(values)) and not broken.any()
    if values:
        assert largest.max() == max(values) and frames[0] == 0


@given(st.integers(0, 99), st.sampled_from([math.nan, math.inf]))
def test_thinning_keeps_every_gap(where: int, gap: float) -> None:
    values = np.ones(100)
    values[where] = gap
    frames, largest, broken = peaks(values, 10)
    assert broken.sum() == 1 and frames[np.argmax(broken)] <= where < frames[np.argmax(broken)] + 10
    assert (largest == 1.0).all()


def test_one_overlap_panel_per_scene_with_words(run_dir: Write, results: Json) -> None:
    panels = overlap_panels(load(run_dir(results)), strokes(RUNS), ("hand_over_table", "ball_drop", "arm_wall"))
    assert [panel.scene for panel in panels] == ["hand_over_table", "arm_wall"]
    assert panels[1].conclusion.startswith("avatarsim/default stays within 1 µm; tracker/default reaches 100 mm")
    assert 'role="img"' in panels[0].svg and "mujoco/tuned: peak 540 µm" in panels[0].svg
    for stroke in strokes(RUNS).values():
        assert f'stroke="{stroke.light}"' in panels[0].svg


def test_a_deeper_overlap_is_drawn_higher(run_dir: Write, results: Json) -> None:
    series = {"arm_wall": {"mujoco/default": {"overlap_m": [1e-3] * 5}, "avatarsim/default": {"overlap_m": [0.0] * 5}}}
    panel = overlap_panels(load(run_dir(results | {"series": series})), strokes(RUNS), ("arm_wall",))[0]

    def height(run: str) -> float:
        found = re.search(rf'd="M[\d.]+,([\d.]+)[^"]*" stroke="{strokes(RUNS)[run].light}"', panel.svg)
        assert found is not None
        return float(found.group(1))

    # nine decades over 150 px, downwards: 1 mm is three decades below the top, zero lies on the floor
    assert height("mujoco/default") == pytest.approx(50.0, abs=1.0)
    assert height("avatarsim/default") == pytest.approx(150.0, abs=1.0)


def test_percentiles_come_from_rows_or_else_from_the_series(run_dir: Write, results: Json) -> None:
    rows = results["rows"]
    assert isinstance(rows, list)
    found = time_percentiles(load(run_dir(results)))
    assert found["arm_wall"]["avatarsim/default"] == pytest.approx((31.0, 49.6, 74.4))
    assert "tracker/default" not in found["arm_wall"] and "ball_drop" not in found
    less = results | {"rows": [row for row in rows if not str(row["metric"]).startswith("frame_time")]}
    assert time_percentiles(load(run_dir(less)))["arm_wall"]["avatarsim/default"][0] == pytest.approx(31.0)


def test_time_panels_conclude_from_the_numbers(run_dir: Write, results: Json) -> None:
    spreads = time_panels(load(run_dir(results)), strokes(RUNS), ("arm_wall",))
    assert spreads[0].conclusion == (
        "avatarsim/default has the lowest p95, 49.6 µs; pybullet/default takes 28.4 times as long; all keep 90 Hz at p99."
    )
    noisy = {"scenario": "arm_wall", "metric": "frame_time_raw_p99", "value": 7374.0, "status": "info"}
    rows = results["rows"]
    assert isinstance(rows, list)
    again = time_panels(load(run_dir(results | {"rows": [*rows, rows[0] | noisy]})), strokes(RUNS), ("arm_wall",))
    assert again[0].conclusion.endswith("left in, p99 is: avatarsim/default 7.37 ms.")


def test_a_run_with_too_few_frames_for_a_p99_has_none_and_nothing_is_concluded_from_it(run_dir: Write, results: Json) -> None:
    rows = results["rows"]
    assert isinstance(rows, list)
    few = {"value": None, "note": "1 x 46 frames, 30 warm-up frames: fewer than 3 x 200"}
    cut = [row | few if (row["metric"], row["engine"]) == ("frame_time_p99", "pybullet") else row for row in rows]
    found = load(run_dir(results | {"rows": cut}))
    # not from the series either, which holds those few frames
    three = time_percentiles(found)["arm_wall"]
    assert math.isnan(three["pybullet/default"][2]) and three["avatarsim/default"][2] == pytest.approx(74.4)
    [panel] = time_panels(found, strokes(RUNS), ("arm_wall",))
    assert panel.conclusion.endswith("all keep 90 Hz at p95.") and "1.41 ms, —" in panel.svg and "NaN" not in panel.svg


@pytest.mark.parametrize(("three", "said"), [
    ((1e3, 2e3, 3e3), "it keeps 90 Hz at p99."), ((1e3, 2e3, math.nan), "it keeps 90 Hz at p95."),
    ((1e3, 2e3, 2e4), "mine/x misses 90 Hz in more than 1 % of the frames."),
    ((1e3, 2e4, math.nan), "mine/x misses 90 Hz in more than 5 % of the frames."),
    ((1e3, 2e4, 3e4), "mine/x misses 90 Hz in more than 5 % of the frames."),
])
def test_what_90_hz_is_kept_by_is_what_was_measured(three: tuple[float, float, float], said: str) -> None:
    assert time_sentence({"mine/x": three}).endswith(f"; {said}")


def test_series_without_one_finite_number_are_drawn_as_gaps(run_dir: Write, results: Json) -> None:
    gone = {"overlap_m": ["NaN", None], "frame_time_us": [None, "NaN"]}
    found = load(run_dir(results | {"series": {"arm_wall": {"avatarsim/default": gone}}}))
    panel = overlap_panels(found, strokes(RUNS), ("arm_wall",))[0]
    assert panel.conclusion == "avatarsim/default has frames without a finite number."
    assert "peak NaN, 100 % of frames above" in panel.svg


def test_what_ours_does_not_show_is_in_no_denominator_and_in_no_plot(run_dir: Write, results: Json) -> None:
    series = results["series"]
    assert isinstance(series, dict)
    theirs = {"mujoco/tuned": {"overlap_m": [0.0, 0.4], "frame_time_us": []}}
    found = load(run_dir(results | {"series": series | {"start_inside": theirs}}))
    assert list(shown_scenes(found, "avatarsim/default")) == ["arm_wall", "hand_over_table"]
    said = overlap_summary(found, "avatarsim/default")
    assert "mujoco/tuned in 0 of 2" in said and said.endswith("since avatarsim/default refuses or shows nothing: start_inside.")
    assert "400 mm" not in overlaps(found, strokes(RUNS), "avatarsim/default")
    assert list(shown_scenes(found, "other/engine")) == ["arm_wall", "hand_over_table", "start_inside"]
