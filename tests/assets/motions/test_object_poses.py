"""The object of an archive: its poses in each form, its name, and refusals."""

from pathlib import Path

import numpy as np
import pytest

from avatarsim.assets.motions.carried_object import load_object
from avatarsim.assets.motions.load import load_motion
from avatarsim.errors import InvalidFile
from avatarsim.scene.shape import Box
from avatarsim.spatial import rotation
from tests.assets.motions.robots import JOINTS, entries, robot, saved, walk

FRAMES = 9
PLACES = np.linspace([0.3, 0.0, 1.0], [0.5, 0.2, 1.1], FRAMES)
TURNS = rotation.from_axis_angle((0.0, 0.6, 0.8), np.linspace(0.0, 1.0, FRAMES))


def clip(path: Path, **others: object) -> Path:
    """Return a trajectory of the robot with these additional entries."""
    return saved(path / "carry.npz", {"fps": 50, "joint_pos": walk(FRAMES), "joint_names": JOINTS, **others})


@pytest.mark.parametrize(("places", "turns", "options"), [
    (("object_pos_w", PLACES), ("object_quat_w", TURNS), {}),
    (("object_pos_w", PLACES[:, None]), ("object_quat_w", -TURNS[:, None]), {}),
    (("obj_trans", PLACES[:, :, None]), ("obj_rot", rotation.to_matrix(TURNS)), {}),
    (("object_pos", PLACES), ("object_rot", np.roll(TURNS, -1, axis=1)), {"quaternion": "xyzw"}),
])
def test_poses_in_each_form(tmp_path: Path, places: tuple, turns: tuple, options: dict) -> None:
    found = load_motion(clip(tmp_path, **dict([places, turns])), **options).object
    assert found is not None and found.name == "object" and found.size is None and found.scale is None
    assert found.motion.positions[:, 0] == pytest.approx(PLACES) and len(found.motion) == FRAMES
    assert rotation.to_matrix(found.motion.rotations[:, 0]) == pytest.approx(rotation.to_matrix(TURNS), abs=1e-12)


def test_a_clip_without_an_object_has_none(tmp_path: Path) -> None:
    assert load_motion(clip(tmp_path)).object is None


@pytest.mark.parametrize(("entry", "match"), [
    ({"object_pos_w": PLACES}, "object in"),
    ({"object_pos_w": PLACES[:4], "object_quat_w": TURNS}, "shape of object_pos_w"),
    ({"object_pos_w": np.stack([PLACES, PLACES], axis=1), "object_quat_w": TURNS}, "one object"),
    ({"object_pos_w": PLACES, "object_quat_w": TURNS[:, :3]}, "shape of object_quat_w"),
    ({"object_pos_w": PLACES, "object_quat_w": 0.0 * TURNS}, "length of the quaternions"),
    ({"object_pos_w": PLACES, "obj_rot": 2.0 * rotation.to_matrix(TURNS)}, "difference of obj_rot"),
    ({"object_pos_w": PLACES * np.nan, "object_quat_w": TURNS}, "object_pos_w"),
    ({"object_pos_w": PLACES * 1e12, "object_quat_w": TURNS}, "place of the object"),
    ({"object_pos_w": PLACES, "object_quat_w": TURNS, "object_size": (1.0, -1.0, 1.0)}, "object_size"),
    ({"object_pos_w": PLACES, "object_quat_w": TURNS, "obj_scale": np.linspace(1.0, 2.0, FRAMES)}, "obj_scale"),
    ({"object_pos_w": PLACES, "object_quat_w": TURNS, "object_name": 7}, "object_name"),
])
def test_what_is_no_pose_is_refused_by_its_entry(tmp_path: Path, entry: dict, match: str) -> None:
    with pytest.raises(InvalidFile, match=match):
        load_motion(clip(tmp_path, **entry))


def test_a_shape_comes_from_the_size_or_from_a_file(tmp_path: Path) -> None:
    poses = {"object_pos_w": PLACES, "object_quat_w": TURNS}
    sized = load_motion(clip(tmp_path, **poses, object_size=(0.2, 0.3, 0.4), object_name="crate")).object
    assert sized is not None
    box = load_object(sized)
    assert isinstance(shape := box.body.links[0].pieces[0].shape, Box) and shape.size == pytest.approx((0.2, 0.3, 0.4))
    assert box.body.name == "crate" and box.body.links[0].anchor == pytest.approx(PLACES[0])
    (tmp_path / "cube.xml").write_text(
        '<mujoco><worldbody><body pos="9 9 9"><freejoint/><geom type="box" size="1 2 3" pos="1 0 0"/></body></worldbody></mujoco>'
    )
    plain = load_motion(clip(tmp_path, **poses, obj_scale=np.full(FRAMES, 0.1))).object
    assert plain is not None
    with pytest.raises(InvalidFile, match="shape of object"):
        load_object(plain)
    piece = load_object(plain, tmp_path / "cube.xml").body.links[0].pieces[0]
    assert isinstance(piece.shape, Box) and piece.shape.size == pytest.approx((0.2, 0.4, 0.6))
    assert piece.position == pytest.approx((0.1, 0.0, 0.0))
    assert load_object(plain, tmp_path / "cube.xml", scale=1.0).body.links[0].pieces[0].position == pytest.approx((1.0, 0.0, 0.0))


@pytest.mark.parametrize("turns", [TURNS, rotation.to_matrix(TURNS)])
def test_object_poses_are_written_back_and_resampled(tmp_path: Path, turns: np.ndarray) -> None:
    path = clip(tmp_path, object_pos_w=PLACES, object_quat_w=turns, object_lin_vel_w=0.0 * PLACES)
    file, model = load_motion(path), robot()
    motion = file.motion(model)
    same = entries(file.written(motion, model))
    assert np.array_equal(same["object_pos_w"], PLACES) and np.array_equal(same["object_quat_w"], turns)
    other = entries(file.written(motion.resampled(100.0), model))
    (tmp_path / "again.npz").write_bytes(file.written(motion.resampled(100.0), model))
    assert len(other["object_pos_w"]) == 2 * FRAMES - 1 and "object_lin_vel_w" not in other
    again, before = load_motion(tmp_path / "again.npz").object, file.object
    assert again is not None and before is not None
    assert again.motion.positions == pytest.approx(before.motion.resampled(100.0).positions, abs=1e-12)
    assert again.motion.rotations == pytest.approx(before.motion.resampled(100.0).rotations, abs=1e-9)
