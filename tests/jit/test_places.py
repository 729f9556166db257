"""Kernels of many checkouts live side by side; what is long unused or too much goes, oldest first, and nothing else."""

import os
import time
from pathlib import Path

import pytest

from avatarsim.jit import places
from avatarsim.jit.places import DAY, MOST_DAYS, CannotKeep, Places, prune


def version(base: Path, number: int, days: float, size: int = 100) -> Path:
    """The kernels of one version of a source file, last used so many days ago."""
    folder = base / "avatarsim.room.wall" / f"{number:020x}"
    folder.mkdir(parents=True)
    (folder / "f-0.kernel").write_bytes(bytes(size))
    used = time.time() - days * DAY
    os.utime(folder, (used, used))
    return folder


def test_twenty_checkouts_do_not_evict_one_another(tmp_path: Path) -> None:
    made = [version(tmp_path, k, days=0.1 * k) for k in range(20)]
    prune(tmp_path)
    assert all(folder.exists() for folder in made)


def test_what_is_long_unused_goes(tmp_path: Path) -> None:
    kept, gone = version(tmp_path, 1, MOST_DAYS - 1.0), version(tmp_path, 2, MOST_DAYS + 1.0)
    prune(tmp_path)
    assert kept.exists() and not gone.exists()


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


def test_what_a_killed_process_left_half_written_goes_after_a_day(tmp_path: Path) -> None:
    folder = version(tmp_path, 1, 0.0)
    old, new = folder / ".old.part", folder / ".new.part"
    for path in (old, new):
        path.write_bytes(b"half")
    os.utime(old, (time.time() - 2.0 * DAY,) * 2)
    prune(tmp_path)
    assert not old.exists() and new.exists() and (folder / "f-0.kernel").exists()


def test_use_is_noted_so_that_what_is_used_stays(tmp_path: Path) -> None:
    folder = version(tmp_path, 1, MOST_DAYS + 1.0)
    Places(tmp_path).use(folder)
    prune(tmp_path)
    assert folder.exists()


def test_a_folder_that_was_made_after_the_start_is_read_too(tmp_path: Path) -> None:
    chosen = Places(tmp_path / "kernels")
    assert chosen.read == ()
    assert chosen.write == tmp_path / "kernels" and chosen.read == (tmp_path / "kernels",)


def test_where_nothing_can_be_kept_it_is_said_once_or_refused(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr("avatarsim.console._SAID", set())
    blocked = tmp_path / "a_file"
    blocked.write_text("")
    unable = Places(blocked / "kernels")
    assert unable.write is None and unable.write is None and unable.read == ()
    unable.keep_no_more(OSError(28, "No space left on device"))
    said = capsys.readouterr().err
    assert said.count("\n") == 1 and "cannot be kept" in said
    with pytest.raises(CannotKeep, match="no folder can be written to .*a_file"):
        _ = Places(blocked / "kernels", required=True).write
