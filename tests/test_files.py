"""Entries of a cache are whole or not there; folders and files that others may have written are never touched."""

import os
import tempfile
from pathlib import Path

import pytest

from avatarsim import files as cache_folder
from avatarsim.files import (
    HEAD,
    Damaged,
    Distrusted,
    bases,
    is_readable,
    is_writable,
    read_entry,
    require_trusted,
    require_trusted_folder,
    write_entry,
)

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


def test_refuses_entries_that_others_may_write(tmp_path: Path) -> None:
    path = tmp_path / "entry"
    write_entry(path, DATA)
    path.chmod(0o666)
    with pytest.raises(Distrusted, match="other users may write"):
        read_entry(path)
    assert read_entry(path, must_be_private=False) == DATA


def test_pipes_and_folders_are_no_entries(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "pipe", 0o600)
    with pytest.raises(Damaged, match="not a file"):
        read_entry(tmp_path / "pipe")
    (tmp_path / "folder").mkdir(mode=0o700)
    with pytest.raises((Damaged, IsADirectoryError)):
        read_entry(tmp_path / "folder")
    with pytest.raises(FileNotFoundError):
        read_entry(tmp_path / "absent")


@pytest.fixture(autouse=True)
def nothing_said(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("avatarsim.console._PRINTED", set())


def give_away(path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Let a file or folder belong to another user: by the administrator's power, or by being another user oneself."""
    if os.geteuid() == cache_folder.ADMINISTRATOR:
        os.chown(path, 12345, -1, follow_symlinks=False)
    else:
        other = os.geteuid() + 1
        monkeypatch.setattr(os, "geteuid", lambda: other)


def test_folders_come_in_the_order_of_the_environment(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    for variable, value in (("AVATARSIM_CACHE_DIR", "a"), ("MORE", "b"), ("XDG_CACHE_HOME", "c"), ("HOME", "d")):
        monkeypatch.setenv(variable, str(tmp_path / value))
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path / "e"))
    found = [tmp_path / place for place in ("a/n", "b/n", "c/n", "d/.cache/n", f"e/n-{os.geteuid()}")]
    assert bases("n", "MORE") == found
    monkeypatch.setenv("MORE", "")
    assert bases("n", "MORE") == found[:1] + found[2:] == bases("n")


def test_a_machine_without_home_or_temporary_folder_has_none(monkeypatch: pytest.MonkeyPatch) -> None:
    def none() -> str:
        raise FileNotFoundError(2, "no usable temporary directory")

    for variable in ("AVATARSIM_CACHE_DIR", "XDG_CACHE_HOME"):
        monkeypatch.delenv(variable, raising=False)
    monkeypatch.setenv("HOME", "nowhere")
    monkeypatch.setattr(tempfile, "gettempdir", none)
    assert bases("n") == []


def test_folders_are_made_for_this_user_alone(tmp_path: Path) -> None:
    before = os.umask(0)
    try:
        assert is_writable(tmp_path / "a" / "b" / "c")
    finally:
        os.umask(before)
    assert {path.stat().st_mode & 0o777 for path in (tmp_path / "a").rglob("*")} == {0o700}
    assert is_writable(tmp_path / "a" / "b" / "c") and is_readable(tmp_path / "a" / "b" / "c")


@pytest.mark.parametrize("mode", [0o777, 0o775, 0o757, 0o1777])
def test_what_others_may_write_to_is_refused_and_said_once(mode: int, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    folder = tmp_path / "open"
    folder.mkdir()
    folder.chmod(mode)
    assert not is_writable(folder) and not is_readable(folder) and list(folder.iterdir()) == []
    said = capsys.readouterr().err
    assert said.count("\n") == 1 and str(folder) in said and f"mode {mode:04o}" in said
    folder.chmod(0o755)
    assert is_writable(folder) and is_readable(folder)


def test_what_belongs_to_another_user_is_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    folder = tmp_path / "theirs"
    folder.mkdir(mode=0o755)
    give_away(folder, monkeypatch)
    with pytest.raises(Distrusted, match="belongs to user"):
        require_trusted_folder(folder)
    assert not is_writable(folder) and not is_readable(folder)


def test_a_symlink_is_followed_only_if_it_is_ones_own(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "mine").mkdir(mode=0o700)
    link = tmp_path / "link"
    link.symlink_to(tmp_path / "mine")
    assert is_readable(link) and is_writable(link)
    give_away(link, monkeypatch)
    assert not is_readable(link)


def test_the_administrators_files_are_trusted_by_their_mode(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = tmp_path / "file"
    path.write_text("")
    path.chmod(0o644)
    require_trusted(path.stat(), path)
    monkeypatch.setattr(cache_folder, "ADMINISTRATOR", path.stat().st_uid)
    monkeypatch.setattr(os, "geteuid", lambda: 12345)
    require_trusted(path.stat(), path)
    path.chmod(0o664)
    with pytest.raises(Distrusted, match="mode 0664"):
        require_trusted(path.stat(), path)


def test_a_file_where_the_folder_should_be_is_no_folder(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    assert not is_readable(tmp_path / "file") and not is_writable(tmp_path / "file") and not is_writable(tmp_path / "file" / "x")
    assert not is_readable(tmp_path / "absent")
