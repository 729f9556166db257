"""How many planned cells of other engines were measured: in all scenes, by what a setting turns."""

import math
from dataclasses import replace

import pytest

from reports.sections.sweep.planned import kind, sentence
from reports.sections.sweep.points import Point, Sweep
from tests.reports.sections.sweep.test_cheapest import point


def left(run: str, scene: str = "wall") -> Point:
    return replace(point(run, math.nan, math.nan, scene), state="not-measured")


@pytest.mark.parametrize(("setting", "told"), [
    ("tuned", "presets"), ("tuned dt=1/60", "steps"), ("tuned solver_iterations=10", "iterations"), ("tuned sleep=true", "sleep"),
    ("tuned loose_margin=0", "margins"), ("tuned sleep=true margin=0", "others"), ("tuned motors DISCRETE dt=1/240", "others"),
])
def test_what_a_setting_turns(setting: str, told: str) -> None:
    assert kind(point(f"m/{setting}", 0.0, 1.0)) == told


def test_all_scenes_are_counted_and_what_was_left_out_is_named() -> None:
    measured = [point("m/tuned", 0.0, 1.0), point("m/tuned", 0.0, 1.0, metric="apex_error_max"),
                point("m/tuned dt=1/60", 0.0, 1.0), point("m/tuned", 0.0, 1.0, "punch"), point("avatarsim/default", 0.0, 1.0)]
    said = sentence(Sweep((*measured, left("m/tuned dt=1/120"), left("m/tuned iterations=10", "punch"), left("m/tuned margin=0"),
                           left("avatarsim/default steps=1"))))
    assert "of 6 planned cells of other engines in all scenes, each a setting in a scene, 3 were" in said
    assert said.endswith("presets 2 of 2, steps 1 of 2, iterations 0 of 1, margins 0 of 1.")


def test_what_has_no_words_is_no_cell() -> None:
    assert sentence(Sweep((point("m/tuned", math.nan, 1.0, state="cannot-say"), point("avatarsim/default", 0.0, 1.0)))) == ""
