"""Outputs are whole or absent, halves of killed commands go, and a folder has one writer."""

import hashlib
from pathlib import Path

import pytest

from avatarsim.clips.atomic_files import BEGUN, PART, remove_partial_files, sha256_of, write_atomically

ROOT = Path(__file__).resolve().parents[2]


def test_a_file_is_whole_or_what_it_was(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    place = tmp_path / "deep" / "a.txt"
    write_atomically(place, b"one")
    assert place.read_bytes() == b"one" and sha256_of(place) == hashlib.sha256(b"one").hexdigest()

    def full(*words: object) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("avatarsim.clips.atomic_files.os.fsync", full)
    with pytest.raises(OSError, match="No space left") as caught:
        write_atomically(place, b"two")
    assert place.read_bytes() == b"one" and [path.name for path in place.parent.iterdir()] == ["a.txt"]
    assert str(caught.value.filename).endswith("a.txt")


def test_halves_go_and_nothing_else(tmp_path: Path) -> None:
    (tmp_path / "b" / f"{BEGUN}x{PART}").mkdir(parents=True)
    (tmp_path / "b" / f"{BEGUN}x{PART}" / "half.bvh").write_text("ha")
    (tmp_path / f"{BEGUN}notes").mkdir()
    (tmp_path / f"mine{PART}").write_text("mine")
    remove_partial_files(tmp_path)
    assert sorted(path.relative_to(tmp_path).as_posix() for path in tmp_path.rglob("*")) == [f"{BEGUN}notes", "b", f"mine{PART}"]
