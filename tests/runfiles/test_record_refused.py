"""A damaged recording is refused with its name."""

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from avatarsim.errors import InvalidFile
from runfiles import array_file, record
from tests.runfiles.recordings import full


@pytest.mark.parametrize("keep", [0, 10, 1000])
def test_a_truncated_recording_is_an_invalid_file(tmp_path: Path, keep: int) -> None:
    path = tmp_path / "one.npz"
    record.save(full(), path)
    path.write_bytes(path.read_bytes()[:keep])
    with pytest.raises(InvalidFile, match="one.npz"):
        record.load(path)


def test_a_missing_recording_and_another_layout_are_invalid_files(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    with pytest.raises(InvalidFile, match="none.npz"):
        record.load(tmp_path / "none.npz")
    monkeypatch.setattr(record, "SCHEMA_VERSION", 99)
    record.save(full(), tmp_path / "new.npz")
    monkeypatch.undo()
    with pytest.raises(InvalidFile, match="schema_version"):
        record.load(tmp_path / "new.npz")


def test_a_field_too_many_is_an_invalid_file(tmp_path: Path) -> None:
    path = tmp_path / "one.npz"
    record.save(full(), path)
    arrays = array_file.read(path)
    with path.open("wb") as file:
        array_file.write(file, {**arrays, "surprise": np.zeros(1)})
    with pytest.raises(InvalidFile, match="surprise"):
        record.load(path)


@pytest.mark.parametrize(
    ("name", "shape"),
    [
        ("positions", (4, 3)),
        ("orientations", (4, 2, 3)),
        ("velocities", (3, 2, 3)),
        ("inside_positions", (5, 3, 3)),
        ("inside_event", (5,)),
        ("angles", (3, 0)),
        ("raw_positions", (4, 0)),
        ("times", ()),
        ("state_hashes", (4,)),
        ("overlap", (3,)),
    ],
)
def test_shapes_that_contradict_each_other_are_an_invalid_file(tmp_path: Path, name: str, shape: tuple[int, ...]) -> None:
    path = tmp_path / "one.npz"
    changed: Any = {name: np.zeros(shape)}
    record.save(replace(full(), **changed), path)
    with pytest.raises(InvalidFile, match="one.npz"):
        record.load(path)


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("inside_frame", [1, 1, 2, 2, 4]),
        ("inside_frame", [1, 1, 2, 2, -1]),
        ("inside_event", [0, 0, 0, 1, 3]),
        ("counts", {"pairs": np.arange(3)}),
        ("statuses", {"held": np.zeros(4)}),
        ("positions", np.zeros((4, 2, 3), dtype=np.float32)),
    ],
)
def test_numbers_that_mean_nothing_are_an_invalid_file(tmp_path: Path, name: str, value: object) -> None:
    path = tmp_path / "one.npz"
    changed: Any = {name: np.array(value) if isinstance(value, list) else value}
    record.save(replace(full(), **changed), path)
    with pytest.raises(InvalidFile, match="one.npz"):
        record.load(path)


@pytest.mark.parametrize("meta", ["[]", "3", "{", "{}", "null"])
def test_meta_that_this_runner_did_not_write_is_an_invalid_file(tmp_path: Path, meta: str) -> None:
    path = tmp_path / "one.npz"
    with path.open("wb") as file:
        array_file.write(file, {"meta": np.array(meta), "times": np.zeros(1)})
    with pytest.raises(InvalidFile, match="one.npz"):
        record.load(path)
