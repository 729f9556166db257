"""Bounds by kind: in how many scenes, the largest figure, what is nearest to its bound, and which bounds are loose."""

from collections.abc import Callable
from pathlib import Path

from reports import write_report
from reports.deciding.bounds_by_kind import Kind, kinds, loose, promised, wider
from reports.deciding.verdict import verdict
from reports.reading.load import load
from tests.reports.conftest import row

Json = dict[str, object]
Write = Callable[[object], Path]
OURS = "avatarsim/default"


def found(run_dir: Write, results: Json, *rows: Json) -> tuple[Kind, ...]:
    return kinds(verdict(load(run_dir(results | {"rows": list(rows)}))))


def gated(scene: str, metric: str, value: float, bound: float, unit: str = "m") -> Json:
    return row(scene, OURS, metric, value, unit, bound=bound, status="pass" if value <= bound else "fail")


def test_the_nearest_to_its_bound_need_not_be_the_largest(run_dir: Write, results: Json) -> None:
    course, overlap = "course_error_max", "residual_overlap_max"
    first, second = found(
        run_dir, results, gated("a", course, 5e-4, 1e-3), gated("b", course, 9e-8, 1e-7), gated("a", overlap, 3e-7, 1e-6))
    assert (first.metric, first.scenes, first.bound) == (overlap, 1, "1 µm")
    assert (second.scenes, second.bound, second.largest.scenario) == (2, "100 nm to 1 mm", "a")
    assert second.nearest_said == "90 % (b)"
    assert promised((first, second)) == ("Promised everywhere: deepest overlap shown 1 µm at most, in 1 scene, largest 300 nm, "
                                         "nearest to its bound 30 % (a).")


def test_a_bound_of_nothing_and_one_that_fails(run_dir: Write, results: Json) -> None:
    side, failed = found(run_dir, results, gated("a", "wrong_side_frames", 0.0, 0.0, "frames"), gated("b", "drift_max", 2.0, 1.0))
    assert side.nearest_said == "0 in all" and failed.nearest_said == "above it (b)"
    assert promised((side,)) == "Promised everywhere: frames on the wrong side 0 at most, in 1 scene, 0 in all."


def test_what_holds_by_a_bound_wider_than_that_of_other_scenes_is_named(run_dir: Write, results: Json) -> None:
    still = [gated(scene, "still_frames", value, bound, "%") for scene, value, bound in (
        ("a", 0.5, 1.0), ("b", 0.0, 1.0), ("c", 0.0, 1.0), ("d", 0.0, 1.0), ("centres", 15.8, 25.0), ("fine", 0.4, 25.0),
        ("above", 30.0, 25.0))]
    course = [gated("a", "course_error_max", 1e-5, 1e-3), gated("b", "course_error_max", 0.0, 1e-7)]
    assert wider(found(run_dir, results, *still, *course)) == (
        "Of how motion looks, held by a wider bound alone: "
        "frames that stand still while the user moves in centres: 15.8 %, bound 25 %, wider than "
        "the 1 % of other scenes.")
    assert wider(found(run_dir, results, *still[:2])) == ""


def test_the_wider_bound_stands_below_those_that_do_not_hold(run_dir: Write, results: Json) -> None:
    rows = [gated(scene, "still_frames", value, bound, "%") for scene, value, bound in (
        ("a", 0.5, 1.0), ("b", 0.0, 1.0), ("centres", 15.8, 25.0), ("broken", 3.0, 1.0))]
    folder = run_dir(results | {"rows": rows, "series": {}})
    write_report(folder)
    page = (folder / "index.html").read_text(encoding="utf-8")
    assert page.index("Bounds that do not hold</h2>") < page.index("held by a wider bound alone") < page.index('id="losses"')


def test_loose_bounds_on_physics_are_counted_by_kind_and_in_all(run_dir: Write, results: Json) -> None:
    every = found(
        run_dir, results, gated("cradle", "velocity_error_max", 0.0, 0.99, "m/s"), gated("drop", "apex_error_max", 2e-8, 1e-3),
        gated("fine", "apex_error_max", 0.0, 1e-6), gated("near", "drift_max", 0.5, 1.0), gated("none", "drift_max", 0.0, 0.0),
        gated("a", "root_jump_max", 0.0, 0.4))
    assert {one.metric: one.loose for one in every} == {
        "velocity_error_max": 1, "apex_error_max": 2, "drift_max": 0, "root_jump_max": 1}
    assert loose(every) == (
        "Loose, of the bounds on physics: of 5 less than a thousandth was measured in 3, which the column counts; the largest "
        "number among them is 0.99 m/s for error of velocity in cradle, measured 0 m/s.")
    assert loose([one for one in every if one.metric in ("drift_max", "root_jump_max")]) == ""


def test_the_headline_has_the_numbers_and_leads_to_the_table(run_dir: Write, results: Json) -> None:
    folder = run_dir(results)
    write_report(folder)
    page = (folder / "index.html").read_text(encoding="utf-8")
    assert page.index("Promised everywhere: deepest overlap shown 1 µm at most") < page.index('href="#bounds"') < page.index(
        'id="bounds"')


def test_the_slowest_frame_stands_beside_what_is_promised(run_dir: Write, results: Json) -> None:
    rows = results["rows"]
    assert isinstance(rows, list)
    slow = row("arm_wall", OURS, "frame_time_max", 3990.0, "us", note="3 x 300 frames, 30 warm-up frames")
    folder = run_dir(results | {"rows": [*rows, slow]})
    write_report(folder)
    page = (folder / "index.html").read_text(encoding="utf-8")
    assert page.index("Promised everywhere") < page.index("the least of 3 repeats) takes 3.99 ms, in arm_wall") < page.index(
        'href="#bounds"')
