"""A run of a user's own scenes: which setting leaves at most a millimetre is said first, and the page stands alone."""

import json
import math
from collections.abc import Callable
from pathlib import Path

import pytest

from reports import write_report
from reports.reading.load import load
from reports.sections.own_scenes import STANDS_ALONE, are_own, least
from reports.sections.sweep.points import Point, Sweep

Json = dict[str, object]
Write = Callable[[object], Path]
ABSENT = "Not in this run."


def point(run: str, error: float, time: float) -> Point:
    engine, setting = run.split("/", 1)
    overlap = "residual_overlap_max"
    return Point("own_desk", engine, setting, overlap, "m", error, time, math.nan, "measured", "", 1e-6, "", setting)


def swept(*points: Point) -> Sweep:
    return Sweep(points, {"form": "short"})


def own(results: Json) -> Json:
    """The run with its scenes called as a user's own are."""
    return json.loads(json.dumps(results).replace("arm_wall", "own_desk").replace("hand_over_table", "own_shelf")
                      .replace("ball_drop", "own_ball"))


@pytest.fixture
def own_run(results: Json, run_dir: Write) -> Path:
    return run_dir(own(results))


def test_the_cheapest_is_named_first_and_who_comes_nowhere_near_last(own_run: Path) -> None:
    points = point("avatarsim/default", 2e-7, 50.0), point("mujoco/tuned", 9e-4, 20.0), point("pybullet/tuned", 5e-3, 9.0)
    said = least(load(own_run), swept(*points))[0]
    assert said == (
        "own_desk: at most 1 mm is left for the least time by mujoco/tuned (20.0 µs a frame, leaves 900 µm); then "
        "avatarsim/default (50.0 µs a frame, leaves 200 nm); pybullet at best 5.00 mm (measured: 1). Time: median of all frames."
    )


def test_where_nothing_leaves_so_little_that_is_said(own_run: Path) -> None:
    said = least(load(own_run), swept(point("mujoco/tuned", 2e-3, 20.0)))[0]
    assert said.startswith("own_desk: no setting of any engine leaves at most 1 mm: mujoco at best 2.00 mm")


def test_without_a_sweep_no_setting_is_named(own_run: Path) -> None:
    found = load(own_run)
    assert [said.partition(":")[0] for said in least(found, None)] == list(found.scenes())
    assert all("none is named" in said for said in least(found, None))


def test_one_scene_of_the_catalogue_and_the_run_is_no_users(results: Json, run_dir: Write) -> None:
    mixed = json.loads(json.dumps(results).replace("arm_wall", "own_desk"))
    found = load(run_dir(mixed))
    assert not are_own(found) and least(found, None) == ()


def test_the_page_stands_alone_and_says_so_once(own_run: Path, results: Json, run_dir: Write) -> None:
    assert write_report(own_run) == ()
    page = (own_run / "index.html").read_text()
    assert page.count(STANDS_ALONE.replace("'", "&#39;")) == 1 and ABSENT not in page
    assert "own_desk: no setting was both measured and timed" in page
    assert "own_desk: no setting was both measured and timed" in (own_run / "summary.md").read_text().replace("\\", "")
    catalogued = run_dir(results)
    write_report(catalogued)
    other = (catalogued / "index.html").read_text()
    assert ABSENT in other and "Sections that need the catalogue" not in other
