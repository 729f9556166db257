"""Scenes and recordings of a run are read completely, or rejected with their names."""

import json
import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from avatarsim.errors import InvalidFile
from reports.reading.kept import read_scene, shown
from runfiles import array_file
from tests.reports.recorded import AT_ORIGIN, BODIES, STATES, recording, scene
from tests.reports.small_runs import OURS

NAME, THEIRS = "arm_wall", "mujoco/default"
FILE = f"{NAME}.mujoco.default.0.npz"


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    scene(tmp_path, NAME)
    recording(tmp_path, NAME, OURS)
    recording(tmp_path, NAME, THEIRS, states=12, sinks=True)
    return tmp_path


def replaced(path: Path, name: str, value: Any) -> None:
    """Replace or remove an array of a file."""
    arrays = {**array_file.read(path), name: value}
    with path.open("wb") as file:
        array_file.write(file, {key: array for key, array in arrays.items() if array is not None})


def test_recordings_come_back_in_the_order_asked_for(folder: Path) -> None:
    found = shown(folder, NAME, [THEIRS, "nobody/default", OURS])
    assert [one.run for one in found] == [THEIRS, OURS] and [len(one.times) for one in found] == [12, STATES]
    assert len(found[0].pairs) == 3 and found[1].pairs == []
    assert shown(folder, "x" * 5000, [OURS]) == [] and shown(folder, NAME, [OURS], seed=1) == []
    assert read_scene(folder, "no_such_scene") is None and read_scene(folder, "x" * 5000) is None


@pytest.mark.parametrize(("kind", "name", "value"), [
    ("recordings", "positions", np.zeros((12, 2, 3))), ("recordings", "velocities", np.zeros(3)),
    ("recordings", "meta", np.array("[]")), ("recordings", "meta", np.array(json.dumps({"schema_version": 1}))),
    ("recordings", "raw_positions", None),
    *(("overlaps", "frame", value) for value in (np.array([12, 0, 0]), np.zeros(3), None)),
    ("overlaps", "first", np.array([-1, 0, 0])), ("overlaps", "first", None), ("overlaps", "second", np.array([3, 0, 0])),
    ("overlaps", "depth", np.zeros(2)), ("overlaps", "depth", np.full(3, np.nan)),
])
def test_a_file_that_contradicts_itself_is_named(folder: Path, kind: str, name: str, value: Any) -> None:
    replaced(folder / kind / FILE, name, value)
    with pytest.raises(InvalidFile, match=re.escape(FILE)):
        shown(folder, NAME, [THEIRS])


PIECES: tuple[object, ...] = (3, [{}], [{"kind": "sphere", "radius": -1.0} | AT_ORIGIN])
CHANGES = (
    {"bodies": [3]}, {"gravity": [10**400, 0, 0]}, {"gravity": [1.0]}, {"schema_version": 2}, {"parents": [5]}, {"parents": "x"},
    *({"bodies": [BODIES[0] | {"pieces": pieces}]} for pieces in PIECES),
)


@pytest.mark.parametrize("change", CHANGES)
def test_a_file_of_a_scene_that_is_none_is_named(folder: Path, change: dict[str, object]) -> None:
    scene(folder, NAME, **change)
    with pytest.raises(InvalidFile, match=NAME):
        read_scene(folder, NAME)


def test_a_recording_fits_its_scene_or_is_refused(folder: Path) -> None:
    assert shown(folder, NAME, [THEIRS], 0, read_scene(folder, NAME))
    scene(folder, NAME, bodies=[])
    with pytest.raises(InvalidFile, match="bodies"):
        shown(folder, NAME, [THEIRS], 0, read_scene(folder, NAME))
    replaced(folder / "recordings" / FILE, "times", np.full(12, np.nan))
    with pytest.raises(InvalidFile, match="times"):
        shown(folder, NAME, [THEIRS])
