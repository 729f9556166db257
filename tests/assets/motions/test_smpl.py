"""Bodies of the SMPL family: their kinematics against plain rotation matrices, every layout of entries, and written files."""

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from avatarsim.assets.models.smpl_skeleton import TREES, approximate, to_smpl_axes
from avatarsim.assets.motions.load import load_motion
from avatarsim.errors import InvalidFile, InvalidInput, UnknownName
from avatarsim.scene.motion import Motion
from avatarsim.scene.written import written as scene_data
from tests.assets.motions.robots import driven, entries, places, robot, saved, walk

FRAMES = 8
MEMBERS = {"SMPL": 72, "SMPL-H": 156, "SMPL-X": 165}
STANDING = np.array([0.5 * np.pi, 0.0, 0.0])
"""Rotation vector of an upright root: the family's y is the world's z."""


def amass(member: str = "SMPL-H", dtype: type = np.float64) -> dict[str, Any]:
    """Return entries as AMASS has them: an upright body that moves each joint a little."""
    rng = np.random.default_rng(0)
    width = MEMBERS[member]
    poses = 0.3 * np.sin(np.linspace(0.0, 2.0, FRAMES)[:, None] + rng.uniform(0.0, 6.0, width))
    poses[:, :3] = STANDING + 0.2 * poses[:, :3]
    trans = np.linspace([0.0, 0.0, 0.9], [0.5, -0.2, 0.95], FRAMES)
    return {"trans": trans.astype(dtype), "gender": np.array("female"), "mocap_framerate": np.array(120.0), "betas": np.zeros(16),
            "dmpls": np.ones((FRAMES, 8)), "poses": poses.astype(dtype)}


def parted() -> dict[str, Any]:
    """Return the same entries, also split into the parts of SMPL-X."""
    whole = amass("SMPL-X")
    poses = whole["poses"]
    return {**whole, "root_orient": poses[:, :3], "pose_body": poses[:, 3:66], "pose_jaw": poses[:, 66:69],
            "pose_eye": poses[:, 69:75], "pose_hand": poses[:, 75:], "mocap_frame_rate": np.array(120)}


def parts_alone() -> dict[str, Any]:
    return {key: values for key, values in parted().items() if key not in ("poses", "mocap_framerate")}


def joints_by_matrices(poses: np.ndarray, trans: np.ndarray, rest: np.ndarray, member: str) -> np.ndarray:
    """Return places (F, joints, 3) in the file's own world, by rotation matrices down the tree."""
    found = np.empty((len(poses), len(rest), 3))
    for frame, pose in enumerate(poses.reshape(len(poses), -1, 3)):
        turned: list[Rotation] = []
        for k, (_, parent) in enumerate(TREES[member]):
            own = Rotation.from_rotvec(pose[k])
            turned.append(own if parent < 0 else turned[parent] * own)
            if parent < 0:
                found[frame, k] = rest[0] + trans[frame]
            else:
                found[frame, k] = found[frame, parent] + turned[parent].apply(rest[k] - rest[parent])
    return found


def rest_joints(member: str) -> np.ndarray:
    """Return joints at rest in the family's axes, and further rows as model files have them."""
    skeleton, pelvis = approximate(member, 1.8)
    return to_smpl_axes(skeleton.rest[: len(skeleton.bones)] * np.array([1.0, 1.1, 1.0])) + pelvis


@pytest.mark.parametrize("member", MEMBERS)
@pytest.mark.parametrize("up", ["z", "y"])
@pytest.mark.parametrize("exact", [True, False])
def test_joints_are_where_matrices_put_them(tmp_path: Path, member: str, up: str, exact: bool) -> None:
    arrays = amass(member)
    joints = rest_joints(member)
    options: dict[str, Any] = {"up": up}
    if exact:
        options["offsets"] = saved(tmp_path / "model.npz", {"J": joints})
    else:
        skeleton, pelvis = approximate(member)
        joints = to_smpl_axes(skeleton.rest[: len(skeleton.bones)]) + pelvis
    found = load_motion(saved(tmp_path / "some.npz", arrays), **options)
    model = driven(found.model())
    shown = places(model, found.motion(model))
    expected = joints_by_matrices(arrays["poses"], arrays["trans"], joints, member)
    if up == "y":
        expected = np.stack([expected[..., 0], -expected[..., 2], expected[..., 1]], axis=-1)
    assert np.abs(shown - expected).max() < 1e-12
    assert np.allclose(found.motion(model).times, np.arange(FRAMES) / 120.0)


def test_ranges_and_allowed_depths_are_the_same_for_every_clip(tmp_path: Path) -> None:
    arrays = amass()
    bent = arrays | {"poses": arrays["poses"] + np.linspace(0.0, 1.2, 156)}
    files = [saved(tmp_path / f"{k}.npz", own) for k, own in enumerate((arrays, bent))]
    one, other = (scene_data(driven(load_motion(file).model()).avatar) for file in files)
    assert one == other and one["at_rest"]


FORMS: dict[str, Callable[[], dict[str, Any]]] = {
    **{member: lambda member=member: amass(member) for member in MEMBERS},  # type: ignore[misc]
    "parts beside the whole": parted, "parts alone": parts_alone, "float32": lambda: amass(dtype=np.float32),
}


def bent(motion: Motion, link: int, first: int, last: int) -> Motion:
    """Return the motion with a ball turned and the root lifted from one frame to another."""
    rotations, positions = motion.rotations.copy(), motion.positions.copy()
    turn = Rotation.from_rotvec([0.1, 0.3, -0.2])
    for frame in range(first, last + 1):
        rotations[frame, link] = (Rotation.from_quat(rotations[frame, link], scalar_first=True) * turn).as_quat(scalar_first=True)
        positions[frame, 0, 2] += 0.1
    return replace(motion, rotations=rotations, positions=positions)


@pytest.mark.parametrize("form", FORMS)
def test_bodies_are_written_bit_for_bit_where_nothing_moved(tmp_path: Path, form: str) -> None:
    arrays = FORMS[form]()
    found = load_motion(saved(tmp_path / "some.npz", arrays))
    model = driven(found.model())
    written = entries(found.written(found.motion(model), model))
    assert list(written) == list(arrays)
    for key, values in arrays.items():
        assert written[key].dtype == values.dtype and written[key].tobytes() == values.tobytes()
    for link in (0, 5, 20):
        changed = bent(found.motion(model), link, 2, 4)
        (tmp_path / "other.npz").write_bytes(found.written(changed, model))
        again = load_motion(tmp_path / "other.npz").motion(model)
        fine = 3e-7 if form == "float32" else 1e-12
        assert np.abs(places(model, again) - places(model, changed)).max() < 4.0 * fine
        written = entries((tmp_path / "other.npz").read_bytes())
        for key, values in arrays.items():
            moves = key in ("poses", "trans", "root_orient", "pose_body")
            same = (written[key] == values).all(axis=1)[[0, 1, 5, 6, 7]] if moves else written[key] == values
            assert written[key].dtype == values.dtype and np.all(same), key
        if "poses" in arrays:
            others = np.delete(np.arange(arrays["poses"].shape[1]), np.arange(3 * link, 3 * link + 3))
            assert (written["poses"][:, others] == arrays["poses"][:, others]).all()


def test_another_rate_is_written_with_its_rate(tmp_path: Path) -> None:
    found = load_motion(saved(tmp_path / "some.npz", amass() | {"joints": np.zeros((FRAMES, 52, 3))}))
    model = driven(found.model())
    motion = found.motion(model).resampled(240.0)
    (tmp_path / "other.npz").write_bytes(found.written(motion, model))
    written = entries((tmp_path / "other.npz").read_bytes())
    assert written["mocap_framerate"] == 240.0 and "dmpls" not in written and "joints" not in written
    again = load_motion(tmp_path / "other.npz").motion(model)
    assert np.abs(again.times - motion.times).max() < 1e-12
    assert np.abs(places(model, again) - places(model, motion)).max() < 1e-12


@pytest.mark.parametrize(("change", "says"), [
    ({"poses": np.zeros((FRAMES, 66))}, "columns of poses of some.npz is 66.*156"),
    ({"poses": np.zeros((FRAMES, 157))}, "columns of poses"),
    ({"poses": np.full((FRAMES, 156), np.nan)}, "column 0 of frame 0 of poses"),
    ({"poses": np.zeros((FRAMES, 52, 3))}, "shape of poses"),
    ({"trans": np.zeros((FRAMES + 1, 3))}, "frames of trans"),
    ({"trans": np.full((FRAMES, 3), 1e300)}, "place of the root in frame 0"),
    ({"poses": np.full((FRAMES, 156), 1e300)}, "turn of pelvis in frame 0"),
    ({"mocap_framerate": np.array(0.0)}, "frames a second"),
    ({"poses": np.array([{}], dtype=object)}, "poses in some.npz.*pickle"),
])
def test_files_that_do_not_fit_end_in_a_sentence(tmp_path: Path, change: dict[str, Any], says: str) -> None:
    with pytest.raises(InvalidFile, match=says):
        load_motion(saved(tmp_path / "some.npz", amass() | change))


@pytest.mark.parametrize(("joints", "says"), [
    (np.zeros((52, 3)), "height of J"), (np.zeros((40, 3)), "J of model.npz"), (np.full((52, 3), 1e3), "J of model.npz"),
    (np.full((52, 3), np.nan), "J in model.npz"),
])
def test_rest_joints_that_are_none_are_refused(tmp_path: Path, joints: np.ndarray, says: str) -> None:
    model = saved(tmp_path / "model.npz", {"J": joints})
    with pytest.raises(InvalidFile, match=says):
        load_motion(saved(tmp_path / "some.npz", amass()), offsets=model)


def test_another_avatar_is_refused_by_its_joints(tmp_path: Path) -> None:
    found = load_motion(saved(tmp_path / "some.npz", amass()))
    with pytest.raises(InvalidFile, match="balls called pelvis.*others than these: waist"):
        found.motion(robot())


def test_options_of_the_other_kind_are_refused(tmp_path: Path) -> None:
    body, trajectory = saved(tmp_path / "body.npz", amass()), saved(tmp_path / "robot.npz", {"qpos": walk(3), "fps": 30})
    with pytest.raises(InvalidInput, match="quaternion.*rate, offsets"):
        load_motion(body, quaternion="wxyz")
    with pytest.raises(InvalidInput, match="stature.*rate, quaternion"):
        load_motion(trajectory, stature=1.7)
    with pytest.raises(UnknownName, match="up"):
        load_motion(body, up="x")
