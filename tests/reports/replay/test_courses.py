"""Lines over time: what is said is what the numbers say, and what is drawn comes back."""

import base64
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from reports.reading.load import Series, load
from reports.replay.courses import Course, charts, conclusion, courses, over_all, sentence
from reports.replay.packed import unpacked
from reports.words.wording import quantity
from runfiles.timing_protocol import TAIL_FRAMES

Json = dict[str, object]
Write = Callable[[object], Path]

OVERLAP = np.array([0.0, 1e-3, 2e-2, np.nan, 1e-7])


def test_a_line_of_overlap_comes_back_in_decades() -> None:
    lines = courses({"a/default": Series(OVERLAP, np.zeros(0))}, [], None)
    [chart] = charts(lines, 0.5, 100)
    assert (chart["key"], chart["low"], chart["high"], chart["log"]) == ("overlap", 1e-9, 1.0, True)
    [line] = chart["lines"]  # type: ignore[misc]
    found = 10.0 ** values_of(line)
    assert found[[0, 1, 2, 4]] == pytest.approx([1e-9, 1e-3, 2e-2, 1e-7], rel=1e-3) and np.isnan(found[3])
    assert moments(line["times"]) == pytest.approx([0.0, 0.5, 1.0, 1.5, 2.0])


def test_frame_times_begin_with_the_first_frame_not_the_first_state() -> None:
    lines = courses({"a/default": Series(np.zeros(0), np.array([10.0, 20.0, 40.0]))}, [], None)
    assert lines["time"][0].first == 1 and list(lines) == ["time"]
    assert sentence("time", lines["time"]) == "a/default: median 20.0 µs, largest 40.0 µs."


def test_times_say_of_how_many_repeats_they_are() -> None:
    times = {run: Series(np.zeros(0), np.array([10.0, 20.0, most])) for run, most in (("a/default", 40.0), ("b/default", 50.0))}
    [chart] = charts(courses(times, [], None), 0.01, 100, repeats=1)
    assert chart["concludes"] == ("Slowest: b/default, 50.0 µs (each frame run once); too few repeats or frames to say which "
                                  "peak is the lowest.")
    assert str(chart["text"]).endswith("largest 50.0 µs (each frame run once).")
    [chart] = charts(courses(times, [], None), 0.01, 100, repeats=3)
    assert str(chart["text"]).endswith("largest 50.0 µs (each frame the least of 3 repeats).")
    [chart] = charts({"overlap": [Course("a/default", 0, OVERLAP)]}, 0.01, 100, repeats=3)
    assert "repeat" not in str(chart)


def test_times_of_a_window_name_it_and_no_peak_of_it_is_the_lowest() -> None:
    time = [Course("a/default", 6, np.array([1.0, 40.0])), Course("b/default", 6, np.array([50.0, 2.0]))]
    (_, chart) = charts({"overlap": [Course("a/default", 0, np.zeros(21))], "time": time}, 1.0 / 60.0, 100)
    for words in (str(chart["concludes"]), str(chart["text"])):
        assert words.startswith("2 of 20 frames alone, from frame 5 on: ")
    assert "Lowest peak" not in str(chart["concludes"]) and "slowest b/default, 50.0 µs" in str(chart["concludes"])
    for frames, said in ((2, "Slowest: b/default"), (TAIL_FRAMES, "Lowest peak: a/default")):
        time = [Course(run, 1, np.full(frames, most)) for run, most in (("a/default", 40.0), ("b/default", 50.0))]
        (_, whole) = charts({"overlap": [Course("a/default", 0, np.zeros(frames + 1))], "time": time}, 1.0 / 60.0, 100)
        assert str(whole["concludes"]).startswith(said)


def test_spikes_survive_fewer_points() -> None:
    values = np.zeros(1000)
    values[777] = 0.5
    [chart] = charts({"overlap": [Course("a/default", 0, values)]}, 0.01, 50)
    [line] = chart["lines"]  # type: ignore[misc]
    found = values_of(line)
    assert len(found) == 50 and found.max() == pytest.approx(np.log10(0.5), abs=1e-3)


@pytest.mark.parametrize("frames", [601, 999, 450])
def test_points_stand_at_the_first_frame_of_their_groups(frames: int) -> None:
    """Groups that do not come out even are longer at first: evenly spaced, points would stand too late."""
    [chart] = charts({"offset": [Course("a/default", 2, np.linspace(0.0, 0.5, frames))]}, 0.01, 400)
    [line] = chart["lines"]  # type: ignore[misc]
    whole = np.linspace(0.0, 0.5, frames)
    found, at = values_of(line), moments(line["times"])
    begins = np.rint(at / 0.01).astype(int) - 2
    ends = np.append(begins[1:], frames)
    assert begins[0] == 0 and found[1:] == pytest.approx(whole[ends - 1][1:], abs=1e-5)


def test_the_largest_value_keeps_three_digits_beside_a_line_that_explodes() -> None:
    calm, spike = np.full(600, 0.01), np.zeros(600)
    calm[300], spike[5] = 0.4735, 1e6
    [chart] = charts({"offset": [Course("a/default", 0, calm), Course("b/default", 0, spike)]}, 0.01, 600)
    lines = [values_of(line) for line in chart["lines"]]  # type: ignore[attr-defined]
    assert lines[0][300] == pytest.approx(0.4735, rel=1e-4) and lines[1][5] == 1e6
    assert float(str(chart["high"])) < 0.05, "the axis is that of nearly all values"


def test_every_depth_comes_back_with_the_digits_that_words_have() -> None:
    depths = np.array([0.0, *np.geomspace(2e-9, 0.0895, 500)])
    [chart] = charts({"overlap": [Course("a/default", 0, depths)]}, 0.01, 600, 1)
    [line] = chart["lines"]  # type: ignore[misc]
    assert [quantity(10.0**value, "m") for value in values_of(line)[1:]] == [quantity(depth, "m") for depth in depths[1:]]


def values_of(line: Json) -> np.ndarray:
    """Values that a page holds of one line, or their decimal logarithms."""
    return unpacked(str(line["values"]), (float(str(line["low"])), float(str(line["high"]))))


def moments(text: str) -> np.ndarray:
    """Times that a page holds."""
    return np.frombuffer(base64.b64decode(text), dtype="<f4").astype(np.float64)


def test_an_engine_that_rises_above_its_energy_is_named() -> None:
    calm, wild = Course("a/default", 0, np.array([5.0, 4.0, 3.0])), Course("b/default", 0, np.array([5.0, 5.2, 3.0]))
    assert conclusion("energy", [calm, wild]).startswith("Above the energy they began with, by a hundredth or more: b/default;")
    assert conclusion("energy", [calm, Course("c/default", 0, np.array([4.0, 3.0, 2.0]))]).startswith("No engine rises")


def test_gaps_and_nothing_finite_are_said() -> None:
    line = Course("a/default", 0, OVERLAP)
    assert "1 value missing or not finite" in sentence("overlap", [line])
    nothing = [Course("a/default", 0, np.full(3, np.nan))]
    assert sentence("overlap", nothing) == "a/default: no finite value."
    assert conclusion("overlap", nothing).startswith("No engine")


def test_over_all_scenes_other_engines_are_counted_and_refused_scenes_are_not(run_dir: Write, results: Json) -> None:
    def series(**peaks: float) -> dict[str, object]:
        return {run.replace("_", "/"): {"overlap_m": [0.0, value], "frame_time_us": []} for run, value in peaks.items()}

    data = results | {"series": {
        "level": series(avatarsim_default=0.0, avatarsim_paper=0.0, mujoco_tuned=0.0),
        "own": series(avatarsim_default=2e-7, avatarsim_paper=0.0, tracker_raw=0.0, mujoco_tuned=1e-3),
        "lost": series(avatarsim_default=3e-7, mujoco_tuned=1e-7), "refused": series(mujoco_tuned=0.0),
    }}
    assert over_all(load(run_dir(data)), "avatarsim/default") == (
        "In 2 of 3 scenes no other engine's overlap peaks lower than that of avatarsim/default; where one does (1), ours "
        "reaches at most 300 nm (lost).")
