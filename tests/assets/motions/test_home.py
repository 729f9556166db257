"""Home of recorded skeletons that are folded at rest: one verdict on a frame, wherever its clip is cut, and refusals."""

from pathlib import Path

import numpy as np
import pytest

import avatarsim as av
from avatarsim.assets.motions.bvh import read_bvh
from avatarsim.cleaning import Audit, Options, audit
from avatarsim.scene.written import written as scene_data
from tests.assets.motions.files import joint
from tests.assets.motions.folded import FRAMES, hierarchy, rows, written


def judged(path: Path, home: object = None) -> tuple[av.Model, Audit]:
    file = read_bvh(path, home=home)  # type: ignore[arg-type]
    return file.model(), audit(file.motion(file.model()), file.model(), (), Options(opinion=False))


@pytest.mark.parametrize("home", ["whole.bvh", "whole.bvh:3"])
@pytest.mark.parametrize("cut", [slice(0, 12), slice(9, 30), slice(14, 16), slice(15, 16)])
def test_a_frame_is_judged_the_same_wherever_its_clip_is_cut(tmp_path: Path, cut: slice, home: str) -> None:
    whole, part = written(tmp_path, "whole.bvh", rows()), written(tmp_path, "part.bvh", rows()[cut])
    model, before = judged(whole, 3 if ":" in home else None)
    own, found = judged(part, tmp_path / home)
    assert before.overlapping > 3 and model.avatar is not None and own.avatar is not None
    assert scene_data(model.avatar)["links"] == scene_data(own.avatar)["links"]
    assert model.avatar.at_rest == own.avatar.at_rest and model.avatar.at_rest
    assert (before.depths[cut] == found.depths).all()
    assert (before.proven[cut.start : cut.stop - 1] == found.proven).all()


def test_a_folded_skeleton_states_the_frame_taken_as_home(tmp_path: Path) -> None:
    whole = written(tmp_path, "whole.bvh", rows())
    model, _ = judged(whole)
    frame = int(np.argmin(np.abs(rows()[:, 6])))
    assert sum(f"whole.bvh:{frame}" in note for note in read_bvh(whole).notes) == 1
    assert scene_data(judged(whole, frame)[0].avatar) == scene_data(model.avatar)
    assert scene_data(judged(whole, f"{whole}:{frame}")[0].avatar) == scene_data(model.avatar)
    assert scene_data(judged(whole, 0)[0].avatar) != scene_data(model.avatar)
    assert not any("home" in note for note in read_bvh(whole, home=frame).notes)


def test_joints_with_own_places_lie_where_the_home_has_them(tmp_path: Path) -> None:
    """A constant place, whose mean is rounded differently in each cut."""
    text = hierarchy().replace("CHANNELS 3 Zrotation", "CHANNELS 6 Xposition Yposition Zposition Zrotation")
    old = rows()
    offsets = ((0.0, 0.1, 0.0), (0.0, 0.45, 0.0), *((x, 0.0, 0.0) if k == 0 else (0.0, 0.42, 0.0)
               for x in (0.09, -0.09) for k in range(3)))
    wide = [old[:, :6]]
    for k, offset in enumerate(offsets):
        wide += [np.tile(np.array(offset) / 3.0 * 3.0 + 1e-9 / 3.0, (FRAMES, 1)), old[:, 6 + 3 * k : 9 + 3 * k]]
    values = np.concatenate(wide, axis=1)
    whole, part = written(tmp_path, "w.bvh", values, text), written(tmp_path, "p.bvh", values[11:14], text)
    (model, before), (own, found) = judged(whole), judged(part, whole)
    assert scene_data(model.avatar)["links"] == scene_data(own.avatar)["links"]
    assert (before.depths[11:14] == found.depths).all() and found.overlapping > 0


@pytest.mark.parametrize("home", [FRAMES, -1, True, 1.5, "", "x", "walk", "12.5", ":3", "w.csv", ("a.bvh", 3), 10**9])
def test_a_home_that_is_none_is_refused(tmp_path: Path, home: object) -> None:
    with pytest.raises(av.InvalidInput) as found:
        read_bvh(written(tmp_path, "w.bvh", rows()), home=home)  # type: ignore[arg-type]
    assert "home" in found.value.thing and found.value.valid


def test_refuses_a_home_that_does_not_stand_or_is_missing(tmp_path: Path) -> None:
    values = rows()
    values[4, 12:30] = 0.0
    path = written(tmp_path, "w.bvh", values)
    with pytest.raises(av.InvalidInput, match="frame 4"):
        read_bvh(path, home=4, scale=1.0, up="y")
    with pytest.raises(av.InvalidInput, match=r"none\.bvh"):
        read_bvh(path, home=tmp_path / "none.bvh")
    with pytest.raises(av.InvalidInput, match=str(FRAMES)):
        read_bvh(path, home=f"{path}:{FRAMES}")


@pytest.mark.parametrize(("text", "values", "names"), [
    (hierarchy(shin=0.44), rows(), "offset of LeftFoot"), (hierarchy(shank="Shin"), rows(), "LeftShin"),
    (hierarchy(channels="XYZ"), rows(), "axes"), (hierarchy(more=joint("Tail", "0 0 0.1", "XYZ")), rows(33), "joints"),
])
def test_another_skeleton_is_refused_by_what_differs(tmp_path: Path, text: str, values: np.ndarray, names: str) -> None:
    other, path = written(tmp_path, "other.bvh", values, text), written(tmp_path, "w.bvh", rows())
    with pytest.raises(av.InvalidInput) as found:
        read_bvh(path, home=other)
    assert names in found.value.thing and "other.bvh" in found.value.thing
