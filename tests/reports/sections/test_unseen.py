"""The section on motions that nothing was tuned for: losses first, promises named, seeds and their origin stated."""

import re
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from reports.deciding.verdict import verdict
from reports.page.index import page
from reports.reading.load import Results, Series, load
from reports.sections import unseen
from reports.summaries import baseline
from reports.summaries.diff import diff
from reports.words.wording import MISSING
from tests.reports.conftest import row, whole_run

Json = dict[str, object]
Write = Callable[[object], Path]
OURS, TUNED, BULLET = "avatarsim/default", "mujoco/tuned", "pybullet/tuned"
RULE = "Smoother than ours (roughness less by more than 0.05, in a room whose allowed side it does not leave)"
SAID = "seed 77 of the unseen motions: the first 7 digits of commit 000004d1"
FIGURES = {
    "residual_overlap_max": (0.0, 3e-3, 0.02), "chatter_frames": (9.0, 0.0, 1.0), "reversal_p95": (0.026, 0.0, 2e-3),
    "jerk_ratio": (12.0, 1.2, 2.0), "tracker_offset_rms": (0.3, 0.2, 0.1), "silent_offset_frames": (4.0, 0.0, 0.0),
    "link_jump_max": (0.5, 0.03, 0.01), "root_jump_max": (0.3, 0.02, 0.01), "reversal_max": (0.47, 0.01, 0.001),
    "tracker_offset_max": (0.9, 0.8, 0.7), "joint_limit_excess_max": (0.0, 0.4, 0.2), "waiting": (12.0, 0.0, 0.0),
    "frame_time_p50": (40.0, 900.0, 1500.0), "frame_time_max": (5e3, 1.5e3, 1e3), "wrong_side_frames": (0.0, 0.0, 9.0),
}
UNITS = {"residual_overlap_max": "m", "chatter_frames": "%", "reversal_p95": "m", "tracker_offset_rms": "m",
         "silent_offset_frames": "frames", "frame_time_p50": "us", "frame_time_max": "us", "wrong_side_frames": "frames",
         "link_jump_max": "m", "root_jump_max": "m", "reversal_max": "m",
         "tracker_offset_max": "m", "joint_limit_excess_max": "deg", "waiting": "frames"}


def rows_of(room: str, shakes: float = 9.0) -> list[Json]:
    """Figures of one room in three engines, the last of which went through the wall, and the raw tracker."""
    found = [row(f"unseen_{room}", "tracker/default", "chatter_frames", 0.0, "%", seed=77)]
    for metric, values in FIGURES.items():
        for run, value in zip((OURS, TUNED, BULLET), values, strict=True):
            gate: Json = {"bound": 1e-6, "status": "pass"} if (run, metric) == (OURS, "residual_overlap_max") else {}
            shown = shakes if (run, metric) == (OURS, "chatter_frames") else value
            found.append(row(f"unseen_{room}", run, metric, shown, UNITS.get(metric, ""), seed=77, frames=600, **gate))
    return found


def run_with(write: Write, rows: list[Json]) -> Results:
    plain = whole_run()
    assert isinstance(plain["rows"], list) and isinstance(plain["provenance"], dict)
    plain["rows"] = plain["rows"] + rows
    plain["provenance"] = plain["provenance"] | {"unseen": SAID}
    return load(write(plain))


def test_a_run_without_these_rooms_has_no_section(run_dir: Write, results: Json) -> None:
    found = load(run_dir(results))
    assert unseen.unseen(found, OURS) is None and 'id="unseen"' not in page(found, verdict(found))


def test_losses_come_first_with_the_worst_room_and_an_engine_outside_wins_time_only(run_dir: Write) -> None:
    found = unseen.unseen(run_with(run_dir, [*rows_of("wall"), *rows_of("door", 15.0)]), OURS)
    assert found is not None and found.rooms == ("wall", "door") and found.broken == () and found.seeds == (77,)
    said = unseen.conclusion(found)
    assert said.startswith(f"{OURS} is behind another engine (furthest: by our figure over theirs) in frames in "
                           "contact that shake: 2 of 2 rooms, "
                           "furthest behind in door (15.0 % "
                           f"against 0 %, {TUNED})")
    # the engine outside has the smaller offset, which counts for nothing, and the faster slowest frame, which does
    assert f"(300 mm against 200 mm, {TUNED})" in said and f"(5.00 ms against 1.00 ms, {BULLET})" in said
    assert "frame time p50" not in said and "deepest overlap shown:" not in said
    assert "keeps what it promises" in said and f"20.0 mm ({BULLET}," in said
    assert said.index("behind") < said.index("keeps") and SAID in unseen.source(found)
    assert all(line.run != "tracker/default" for line in found.lines)
    assert unseen.statuses(found) == f"Frames and events that {OURS} itself reports: wall: 12 waiting; door: 12 waiting."


def test_the_room_in_which_ours_shakes_most_stands_first(run_dir: Write) -> None:
    found = unseen.unseen(run_with(run_dir, [*rows_of("wall"), *rows_of("door", 15.0)]), OURS)
    assert found is not None
    assert [(line.room, line.run) for line in unseen.worst_first(found)][:4] == [
        ("door", OURS), ("door", TUNED), ("door", BULLET), ("wall", OURS)
    ]


def test_a_room_at_another_frame_rate_is_listed_and_not_counted_again(run_dir: Write) -> None:
    plain = run_with(run_dir, [*rows_of("door"), *rows_of("door_90hz", 15.0)])
    results = replace(plain, families={"unseen_door_90hz": "unseen_door", "unseen_door": "unseen_door"})
    found = unseen.unseen(results, OURS)
    assert found is not None and found.rooms == ("door", "door_90hz") and found.asked == ("door",)
    assert "In 1 room (and again: door_90hz) with motions" in unseen.verdict_sentence(found)
    assert "1 of 1 room, furthest behind in door" in unseen.conclusion(found)
    (_, short), (_, every) = unseen.section(results, OURS)["unseen_tables"]  # type: ignore[misc]
    assert [row["scene"] for row in short] == 3 * ["unseen_door"] and len(every) == 6


def test_the_verdict_names_the_worst_room_and_the_best_other_engine(run_dir: Write) -> None:
    found = unseen.unseen(run_with(run_dir, [*rows_of("wall"), *rows_of("door", 15.0)]), OURS)
    assert found is not None
    assert unseen.verdict_sentence(found) == (
        f"In 2 rooms with motions that nothing was tuned for, in {OURS} nothing overlaps, no joint is beyond its limits, all "
        f"stays on its side; but a link jumps in one frame by up to 500 mm more than its user's (wall; {TUNED} 30.0 mm), the "
        f"root jumps by up to 300 mm (wall; {TUNED} 20.0 mm), the largest displacement to and fro is 470 mm (wall; {TUNED} "
        f"10.0 mm), the farthest from the user 900 mm (wall; {TUNED} 800 mm), up to 15.0 % of the frames in contact shake "
        f"(door; {TUNED} 0 %). Smoother than ours in a room at least: 1 preset of the other engines."
    )
    assert unseen.smoother(found) == (
        f"{RULE}: {TUNED} in 2 of 2 rooms (joints beyond their limits by 0.4° (wall), 0.4° (door); adapter: twist unlimited)."
    )
    bad = replace(found, lines=tuple(replace(line, figures=(None,) * len(line.figures)) for line in found.lines))
    assert unseen.verdict_sentence(bad).endswith("has no figure.")


def test_the_room_furthest_behind_by_factor_stands_beside_the_largest_figure(run_dir: Write) -> None:
    """83 mm against 62 is the larger figure and the larger difference, 20 against 1 the larger factor."""
    rows = [one for room in ("gallery", "door") for one in rows_of(room) if one["metric"] != "root_jump_max"]
    for room, ours, theirs in (("gallery", 0.0833, 0.0619), ("door", 0.0200, 0.0010)):
        rows += [row(f"unseen_{room}", run, "root_jump_max", value, "m", seed=77)
                 for run, value in ((OURS, ours), (TUNED, theirs))]
    found = unseen.unseen(run_with(run_dir, rows), OURS)
    assert found is not None
    assert (f"the root jumps by up to 83.3 mm (gallery; {TUNED} 61.9 mm; furthest behind ×20 in door: 20.0 mm against 1.00 mm, "
            f"{TUNED})") in unseen.verdict_sentence(found)
    said = f"jump of the root: 2 of 2 rooms, furthest behind in door (20.0 mm against 1.00 mm, {TUNED})"
    assert said in unseen.conclusion(found)


@pytest.mark.parametrize("value", [2e-6, None, "NaN"])
def test_a_broken_promise_stands_before_everything(run_dir: Write, value: object) -> None:
    rows = rows_of("wall")
    broken = [r | {"value": value} if r["bound"] is not None else r for r in rows]
    found = unseen.unseen(run_with(run_dir, broken), OURS)
    assert found is not None and len(found.broken) == 1 and "seed 77" in found.broken[0]
    assert unseen.conclusion(found).startswith(f"Broken by {OURS}: residual_overlap_max")
    assert "breaks 1 promise" in unseen.verdict_sentence(found) and "keeps what it promises" not in unseen.conclusion(found)


def test_an_engine_that_crashed_says_so_and_a_page_escapes_it(run_dir: Write) -> None:
    crash = row("unseen_wall", "mujoco/default", "run", None, status="crashed", note="<b>boom</b>", seed=77)
    text = page(results := run_with(run_dir, [*rows_of("wall"), crash]), verdict(results))
    assert 'id="unseen"' in text and 'href="#unseen"' in text and "crashed: &lt;b&gt;boom" in text and "<b>boom" not in text
    assert "left the allowed side" in text and text.index("with motions that nothing was tuned for") < text.index('id="unseen"')


def test_figures_that_change_with_the_commit_are_no_baseline_and_no_difference(run_dir: Write) -> None:
    crowd = row("crowd_poured_8", OURS, "residual_overlap_max", 1e-7, "m")
    before, after = run_with(run_dir, [*rows_of("wall"), crowd]), run_with(run_dir, rows_of("wall", 50.0))
    assert "unseen_" not in baseline.text(before) and "arm_wall" in baseline.text(before)
    assert "crowd_" not in baseline.text(before) and "crowd_" not in diff(before, after).text()
    found = unseen.unseen(before, OURS)
    assert found is not None and {line.room for line in found.lines} == {"wall"}
    assert "unseen_wall  avatarsim/default  chatter_frames" not in diff(before, after).text()


def test_joints_beyond_their_limits_are_stated_room_by_room_without_a_cause(run_dir: Write) -> None:
    """The smoothest room of an engine need not be that in which its joints are worst."""
    rows = [one for room in ("wall", "door") for one in rows_of(room)
            if (one["engine"], one["metric"]) != ("mujoco", "joint_limit_excess_max")]
    rows += [row(f"unseen_{room}", TUNED, "joint_limit_excess_max", value, "deg", seed=77)
             for room, value in {"wall": 0.875, "door": 95.0}.items()]
    results = run_with(run_dir, rows)
    found = unseen.unseen(results, OURS)
    assert found is not None
    said = unseen.limits_sentence(found)
    assert f"room by room: {TUNED} 95.0° (door), 0.875° (wall)." in said and BULLET not in said and "price" not in said
    assert said == unseen.section(results, OURS)["unseen_limits"]
    assert "in 2 of 2 rooms (joints beyond their limits by 95.0° (door), 0.875° (wall);" in unseen.smoother(found)
    plain = unseen.unseen(run_with(run_dir, rows_of("wall")), OURS)
    assert plain is not None and unseen.limits_sentence(plain) == ""


def test_the_smoother_preset_stands_beside_its_own_limits_and_hinges_beside_it(run_dir: Write) -> None:
    rows = [*rows_of("wall"), *rows_of("door", 15.0), *rows_of("door_90hz", 20.0)]
    for room in ("wall", "door"):
        rows += [row(f"unseen_{room}", "mujoco/default", metric, value, unit, seed=77) for metric, value, unit in (
            ("jerk_ratio", 1.1, ""), ("joint_limit_excess_max", 150.0, "deg"))]
    rows += [row("unseen_door", "mujoco/hinges", metric, value, unit, seed=77) for metric, value, unit in (
        ("jerk_ratio", 1.1, ""), ("joint_limit_excess_max", 0.1, "deg"))]
    rows = [one for one in rows if one["engine"] != "mujoco" or one["preset"] != "tuned" or one["metric"] != "jerk_ratio"]
    results = replace(run_with(run_dir, rows), families={"unseen_door_90hz": "unseen_door"})
    found = unseen.unseen(results, OURS)
    assert found is not None
    assert unseen.smoother(found) == (
        f"{RULE}: mujoco/default in 2 of 2 rooms (joints beyond their limits by 150° (wall), 150° (door); adapter: twist "
        "unlimited); "
        "mujoco/hinges in 1 of 2 rooms (joints beyond their limits by 0.1° (door); adapter: angles of hinges are not swing and "
        "twist).")
    assert "door_90hz;" not in unseen.verdict_sentence(found), "figures are of the rooms that are counted and shown"
    short = unseen.section(results, OURS)["unseen_tables"][0][1]  # type: ignore[index]
    assert "mujoco/hinges" in {one["run"] for one in short} and "door_90hz" not in {one["room"] for one in short}


def test_zero_is_no_but_and_jitter_stands_there_where_ours_is_behind(run_dir: Write) -> None:
    def said(ours: float, theirs: float) -> str:
        jitter = [row("unseen_wall", run, "jitter_rms", value, "m", seed=77) for run, value in ((OURS, ours), (TUNED, theirs))]
        found = unseen.unseen(run_with(run_dir, [*rows_of("wall", 0.0), *jitter]), OURS)
        assert found is not None
        return unseen.verdict_sentence(found)

    assert "links in contact jitter more than in another engine in 1 of 1 room" in said(7.56e-4, 3e-5)
    assert "756 µm" not in said(7.56e-4, 3e-5), "where few frames are in contact one event decides the figure"
    assert "jitter" not in said(3e-5, 3e-5) and "shake" not in said(3e-5, 3e-5)


def test_every_preset_that_is_smoother_by_the_table_is_named(run_dir: Write) -> None:
    rows = rows_of("wall")
    for preset, rough in (("default", 1.1), ("servos", 1.3), ("level", 11.96)):
        rows.append(row("unseen_wall", f"mujoco/{preset}", "jerk_ratio", rough, "", seed=77))
    found = unseen.unseen(run_with(run_dir, rows), OURS)
    assert found is not None
    named = set(re.findall(r"(\w+/\w+) in 1 of 1 room", unseen.smoother(found)))
    assert named == {TUNED, "mujoco/default", "mujoco/servos"}, "level is within 0.05 of ours, and pybullet/tuned left the room"


def test_the_table_says_from_which_frame_on_its_times_are(run_dir: Write) -> None:
    found = run_with(run_dir, rows_of("wall"))
    late = Series(np.zeros(0), np.array([np.nan] * 226 + [5.0] * 40))
    found = replace(found, series={"unseen_wall": {OURS: late}})
    (_, short), _ = unseen.section(found, OURS)["unseen_tables"]  # type: ignore[misc]
    timed = {one["run"]: one["timed"] for one in short}
    assert timed[OURS] == "40 from 226" and timed[TUNED] == MISSING
