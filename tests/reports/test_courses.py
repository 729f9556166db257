"""Lines over time: what is said is what the numbers say, and what is drawn comes back."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from reports.courses import Course, charts, conclusion, courses, over_all, sentence
from reports.load import Series, load
from reports.packed import unpacked

Json = dict[str, object]
Write = Callable[[object], Path]

OVERLAP = np.array([0.0, 1e-3, 2e-2, np.nan, 1e-7])


def test_a_line_of_overlap_comes_back_in_decades() -> None:
    lines = courses({"a/default": Series(OVERLAP, np.zeros(0))}, [], None)
    [chart] = charts(lines, 0.5, 100)
    assert (chart["key"], chart["low"], chart["high"], chart["log"]) == ("overlap", 1e-9, 1.0, True)
    [line] = chart["lines"]  # type: ignore[misc]
    found = 10.0 ** unpacked(line["values"], (-9.0, 0.0))
    assert found[[0, 1, 2, 4]] == pytest.approx([1e-9, 1e-3, 2e-2, 1e-7], rel=1e-3) and np.isnan(found[3])
    assert (line["first"], line["step"]) == (0.0, 0.5)


def test_frame_times_begin_with_the_first_frame_not_the_first_state() -> None:
    lines = courses({"a/default": Series(np.zeros(0), np.array([10.0, 20.0, 40.0]))}, [], None)
    assert lines["time"][0].first == 1 and list(lines) == ["time"]
    assert sentence("time", lines["time"]) == "a/default: median 20.0 µs, largest 40.0 µs."


def test_spikes_survive_fewer_points() -> None:
    values = np.zeros(1000)
    values[777] = 0.5
    [chart] = charts({"overlap": [Course("a/default", 0, values)]}, 0.01, 50)
    [line] = chart["lines"]  # type: ignore[misc]
    found = unpacked(line["values"], (-9.0, 0.0))
    assert len(found) == 50 and found.max() == pytest.approx(np.log10(0.5), abs=1e-3) and line["step"] == pytest.approx(0.2)


def test_who_rises_above_its_energy_is_named() -> None:
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
