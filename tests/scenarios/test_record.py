from dataclasses import fields, replace
from pathlib import Path

import numpy as np
import pytest

from avatarsim.errors import InvalidFile
from scenarios import record
from scenarios.record import Recording
from tests.scenarios.examples import DT, drop_scene, resting, with_inside


def full() -> Recording:
    """A recording with every field filled, nan and minus zero among the numbers."""
    base = resting(drop_scene(), 3)
    rng = np.random.default_rng(7)
    p, v = np.tile(base.positions[0], (5, 1, 1)), rng.normal(size=(5, 2, 3))
    p[:, 1] = rng.normal(size=(5, 3))
    p[3, 1, 2], v[:, 0] = np.nan, -0.0
    filled = with_inside(base, [0.001, 0.002, 0.02, 0.03, 0.03], [1, 1, 2, 2, 2], ["step"] * 3 + ["approach", "impact"], p, v)
    return replace(
        filled, meta={"dt": DT, "scene": "drop", "cannot_say": {"a": "b"}}, counts={"pairs": np.arange(4)},
        statuses={"OUT_OF_ITERATIONS": np.array([0, 1, 0, 2])}, frame_times_ns=np.arange(6).reshape(2, 3),
    )


def test_what_is_saved_is_loaded_bit_for_bit(tmp_path: Path) -> None:
    recording = full()
    record.save(recording, tmp_path / "deep" / "one.npz")
    again = record.load(tmp_path / "deep" / "one.npz")
    for entry in fields(Recording):
        kept, found = getattr(recording, entry.name), getattr(again, entry.name)
        if entry.name == "meta":
            assert found == kept
        elif isinstance(kept, dict):
            assert {name: a.tolist() for name, a in found.items()} == {name: a.tolist() for name, a in kept.items()}
        else:
            assert found.shape == kept.shape and found.tobytes() == kept.tobytes(), entry.name
    assert again.frames == 3 and again.dt == DT and again.links == slice(2, 2)


def test_bodies_that_never_change_are_stored_once(tmp_path: Path) -> None:
    record.save(full(), tmp_path / "one.npz")
    with np.load(tmp_path / "one.npz") as stored:
        assert stored["inside_positions"].shape == (5, 1, 3)
        assert stored["inside_orientations"].shape == (5, 0, 4)


def test_nothing_but_the_recording_is_left_behind(tmp_path: Path) -> None:
    record.save(full(), tmp_path / "one.npz")
    assert [path.name for path in tmp_path.iterdir()] == ["one.npz"]


def test_a_write_that_fails_keeps_what_was_there(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = tmp_path / "one.npz"
    record.save(full(), path)
    before = path.read_bytes()

    def broken(file: object, **arrays: object) -> None:
        file.write(b"half")
        raise OSError("no space left")

    monkeypatch.setattr(np, "savez", broken)
    with pytest.raises(OSError, match="no space"):
        record.save(full(), path)
    assert path.read_bytes() == before
    assert [entry.name for entry in tmp_path.iterdir()] == ["one.npz"]


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
    with np.load(path) as stored:
        arrays = {name: stored[name] for name in stored.files}
    np.savez(path, **arrays, surprise=np.zeros(1))
    with pytest.raises(InvalidFile, match="surprise"):
        record.load(path)
