"""A scene that ended before its full length is named as such under the headline, on its card and on its page."""

from collections.abc import Callable
from pathlib import Path

from reports import write_report
from reports.deciding.cut_short import cuts, scene_sentence, sentence
from reports.reading.load import load
from tests.reports.conftest import row

Json = dict[str, object]
Write = Callable[[object], Path]


def with_lengths(results: Json, **frames: int) -> Json:
    """The run, whose rows are over 200 frames, with full lengths of scenes at 50 Hz."""
    return results | {"scenes": {scene: {"title": "", "dt": 0.02, "frames": length} for scene, length in frames.items()}}


def test_what_ran_fewer_frames_than_it_has_is_cut_short(run_dir: Write, results: Json) -> None:
    found = load(run_dir(with_lengths(results, arm_wall=200, hand_over_table=30_000)))
    assert {scene: cut.said for scene, cut in cuts(found).items()} == {"hand_over_table": "ran 4 s of 600 s"}
    assert sentence(found).startswith("Quick comparison: 1 of 3 scenes are cut short, hand_over_table most (ran 4 s of 600 s)")
    assert "make compare FULL=1" in sentence(found) and "PyBullet" not in scene_sentence(found, "hand_over_table")
    assert scene_sentence(found, "arm_wall") == scene_sentence(found, "ball_drop") == ""


def test_a_run_at_full_lengths_and_one_that_does_not_say_are_not_cut(run_dir: Write, results: Json) -> None:
    for data in (results, with_lengths(results, arm_wall=200, hand_over_table=200)):
        assert sentence(load(run_dir(data))) == ""


def test_what_follows_for_sleeping_is_said_where_an_engine_sleeps(run_dir: Write, results: Json) -> None:
    data = with_lengths(results, stack=600)
    rows = [row("stack", "mujoco/sleeping", "residual_overlap_max", 0.0, "m", frames=60)]
    found = load(run_dir(data | {"rows": [*list(data["rows"]), *rows]}))  # type: ignore[call-overload]
    said = scene_sentence(found, "stack")
    assert "ran 1.2 s of 12 s" in said and "waits for 2 s of rest, so a median here is mostly of frames before that" in said


def test_card_scene_page_and_headline_say_it(run_dir: Write, results: Json) -> None:
    folder = run_dir(with_lengths(results, arm_wall=500))
    write_report(folder)
    index, scene = (folder / name for name in ("index.html", "scenes/arm_wall.html"))
    page = index.read_text(encoding="utf-8")
    assert page.index("</h1>") < page.index("1 of 3 scenes are cut short") < page.index('<dl class="tiles">')
    assert '<span class="cut">ran 4 s of 10 s</span>' in page
    assert "Cut short: this scene ran 4 s of 10 s." in scene.read_text(encoding="utf-8")
