"""Loading of motion files: a reader per suffix, and errors for unsupported files."""

from pathlib import Path

import numpy as np
import pytest

import avatarsim as av
from avatarsim.assets import caps
from avatarsim.assets.motions.load import load_motion
from avatarsim.errors import InvalidFile, InvalidInput
from tests.assets.motions.files import ASF, WALKER, amc, bvh
from tests.assets.motions.robots import saved, walk


@pytest.mark.parametrize("name", ["some.pkl", "some.pickle", "some.joblib", "some.pt"])
def test_pickles_are_refused_with_a_way_out(tmp_path: Path, name: str) -> None:
    path = tmp_path / name
    path.write_bytes(b"cos\nsystem\n(S'touch sprung'\ntR.")
    with pytest.raises(InvalidFile, match=r"a pickle.*numpy\.savez\('some\.npz'"):
        load_motion(path)


@pytest.mark.parametrize("name", ["some.fbx", "some", "some.npz.zip"])
def test_other_suffixes_are_refused_with_those_that_are_read(tmp_path: Path, name: str) -> None:
    with pytest.raises(InvalidFile, match=r"end of the name.*\.amc, \.bvh, \.csv, \.npz, \.txt"):
        load_motion(tmp_path / name)


def test_an_option_of_another_format_is_refused_by_name(tmp_path: Path) -> None:
    path = saved(tmp_path / "some.npz", {"qpos": walk(3), "fps": 30})
    with pytest.raises(InvalidInput, match=r"option for some\.npz is 'units'.*quaternion.*rate"):
        load_motion(path, units="cm")


@pytest.mark.parametrize("name", ["robot.npz", "body.npz", "robot.csv", "body.txt"])
def test_a_home_is_refused_where_no_skeleton_is_folded_at_rest(tmp_path: Path, name: str) -> None:
    with pytest.raises(InvalidInput, match=r"stands at rest.*keyframe") as found:
        load_motion(tmp_path / name, home=3)
    assert name in found.value.thing and found.value.value == 3


def test_files_are_known_by_the_end_of_their_names(tmp_path: Path) -> None:
    (tmp_path / "a.BVH").write_text(bvh(WALKER, np.zeros((2, 30))))
    (tmp_path / "b.asf").write_text(ASF)
    (tmp_path / "b.amc").write_text(amc(np.zeros((2, 22))))
    saved(tmp_path / "some.npz", {"qpos": walk(3), "fps": 30}).rename(tmp_path / "SOME.NPZ")
    assert [av.load_motion(tmp_path / name).format for name in ("a.BVH", "b.amc", "SOME.NPZ")] == ["bvh", "amc", "npz"]
    assert av.load_motion(str(tmp_path / "a.BVH"), scale=0.02, up="z").notes == ()


@pytest.mark.parametrize(("name", "most"), [
    ("a.csv", caps.TEXT_BYTES), ("a.txt", caps.JSON_BYTES), ("a.npz", caps.BYTES), ("a.bvh", caps.BYTES),
])
def test_large_files_are_refused_by_their_size(tmp_path: Path, name: str, most: int) -> None:
    with (tmp_path / name).open("wb") as file:
        # a hole, which takes no room on the disk
        file.truncate(most + 1)
    with pytest.raises(InvalidFile, match=f"size of .*a{name[1:]}.* is {most + 1}"):
        load_motion(tmp_path / name)


@pytest.mark.parametrize("suffix", [".amc", ".bvh", ".csv", ".npz", ".txt"])
def test_missing_files_and_folders_are_refused(tmp_path: Path, suffix: str) -> None:
    (tmp_path / f"folder{suffix}").mkdir()
    for name in ("gone", "folder"):
        with pytest.raises(InvalidFile, match=name):
            load_motion(tmp_path / f"{name}{suffix}")
