"""Times of scenes with an avatar have no factor, rank or best anywhere, and all sentences count the families of one rule."""

import re
from collections.abc import Callable
from pathlib import Path

import pytest

from reports import write_report
from reports.deciding.conclusions import time_sentence, time_summary
from reports.deciding.losses import aside_said, best_in, repeats_said
from reports.deciding.tables import blocks
from reports.deciding.verdict import verdict
from reports.drawing.charts import time_panels
from reports.drawing.palette import strokes
from reports.reading.load import Results, load
from reports.summaries import headline
from reports.summaries.summary import summary
from runfiles.like_for_like import AVATAR, RESTING
from runfiles.timing_protocol import TAILS
from tests.reports.conftest import row

Json = dict[str, object]
Write = Callable[[object], Path]
OURS, THEIRS = "avatarsim/default", "mujoco/tuned"
P95 = "frame_time_p95"
TIMES = {
    "hand": (10.0, 190.0), "kick": (500.0, 100.0), "ball": (100.0, 50.0), "slope": (200.0, 50.0), "drop": (1.0, 50.0),
    "stack": (900.0, 50.0),
}
"""Scene -> 95th percentile [us] of ours and theirs; the first two have an avatar, in the last ours sleeps."""


def found(run_dir: Write, results: Json) -> Results:
    rows = []
    for scene, times in TIMES.items():
        for run, time in zip((OURS, THEIRS), times, strict=True):
            rows += [row(scene, run, metric, time, "us") for metric in (P95, "frame_time_p50")]
            if scene in ("hand", "kick"):
                rows.append(row(scene, run, AVATAR, 0.01, "m"))
    rows.append(row("stack", OURS, RESTING, 96.0, "%"))
    scenes = {scene: {"title": "", "everyday": True} for scene in TIMES}
    return load(run_dir(results | {"rows": rows, "series": {}, "scenes": scenes}))


def test_families_are_counted_once_with_the_largest_factor_first(run_dir: Write, results: Json) -> None:
    ranked = verdict(found(run_dir, results)).ranked
    said = best_in(ranked, {}, P95)
    assert said == "1 of 3 families without an avatar, behind in slope (×4.0), ball (×2.0)"
    assert aside_said(ranked, {}).endswith(
        "frame time, 95th percentile: with an avatar, side by side, another engine takes less time in 1 of 2 families, in 1 "
        "family what rests sleeps in that frame.")


def test_losses_ranking_and_frame_times_say_the_same(run_dir: Write, results: Json) -> None:
    made = found(run_dir, results)
    said = best_in(verdict(made).ranked, {}, P95)
    folder = run_dir(results | {"rows": [one.__dict__ for one in made.rows], "series": {}})
    write_report(folder)
    page = (folder / "index.html").read_text(encoding="utf-8")
    assert page.count(said) == 2, "once in the ranking, once in the frame times"
    assert re.search(r"95th percentile without an avatar</span></th><td [^>]*>2 of 3 families</td>", page)
    assert "Times that are not ranked: frame time, median:" in page


def test_no_cell_of_a_time_with_an_avatar_is_best_or_has_a_factor(run_dir: Write, results: Json) -> None:
    made = found(run_dir, results)
    for block in blocks(made):
        times = [cell for line in block.lines for cell in line.cells if cell.row and cell.row.metric == P95]
        compared = block.scene not in ("hand", "kick", "stack")
        assert all((cell.ratio is not None) is compared for cell in times)
        assert any(cell.best for cell in times) is compared
    told = headline.block(headline.load(_written(made, run_dir(results))))
    hand = [line for line in told.splitlines() if "frame time" in line]
    assert sum("**" in line for line in hand) == 3, "ball, slope and drop alone"
    text = summary(made, verdict(made))
    assert "10.0 µs | —" in text or "10.0 µs |" in text
    assert "10.0 µs (best)" not in text and "1.00 µs (best)" in text


def _written(made: Results, folder: Path) -> Path:
    path = folder / "headline.csv"
    path.write_text(headline.numbers(made), encoding="utf-8")
    return path


def test_the_panel_of_a_scene_with_an_avatar_names_no_lowest(run_dir: Write, results: Json) -> None:
    made = found(run_dir, results)
    panels = {panel.scene: panel.conclusion for panel in time_panels(made, strokes([OURS, THEIRS]), tuple(TIMES))}
    assert panels["hand"].startswith("p95, side by side (ours is kinematic, theirs has dynamics): avatarsim/default 10.0 µs, ")
    assert panels["stack"].startswith("p95, side by side (in some what rests sleeps")
    assert panels["drop"].startswith("avatarsim/default has the lowest p95, 1.00 µs; mujoco/tuned takes 50 times as long")
    assert "times as long" not in panels["hand"] + panels["stack"]
    assert time_sentence({OURS: (1.0, 2.0, 3.0)}, "why") == "The p95 of avatarsim/default is 2.00 µs; it keeps 90 Hz at p99."


def test_the_slowest_frame_of_the_summary_says_of_how_many_repeats_it_is() -> None:
    said = time_summary({"maze": {OURS: (1.0, 2.0, 3.0)}}, OURS, "", {"maze": 3850.0}, 1, 3)
    assert said.startswith(f"The slowest frame of {OURS} (each frame the least of 3 repeats) takes 3.85 ms, in maze;")


@pytest.mark.parametrize(("note", "ranked"), [
    ("1 x 200 frames, 30 warm-up frames", False), ("3 x 60 frames", False), ("2 x 200 frames", True), ("", True)])
def test_a_slow_end_of_few_frames_or_one_repeat_ranks_nothing(note: str, ranked: bool, run_dir: Write, results: Json) -> None:
    """Medians of the same frames are ranked."""
    rows = [row("drop", run, metric, time, "us", note=note) for run, time in ((OURS, 100.0), (THEIRS, 50.0))
            for metric in (*TAILS, "frame_time_p50")]
    made = load(run_dir(results | {"rows": rows, "series": {}, "scenes": {"drop": {"title": "", "everyday": True}}}))
    behind = {one.row.metric for one in verdict(made).ranked.behind}
    assert behind == ({*TAILS, "frame_time_p50"} if ranked else {"frame_time_p50"})
    (block,) = blocks(made)
    for line in block.lines:
        ratios = {cell.row.metric: cell.ratio for cell in line.cells if cell.row}
        assert (ratios[P95] is not None) is ranked and ratios["frame_time_p50"] is not None
    (panel,) = time_panels(made, strokes([OURS, THEIRS]), ("drop",))
    assert ("has the lowest p95" in panel.conclusion) is ranked
    once = "Engines are compared over frames of 1 repeat in 1 of 1 scene."
    assert repeats_said(made, OURS) == (once if note[:1] == "1" else "")
    few = "in 1 family frames or repeats are too few, in 1 of them another engine takes less time"
    assert (few in aside_said(verdict(made).ranked, {})) is not ranked
