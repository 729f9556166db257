"""Bad news stands first: what a screen shows, in that order, each with the scene and the moment where it can be seen."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from reports import write_report
from reports.deciding.moments import Instants, instants, moment
from reports.deciding.seen_first import SEEN
from reports.deciding.verdict import verdict
from reports.reading.kept import drawn, shown
from reports.reading.load import load
from reports.sections.bad_news import MOST, news, waiting
from runfiles import array_file
from tests.reports.conftest import row
from tests.reports.recorded import recording, scene

Json = dict[str, object]
Write = Callable[[object], Path]
OURS, THEIRS, ROOM = "avatarsim/default", "mujoco/tuned", "unseen_door"


def lost(scene: str, metric: str, ours: float, theirs: float) -> list[Json]:
    return [row(scene, run, metric, value, "m") for run, value in ((OURS, ours), (THEIRS, theirs))]


def test_what_a_screen_shows_stands_in_its_order_and_leads_to_its_moment(run_dir: Write, results: Json) -> None:
    rows = [*lost("a", "jitter_rms", 0.9, 0.1), *lost("a", "tracker_offset_max", 0.5, 0.1), *lost("b", "link_jump_max", 0.2, 0.1),
            *lost("a", "link_jump_max", 0.474, 0.3), *lost("a", "reversal_max", 0.01, 0.02)]
    found = load(run_dir(results | {"rows": rows, "series": {}}))
    known = {"a": Instants({"link_jump_max": 1.25})}
    made = news(found, verdict(found).ranked, OURS, known)
    assert [(one.said, one.path, one.beside) for one in made] == [
        ("jump of a link in a frame beyond its target's 474 mm", "scenes/a.html#t=1.25", f"a; {THEIRS} 300 mm"),
        ("farthest from the user 500 mm", "scenes/a.html", f"a; {THEIRS} 100 mm"),
    ]
    # a body that is lifted out of another moves on the screen: it stands before what shakes
    rows = [*lost("a", "chatter_frames", 2.0, 0.0), *lost("stack_struck", "lift_height_max", 0.07, 0.0)]
    found = load(run_dir(results | {"rows": rows, "series": {}}))
    assert [one.beside for one in news(found, verdict(found).ranked, OURS, {})] == [f"stack_struck; {THEIRS} 0", f"a; {THEIRS} 0"]
    every = [one for metric in SEEN for one in lost("a", metric, 2.0, 1.0)]
    found = load(run_dir(results | {"rows": every, "series": {}}))
    assert len(news(found, verdict(found).ranked, OURS, {})) == MOST


def test_beside_a_scene_that_was_cut_short_stands_how_much_of_it_ran(run_dir: Write, results: Json) -> None:
    rows = [*lost("short", "reversal_max", 0.4, 0.1), *lost("whole", "root_jump_max", 0.4, 0.1)]
    lengths = {"whole": {"dt": 0.02, "frames": 200}, "short": {"dt": 0.02, "frames": 1000}}
    found = load(run_dir(results | {"rows": rows, "series": {}, "scenes": lengths}))
    said = [one.beside for one in news(found, verdict(found).ranked, OURS, {})]
    assert f"short, in 4 s of 20 s; {THEIRS} 100 mm" in said and f"whole; {THEIRS} 100 mm" in said


def test_the_longest_wait_of_a_room_is_told_with_its_begin() -> None:
    waits = {"unseen_wall": (0.5, 3.0), ROOM: (4.25, 5.5), "mocap_walk_wall": (9.0, 0.0)}
    known = {scene: Instants(wait=wait) for scene, wait in waits.items()}
    assert [(one.said, one.path) for one in waiting(known)] == [("an avatar waits up to 4.25 s", f"scenes/{ROOM}.html#t=5.5")]
    assert waiting({"unseen_wall": Instants()}) == ()


@pytest.fixture
def room(run_dir: Write, results: Json) -> Path:
    """A run of one room, in which our hand jumps at state 12 and waits from the frame of state 5 on, six frames long."""
    rows = [*lost(ROOM, "link_jump_max", 0.4, 0.1), row(ROOM, OURS, "tracker_offset_rms", 0.1, "m")]
    folder = run_dir(results | {"rows": rows, "series": {}})
    scene(folder, ROOM)
    recording(folder, ROOM, OURS)
    path = folder / "recordings" / f"{ROOM}.avatarsim.default.0.npz"
    arrays = array_file.read(path)
    arrays["positions"][12:, 2, 0] += 0.4
    waits = np.zeros(len(arrays["times"]), dtype=np.int64)
    waits[[2, 16, 17]], waits[5:11] = 1, 2
    # for a frame in between a path is sought
    waits[8], seeks = 0, np.zeros_like(waits)
    seeks[8] = 1
    with path.open("wb") as file:
        array_file.write(file, arrays | {"counts:waiting": waits, "counts:planning": seeks})
    return folder


def test_instants_come_from_the_recording(room: Path) -> None:
    one, found = shown(room, ROOM, [OURS])[0], load(room)
    times = instants(one, drawn(room, ROOM))
    assert times.wait == pytest.approx((6 / 60, 5 / 60)) and times.at["link_jump_max"] == pytest.approx(12 / 60)
    assert moment(found, ROOM, OURS, "link_jump_max", {ROOM: times}) == "#t=0.2"
    assert moment(found, ROOM, OURS, "link_jump_max") == ""


def test_it_stands_directly_under_the_headline_and_not_in_the_colour_of_links(room: Path) -> None:
    write_report(room)
    page = (room / "index.html").read_text(encoding="utf-8")
    headline = page.index("</h1>")
    told = page[headline : page.index("</p>", headline)]
    assert 'class="bad-news"' in told and f'href="scenes/{ROOM}.html#t=0.2"' in told and "400 mm" in told
    assert f'<a href="scenes/{ROOM}.html#t=0.0833333">an avatar waits up to 100 ms</a>' in told
    assert ".bad-news,.bad-news a{color:var(--warn)}" in page
    assert page.count('class="bad-news"') == 1
