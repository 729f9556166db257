"""Every large figure of another engine is on the page with its cause, or as one that is not yet explained."""

import math
from collections.abc import Callable
from dataclasses import dataclass
from fnmatch import fnmatchcase
from pathlib import Path

import pytest

from reports import write_report
from reports.reading.load import load
from reports.sections import explained
from runfiles.explained import ASKED, BOUNDS, EXCESS, EXPLAINED, LARGE, LARGE_ANGLE, SAME, Cause, explanation, large
from runfiles.naming import BASE
from scenarios import catalog
from scenarios.engines import PRESETS
from scenarios.running.offered import scenarios
from tests.reports.conftest import row

Json = dict[str, object]
Write = Callable[[object], Path]


@dataclass(frozen=True)
class Figure:
    """A row of results, as short as can be."""

    scenario: str
    run: str
    metric: str
    value: float
    seed: int = 0
    unit: str = "m"


def run_of(results: Json, *rows: Json) -> Json:
    return results | {"rows": [*list(results["rows"]), *rows]}  # type: ignore[call-overload]


def test_rules_are_of_scenes_and_runs_that_exist_and_each_is_the_first_of_something() -> None:
    scenes = [*catalog.scenarios(), *scenarios("compare", "unseen_*")]
    runs = [f"{engine}/{preset}" for engine, presets in PRESETS.items() for preset in presets]
    runs += [f"{engine}/{variant}" for engine, variant in BASE]
    used = {id(explanation(scene, run, metric)) for scene in scenes for run in runs for metric in BOUNDS}
    for rule in EXPLAINED:
        assert id(rule.why) in used, rule.why.sentence
        assert rule.why.sentence.endswith(".") and rule.why.cause in Cause and set(rule.metrics) <= set(BOUNDS)
        for patterns, known in ((rule.scenes, scenes), (rule.runs, runs)):
            assert all(any(fnmatchcase(name, pattern) for name in known) for pattern in patterns), rule.why.sentence


def test_no_sentence_has_a_figure_of_motions_that_change_with_every_commit() -> None:
    for rule in EXPLAINED:
        sentence = rule.why.sentence
        assert "unseen_" not in sentence and "in one run" not in sentence, sentence


def test_broken_joints_are_asked_for_after_lengths() -> None:
    rows = [
        Figure("arm_wall", "mujoco/default", EXCESS, 1.5 * LARGE_ANGLE), Figure("mocap_run", "mujoco/default", ASKED[1], 0.2),
        Figure("arm_wall", "mujoco/tuned", EXCESS, 0.9 * LARGE_ANGLE),
    ]
    assert [(one.row.run, one.row.metric) for one in large(rows)] == [("mujoco/default", ASKED[1]), ("mujoco/default", EXCESS)]


@pytest.mark.parametrize(("factor", "explained_too"), [(1.0 + 0.5 * SAME, True), (1.0 + 2.0 * SAME, False), (math.nan, False)])
def test_a_variant_has_the_explanation_of_its_preset_where_it_has_its_value(factor: float, explained_too: bool) -> None:
    rows = [Figure("scale_km", "mujoco/tuned", ASKED[0], 143.0), Figure("scale_km", "mujoco/sleeping", ASKED[0], 143.0 * factor)]
    why = {one.row.run: one.why for one in large(rows)}
    assert why["mujoco/tuned"] is not None and (why["mujoco/sleeping"] is why["mujoco/tuned"]) is explained_too


def test_no_large_figure_is_left_out_and_what_is_not_explained_comes_first(run_dir: Write, results: Json) -> None:
    depth, offset = ASKED
    data = run_of(
        results, row("worn_floor", "pybullet/tuned", depth, 0.156, "m"), row("arm_wall", "mujoco/default", depth, 0.2, "m"),
        row("arm_wall", "mujoco/default", offset, "NaN", "m"),  # type: ignore[arg-type]
        row("arm_wall", "mujoco/tuned", offset, 0.99 * LARGE, "m"),
        row("arm_wall", "tracker/default", depth, 3.0, "m"), row("arm_wall", "avatarsim/paper", offset, 3.0, "m"),
    )
    folder = run_dir(data)
    found = large(load(folder).rows)
    assert [(one.row.scenario, one.row.run, one.row.metric) for one in found] == [
        ("arm_wall", "mujoco/default", offset), ("arm_wall", "mujoco/default", depth), ("worn_floor", "pybullet/tuned", depth)]
    assert [one.said.partition(":")[0] for one in found] == ["not yet explained", "not yet explained", "our adapter"]
    assert math.isnan(found[0].row.value or 0.0)
    assert explained.sentence(found) == "3 figures: 2 not yet explained; 1 our adapter."
    write_report(folder)
    page = (folder / "index.html").read_text(encoding="utf-8")
    assert "not yet explained" in page and "PyBullet takes 16 pieces" in page


def test_the_link_leads_to_the_deepest_moment(run_dir: Write, results: Json) -> None:
    series = {"arm_wall": {"mujoco/default": {"overlap_m": [0.0, None, 0.3, 0.1], "frame_time_us": []}}}
    data = run_of(results, *(row("arm_wall", "mujoco/default", metric, 0.3, "m") for metric in ASKED))
    found = load(run_dir(data | {"series": series, "scenes": {"arm_wall": {"title": "", "dt": 0.25}}}))
    assert {one.row.metric: explained.moment(found, one) for one in large(found.rows)} == {ASKED[0]: "#t=0.5", ASKED[1]: ""}
    without = load(run_dir(data | {"series": series}))
    assert [explained.moment(without, one) for one in large(without.rows)] == ["", ""]


def test_a_run_without_large_figures_says_so(run_dir: Write, results: Json) -> None:
    assert explained.sentence(large(load(run_dir(results)).rows)) == "No other engine has a figure of this size."


def test_a_world_a_thousand_times_as_large_leads_nothing_for_its_size(run_dir: Write, results: Json) -> None:
    rows = (row("scale_km", "mujoco/default", ASKED[0], 884.0, "m"), row("scale_mm", "mujoco/default", ASKED[0], 0.01, "m"),
            row("worn_floor", "pybullet/tuned", ASKED[0], 2.0, "m"))
    scenes = {"scale_km": {"title": "", "scale": 1e3}, "scale_mm": {"title": "", "scale": 1e-3}}
    found = load(run_dir(run_of(results, *rows) | {"scenes": scenes}))
    assert {one.row.scenario: one.value for one in large(found.rows, found.scales)} == {
        "scale_km": 0.884, "scale_mm": 10.0, "worn_floor": 2.0}


def test_an_overlap_that_the_scene_starts_with_is_no_engine_s(run_dir: Write, results: Json) -> None:
    """One engine leaves what was there and goes no deeper, the other goes deeper."""
    rows = [row("arm_wall", run, ASKED[0], value, "m") for run, value in (("mujoco/default", 0.3), ("mujoco/tuned", 0.5))]
    series = {"arm_wall": {run: {"overlap_m": [0.3, last], "frame_time_us": []} for run, last in (
        ("mujoco/default", 0.1), ("mujoco/tuned", 0.5))}}
    told = explained.section(load(run_dir(run_of(results, *rows) | {"series": series})))
    shown = told["large_rows"]
    assert isinstance(shown, tuple) and [one.row.run for one in shown] == ["mujoco/tuned"]
    assert str(told["large_said"]).endswith("Left out: 1 figure that a scene starts with.")
