"""Folders are taken whole, sorted, with their layout; files without motion are left alone; no result replaces another file."""

import os
from collections.abc import Iterator
from pathlib import Path

import pytest

from avatarsim.clips.clip_files import find_clips
from avatarsim.errors import InvalidInput


def touch(folder: Path, *names: str) -> None:
    for name in names:
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).write_text("{}" if name.endswith(".txt") else "")


def test_folders_are_taken_whole_and_sorted_with_their_layout(tmp_path: Path) -> None:
    touch(tmp_path, "in/b/2.bvh", "in/a.csv", "in/b/1.BVH", "in/b/c/x.npz", "in/t.txt", "one.amc", "in/p.pkl")
    clips = find_clips([tmp_path / "one.amc", tmp_path / "in"], None).clips
    assert [clip.place for clip in clips] == ["a.csv", "b/1.BVH", "b/2.bvh", "b/c/x.npz", "one.amc", "p.pkl", "t.txt"]
    assert clips[1].path == tmp_path / "in" / "b" / "1.BVH"
    assert find_clips([tmp_path / name for name in ("one.amc", "in", "in/a.csv", "one.amc")], None).clips == clips


def test_what_is_no_motion_is_left_alone(tmp_path: Path) -> None:
    touch(tmp_path, "README.md", "a.bvh", ".hidden.bvh", ".git/b.bvh", "skeleton.asf", "out/old.bvh")
    (tmp_path / "LICENCE.txt").write_text("All rights\n")
    (tmp_path / "clip.txt").write_text('\n {"Loop": "none"')
    one = find_clips([tmp_path], tmp_path / "out")
    assert [clip.place for clip in one.clips] == ["a.bvh", "clip.txt"]
    assert sorted(path.name for path in one.left) == ["LICENCE.txt", "README.md", "skeleton.asf"]


def test_links_that_lead_in_circles_and_pipes_end_nothing(tmp_path: Path) -> None:
    touch(tmp_path, "a.bvh")
    (tmp_path / "circle").symlink_to(tmp_path, target_is_directory=True)
    os.mkfifo(tmp_path / "pipe.txt")
    one = find_clips([tmp_path], None)
    assert [clip.place for clip in one.clips] == ["a.bvh"] and [path.name for path in one.left] == ["pipe.txt"]


def test_a_folder_that_cannot_be_read_has_a_place_without_a_path(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    touch(tmp_path, "in/a.bvh", "in/deep/locked/b.bvh")
    scan = os.scandir

    def refusing(place: str) -> "Iterator[os.DirEntry[str]]":
        if str(place).endswith(("locked", "shut")):
            raise PermissionError(13, "Permission denied", str(place))
        return scan(place)

    monkeypatch.setattr(os, "scandir", refusing)
    one = find_clips([tmp_path / "in"], None)
    assert one.unreadable == (("deep/locked/", tmp_path / "in" / "deep" / "locked", "Permission denied"),)
    assert one.places == {"in/", "deep/", "deep/locked/", "a.bvh"}
    (tmp_path / "shut").mkdir()
    assert [place for place, _, _ in find_clips([tmp_path / "shut"], None).unreadable] == ["shut/"]


@pytest.mark.parametrize(("named", "out", "said"), [
    (["x/a.bvh", "y/a.bvh"], "out", "clips of one name"), (["x", "y"], "out", "clips of one name"),
    (["x/a.bvh"], "x", "no file that is read"), (["x"], "x", "no file that is read"), (["pages"], "out", None),
    (["top"], "out", "name of a clip is 'pages/a.bvh'"),
])
def test_no_result_takes_the_place_of_another_file(tmp_path: Path, named: list[str], out: str, said: str | None) -> None:
    touch(tmp_path, "x/a.bvh", "y/a.bvh", "pages/a.bvh", "top/pages/a.bvh")
    paths = [tmp_path / one for one in named]
    if said is None:
        assert len(find_clips(paths, tmp_path / out).clips) == 1
        return
    if named == ["x"]:
        # files in the output folder are no input
        assert find_clips(paths, tmp_path / "x" / "deeper").clips != ()
    with pytest.raises(InvalidInput, match=said):
        find_clips(paths, tmp_path / out)
