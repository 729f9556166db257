"""An entry is whole or it is not there, and what is not whole is never handed out."""

import os
from pathlib import Path

import pytest

from avatarsim.files import HEAD, Damaged, Distrusted, read_entry, write_entry

DATA = bytes(range(256)) * 3


@pytest.mark.parametrize("data", [b"", b"x", DATA])
def test_what_is_written_comes_back(data: bytes, tmp_path: Path) -> None:
    path = tmp_path / "entry"
    write_entry(path, data)
    assert read_entry(path) == data
    assert [one.name for one in tmp_path.iterdir()] == ["entry"] and path.stat().st_mode & 0o777 == 0o600


def test_any_cut_any_flipped_byte_and_anything_added_is_found(tmp_path: Path) -> None:
    path = tmp_path / "entry"
    write_entry(path, DATA)
    raw = path.read_bytes()
    cuts = [raw[:length] for length in (0, 1, HEAD.size - 1, HEAD.size, len(raw) - 1)]
    flips = [raw[:k] + bytes([raw[k] ^ 1]) + raw[k + 1 :] for k in range(0, len(raw), 7)]
    for damaged in (*cuts, *flips, raw + b"x", b"x" * len(raw)):
        path.write_bytes(damaged)
        with pytest.raises(Damaged, match="entry"):
            read_entry(path)
    path.write_bytes(raw)
    assert read_entry(path) == DATA


@pytest.mark.parametrize("step", ["os.fsync", "os.replace"])
@pytest.mark.parametrize("trouble", [OSError(28, "No space left on device"), KeyboardInterrupt()])
def test_a_write_that_fails_leaves_what_was_there(
    step: str, trouble: BaseException, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def fail(*_: object) -> None:
        raise trouble

    path = tmp_path / "entry"
    write_entry(path, b"before")
    with monkeypatch.context() as patch, pytest.raises(type(trouble)):
        patch.setattr(step, fail)
        write_entry(path, DATA)
    assert read_entry(path) == b"before" and [one.name for one in tmp_path.iterdir()] == ["entry"]


def test_what_others_may_have_written_is_refused_unless_it_lies_beside_the_sources(tmp_path: Path) -> None:
    path = tmp_path / "entry"
    write_entry(path, DATA)
    path.chmod(0o666)
    with pytest.raises(Distrusted, match="other users may write"):
        read_entry(path)
    assert read_entry(path, must_be_private=False) == DATA


def test_a_pipe_or_a_folder_in_place_of_a_file_keeps_no_reader_waiting(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "pipe", 0o600)
    with pytest.raises(Damaged, match="not a file"):
        read_entry(tmp_path / "pipe")
    (tmp_path / "folder").mkdir(mode=0o700)
    with pytest.raises((Damaged, IsADirectoryError)):
        read_entry(tmp_path / "folder")
    with pytest.raises(FileNotFoundError):
        read_entry(tmp_path / "absent")
