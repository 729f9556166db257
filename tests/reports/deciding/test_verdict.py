"""The verdict counts right, believes no pass that its own numbers contradict, and takes no gap for a pass."""

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import pytest

from reports.deciding.bounds_by_kind import kinds, promised
from reports.deciding.tables import blocks
from reports.deciding.verdict import loosest, losing_scenes, reading_order, scenes_sentence, verdict
from reports.page.gallery import cards
from reports.reading.load import load
from reports.words.metric_words import words

Json = dict[str, object]
Write = Callable[[object], Path]


def only(results: Json, *scenes: str, engine: str = "") -> Json:
    """The run reduced to some scenes, and to one engine where one is named."""
    rows = results["rows"]
    assert isinstance(rows, list)
    kept = [r for r in rows if r["scenario"] in scenes and (not engine or r["engine"] == engine)]
    return results | {"rows": kept, "exit_code": 0}


def changed(results: Json, **change: object) -> Json:
    """The run with its first row (a pass of ours) changed."""
    rows = results["rows"]
    assert isinstance(rows, list)
    return results | {"rows": [rows[0] | change, *rows[1:]]}


def test_everything_is_counted_once(run_dir: Write, results: Json) -> None:
    found = verdict(load(run_dir(results)))
    assert [len(rows) for rows in (found.passed, found.waived, found.failed, found.crashed, found.unmeasured)] == [1] * 5
    assert found.word == "failed" and found.exit_code == 1
    assert "1 of 3" in found.sentence and "1 waived" in found.sentence


def test_all_pass(run_dir: Write, results: Json) -> None:
    found = verdict(load(run_dir(only(results, "arm_wall"))))
    assert (found.word, found.exit_code, found.losses) == ("passed", 0, ())
    assert found.unbounded == ("tracker_offset_rms_free",)


def test_a_waived_check_is_counted_and_comes_before_any_comparison(run_dir: Write, results: Json) -> None:
    found = verdict(load(run_dir(only(results, "hand_over_table"))))
    assert (found.word, found.exit_code) == ("passed", 0)
    assert len(found.passed) == 0 and "0 of 1" in found.sentence and "1 waived" in found.sentence
    assert "0 pass, 1 waived, 0 failed" in scenes_sentence(found)
    assert [loss.kind for loss in found.losses] == ["above bound"]
    full = verdict(load(run_dir(results)))
    assert [loss.kind for loss in full.losses] == ["failed", "above bound", "behind"]
    assert losing_scenes(full) == ("ball_drop", "hand_over_table")


def test_the_status_of_a_waiver_and_that_of_earlier_versions_read_the_same(run_dir: Write, results: Json) -> None:
    rows = only(results, "hand_over_table")["rows"]
    assert isinstance(rows, list)
    new = [row | ({"status": "waived"} if row["bound"] is not None else {}) for row in rows]
    assert [row["status"] for row in rows] != [row["status"] for row in new]
    found = [verdict(load(run_dir(results | {"rows": each, "exit_code": 0}))) for each in (rows, new)]
    assert [(one.sentence, one.scenes, len(one.waived), one.exit_code) for one in found[:1]] == [
        (one.sentence, one.scenes, len(one.waived), one.exit_code) for one in found[1:]]
    above = [row | ({"value": 1.0} if row["status"] == "waived" else {}) for row in new]
    assert verdict(load(run_dir(results | {"rows": above}))).word == "failed"


@pytest.mark.parametrize("value", ["NaN", "Infinity", 2e-6])
def test_a_pass_that_is_none_is_not_believed(run_dir: Write, results: Json, value: object) -> None:
    found = verdict(load(run_dir(changed(only(results, "arm_wall"), value=value))))
    assert (found.word, found.exit_code) == ("failed", 1)


def test_a_pass_without_a_number_is_not_measured(run_dir: Write, results: Json) -> None:
    found = verdict(load(run_dir(changed(only(results, "arm_wall"), value=None))))
    assert (found.word, found.exit_code) == ("incomplete", 3)


def test_a_scene_that_we_are_missing_from_is_a_gap(run_dir: Write, results: Json) -> None:
    rows = only(results, "arm_wall")["rows"]
    assert isinstance(rows, list)
    foreign = {"scenario": "new", "engine": "mujoco", "bound": None, "status": "info"}
    found = verdict(load(run_dir(results | {"rows": [*rows, rows[0] | foreign]})))
    assert found.word == "incomplete" and [row.scenario for row in found.unmeasured] == ["new"]


def test_a_run_that_never_ended_is_incomplete(run_dir: Write, results: Json) -> None:
    found = verdict(load(run_dir(only(results, "arm_wall") | {"exit_code": None})))
    assert found.word == "incomplete" and "did not end" in found.sentence


def test_nothing_measured_is_no_verdict(run_dir: Write, results: Json) -> None:
    found = verdict(replace(load(run_dir(results)), rows=(), exit_code=5))
    assert (found.word, found.exit_code) == ("empty", 5)
    assert verdict(load(run_dir(only(results, "arm_wall", engine="mujoco")))).word == "empty"


def test_rivals_are_engines_that_brought_a_number(run_dir: Write, results: Json) -> None:
    assert verdict(load(run_dir(results))).rivals
    assert not verdict(load(run_dir(only(results, "arm_wall", engine="avatarsim")))).rivals
    assert not verdict(load(run_dir(only(results, "arm_wall", engine="tracker")))).rivals


def test_where_others_do_better_we_say_so(run_dir: Write, results: Json) -> None:
    slow = changed(only(results, "arm_wall"), metric="frame_time_p95", value=400.0, unit="us", bound=None, status="info")
    losses = verdict(load(run_dir(slow))).losses
    assert [(loss.what, loss.kind) for loss in losses] == [("frame_time_p95", "behind")]
    assert losses[0].theirs == "mujoco/default 304 µs" and losses[0].factor == pytest.approx(400.0 / 304.0)


def test_another_preset_of_our_own_engine_is_no_rival(run_dir: Write, results: Json) -> None:
    """Ours is 40 us, our other preset 20 us, another engine 30 us: what we lose is lost to the other engine."""
    times = {"avatarsim/default": 40.0, "avatarsim/paper": 20.0, "mujoco/default": 30.0}
    rows = only(results, "arm_wall")["rows"]
    assert isinstance(rows, list)
    rows = [r for r in rows if r["metric"] != "frame_time_p50"]
    for run, value in times.items():
        engine, preset = run.split("/")
        rows.append(rows[-1] | {"engine": engine, "preset": preset, "metric": "frame_time_p50", "value": value, "unit": "us",
                                "status": "info", "bound": None, "ceiling": None})
    found = verdict(load(run_dir(results | {"rows": rows, "exit_code": 0})))
    losses = [loss for loss in found.losses if loss.what == "frame_time_p50"]
    assert [(loss.theirs, loss.factor) for loss in losses] == [("mujoco/default 30.0 \u00b5s", pytest.approx(40.0 / 30.0))]


def bounded(results: Json, scene: str, metric: str, value: float, bound: float) -> Json:
    """One more row of ours that is held by a bound."""
    rows = results["rows"]
    assert isinstance(rows, list)
    gate = {"scenario": scene, "metric": metric, "value": value, "bound": bound, "unit": "m", "status": "pass"}
    return results | {"rows": [*rows, rows[0] | gate]}


def test_the_headline_says_what_is_promised_and_the_loosest_bounds_stand_below_it(run_dir: Write, results: Json) -> None:
    data = only(results, "arm_wall")
    for scene, value, bound in (("arm_wall", 0.002, 0.01), ("door", 0.3, 0.4)):
        data = bounded(data, scene, "root_jump_max", value, bound)
    found = verdict(load(run_dir(data)))
    assert "All 3 " in found.sentence and "no overlap" in found.sentence
    said = "bounded in 2 of 2 scenes with an avatar, by 400 mm at most, largest there 300 mm (door)"
    assert f"{words('root_jump_max')}: {said}" in loosest(load(run_dir(data)), found)
    assert loosest(load(run_dir(only(results, "ball_drop"))), found) == ()


def test_a_run_in_which_most_figures_of_looks_have_no_bound_says_so_in_its_headline(run_dir: Write, results: Json) -> None:
    rows = bounded(only(results, "arm_wall"), "arm_wall", "root_jump_max", 0.002, 0.01)["rows"]
    assert isinstance(rows, list)
    free = [rows[-1] | {"scenario": scene, "metric": metric, "value": value, "bound": None, "status": "info"}
            for scene, metric, value in (
                ("hall", "root_jump_max", 0.5), ("hall", "jitter_rms", 0.001), ("door", "jitter_rms", 0.004))]
    found = load(run_dir(results | {"rows": [*rows, *free], "exit_code": 0}))
    assert verdict(found).sentence.endswith(
        "no overlap; of how motion looks 1 of 5 figures has a bound, 2 measures nowhere.")
    assert verdict(found).unbounded == ("jitter_rms", "tracker_offset_rms_free"), "the jump of the root has a bound somewhere"
    assert loosest(found, verdict(found)) == (
        f"{words('root_jump_max')}: bounded in 1 of 3 scenes with an avatar, by 10 mm at most, largest there 2.00 mm (arm_wall); "
        "largest without a bound 500 mm (hall)",
        f"{words('jitter_rms')}: bounded nowhere; largest without a bound 4.00 mm (door)",
        f"{words('tracker_offset_rms_free')}: bounded nowhere; largest without a bound 2.00 mm (arm_wall)",
    )


def test_tables_begin_with_trouble_then_everyday_scenes_then_avatars(run_dir: Write, results: Json) -> None:
    rows = results["rows"]
    assert isinstance(rows, list)
    more = [rows[1] | {"scenario": scene, "metric": metric} for scene, metric in (
        ("balls", "frame_time_p50"), ("reach", "tracker_offset_rms"), ("drop", "frame_time_p50"))]
    scenes = {name: {"title": "", "everyday": name == "drop"} for name in ("balls", "reach", "drop")}
    found = load(run_dir(results | {"rows": [*more, *rows], "scenes": scenes}))
    order = reading_order(found, verdict(found))
    assert order.index("ball_drop") < order.index("drop") < order.index("reach") < order.index("arm_wall")
    assert set(order) == set(found.scenes())
    assert order.index("reach") < order.index("balls")


def test_tiles_headline_cards_and_the_table_of_bounds_agree(run_dir: Write, results: Json) -> None:
    """A waived scene does not pass: its bound does not hold."""
    made = load(run_dir(results))
    found = verdict(made)
    assert found.scenes == {"passed": 1, "waived": 1, "failed": 1, "crashed": 0, "refused": 0, "not measured": 0}
    statuses = [card.status for card in cards(made, blocks(made), found, {})]
    assert all(statuses.count(state.replace(" ", "-")) == number for state, number in found.scenes.items())
    bounds = {one.metric: (one.scenes, one.above) for one in kinds(found)}
    assert bounds == {"residual_overlap_max": (2, 1), "restitution_error_max": (1, 1)}
    assert sum(above for _, above in bounds.values()) == len(found.failed) + len(found.waived)
    assert promised(kinds(found)).startswith("Promised everywhere: deepest overlap shown 1 µm at most, in 1 of 2 scenes, ")
    assert scenes_sentence(found).startswith("Scenes: 1 passed + 1 waived + 1 failed")
