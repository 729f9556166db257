"""Recordings in files: bits and hashes survive, a write that fails changes nothing, a damaged file is refused by its name."""

from dataclasses import fields, replace
from pathlib import Path
from typing import IO, Any

import numpy as np
import pytest

from avatarsim.engine import FrameRecord, Snapshot
from avatarsim.errors import InvalidFile
from runfiles import array_file, record
from runfiles.record import Recording
from tests.runfiles.recordings import full
from tests.scenarios.examples import DT, drop_scene, resting


def test_what_is_saved_is_loaded_bit_for_bit(tmp_path: Path) -> None:
    recording = full()
    record.save(recording, tmp_path / "deep" / "one.npz")
    assert [path.name for path in (tmp_path / "deep").iterdir()] == ["one.npz"]
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


def test_state_hashes_follow_from_what_is_loaded(tmp_path: Path) -> None:
    recording = full()
    hashes = [hash_of(recording, k) for k in range(4)]
    record.save(replace(recording, state_hashes=np.array(hashes)), tmp_path / "one.npz")
    again = record.load(tmp_path / "one.npz")
    assert [hash_of(again, k) for k in range(4)] == again.state_hashes.tolist() == hashes


def hash_of(recording: Recording, k: int) -> str:
    """Return the hash of the k-th state shown."""
    shown = (recording.positions, recording.orientations, recording.velocities, recording.angular_velocities)
    return FrameRecord(Snapshot(0.0, *(array[k] for array in shown)), recording.angles[k]).state_hash()


def test_a_body_that_never_moves_costs_next_to_nothing(tmp_path: Path) -> None:
    """In a room of a hundred pieces of furniture only moving bodies are stored."""
    base, rng = resting(drop_scene(), 600), np.random.default_rng(3)
    still = np.tile(rng.normal(size=(1, 100, 3)), (601, 1, 1))
    orientations = np.tile(rng.normal(size=(1, 100, 4)), (601, 1, 1))
    room = replace(base, positions=still, orientations=orientations, velocities=0.0 * still, angular_velocities=0.0 * still)
    record.save(room, tmp_path / "room.npz")
    assert (tmp_path / "room.npz").stat().st_size < 0.02 * 4 * still.nbytes


def test_the_motion_of_a_scene_is_kept_once(tmp_path: Path) -> None:
    """And is loaded bit for bit with every recording that shows it; another motion has another file."""
    first, motions = full(), tmp_path / "motions"
    first = replace(first, raw_positions=np.random.default_rng(5).normal(size=(4, 3, 3)), raw_orientations=np.ones((4, 3, 4)))
    second = replace(first, raw_positions=np.nextafter(first.raw_positions, 9.0))
    for name, one in {"a.npz": first, "b.npz": replace(first, times=first.times + 1.0), "c.npz": second}.items():
        record.save(one, tmp_path / "recordings" / name, motions)
        again = record.load(tmp_path / "recordings" / name)
        assert all(getattr(again, field).tobytes() == getattr(one, field).tobytes() for field in record.OF_USER)
        assert again.times.tolist() == one.times.tolist()
    assert len(list(motions.iterdir())) == 2
    wanted = {"raw_angles", "times"}
    assert record.read(tmp_path / "recordings" / "a.npz", wanted).keys() == {"meta", *wanted}


@pytest.mark.parametrize("harm", ["gone", "half", "other", "elsewhere"])
def test_a_motion_that_is_damaged_is_an_invalid_file(tmp_path: Path, harm: str) -> None:
    path, motions = tmp_path / "recordings" / "one.npz", tmp_path / "motions"
    record.save(full(), path, motions)
    (motion,) = motions.iterdir()
    if harm == "gone":
        motion.unlink()
    elif harm == "half":
        motion.write_bytes(motion.read_bytes()[:-9])
    elif harm == "other":
        other = {**array_file.read(motion), "raw_angles": np.ones((4, 0)), "raw_positions": np.ones((4, 1, 3))}
        with motion.open("wb") as file:
            array_file.write(file, other)
    else:
        arrays = array_file.read(path)
        with path.open("wb") as file:
            array_file.write(file, {**arrays, "motion": np.array(f"../motions/{motion.stem}")})
    with pytest.raises(InvalidFile, match="motion"):
        record.load(path)


def test_a_full_disk_is_named_and_keeps_what_was_there(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = tmp_path / "one.npz"
    record.save(full(), path)
    before = path.read_bytes()

    def full_disk(file: IO[bytes], arrays: object) -> None:
        file.write(b"half")
        # the system's own message, without a name
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(array_file, "write", full_disk)
    with pytest.raises(OSError, match=r"No space left on device: '.*one\.npz'"):
        record.save(full(), path)
    assert path.read_bytes() == before
    assert [entry.name for entry in tmp_path.iterdir()] == ["one.npz"]


def test_absent_truncated_or_other_recording_is_an_invalid_file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    with pytest.raises(InvalidFile, match="none.npz"):
        record.load(tmp_path / "none.npz")
    record.save(full(), tmp_path / "cut.npz")
    (tmp_path / "cut.npz").write_bytes((tmp_path / "cut.npz").read_bytes()[:1000])
    with pytest.raises(InvalidFile, match="cut.npz"):
        record.load(tmp_path / "cut.npz")
    monkeypatch.setattr(record, "SCHEMA_VERSION", 99)
    record.save(full(), tmp_path / "new.npz")
    monkeypatch.undo()
    with pytest.raises(InvalidFile, match="schema_version"):
        record.load(tmp_path / "new.npz")


@pytest.mark.parametrize(("name", "value"), [
    ("positions", np.zeros((4, 3))), ("orientations", np.zeros((4, 2, 3))), ("velocities", np.zeros((3, 2, 3))),
    ("inside_positions", np.zeros((5, 3, 3))), ("inside_event", np.zeros(5)), ("angles", np.zeros((3, 0))),
    ("raw_positions", np.zeros((4, 0))), ("times", np.zeros(())), ("state_hashes", np.zeros(4)), ("overlap", np.zeros(3)),
    ("inside_frame", np.array([1, 1, 2, 2, 4])), ("inside_frame", np.array([1, 1, 2, 2, -1])),
    ("inside_event", np.array([0, 0, 0, 1, 3])), ("counts", {"pairs": np.arange(3)}), ("statuses", {"held": np.zeros(4)}),
    ("positions", np.zeros((4, 2, 3), dtype=np.float32)),
])
def test_arrays_that_contradict_each_other_are_an_invalid_file(tmp_path: Path, name: str, value: Any) -> None:
    path = tmp_path / "one.npz"
    record.save(replace(full(), **{name: value}), path)
    with pytest.raises(InvalidFile, match="one.npz"):
        record.load(path)


@pytest.mark.parametrize(("arrays", "said"), [
    *(({"meta": np.array(meta), "times": np.zeros(1)}, "one.npz") for meta in ("[]", "3", "{", "{}", "null")),
    ({"surprise": np.zeros(1)}, "surprise"),
])
def test_unknown_entries_are_an_invalid_file(tmp_path: Path, arrays: dict[str, Any], said: str) -> None:
    path = tmp_path / "one.npz"
    record.save(full(), path)
    whole = array_file.read(path) if "meta" not in arrays else {}
    with path.open("wb") as file:
        array_file.write(file, {**whole, **arrays})
    with pytest.raises(InvalidFile, match=said):
        record.load(path)
