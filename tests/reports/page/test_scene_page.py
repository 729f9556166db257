"""A page per scene: whole, with its replay where three.js is, in words where it is not, and from files alone."""

import json
import os
import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from markupsafe import escape

from avatarsim.errors import InvalidFile
from reports import write_report
from reports.page.scene_page import kept
from reports.reading.kept import drawn, shown
from reports.reading.load import load
from reports.replay import three_js
from reports.replay.courses import conclusion, courses, sentence
from reports.replay.packed import unpacked
from reports.replay.scene import MOST_BYTES, replay, stride
from runfiles import array_file
from tests.reports.page.test_page import Tree
from tests.reports.recorded import STATES, recording, scene

Json = dict[str, object]
Write = Callable[[object], Path]
NAME, OURS, THEIRS = "arm_wall", "avatarsim/default", "mujoco/default"


@pytest.fixture
def folder(run_dir: Write, results: Json) -> Path:
    """A run with recordings of one of its scenes; theirs ends early and sinks."""
    found = run_dir(results)
    scene(found, NAME)
    recording(found, NAME, OURS)
    recording(found, NAME, THEIRS, states=12, sinks=True)
    return found


def page(folder: Path, name: str = NAME) -> tuple[str, Tree]:
    write_report(folder)
    text = (folder / "scenes" / f"{name}.html").read_text(encoding="utf-8")
    tree = Tree()
    # what stands inside scripts is no markup
    tree.feed(re.sub(r"(<script[^>]*>).*?(</script>)", r"\1\2", text, flags=re.S))
    assert tree.open == [] and len(tree.ids) == len(set(tree.ids))
    return text, tree


def held(text: str, name: str) -> Json:
    found = re.search(rf'<script type="application/json" id="{name}">(.*?)</script>', text, flags=re.S)
    assert found
    data: Json = json.loads(found[1])
    return data


def test_every_scene_has_a_page_and_the_index_leads_there_and_back(folder: Path) -> None:
    text, tree = page(folder)
    index = (folder / "index.html").read_text()
    for name in (NAME, "hand_over_table", "ball_drop"):
        assert f'href="scenes/{name}.html"' in index and (folder / "scenes" / f"{name}.html").exists()
    assert f"../index.html#scene-{NAME}" in tree.links and f'id="scene-{NAME}"' in index
    assert not [link for link in tree.links if "//" in link]
    assert not list(folder.rglob(".*.part"))


def test_the_replay_holds_what_was_recorded(folder: Path) -> None:
    data = held(page(folder)[0], "replay-data")
    ours, theirs = data["runs"]
    assert (ours["run"], ours["frames"], theirs["run"], theirs["frames"]) == (OURS, STATES, THEIRS, 12)
    assert data["moving"] == [1, 2] and data["links"] == [2] and data["ghost"]["frames"] == STATES
    heights = unpacked(ours["places"], (data["low"][2], data["high"][2])).reshape(STATES, 2, 3)[:, 0, 2]
    assert heights == pytest.approx(1.0 - 5.0 * (np.arange(STATES) / 60.0) ** 2, abs=1e-4)
    # depths below what counts as overlap are no pair
    assert theirs["pairs"][10] == [[2, 0, 20.0]] and theirs["pairs"][9] == [[2, 0, 10.0]] and not any(ours["pairs"])


def test_without_three_js_the_page_says_so_and_keeps_its_charts(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(three_js, "library", lambda: None)
    text, _ = page(folder)
    assert "pip install &#39;.[assets]&#39;" in text and 'id="replay-data"' not in text and "courses-data" in text


def test_without_recordings_the_page_has_its_figures(folder: Path) -> None:
    text, _ = page(folder, "ball_drop")
    assert "Nothing was recorded here" in text and "restitution_error_max" in text


def test_only_our_own_scripts_may_run(folder: Path) -> None:
    text, tree = page(folder)
    policy = re.search(r'Content-Security-Policy" content="([^"]*)"', text)
    assert policy and policy[1].count("sha256-") == text.count("<script>") == 5
    assert "default-src 'none'" in policy[1].replace("&#39;", "'") and "http" not in policy[1]


def test_nan_in_a_recording_is_hidden_not_drawn(folder: Path) -> None:
    path = folder / "recordings" / f"{NAME}.mujoco.default.0.npz"
    arrays = array_file.read(path)
    arrays["positions"][5:, 1] = np.nan
    with path.open("wb") as file:
        array_file.write(file, arrays)
    data = held(page(folder)[0], "replay-data")
    places = unpacked(data["runs"][1]["places"], (0.0, 1.0)).reshape(12, 2, 3)
    assert np.isnan(places[5:, 0]).all() and not np.isnan(places[:5]).any()
    assert data["runs"][1]["broken"] == list(range(5, 12)) and data["runs"][0]["broken"] == []
    assert f"{THEIRS} 2 and 7 without numbers" in page(folder)[0]


THEIR_FILE = f"{NAME}.mujoco.default.0.npz"


def left_out(folder: Path, *words: str) -> str:
    """Write the pages: one file costs its part of this scene, is named on both pages, and nothing else is missing. Returns the
    page of the scene."""
    (said,) = write_report(folder)
    index = (folder / "index.html").read_text(encoding="utf-8")
    text = (folder / "scenes" / f"{NAME}.html").read_text(encoding="utf-8")
    assert said.startswith(f"{NAME}: ") and all(word in said for word in words) and str(folder) not in said
    told = str(escape(said.removeprefix(f"{NAME}: ")))
    assert f"Left out, since it cannot be used: {told}" in text and f"Left out, since it cannot be used: {NAME}: {told}" in index
    others = [path.read_text(encoding="utf-8") for path in folder.glob("scenes/*.html") if path.stem != NAME]
    assert others and not any("Left out, since" in other for other in others)
    return text


@pytest.mark.parametrize("content", [b"half", None])
@pytest.mark.parametrize(("file", "plays"), [
    (f"scenes/{NAME}.json", None), (f"recordings/{THEIR_FILE}", [OURS]), (f"overlaps/{THEIR_FILE}", [OURS]),
])
def test_a_damaged_file_costs_its_part_and_is_named(
    folder: Path, file: str, plays: list[str] | None, content: bytes | None,
) -> None:
    (folder / file).unlink()
    if content is None:
        os.mkfifo(folder / file)
    else:
        (folder / file).write_bytes(content)
    text = left_out(folder, Path(file).name)
    if three_js.library() is not None and plays:
        assert [run["run"] for run in held(text, "replay-data")["runs"]] == plays
    if plays is None:
        assert "Nothing was recorded here that could be played." in text


@pytest.mark.parametrize("value", [np.nan, np.inf])
def test_poses_of_ours_that_are_no_numbers_cost_the_replay_of_their_scene(folder: Path, value: float) -> None:
    path = folder / "recordings" / f"{NAME}.avatarsim.default.0.npz"
    arrays = array_file.read(path)
    arrays["positions"][:] = value
    with path.open("wb") as file:
        array_file.write(file, arrays)
    assert "Nothing was recorded here that could be played." in left_out(folder, "cannot be drawn")


@pytest.mark.parametrize(("change", "named"), [
    ({"bodies": []}, "bodies"), ({"bodies": [3]}, "json"), ({"gravity": [10**400, 0, 0]}, "json"), ({"gravity": [1.0]}, "json"),
    ({"bodies": [dict.fromkeys(("name", "role", "pieces", "mass"))] * 3}, "drawn"), ({"schema_version": 2}, "schema_version"),
])
def test_a_file_of_a_scene_that_is_none_costs_its_scene(folder: Path, change: Json, named: str) -> None:
    scene(folder, NAME, **change)
    found = kept(folder, NAME, load(folder), OURS)
    assert found.replay is None and found.damage and named in found.damage[0]


@pytest.mark.parametrize(("name", "value"), [
    ("positions", np.zeros((12, 2, 3))), ("velocities", np.zeros(3)), ("counts:contacts", np.zeros(12)), ("meta", np.array("[]")),
    ("meta", np.array(json.dumps({"schema_version": 1}))), ("raw_positions", None),
])
def test_a_recording_that_contradicts_itself_is_named(folder: Path, name: str, value: Any) -> None:
    path = folder / "recordings" / THEIR_FILE
    arrays = {**array_file.read(path), name: value}
    with path.open("wb") as file:
        array_file.write(file, {key: array for key, array in arrays.items() if array is not None})
    with pytest.raises(InvalidFile, match=re.escape(THEIR_FILE)):
        shown(folder, NAME, [THEIRS])


@pytest.mark.parametrize(("name", "value"), [
    ("frame", np.array([12, 0, 0])), ("first", np.array([-1, 0, 0])), ("second", np.array([3, 0, 0])), ("depth", np.zeros(2)),
    ("depth", np.full(3, np.nan)), ("frame", np.zeros(3)), ("first", None), ("frame", None),
])
def test_pairs_that_are_nowhere_are_named(folder: Path, name: str, value: Any) -> None:
    path = folder / "overlaps" / THEIR_FILE
    arrays = {**array_file.read(path), name: value}
    with path.open("wb") as file:
        array_file.write(file, {key: array for key, array in arrays.items() if array is not None})
    with pytest.raises(InvalidFile, match=rf"{name} in .*{re.escape(THEIR_FILE)}"):
        shown(folder, NAME, [THEIRS])


def test_a_name_that_leads_elsewhere_is_refused(run_dir: Write, results: Json) -> None:
    rows = results["rows"]
    assert isinstance(rows, list)
    found = run_dir(results | {"rows": [rows[0] | {"scenario": "../elsewhere"}]})
    with pytest.raises(InvalidFile, match="elsewhere"):
        write_report(found)


def test_it_opens_where_ours_looks_worst_and_offers_the_worst_of_the_others(folder: Path) -> None:
    found, (ours, theirs) = drawn(folder, NAME), shown(folder, NAME, [OURS, THEIRS])
    # 0.4 m aside and back in state 12 while it goes down by 50 mm a frame, and from state 15 on farther from the user, bit by bit
    ours.positions[12, 2, 0] += 0.4
    ours.positions[15:, 2, 1] += 0.05 * np.arange(1, STATES - 14)
    data = replay(found, [ours, theirs], OURS) if found else None
    # the jump there and the jump back are equal but for rounding
    assert data is not None and data["opens"]["others"] == {"state": 10, "run": THEIRS}  # type: ignore[index]
    assert data["opens"]["ours"]["state"] in (12, 13)  # type: ignore[index]
    first = data["runs"][0]  # type: ignore[index]
    remarks = dict(first["remarks"])
    assert remarks[13].startswith("403 mm to and fro") and 5 not in remarks and remarks[19].endswith("from its user")
    assert any(moment["said"].startswith("root ") for moment in first["worst"])
    still = replay(found, [shown(folder, NAME, [OURS])[0]], OURS) if found else None
    assert still is not None and still["opens"] == {}


def test_where_ours_shows_nothing_no_moment_of_another_is_called_ours(folder: Path) -> None:
    found, theirs = drawn(folder, NAME), shown(folder, NAME, [THEIRS])[0]
    data = replay(found, [theirs], OURS) if found else None
    assert data is not None and data["opens"] == {"others": {"state": 10, "run": THEIRS}}
    (folder / "recordings" / f"{NAME}.avatarsim.default.0.npz").unlink()
    text = page(folder)[0]
    assert "ours at its worst" not in text and "It opens on the deepest overlap of the others" in text


def test_the_view_holds_the_user_too(folder: Path) -> None:
    found, ours = drawn(folder, NAME), shown(folder, NAME, [OURS])[0]
    near = replay(found, [ours], OURS) if found else None
    ours.raw_positions[:, :, 0] += 3.0
    far = replay(found, [ours], OURS) if found else None
    assert near is not None and far is not None and far["near"] > near["near"] + 1.4  # type: ignore[operator]


def test_where_what_is_grasped_ends_stands_on_its_page(run_dir: Write, results: Json) -> None:
    rows = results["rows"]
    assert isinstance(rows, list)
    own = rows[0] | {"metric": "grasped_fall_end", "value": 0.96, "unit": "m", "bound": None, "status": "info"}
    text = page(run_dir(results | {"rows": [*rows, own]}))[0]
    assert f"height by which a grasped thing has fallen at the end: {OURS} 960 mm" in text


def test_a_long_scene_leaves_out_states() -> None:
    assert stride([600] * 6, 15) == 1 and stride([1200], 1) == 2
    assert 3601 * 6 * 216 * 14 / stride([3601] * 6, 216) <= MOST_BYTES


def test_a_falling_ball_keeps_its_energy(folder: Path) -> None:
    found = drawn(folder, NAME)
    lines = courses({}, shown(folder, NAME, [OURS, THEIRS]), found)
    assert found and lines["energy"][0].values == pytest.approx(np.zeros(STATES), abs=1e-12)
    assert conclusion("energy", lines["energy"]).startswith(("All reach the same", "No engine rises"))
    assert sentence("contacts", lines["contacts"]) == f"{OURS}: median 10, largest 19; {THEIRS}: median 6, largest 11."


def test_the_first_seed_is_played(run_dir: Write, results: Json) -> None:
    rows = results["rows"]
    assert isinstance(rows, list)
    found = run_dir(results | {"rows": [row | {"seed": 7} for row in rows]})
    scene(found, NAME)
    recording(found, NAME, OURS)
    assert "Nothing was recorded here" in page(found)[0]
    (found / "recordings" / f"{NAME}.avatarsim.default.0.npz").rename(found / "recordings" / f"{NAME}.avatarsim.default.7.npz")
    assert 'id="replay-data"' in page(found)[0]


def test_nothing_recorded_is_nothing_to_play(folder: Path) -> None:
    found = drawn(folder, NAME)
    assert found and replay(found, [], OURS) is None
