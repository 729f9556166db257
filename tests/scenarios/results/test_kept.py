"""The two questions that are answered from the recordings of a run, through their commands."""

import csv
import subprocess
import sys
from collections.abc import Callable, Iterator, Sequence
from dataclasses import fields, replace
from pathlib import Path

import numpy as np
import pytest

from avatarsim.errors import UnknownName
from avatarsim.running.processes import Died
from runfiles import record
from runfiles.record import LAYOUT, Recording
from scenarios import catalog
from scenarios.beside.__main__ import main as beside
from scenarios.job import Job
from scenarios.nearest.__main__ import main as nearest
from scenarios.results.kept import recordings, scenes_of
from scenarios.running.run import accuracy
from tests.scenarios.beside.test_pair import shown
from tests.scenarios.examples import fist


@pytest.fixture
def run(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setattr(catalog, "get", {"fist": fist()}.__getitem__)
    for who, stops in (("avatarsim.default", 0.2), ("mujoco.tuned", 0.4)):
        held = shown(stops)
        record.save(replace(held, meta=dict(held.meta) | {"full": True}), tmp_path / "recordings" / f"fist.{who}.0.npz")
    return tmp_path


def test_scenes_and_recordings_are_found_by_name(run: Path) -> None:
    assert scenes_of(run, "mujoco.tuned") == ["fist"] and scenes_of(run, "mujoco.tuned", "hand*") == []
    first, other = recordings(run, "fist", "mujoco.tuned")
    assert first.positions[-1, 1, 0] == 0.4 and other.positions[-1, 1, 0] == 0.2
    with pytest.raises(UnknownName):
        recordings(run, "fist", "pybullet.tuned")


def test_beside_writes_a_row_and_says_that_theirs_is_nearer(run: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert beside(["--run", str(run)]) == 1
    assert "theirs 1" in capsys.readouterr().out
    [row] = csv.DictReader((run / "beside.csv").read_text().splitlines())
    assert (row["other"], row["counted"], row["nearer_offset"]) == ("mujoco.tuned", "30", "theirs")


def test_nearest_writes_samples_and_says_that_ours_is_too_far(run: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert nearest(["--run", str(run), "--frames", "3", "--jobs", "0"]) == 1
    assert "OVER" in capsys.readouterr().out
    rows = list(csv.DictReader((run / "nearest_free.csv").read_text().splitlines()))
    assert [row["frame"] for row in rows] == ["23", "25", "28"]
    [scene] = csv.DictReader((run / "nearest_free_scenes.csv").read_text().splitlines())
    assert (scene["scenario"], scene["frames"], scene["lost"]) == ("fist", "3", "0") and float(scene["offset"]) > 0.2
    assert nearest(["--run", str(run), "--frames", "3", "--engine", "mujoco", "--preset", "tuned", "--jobs", "0"]) == 0
    assert nearest(["--run", str(run), "--frames", "0"]) == 2
    assert "--frames" in capsys.readouterr().err


def test_scenes_are_searched_side_by_side_by_the_command_itself(tmp_path: Path) -> None:
    assert accuracy(Job("shallow_overlap", "avatarsim", "default"), tmp_path).state == "measured"
    command = [sys.executable, "-m", "scenarios.nearest", "--run", str(tmp_path), "--frames", "1", "--jobs", "2"]
    done = subprocess.run(command, capture_output=True, text=True, timeout=300)
    assert done.returncode == 0, done.stderr
    assert "within 2 times in 1 of 1 scenes" in done.stdout


def test_a_scene_whose_search_dies_is_named_and_what_the_others_found_is_kept(
    run: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    def answers(function: Callable[[str], object], names: Sequence[str], jobs: int) -> Iterator[tuple[str, object]]:
        assert names == ["fist"] and jobs == 0
        yield "fist", function("fist")
        yield "gone", Died("its process was killed by signal 9")

    monkeypatch.setattr("scenarios.nearest.__main__.side_by_side", answers)
    assert nearest(["--run", str(run), "--frames", "2", "--jobs", "0"]) == 2
    assert "gone was not searched: its process was killed by signal 9" in capsys.readouterr().err
    assert len((run / "nearest_free.csv").read_text().splitlines()) == 3


@pytest.mark.parametrize("main", [beside, nearest])
def test_a_run_without_recordings_is_a_usage_error(main, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["--run", str(tmp_path)]) == 2
    said = capsys.readouterr().err
    assert "InvalidInput" in said and str(tmp_path) in said and "make compare" in said


def widened(recording: Recording, name: str) -> Recording:
    """A recording with one body, link or hinge more, in the fields that have them."""
    names = [entry.name for entry in fields(recording) if LAYOUT.get(entry.name, ())[2:3] == (name,)]
    found = {entry: np.concatenate([getattr(recording, entry), np.zeros_like(getattr(recording, entry)[:, :1])], axis=1)
             if getattr(recording, entry).shape[1] else np.zeros((len(getattr(recording, entry)), 1)) for entry in names}
    return replace(recording, **found)


@pytest.mark.parametrize("main", [beside, nearest])
@pytest.mark.parametrize(("who", "change", "said"), [
    ("avatarsim.default", lambda one: replace(one, positions=one.positions * np.nan), "positions"),
    ("avatarsim.default", lambda one: replace(one, orientations=one.orientations + np.inf), "orientations"),
    ("mujoco.tuned", lambda one: replace(one, raw_positions=one.raw_positions * np.nan), "raw_positions"),
    ("mujoco.tuned", lambda one: replace(one, times=one.times * np.nan), "times"),
    ("avatarsim.default", lambda one: widened(one, "bodies"), "width of positions"),
    ("mujoco.tuned", lambda one: widened(one, "links"), "width of raw_positions"),
    ("mujoco.tuned", lambda one: widened(one, "hinges"), "width of raw_angles"),
    ("avatarsim.default", lambda one: replace(one, meta={**one.meta, "dt": "long"}), "dt"),
    ("avatarsim.default", lambda one: replace(one, meta={**one.meta, "dt": 0.0}), "dt"),
])
def test_a_recording_that_is_not_of_its_scene_is_refused(
    main, who: str, change: Callable[[Recording], Recording], said: str, run: Path, capsys: pytest.CaptureFixture[str],
) -> None:
    path = run / "recordings" / f"fist.{who}.0.npz"
    record.save(change(record.load(path)), path)
    assert main(["--run", str(run), *(["--jobs", "0", "--frames", "1"] if main is nearest else [])]) == 2
    err = capsys.readouterr().err
    assert said in err and path.name in err and "valid: " in err


def test_a_rival_that_loses_its_numbers_is_compared_where_it_has_them(run: Path) -> None:
    path = run / "recordings" / "fist.mujoco.tuned.0.npz"
    found = record.load(path)
    found.positions[10:] = np.nan
    record.save(found, path)
    beside(["--run", str(run)])
    [row] = csv.DictReader((run / "beside.csv").read_text().splitlines())
    assert row["counted"] == "9"
