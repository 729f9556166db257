"""Kernels of many checkouts live side by side; long unused or too many go, oldest first; missing ones are counted."""

import io
import os
import sys
import time
from pathlib import Path

import pytest

from avatarsim import console as progress
from avatarsim.jit import places
from avatarsim.jit.first_compile import FirstCompile
from avatarsim.jit.places import DAY, MOST_DAYS, CannotKeep, Places, prune


def version(base: Path, number: int, days: float, size: int = 100) -> Path:
    """Return the kernels of one version of a source file, last used so many days ago."""
    folder = base / "avatarsim.room.wall" / f"{number:020x}"
    folder.mkdir(parents=True)
    (folder / "f-0.kernel").write_bytes(bytes(size))
    used = time.time() - days * DAY
    os.utime(folder, (used, used))
    return folder


def test_long_unused_kernels_go_and_twenty_in_use_stay(tmp_path: Path) -> None:
    made = [version(tmp_path, k, days=0.1 * k) for k in range(20)]
    kept, gone = version(tmp_path, 21, MOST_DAYS - 1.0), version(tmp_path, 22, MOST_DAYS + 1.0)
    used = version(tmp_path, 23, MOST_DAYS + 1.0)
    Places(tmp_path).use(used)
    prune(tmp_path)
    assert all(folder.exists() for folder in (*made, kept, used)) and not gone.exists()


def test_above_the_total_size_what_was_used_longest_ago_goes(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(places, "MOST_BYTES", 350)
    made = [version(tmp_path, k, days=k) for k in (3, 0, 4, 1, 2)]
    prune(tmp_path)
    assert [folder.exists() for folder in made] == [False, True, False, True, True]


def test_nothing_but_versions_of_kernels_is_ever_removed(tmp_path: Path) -> None:
    other = tmp_path / "avatarsim.room.wall" / "notes"
    other.mkdir(parents=True)
    (other / "a").write_text("mine")
    os.utime(other, (0.0, 0.0))
    (tmp_path / "file").write_text("mine")
    linked = version(tmp_path / "elsewhere", 7, MOST_DAYS + 1.0)
    prune(tmp_path)
    assert (other / "a").exists() and (tmp_path / "file").exists() and linked.exists()


def test_what_a_killed_process_left_goes_after_a_day(tmp_path: Path) -> None:
    folder = version(tmp_path, 1, 0.0)
    old, new = folder / ".old.part", folder / ".new.part"
    for path in (old, new):
        path.write_bytes(b"half")
    os.utime(old, (time.time() - 2.0 * DAY,) * 2)
    prune(tmp_path)
    assert not old.exists() and new.exists() and (folder / "f-0.kernel").exists()


def test_kernels_removed_meanwhile_are_no_fault(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Wherever the other process is ahead: each folder is gone by the time it is listed."""
    listed = os.scandir
    for depth in range(3):
        base = tmp_path / str(depth)
        folder = version(base, 1, MOST_DAYS + 1.0)
        first_gone = (base, folder.parent, folder)[depth]

        def late(path: str | Path | int, first_gone: Path = first_gone) -> object:
            if path in (first_gone, str(first_gone)) and first_gone.exists():
                first_gone.rename(tmp_path / f"removed {first_gone.name}")
            return listed(path)

        with monkeypatch.context() as patched:
            patched.setattr(os, "scandir", late)
            prune(base)
        assert not folder.exists()


def test_a_folder_that_was_made_after_the_start_is_read_too(tmp_path: Path) -> None:
    chosen = Places(tmp_path / "kernels")
    before = chosen.read
    assert chosen.write == tmp_path / "kernels" and (before, chosen.read) == ((), (tmp_path / "kernels",))


def test_reports_once_or_refuses_where_nothing_can_be_kept(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr("avatarsim.console._PRINTED", set())
    blocked = tmp_path / "a_file"
    blocked.write_text("")
    unable = Places(blocked / "kernels")
    assert unable.write is None and unable.write is None and unable.read == ()
    unable.keep_no_more(OSError(28, "No space left on device"))
    assert capsys.readouterr().err.count("\n") == 1
    with pytest.raises(CannotKeep, match="a_file"):
        _ = Places(blocked / "kernels", required=True).write


class Terminal(io.StringIO):
    """A stream that claims to be a terminal."""

    def isatty(self) -> bool:
        return True


@pytest.fixture(autouse=True)
def fresh(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("avatarsim.console._PRINTED", set())
    monkeypatch.setattr(progress, "QUIET_FOR", 0.0)
    monkeypatch.setattr(progress, "BAR_EVERY", 0.0)


def compiled(first: FirstCompile, count: int) -> None:
    """So many kernels, each compiled when the one before calls it."""
    if count:
        with first.nested():
            first.begin("avatarsim.room")
            compiled(first, count - 1)


def test_kernels_that_are_kept_are_not_counted(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(places, "PLACES", places.Places(tmp_path))
    folder = tmp_path / "avatarsim.room" / "0"
    folder.mkdir(parents=True)
    for name in ("one-0.kernel", "one-1.kernel", "two-0.kernel", "three-0.compiling"):
        (folder / name).touch()
    wanted = {(Path("avatarsim.room/0"), name) for name in ("one", "two", "three", "four")}
    assert places.missing(wanted) == 2 and places.kept_kernels(Path("avatarsim.room/0")) == {"one": 2, "two": 1}


def test_silent_for_others_kernels_and_under_other_progress(monkeypatch: pytest.MonkeyPatch) -> None:
    stream = Terminal()
    monkeypatch.setattr(sys, "stderr", stream)
    first = FirstCompile()
    first.begin("somewhere.else")
    first.silent = True
    compiled(first, 3)
    assert stream.getvalue() == ""


def test_a_closed_stream_stops_nothing(monkeypatch: pytest.MonkeyPatch) -> None:
    closed = io.StringIO()
    closed.close()
    for stream in (None, closed):
        monkeypatch.setattr("avatarsim.console._PRINTED", set())
        monkeypatch.setattr(sys, "stderr", stream)
        compiled(FirstCompile(), 1)
