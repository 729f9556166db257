"""BVH files: places of joints, guesses and their notes, and the same file again."""

import re
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray
from pymotion.io.bvh import BVH
from pymotion.ops.skeleton import fk

from avatarsim.assets.motions.bvh import BvhFile, read_bvh
from avatarsim.errors import InvalidFile, InvalidInput
from avatarsim.scene.motion import Motion
from avatarsim.scene.written import written as scene_data
from avatarsim.spatial import rotation
from tests.assets.motions.files import WALKER, bvh
from tests.assets.motions.robots import places
from tests.assets.motions.twins import bvh_places

Array = NDArray[np.float64]

SIX = "CHANNELS 6 Xposition Yposition Zposition Zrotation Yrotation Xrotation"


def rows(frames: int = 6, spread: float = 25.0, seed: int = 1) -> Array:
    """Return rows of a walker that is 90 cm high at its root and moves about."""
    found = np.random.default_rng(seed).normal(0.0, spread, (frames, 30))
    found[:, :3] = np.linspace((0.0, 90.0, 0.0), (40.0, 92.0, 10.0), frames)
    return found


def written(folder: Path, text: str, name: str = "walker.bvh") -> Path:
    path = folder / name
    path.write_bytes(text.encode())
    return path


def world(file: BvhFile) -> Array:
    """Return places (F, links, 3) [m] of all joints."""
    model = file.model()
    return places(model, file.motion(model))


def test_joints_are_where_another_library_has_them(tmp_path: Path) -> None:
    path = written(tmp_path, bvh(WALKER, rows(spread=60.0)))
    other = BVH()
    other.load(str(path))
    turns, roots, parents, offsets, _, _ = other.get_data()
    theirs, _ = fk(turns, roots[:, 0], np.where(np.arange(len(offsets))[:, None] == 0, 0.0, offsets), parents)
    assert np.abs(world(read_bvh(path, scale=0.01, up="z")) - 0.01 * theirs).max() < 1e-6


def test_the_avatar_does_not_depend_on_where_the_clip_is_cut(tmp_path: Path) -> None:
    values = rows(spread=60.0)
    files = [read_bvh(written(tmp_path, bvh(WALKER, some)), scale=0.01, up="y") for some in (values, values[2:], values[4:5])]
    one, two, three = (scene_data(file.model().avatar) for file in files)
    assert one == two == three


def test_what_is_moved_is_written_and_the_rest_is_not(tmp_path: Path) -> None:
    """A turned arm and a lifted root come back to 1e-9, on the turn of the original; all other columns keep their bits."""
    values = rows()
    values[:, 15:18] += 720.0
    file = read_bvh(written(tmp_path, bvh(WALKER, values)))
    model, own = file.model(), file.recording.motion
    rotations, positions = own.rotations.copy(), own.positions.copy()
    rotations[2, 4] = rotation.multiply(rotations[2, 4], rotation.from_axis_angle((0.0, 0.6, 0.8), np.array(0.3)))
    positions[3, 0, 2] += 0.01
    moved = Motion(own.times, positions, rotations, own.angles)
    back = read_bvh(written(tmp_path, file.written(moved, model).decode(), "again.bvh"), scale=0.01, up="y")
    changed = back.recording.values != file.recording.values
    assert {tuple(at) for at in np.argwhere(changed)} <= {(2, 15), (2, 16), (2, 17), (3, 1), (3, 0), (3, 2)} and changed[2].any()
    assert np.abs(back.recording.values - file.recording.values)[2, 15:18].max() < 180.0
    assert np.abs(back.recording.motion.positions - positions).max() < 1e-12
    off = rotation.multiply(rotation.conjugate(rotations), back.recording.motion.rotations)
    assert np.linalg.norm(off[..., 1:], axis=-1).max() < 1e-9


def test_a_resampled_motion_has_its_own_frame_time(tmp_path: Path) -> None:
    file = read_bvh(written(tmp_path, bvh(WALKER, rows(13), step="0.01")))
    model = file.model()
    half = file.motion(model).resampled(50.0)
    back = read_bvh(written(tmp_path, file.written(half, model).decode(), "half.bvh"))
    assert len(back.recording.values) == 7 and back.recording.step == pytest.approx(0.02)
    assert (back.recording.values == file.recording.values[::2]).all()
    third = file.motion(model).resampled(75.0)
    back = read_bvh(written(tmp_path, file.written(third, model).decode(), "third.bvh"))
    off = rotation.multiply(rotation.conjugate(third.rotations), back.recording.motion.rotations)
    assert np.linalg.norm(off[..., 1:], axis=-1).max() < 1e-9
    uneven = Motion(np.array([0.0, 0.1, 0.3]), *(array[:3] for array in (half.positions, half.rotations, half.angles)))
    with pytest.raises(InvalidInput, match="steps of a motion .*valid: equal steps"):
        file.written(uneven, model)


@pytest.mark.parametrize("scale", [1.0, 0.01, 0.0254, 0.0254 / 0.45])
@pytest.mark.parametrize("up", ["y", "z"])
def test_unit_and_up_are_guessed(tmp_path: Path, scale: float, up: str) -> None:
    def scaled(found: re.Match[str]) -> str:
        return "OFFSET " + " ".join(str(0.01 / scale * float(word)) for word in found[1].split())

    hierarchy = re.sub("OFFSET (.*)", scaled, WALKER)
    values = rows(spread=5.0)
    values[:, :3] *= 0.01 / scale
    if up == "z":
        values[:, 5] += 90.0
        values[:, 3:5] = 0.0
    file = read_bvh(written(tmp_path, bvh(hierarchy, values)))
    assert file.recording.axes.scale == pytest.approx(scale) and file.recording.axes.up == up and len(file.notes) >= 2
    heights = world(file)[:, :, 2]
    assert (heights[:, 2] > heights[:, 7] + 1.2).all(), "the head is above the foot"


def test_what_is_asked_for_is_not_guessed(tmp_path: Path) -> None:
    file = read_bvh(written(tmp_path, bvh(WALKER, rows())), scale=0.02, up="z")
    assert file.notes == () and file.recording.axes.scale == 0.02
    with pytest.raises(InvalidFile, match="height of the skeleton of walker.bvh is .*valid: a standing human of 1.2 to 2.2 m"):
        read_bvh(written(tmp_path, bvh(WALKER.replace("OFFSET 0 -42 0", "OFFSET 0 -420 0"), rows())), up="y")
    for wrong in ({"scale": -1.0}, {"scale": float("nan")}, {"up": "x"}, {"offsets": "any"}):
        with pytest.raises(InvalidFile):
            read_bvh(written(tmp_path, bvh(WALKER, rows())), **wrong)


def six(joint: str, offset: str) -> str:
    """Return the walker with six channels at a joint that has three."""
    before = WALKER[: WALKER.index(f"JOINT {joint}\n")]
    after = WALKER[len(before) :].replace("CHANNELS 3 ", "CHANNELS 6 Xposition Yposition Zposition ", 1)
    return before + after.replace(after.split("OFFSET ")[1].split("\n")[0], offset, 1)


def test_places_below_the_root_are_offsets_if_they_stay(tmp_path: Path) -> None:
    values = np.insert(rows(), [6, 6, 6], [1.0, 10.5, 0.0], axis=1)
    file = read_bvh(written(tmp_path, bvh(six("Spine", "0 3 0"), values)))
    assert file.recording.skeleton.bones[1].offset == pytest.approx((0.01, 0.0, 0.105))
    model = file.model()
    back = read_bvh(written(tmp_path, file.written(file.motion(model), model).decode(), "again.bvh"))
    assert (back.recording.values == values).all()
    added = read_bvh(written(tmp_path, bvh(six("Spine", "0 10 0"), np.insert(rows(), [6, 6, 6], 0.0, axis=1))))
    assert added.recording.skeleton.bones[1].offset == pytest.approx((0.0, 0.0, 0.1))


def test_places_that_vary_are_refused_or_meant(tmp_path: Path) -> None:
    values = np.insert(rows(), [6, 6, 6], np.array([[0.0, 10.0, 0.0], [0.0, 12.0, 0.0]] * 3), axis=1)
    path = written(tmp_path, bvh(six("Spine", "0 10 0"), values))
    with pytest.raises(InvalidFile, match=r"way of Spine on its parent in walker.bvh \[m\] is 0.02; valid: .*offsets=\"mean\""):
        read_bvh(path)
    file = read_bvh(path, offsets="mean")
    assert file.recording.skeleton.bones[1].offset == pytest.approx((0.0, 0.0, 0.11))


def test_hips_that_are_carried_about_are_the_root(tmp_path: Path) -> None:
    body = WALKER[WALKER.index("ROOT") :].replace("ROOT Hips", "JOINT Hips")
    carrier = "HIERARCHY\nROOT Root\n{\nOFFSET 0 0 0\nCHANNELS 6 Xposition Yposition Zposition Zrotation Xrotation Yrotation\n"
    moves = np.random.default_rng(3).normal(0.0, 20.0, (6, 6))
    text = bvh(f"{carrier}{body}}}\n", np.concatenate([moves, rows()], axis=1))
    file = read_bvh(written(tmp_path, text), scale=0.01, up="z")
    assert file.model().avatar.links[0].name == "Hips"  # type: ignore[union-attr]
    where = world(file)
    for k, frame in enumerate(bvh_places(text)):
        assert np.abs(where[k] - 0.01 * np.stack(list(frame.values())[1:])).max() < 1e-12
    own = file.recording.motion
    moved = Motion(own.times, own.positions + 0.02, own.rotations, own.angles)
    back = read_bvh(written(tmp_path, file.written(moved, file.model()).decode(), "again.bvh"), scale=0.01, up="z")
    assert np.abs(world(back) - where - 0.02).max() < 1e-12
    assert (back.recording.values[:, :6] == moves).all()


def test_other_ways_to_write_it_are_read(tmp_path: Path) -> None:
    plain = bvh(WALKER, rows())
    expected = read_bvh(written(tmp_path, plain)).recording
    odd = plain.replace("\n", "\r\n").rstrip().replace("JOINT Spine\r\n\t{", "JOINT Spine {").replace("Xposition", "XPOSITION")
    odd = odd.replace("Frame Time: 0.008333", "Frame Time:\t8.333e-3").replace("HIERARCHY", "\r\n\r\nHierarchy ")
    file = read_bvh(written(tmp_path, odd, "odd.BVH"))
    assert (file.recording.values == expected.values).all() and file.recording.step == expected.step
    assert file.recording.skeleton.bones == expected.skeleton.bones
    again = file.written(file.motion(file.model()), file.model())
    assert again.count(b"\r\n") == again.count(b"\n") and b"8.333e-3" in again


@pytest.mark.parametrize("encoding", ["latin-1", "utf-8", "utf-8-sig"])
def test_names_of_any_encoding_come_back(tmp_path: Path, encoding: str) -> None:
    content = bvh(WALKER.replace("Spine", "R\xfccken 1"), rows()).encode(encoding)
    path = tmp_path / "named.bvh"
    path.write_bytes(content)
    file = read_bvh(path)
    assert file.recording.skeleton.bones[1].name == "R\xfccken 1"
    assert file.written(file.motion(file.model()), file.model()) == content


def test_a_root_says_only_what_it_has_channels_for(tmp_path: Path) -> None:
    hierarchy = WALKER.replace(SIX, "CHANNELS 1 Yposition")
    file = read_bvh(written(tmp_path, bvh(hierarchy, rows()[:, 5:])), scale=0.01, up="y")
    model, own = file.model(), file.recording.motion
    up = Motion(own.times, own.positions + [0.0, 0.0, 0.1], own.rotations, own.angles)
    back = read_bvh(written(tmp_path, file.written(up, model).decode(), "up.bvh"), scale=0.01, up="y")
    assert np.abs(back.recording.motion.positions - up.positions)[:, 0].max() < 1e-12
    with pytest.raises(InvalidInput, match="way of Hips along x"):
        file.written(Motion(own.times, own.positions + [0.1, 0.0, 0.0], own.rotations, own.angles), model)
    turned = rotation.multiply(rotation.from_axis_angle((0.0, 0.0, 1.0), np.array(0.1)), own.rotations)
    with pytest.raises(InvalidInput, match=r"turn of Hips \[rad\] is 0.1"):
        file.written(Motion(own.times, own.positions, turned, own.angles), model)


def test_another_avatar_is_refused_by_its_first_joint(tmp_path: Path) -> None:
    file = read_bvh(written(tmp_path, bvh(WALKER, rows())))
    other = read_bvh(written(tmp_path, bvh(WALKER.replace("LeftLeg", "Shin"), rows()), "other.bvh")).model()
    with pytest.raises(InvalidFile, match="link 6 of the avatar for walker.bvh is 'Shin'; valid: LeftLeg"):
        file.motion(other)
    fewer = bvh(WALKER.replace("CHANNELS 3 Yrotation Zrotation Xrotation", "CHANNELS 2 Yrotation Xrotation"), rows()[:, 1:])
    with pytest.raises(InvalidFile, match="joint of LeftLeg"):
        file.written(file.recording.motion, read_bvh(written(tmp_path, fewer, "fewer.bvh")).model())
