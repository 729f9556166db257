"""Robot trajectories in archives: the conventions of several tools, joints by name, and written entries other than the pose."""

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from avatarsim.assets.models.coordinates import Coordinates, Slot
from avatarsim.assets.models.model import Model
from avatarsim.assets.motions.load import load_motion
from avatarsim.assets.motions.matching import Layout, columns, coordinates_of_model
from avatarsim.errors import InvalidFile
from avatarsim.scene.motion import Motion
from avatarsim.scene.tracker import poses_of_links
from avatarsim.spatial import rotation
from tests.assets.motions.robots import JOINTS, driven, entries, held, puppet, robot, saved, walk

FRAMES = 40
XYZW = [0, 1, 2, 4, 5, 6, 3]
"""Columns of a root whose quaternion is written x, y, z, w."""


def bodies(model: Model, motion: Motion) -> tuple[np.ndarray, np.ndarray]:
    """Return poses of the world, the robot's links, and a badge on its torso that its model does not have."""
    places, turns = poses_of_links((driven(model).avatar,), motion.positions, motion.rotations, motion.angles)
    frames = len(motion)
    badge = places[:, 1:2] + rotation.rotate(turns[:, 1:2], np.array([0.1, 0.0, 0.05]))
    still = np.tile(np.array(rotation.IDENTITY), (frames, 1, 1))
    origin = np.zeros((frames, 1, 3))
    return np.concatenate([origin, places, badge], axis=1), np.concatenate([still, turns, turns[:, 1:2]], axis=1)


def holosoma() -> dict[str, Any]:
    q = walk(FRAMES)
    model = robot()
    motion = model.coordinates.motion(q, np.arange(FRAMES) / 50.0)
    places, turns = bodies(model, motion)
    times = motion.times
    return {
        "fps": np.array([50]), "joint_pos": q,
        "joint_vel": np.c_[np.gradient(q[:, :3], times, axis=0), spin(q[:, 3:7], times), np.gradient(q[:, 7:], times, axis=0)],
        "body_pos_w": places, "body_quat_w": turns, "body_lin_vel_w": np.gradient(places, times, axis=0),
        "body_ang_vel_w": np.stack([spin(turns[:, k], times) for k in range(turns.shape[1])], axis=1),
        "joint_names": np.array(JOINTS), "body_names": np.array(["world", *(link.name for link in model.avatar.links), "badge"]),
        "contact": np.arange(FRAMES) % 2 == 0,
    }


def spin(turns: np.ndarray, times: np.ndarray) -> np.ndarray:
    """Return angular velocities in the world, by central differences of neighbours."""
    found = np.empty((len(turns), 3))
    for k in range(len(turns)):
        a, b = max(k - 1, 0), min(k + 1, len(turns) - 1)
        found[k] = rotation.to_rotation_vector(rotation.multiply(turns[b], rotation.conjugate(turns[a]))) / (times[b] - times[a])
    return found


def gmr(dtype: Any = np.float64) -> dict[str, Any]:
    q = walk(FRAMES)[:, [*XYZW, 7, 8, 9, 10]].astype(dtype)
    return {"fps": 50.0, "root_pos": q[:, :3], "root_rot": q[:, 3:7], "dof_pos": q[:, 7:]}


def isaac() -> dict[str, Any]:
    whole = holosoma()
    order = [3, 1, 0, 2]
    return {
        "fps": 50, "dof_names": np.array([JOINTS[k] for k in order]), "dof_positions": whole["joint_pos"][:, 7:][:, order],
        "body_names": whole["body_names"][1:], "body_positions": whole["body_pos_w"][:, 1:],
        "body_rotations": whole["body_quat_w"][:, 1:],
    }


def beyond() -> dict[str, Any]:
    """Return joints in an order of their own and no names; the root is the first of the bodies."""
    whole = isaac()
    bodies = {"body_pos_w": whole["body_positions"], "body_quat_w": whole["body_rotations"]}
    return {"fps": [50], "joint_pos": whole["dof_positions"], **bodies}


def reordered() -> dict[str, Any]:
    whole, order = holosoma(), [2, 0, 3, 1]
    rows = whole["joint_pos"][:, [*range(7), *(7 + k for k in order)]]
    return {"fps": 50, "joint_pos": rows, "joint_names": [JOINTS[k] for k in order]}


def loco() -> dict[str, Any]:
    return {"qpos": walk(FRAMES), "frequency": 50.0, "joint_names": np.array(["floating_base", *JOINTS])}


FORMS: dict[str, tuple[Mapping[str, Any], dict[str, Any]]] = {
    "holosoma": (holosoma(), {}), "GMR": (gmr(), {}), "Isaac Lab": (isaac(), {}), "other order": (reordered(), {}),
    "all names": (loco(), {}),
    "qpos alone": ({"qpos": walk(FRAMES), "fps": 50}, {}),
    "qpos at times": ({"qpos": walk(FRAMES), "times": np.arange(FRAMES) / 50.0}, {}),
    "rate by the user": ({"qpos": walk(FRAMES)}, {"rate": 50.0}),
    "scalar last": ({"qpos": walk(FRAMES)[:, [*XYZW, 7, 8, 9, 10]], "fps": 50}, {"quaternion": "xyzw"}),
    "scalar first": ({**gmr(), "root_rot": walk(FRAMES)[:, 3:7]}, {"quaternion": "wxyz"}),
    "names by the user": ({"qpos": reordered()["joint_pos"], "fps": 50}, {"joints": ", ".join(reordered()["joint_names"])}),
    "joints without a root, names by the user": (beyond(), {"joints": [JOINTS[k] for k in (3, 1, 0, 2)]}),
    "a joint too many": ({"joint_pos": np.c_[walk(FRAMES), np.ones(FRAMES)], "fps": 50, "joint_names": [*JOINTS, "tail"]}, {}),
}
"""Entries and options of files that all contain the same motion."""


def raised(motion: Motion, first: int, last: int) -> Motion:
    """Return the motion with a shoulder and the root raised from one frame to another."""
    angles, positions = motion.angles.copy(), motion.positions.copy()
    angles[first : last + 1, 1] += 0.2
    positions[first : last + 1, 0, 2] += 0.05
    return replace(motion, angles=angles, positions=positions)


@pytest.mark.parametrize("form", FORMS)
def test_conventions_of_all_tools_are_read_and_written_back(tmp_path: Path, form: str) -> None:
    arrays, options = FORMS[form]
    found, model = load_motion(saved(tmp_path / "some.npz", arrays), **options), robot()
    motion = found.motion(model)
    assert model.coordinates is not None and found.format == "npz" and found.model() is None
    assert_alike(motion, model.coordinates.motion(walk(FRAMES), np.arange(FRAMES) / 50.0), 1e-12)
    # unchanged, the same bits
    written = entries(found.written(motion, model))
    assert list(written) == list(arrays)
    for key, values in arrays.items():
        assert written[key].dtype == np.asarray(values).dtype and written[key].tobytes() == np.asarray(values).tobytes()
    # changed, the same motion again, and the same values where nothing moved
    changed = raised(motion, 10, 19)
    (tmp_path / "other.npz").write_bytes(found.written(changed, model))
    assert_alike(load_motion(tmp_path / "other.npz", **options).motion(model), changed, 1e-9)
    written = entries((tmp_path / "other.npz").read_bytes())
    for key, values in arrays.items():
        recorded = np.asarray(values)
        free = np.r_[:8, 22:FRAMES] if recorded.ndim and len(recorded) == FRAMES else ...
        assert (written[key][free] == recorded[free]).all(), key


def assert_alike(one: Motion, other: Motion, most: float) -> None:
    for name in ("times", "positions", "rotations", "angles"):
        assert np.abs(getattr(one, name) - getattr(other, name)).max() < most, name


def test_bodies_and_speeds_are_those_of_the_new_motion(tmp_path: Path) -> None:
    arrays = holosoma()
    found = load_motion(saved(tmp_path / "some.npz", arrays))
    changed = raised(found.motion(robot()), 10, 19)
    written = entries(found.written(changed, robot()))
    places, turns = bodies(robot(), changed)
    assert np.abs(written["body_pos_w"] - places).max() < 1e-12
    assert np.abs(np.abs((written["body_quat_w"] * turns).sum(axis=2)) - 1.0).max() < 1e-12
    assert np.abs(written["body_lin_vel_w"] - np.gradient(places, changed.times, axis=0)).max() < 1e-9
    assert np.abs(written["joint_vel"][:, :3] - np.gradient(changed.positions[:, 0], changed.times, axis=0)).max() < 1e-9
    assert (written["contact"] == arrays["contact"]).all()


def test_entries_that_we_cannot_compute_are_left_out(tmp_path: Path) -> None:
    arrays = holosoma()
    rng = np.random.default_rng(1)
    arrays["body_lin_vel_w"] = rng.normal(size=arrays["body_lin_vel_w"].shape)
    arrays["joint_vel"] = arrays["joint_vel"] + 3.0
    arrays["qacc"] = np.zeros((FRAMES, 10))
    found = load_motion(saved(tmp_path / "some.npz", arrays))
    written = entries(found.written(raised(found.motion(robot()), 3, 5), robot()))
    assert set(arrays) - set(written) == {"body_lin_vel_w", "joint_vel", "qacc"}
    arrays["body_pos_w"] = rng.normal(size=arrays["body_pos_w"].shape)
    found = load_motion(saved(tmp_path / "some.npz", arrays))
    written = entries(found.written(raised(found.motion(robot()), 3, 5), robot()))
    assert "body_pos_w" not in written and "body_quat_w" not in written


def test_a_root_among_bodies_that_fit_no_link_cannot_be_written(tmp_path: Path) -> None:
    arrays = isaac()
    arrays["body_positions"] = arrays["body_positions"].copy()
    arrays["body_positions"][:, -1] += np.random.default_rng(1).normal(size=(FRAMES, 3))
    found = load_motion(saved(tmp_path / "some.npz", arrays))
    with pytest.raises(InvalidFile, match="body_positions"):
        found.written(raised(found.motion(robot()), 3, 5), robot())


def test_speeds_in_the_roots_own_frame_are_known(tmp_path: Path) -> None:
    q = walk(FRAMES)
    times = np.arange(FRAMES) / 50.0
    own = rotation.rotate(rotation.conjugate(q[:, 3:7]), spin(q[:, 3:7], times))
    speeds = np.concatenate([np.gradient(q[:, :3], times, axis=0), own, np.gradient(q[:, 7:], times, axis=0)], axis=1)
    found = load_motion(saved(tmp_path / "some.npz", {"qpos": q, "qvel": speeds, "fps": 50}))
    written = entries(found.written(raised(found.motion(robot()), 10, 19), robot()))
    assert np.abs(written["qvel"][:, 3:6] - own).max() < 1e-9
    assert written["qvel"][10, 2] > speeds[10, 2] + 1.0


def test_another_rate_is_written_with_its_rate(tmp_path: Path) -> None:
    found = load_motion(saved(tmp_path / "some.npz", holosoma()))
    motion = found.motion(robot()).resampled(100.0)
    (tmp_path / "other.npz").write_bytes(found.written(motion, robot()))
    written = entries((tmp_path / "other.npz").read_bytes())
    assert written["fps"].tolist() == [100] and len(written["joint_pos"]) == 2 * FRAMES - 1
    # a row per frame that belongs to no pose fits no other frames
    assert "contact" not in written and len(written["body_pos_w"]) == 2 * FRAMES - 1
    again = load_motion(tmp_path / "other.npz").motion(robot())
    assert np.abs(again.angles - motion.angles).max() < 1e-12 and np.abs(again.times - motion.times).max() < 1e-12


def test_float32_stays_where_it_is_fine_enough(tmp_path: Path) -> None:
    arrays = gmr(np.float32)
    found = load_motion(saved(tmp_path / "some.npz", arrays))
    changed = raised(found.motion(robot()), 10, 19)
    written = entries(found.written(changed, robot()))
    assert {key: values.dtype for key, values in written.items()} == {"fps": np.dtype(float), **dict.fromkeys(
        ("root_pos", "root_rot", "dof_pos"), np.dtype(np.float32))}
    away = replace(changed, positions=changed.positions + np.array([100.0, 0.0, 0.0]))
    assert entries(found.written(away, robot()))["root_pos"].dtype == np.float64


def test_a_compressed_file_stays_compressed(tmp_path: Path) -> None:
    found = load_motion(saved(tmp_path / "some.npz", holosoma(), np.savez_compressed))
    content = found.written(raised(found.motion(robot()), 3, 5), robot())
    assert len(content) < 0.9 * sum(values.nbytes for values in entries(content).values())
    assert content == found.written(raised(found.motion(robot()), 3, 5), robot())


@pytest.mark.parametrize("form", ["holosoma", "qpos alone", "GMR", "other order"])
def test_columns_of_what_is_fixed_stay_as_they_are(tmp_path: Path, form: str) -> None:
    arrays, options = FORMS[form]
    found = load_motion(saved(tmp_path / "some.npz", arrays), **options)
    motion = found.motion(held())
    assert (motion.angles[:, 1] == 0.0).all()
    angles = motion.angles.copy()
    angles[3:6, 0] += 0.1
    (tmp_path / "other.npz").write_bytes(found.written(replace(motion, angles=angles), held()))
    again, before = (load_motion(tmp_path / name, **options).motion(robot()).angles for name in ("other.npz", "some.npz"))
    assert (again[:, 1] == before[:, 1]).all()
    assert np.allclose(again[3:6, 0], before[3:6, 0] + 0.1)


def test_a_fixed_joint_may_be_missing_in_the_file(tmp_path: Path) -> None:
    names = [name for name in JOINTS if name != "left_shoulder"]
    arrays = {"joint_pos": np.delete(walk(FRAMES), 8, axis=1), "fps": 50, "joint_names": names}
    motion = load_motion(saved(tmp_path / "some.npz", arrays)).motion(held())
    assert np.allclose(motion.angles[:, 0], walk(FRAMES)[:, 7])


def without(key: str) -> dict[str, Any]:
    return {name: values for name, values in holosoma().items() if name != key}


def spoiled(key: str, value: Any) -> dict[str, Any]:
    return {**gmr(), key: value}


@pytest.mark.parametrize(("arrays", "says"), [
    ({"fps": 50}, "entries of some.npz.*qpos"),
    ({"fps": 50, "joint_pos": walk(5)[:, :9]}, "names no joints.*9.*11"),
    (without("fps"), "frames a second of some.npz"),
    ({**holosoma(), "joint_names": np.array(["a", "b", "c", "d"])}, "missing: waist, left_shoulder"),
    ({**holosoma(), "joint_names": np.array([1, 2, 3, 4])}, "row of names"),
    ({"fps": 50, "joint_pos": np.ones((5, 12)), "joint_names": JOINTS}, "columns of some.npz is 12; valid: 11"),
    ({"fps": 50, "joint_pos": np.ones((5, 12)), "joint_names": [*JOINTS, "waist"]}, "joint of some.npz is 'waist'.*once"),
    (spoiled("root_rot", np.zeros((FRAMES, 3))), "shape of root_rot"),
    (spoiled("root_rot", np.zeros((FRAMES, 4))), "length of the quaternion of floating_base in frame 0"),
    (spoiled("root_pos", np.zeros((FRAMES - 1, 3))), "frames of some.npz"),
    (spoiled("dof_pos", np.full((FRAMES, 4), np.nan)), "column 0 of frame 0 of dof_pos in some.npz"),
    (spoiled("dof_pos", np.full((FRAMES, 4), 1e300)), "angle of waist in frame 0"),
    (spoiled("dof_pos", np.zeros((FRAMES, 0))), "names no joints.*7.*11"),
    (spoiled("root_pos", np.full((FRAMES, 3), 1e300)), "distance of floating_base"),
    ({"fps": 50, "qpos": np.zeros((0, 11))}, "shape of qpos"),
])
def test_files_that_do_not_fit_end_in_a_sentence(tmp_path: Path, arrays: Mapping[str, Any], says: str) -> None:
    with pytest.raises(InvalidFile, match=says):
        load_motion(saved(tmp_path / "some.npz", arrays)).motion(robot())


def test_a_fixed_robot_is_driven_by_no_root(tmp_path: Path) -> None:
    with pytest.raises(InvalidFile, match="root of some.npz.*free root"):
        load_motion(saved(tmp_path / "some.npz", loco())).motion(robot(free=False))


def turning(frames: int, canonical: bool) -> np.ndarray:
    """Return rows whose root makes two whole turns; if `canonical`, quaternions with a scalar part from 0 on."""
    q = walk(frames)
    q[:, 3:7] = rotation.from_axis_angle((0.0, 0.0, 1.0), np.linspace(0.0, 4.0 * np.pi, frames))
    if canonical:
        q[:, 3:7] *= np.where(q[:, 3:4] < 0.0, -1.0, 1.0)
    return q


@pytest.mark.parametrize("canonical", [False, True])
def test_quaternions_change_no_sides_in_reading_and_writing(tmp_path: Path, canonical: bool) -> None:
    q = turning(60, canonical)
    model = robot()
    own = model.coordinates.motion(q, np.arange(60) / 50.0)
    places, turns = bodies(model, own)
    arrays = {"fps": 50, "joint_pos": q, "body_pos_w": places, "body_quat_w": turns, "joint_names": np.array(JOINTS)}
    found = load_motion(saved(tmp_path / "some.npz", arrays))
    motion = found.motion(model)
    assert ((motion.rotations[1:] * motion.rotations[:-1]).sum(axis=2) > 0.0).all()
    changed = raised(motion, 10, 40)
    signs = np.where(np.random.default_rng(0).normal(size=(60, 1)) < 0.0, -1.0, 1.0)
    signs[:10] = signs[41:] = 1.0
    rotations = changed.rotations.copy()
    rotations[:, 0] *= signs
    written = entries(found.written(replace(changed, rotations=rotations), model))
    for now, was in ((written["joint_pos"][:, None, 3:7], q[:, None, 3:7]), (written["body_quat_w"], turns)):
        sides = [(one[1:] * one[:-1]).sum(axis=2) > 0.0 for one in (now, was)]
        assert np.array_equal(*sides)
        assert np.allclose(now[:10], was[:10]) and np.allclose(now[41:], was[41:])
    other = entries(found.written(motion.resampled(100.0), model))["joint_pos"][:, 3:7]
    assert ((other[1:] * other[:-1]).sum(axis=1) > 0.0).all()


def test_balls_are_rows_of_four(tmp_path: Path) -> None:
    rng = np.random.default_rng(0)
    q = np.concatenate([walk(5, 0), rotation.normalised(rng.normal(size=(5, 4))), rng.normal(size=(5, 2))], axis=1)
    found = load_motion(saved(tmp_path / "some.npz", {"qpos": q, "fps": 30}))
    motion = found.motion(puppet())
    assert np.allclose(np.abs((motion.rotations[:, 1] * q[:, 7:11]).sum(axis=1)), 1.0) and np.allclose(motion.angles, q[:, 11:])


def test_a_body_without_joints_is_driven_by_no_robots_motion() -> None:
    cube = Coordinates((Slot("cube", "free", 0),), 1, 0)
    with pytest.raises(InvalidFile, match="joints of a is '?waist, .*at least one of the avatar's: cube"):
        columns("a", Layout(JOINTS, "wxyz"), 11, cube)
    assert columns("a", Layout(("cube",), "wxyz"), 7, cube).tolist() == [*range(7)]
    assert columns("a", Layout((), "wxyz"), 7, cube).tolist() == [*range(7)]


def test_a_room_has_no_joints() -> None:
    with pytest.raises(InvalidFile, match=r"avatar for a\.csv"):
        coordinates_of_model("a.csv", Model(None, None, (), ()))
