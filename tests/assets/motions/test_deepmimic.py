"""Clips of 44 columns: every damage of a file, axes, avatars drawn z up and y up, and the same file again."""

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from avatarsim.assets.models.coordinates import coordinates_of
from avatarsim.assets.models.model import Model
from avatarsim.assets.motions.deepmimic import LAYOUT, Y_UP, read_clip
from avatarsim.assets.motions.load import load_motion
from avatarsim.errors import InvalidFile
from avatarsim.scene.avatar import Avatar
from avatarsim.scene.joint import Ball
from avatarsim.spatial import rotation
from scenarios.building.avatars.humanoid import humanoid
from scenarios.motion.mocap import clip_names, load_clip
from scenarios.motion.track import track_of
from tests.assets.motions.clips import figure, moving, upright, written
from tests.assets.motions.robots import driven, places, robot

NUMBER = st.floats(-3.0, 3.0)


@given(st.tuples(NUMBER, NUMBER, NUMBER, NUMBER), st.tuples(NUMBER, NUMBER, NUMBER))
def test_turning_and_changing_axes_commute(q: tuple[float, ...], vector: tuple[float, ...]) -> None:
    v = np.array(vector)
    if np.linalg.norm(q) < 1e-3:
        return
    turn = rotation.normalised(q)
    assert np.allclose(Y_UP.vectors(rotation.rotate(turn, v)), rotation.rotate(Y_UP.turned(turn), Y_UP.vectors(v)), atol=1e-9)
    # up becomes up, and the right side minus y
    assert np.array_equal(Y_UP.vectors(v), [v[0], -v[2], v[1]])


def begun(column: int, value: float) -> list[list[float]]:
    """Return two frames, of which the first has another number in a column."""
    first = upright()
    first[column] = value
    return [first, upright()]


@pytest.mark.parametrize(("frames", "says"), [
    ([upright(), upright()[:43]], "columns of frame 1.*43"), ([upright(), [*upright(), 0.0]], "columns of frame 1.*45"),
    ([upright(), "text"], "columns of frame 1.*str"), ([upright()], "number of frames.* 1"), ("none", "number of frames"),
    ([], "number of frames.* 0"), (begun(0, -0.1), "frame 0"), (begun(0, 1e300), "step in frame 0"),
    (begun(0, 1e-12), "step in frame 0"), (begun(2, 1e300), "place of the root in frame 0"),
    (begun(43, 1e9), "angle of left_elbow in frame 0"), (begun(4, 1e300), "length of the root quaternion in frame 0"),
    *(([upright(), [*upright()[:-1], value]], "frame 1|numbers of clip") for value in (float("nan"), "x", 10**400, None, [0.0])),
    ([upright(), [*upright()[:4], 0.0, *upright()[5:]]], "root quaternion in frame 1"),
])
def test_a_malformed_file_is_refused_by_name(tmp_path: Path, frames: object, says: str) -> None:
    with pytest.raises(InvalidFile, match=says) as caught:
        read_clip(written(tmp_path / "broken.txt", frames))
    assert "broken.txt" in str(caught.value) and caught.value.valid


def test_a_truncated_file_is_refused_by_name(tmp_path: Path) -> None:
    whole = written(tmp_path / "whole.txt", [upright(), upright()]).read_text(encoding="utf-8")
    (tmp_path / "half.txt").write_text(whole[: len(whole) // 2], encoding="utf-8")
    with pytest.raises(InvalidFile, match=r"half\.txt.*cut off.*44"):
        read_clip(tmp_path / "half.txt")
    with pytest.raises(InvalidFile, match=r"absent\.txt"):
        read_clip(tmp_path / "absent.txt")


@pytest.mark.parametrize("name", ["walk", "kick", "backflip"])
def test_the_harness_and_a_user_see_one_motion(name: str) -> None:
    assert name in clip_names()
    avatar = humanoid()
    model = Model(avatar, coordinates_of(avatar), (), ())
    clip = load_clip(name)
    from scenarios.data_folder import data_file

    file = load_motion(data_file(f"data/motions/humanoid3d_{name}.txt"))
    motion, track = file.motion(model), track_of(clip, avatar)
    assert (motion.times == clip.times).all()
    for part in ("positions", "angles"):
        assert (getattr(motion, part) == getattr(track, part)).all()
    # the file's own quaternions may change their sign from frame to frame
    assert (np.abs(motion.rotations) == np.abs(track.rotations)).all()
    assert ((motion.rotations * track.rotations).sum(axis=2) ** 2 > 0.99).all()
    again = json.loads(file.written(motion, model))
    assert again == json.loads(data_file(f"data/motions/humanoid3d_{name}.txt").read_text())


def test_a_figure_drawn_with_y_up_moves_as_one_drawn_with_z_up(tmp_path: Path) -> None:
    file = load_motion(written(tmp_path / "some.txt", moving(6)))
    tall, flat = figure(), figure(y_up=True)
    motions = [file.motion(model) for model in (tall, flat)]
    assert np.abs(places(tall, motions[0])[:, :13] - places(flat, motions[1])[:, :13]).max() < 1e-12
    assert np.abs(motions[0].rotations - motions[1].rotations).max() > 0.1


@pytest.mark.parametrize("flat", [False, True])
def test_unchanged_rows_keep_their_numbers_and_others_come_back(tmp_path: Path, flat: bool) -> None:
    rows, path, model = moving(6), tmp_path / "some.txt", figure(flat)
    path.write_text(json.dumps({"Loop": "none", "More": [1, {"a": None}], "Frames": rows}))
    file = load_motion(path)
    motion = file.motion(model)
    assert file.format == "deepmimic" and file.model() is None
    assert json.loads(file.written(motion, model)) == json.loads(path.read_text())
    rng = np.random.default_rng(3)
    rotations, positions, angles = motion.rotations.copy(), motion.positions.copy(), motion.angles.copy()
    turned = [0, *(k for k, (_, width) in enumerate(LAYOUT) if width == 4)]
    rotations[2:4, turned] = rotation.normalised(rotations[2:4, turned] + 0.1 * rng.normal(size=(2, len(turned), 4)))
    positions[2:4, 0] += 0.1
    angles[2:4, :4] -= 0.2
    changed = replace(motion, rotations=rotations, positions=positions, angles=angles)
    (tmp_path / "other.txt").write_bytes(file.written(changed, model))
    again = load_motion(tmp_path / "other.txt").motion(model)
    for part in ("positions", "angles"):
        assert np.abs(getattr(again, part) - getattr(changed, part)).max() < 1e-15, part
    products = (again.rotations * changed.rotations).sum(axis=2, keepdims=True)
    assert np.abs(again.rotations * np.sign(products) - changed.rotations).max() < 1e-15
    content = json.loads((tmp_path / "other.txt").read_text())
    assert content["Loop"] == "none" and (again.times == motion.times).all()
    assert [k for k, (now, was) in enumerate(zip(content["Frames"], rows, strict=True)) if now != was] == [2, 3]


def test_another_rate_has_equal_steps(tmp_path: Path) -> None:
    file = load_motion(written(tmp_path / "some.txt", moving(6)))
    motion = file.motion(figure()).resampled(60.0)
    (tmp_path / "other.txt").write_bytes(file.written(motion, figure()))
    again = load_motion(tmp_path / "other.txt").motion(figure())
    assert np.abs(again.times - motion.times).max() < 1e-12
    assert np.abs(places(figure(), again) - places(figure(), motion)).max() < 1e-12


def test_joints_that_a_clip_does_not_have_stay(tmp_path: Path) -> None:
    file = load_motion(written(tmp_path / "some.txt", moving(3)))
    assert (file.motion(figure()).angles[:, 4] == 0.0).all() and len(file.notes) == 1


def test_an_avatar_that_lacks_joints_is_refused_by_their_names(tmp_path: Path) -> None:
    file = load_motion(written(tmp_path / "some.txt", moving(3)))
    with pytest.raises(InvalidFile, match="missing: chest, neck, right_hip"):
        file.motion(robot())
    whole = driven(figure()).avatar
    stiff = Avatar("stiff", tuple(replace(link, joint=Ball()) if link.name == "left_knee" else link for link in whole.links))
    with pytest.raises(InvalidFile, match="joint left_knee for some.txt is 'ball'; valid: hinge"):
        file.motion(Model(stiff, coordinates_of(stiff), (), ()))
