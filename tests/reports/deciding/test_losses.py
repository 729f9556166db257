"""The table of losses: factors end, nothing is divided by zero, and every state of a scene has its tile."""

import math
import re
from collections.abc import Callable
from pathlib import Path

from reports import write_report
from reports.deciding.conclusions import table_sentence
from reports.deciding.losses import FIRST, beside, kinds_sentence, over, section, sentence, silent_sentence
from reports.deciding.moments import moment
from reports.deciding.tables import blocks
from reports.deciding.verdict import STATES, scenes_sentence, verdict
from reports.reading.load import load
from reports.summaries.summary import summary
from reports.words.metric_words import words
from runfiles.behind import Behind, MetricLosses, by_family, compared
from runfiles.ranked import KINDS, RANKED

Json = dict[str, object]
Write = Callable[[object], Path]
OURS = "avatarsim/default"


def changed(results: Json, **more: object) -> Json:
    """The run with one more row, like its first but without a gate."""
    rows = results["rows"]
    assert isinstance(rows, list)
    return results | {"rows": [*rows, rows[0] | {"bound": None, "ceiling": None, "status": "info"} | more]}


def lost(factor: float) -> Behind:
    return Behind(None, 1.0, (("a/b", 0.0),), factor, 1.0)  # type: ignore[arg-type]  # the row is not looked at


def test_factors_end_and_none_stands_against_zero() -> None:
    assert [beside(lost(value)) for value in (2.44, 999.0, 1e7, math.inf)] == ["×2.4", "×1,000", "more than ×1,000", ""]


def test_a_figure_that_is_no_number_is_a_loss_without_a_factor(run_dir: Write, results: Json) -> None:
    rows = results["rows"]
    assert isinstance(rows, list)
    own = [r | ({"value": "NaN"} if r["engine"] == "avatarsim" and r["metric"] == "frame_time_p50" else {}) for r in rows]
    found = load(run_dir(results | {"rows": own}))
    text = summary(found, verdict(found))
    assert "| NaN | mujoco/default" in text and "∞" not in text


def test_the_sentence_counts_families(run_dir: Write, results: Json) -> None:
    data = results | {"scenes": {name: {"title": "", "family": "walls"} for name in ("arm_wall", "hand_over_table")}}
    for scene in ("arm_wall", "hand_over_table"):
        for run, value in (("avatarsim", 0.2), ("mujoco", 0.0)):
            data = changed(data, scenario=scene, engine=run, metric="root_jump_max", value=value)
    found = load(run_dir(data))
    said = sentence(by_family(compared(found.rows, OURS), found.families), OURS)
    assert f"{words('root_jump_max')} in 1 of 1 family" in said
    assert f"{words('restitution_error_max')} in 1 of 1 family" in said


def test_the_page_shows_both_figures_the_rest_in_details_and_the_reasons(run_dir: Write, results: Json) -> None:
    folder = run_dir(changed(changed(results, metric="root_jump_max", value=3.9e-3),
                             engine="mujoco", metric="root_jump_max", value=0.0))
    write_report(folder)
    page = (folder / "index.html").read_text(encoding="utf-8")
    section = page[page.index('id="losses"'):page.index('id="ranking"')]
    row = section[section.index("root_jump_max"):]
    assert row.index("3.90 mm") < row.index("mujoco/default 0")
    assert "frame_time_raw_p50" in section and "not ranked" in section and "∞" not in page and "×10" not in section


def test_beside_the_table_the_count_over_all_ranked_metrics_comes_first(run_dir: Write, results: Json) -> None:
    data = changed(changed(results, metric="root_jump_max", value=0.2), engine="mujoco", metric="root_jump_max", value=0.0)
    found = load(run_dir(data))
    every = by_family(compared(found.rows, OURS), found.families)
    said = table_sentence(blocks(found), OURS, every)
    cases, behind = sum(one.families for one in every), sum(len(one.lost) for one in every)
    assert said.startswith(f"Over {len(every)} ranked metrics and the families of scenes of each, another engine is better in "
                           f"{behind} of {cases} cases. Of the cells of this table")
    assert any(one.metric == "root_jump_max" and one.lost for one in every)


def test_tiles_add_up_to_the_scenes(run_dir: Write, results: Json) -> None:
    rows = results["rows"]
    assert isinstance(rows, list)
    refused = rows[0] | {"scenario": "inside", "metric": "run", "value": None, "bound": None, "status": "refused", "note": "no"}
    strange = rows[0] | {"scenario": "new", "engine": "mujoco", "bound": None, "status": "info"}
    data = results | {"rows": [*rows, refused, strange]}
    found = verdict(load(run_dir(data)))
    assert dict(found.scenes) == {"passed": 1, "waived": 1, "failed": 1, "crashed": 0, "refused": 1, "not measured": 1}
    assert sum(found.scenes.values()) == len({row["scenario"] for row in data["rows"]})  # type: ignore[index]
    assert "1 passed + 1 waived + 1 failed + 0 crashed + 1 refused + 1 not measured = 5" in scenes_sentence(found)
    folder = run_dir(data)
    write_report(folder)
    page = (folder / "index.html").read_text(encoding="utf-8")
    assert all(f"<dt>{state}</dt>" in page for state in STATES)


def test_a_scene_in_which_the_gated_run_crashed_is_no_scene_held(run_dir: Write, results: Json) -> None:
    rows = results["rows"]
    assert isinstance(rows, list)
    crashed = rows[0] | {"scenario": "gone", "metric": "run", "value": None, "bound": None, "status": "crashed"}
    assert verdict(load(run_dir(results | {"rows": [*rows, crashed]}))).scenes["crashed"] == 1


def test_the_table_says_how_many_of_how_many_metrics_it_shows(run_dir: Write, results: Json) -> None:
    data = results
    for metric in list(RANKED)[: FIRST + 3]:
        for engine, value in (("avatarsim", 9.0), ("mujoco", 0.0)):
            data = changed(data, engine=engine, metric=metric, value=value)
    found = load(run_dir(data))
    told = section(found, verdict(found).ranked, OURS)
    lost = told["lost_all"]
    assert isinstance(lost, list) and len(lost) > FIRST
    assert told["lost_shown"] == f"the first {FIRST} of {len(lost)} metrics"


def test_a_loss_leads_to_the_moment_of_its_largest_figure_where_a_series_was_kept(run_dir: Write, results: Json) -> None:
    series = {"arm_wall": {OURS: {"overlap_m": [0.0, 0.1, 0.4], "frame_time_us": [5.0, 90.0]}}}
    data = results | {"series": series, "scenes": {"arm_wall": {"title": "", "dt": 0.25}}}
    found = load(run_dir(data))
    assert [moment(found, "arm_wall", OURS, metric) for metric in (
        "residual_overlap_max", "frame_time_max", "root_jump_max")] == ["#t=0.5", "#t=0.5", ""]
    assert moment(found, "arm_wall", "mujoco/default", "frame_time_max") == ""
    for engine, value in (("avatarsim", 90.0), ("mujoco", 1.0)):
        data = changed(data, engine=engine, metric="frame_time_max", unit="us", value=value)
    folder = run_dir(data)
    write_report(folder)
    page = (folder / "index.html").read_text(encoding="utf-8")
    row = page[page.index('title="frame_time_max"'):]
    assert row.index('href="scenes/arm_wall.html#t=0.5"') < row.index("</tr>")


def test_figures_that_do_not_judge_an_engine_are_counted_and_named(run_dir: Write, results: Json) -> None:
    note = {"name": "mujoco", "preset": "default", "scenario": "arm_wall", "cannot_say": {"reach cones": "none"}}
    data = results | {"engines": [note]}
    for engine, value in (("avatarsim", 2.0), ("mujoco", 1.0)):
        data = changed(data, engine=engine, metric="reach_cone_excess_max", value=value)
    ranked = verdict(load(run_dir(data))).ranked
    assert silent_sentence(ranked) == (
        f"Not ranked, because the engine has no words for it, are 1 figure: {words('reach_cone_excess_max')} (mujoco/default).")
    assert silent_sentence(verdict(load(run_dir(results))).ranked) == ""


def test_metrics_of_one_thing_are_counted_together(run_dir: Write, results: Json) -> None:
    data = results
    for metric in ("root_jump_max", "jerk_ratio"):
        for engine, value in (("avatarsim", 9.0), ("mujoco", 0.0)):
            data = changed(data, engine=engine, metric=metric, value=value)
    found = load(run_dir(data))
    said = kinds_sentence(by_family(verdict(found).ranked, found.families))
    assert "overlap 0 of 2" in said and "smoothness 2 of 2" in said
    assert kinds_sentence(()) == ""
    ranked = [MetricLosses("joint_limit_excess_max", 5, ())]
    assert "limits 0 of 1 (angle beyond joint limits in 5 families alone: " in kinds_sentence(ranked, {"joint_limit_excess_max"})
    assert "limits 0 of 1; together" in kinds_sentence(ranked)


def test_each_ranked_metric_is_of_one_kind_so_that_counts_add_up(run_dir: Write, results: Json) -> None:
    assert sorted(metric for metrics in KINDS.values() for metric in metrics) == sorted(RANKED)
    data = results
    for metric in ("root_jump_max", "lift_height_max", "tracker_offset_max"):
        for engine, value in (("avatarsim", 9.0), ("mujoco", 0.0)):
            data = changed(data, engine=engine, metric=metric, value=value)
    found = load(run_dir(data))
    made = by_family(verdict(found).ranked, found.families)
    said = kinds_sentence(made)
    parts, total = said.removesuffix(".").split("; together ")
    counts = [tuple(map(int, part)) for part in re.findall(r"(\d+) of (\d+)", parts)]
    assert total == f"{sum(one.lost != () for one in made)} of {len(made)}"
    assert f"{sum(lost for lost, _ in counts)} of {sum(of for _, of in counts)}" == total
    assert "loose bodies (lift, energy that nothing explains, halts, drift, falls) 1 of 1" in said


def test_times_stand_in_the_table_whatever_their_place(run_dir: Write, results: Json) -> None:
    found = load(run_dir(changed(results, metric="frame_time_p50", value=5000.0, unit="us")))
    shown = section(found, verdict(found).ranked, OURS)["lost_first"]
    assert isinstance(shown, list)
    times = [one for one in shown if one.metric.startswith("frame_time")]
    assert {one.metric for one in times} == {"frame_time_p50", "frame_time_p95", "frame_time_p99"}
    folder = run_dir(results)
    write_report(folder)
    assert ">none</td>" in (folder / "index.html").read_text(encoding="utf-8")


def test_a_time_says_over_which_frames_it_is(run_dir: Write, results: Json) -> None:
    slow = changed(results, metric="frame_time_p99", value=5e3, unit="us", note="1 x 60 frames, 30 warm-up frames; moving 3 us")
    found = load(run_dir(slow))
    own = [one for one in found.rows if one.note.startswith("1 x 60")]
    assert over(Behind(own[0], 1.0, (("a/b", 0.5),), 2.0, 2.0)) == "1 x 60 frames"
    assert over(Behind(found.rows[0], 1.0, (("a/b", 0.5),), 2.0, 2.0)) == ""
