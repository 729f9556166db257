"""Bodies of the SMPL family in NumPy archives: AMASS (Mahmood et al. 2019) and SMPL-X files, a rotation vector a joint and frame.

`poses` (F, 72, 156 or 165) has the rotation vectors [rad] of 24, 52 or 55 joints, `trans` (F, 3) [m] the root's; SMPL-X files may
have these in parts (`root_orient`, `pose_body`, ...), alone or in addition to `poses`. The pelvis is at `trans` plus its place in
the body at rest. Shape and soft tissue (`betas`, `dmpls`) are not used.
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path

import numpy as np

from avatarsim.assets import caps
from avatarsim.assets.models import smpl_skeleton
from avatarsim.assets.models.anthropometry import BODY_MASS
from avatarsim.assets.models.from_skeleton import human
from avatarsim.assets.models.model import Model
from avatarsim.assets.models.skeleton import Skeleton
from avatarsim.assets.motions import matching
from avatarsim.assets.motions.archive import AnyArray, Archive, npz_bytes, open_archive
from avatarsim.assets.motions.frame_times import restated, times_of
from avatarsim.assets.motions.measures import POSTURES
from avatarsim.assets.motions.motion_file import Notes
from avatarsim.assets.motions.object_poses import at_times, object_note, object_of
from avatarsim.assets.motions.recorded_file import limits_note
from avatarsim.errors import InvalidFile, UnknownName
from avatarsim.scene.joint import MANY_TURNS
from avatarsim.scene.motion import Motion
from avatarsim.spatial import rotation
from avatarsim.spatial.rotation import Array

POSES, TRANS = "poses", "trans"

PARTS = {"root_orient": 1, "pose_body": 21, "pose_jaw": 1, "pose_eye": 2, "pose_hand": 30}
"""Entries of SMPL-X in the order of its joints, and how many joints each has."""

DERIVED = ("joints", "keypoints", "joints3d", "verts", "vertices")
"""Entries that follow from the pose through the body model: left out with another motion."""

TURNS = {"z": (1.0, 0.0, 0.0, 0.0), "y": (float(np.sqrt(0.5)), float(np.sqrt(0.5)), 0.0, 0.0)}
"""Rotations of a world with this up axis to z up."""

AXES = np.array([0.5, -0.5, -0.5, -0.5])
"""Rotation of link frames (x forward, z up) to the family's (z forward, y up): this x is along their z."""


def is_one(archive: Archive) -> bool:
    """Return True if an archive contains a body of the family."""
    return archive.first((TRANS,)) is not None and archive.first((POSES, "pose_body")) is not None


def of_archive(
    archive: Archive, rate: float | None, offsets: str | Path | None, up: str | None, stature: float | None, mass: float | None,
    limits: bool | None,
) -> "SmplFile":
    """Return the motion of a body of the family, with options as in `npz.read_npz`.
    Raises InvalidFile, and UnknownName for an invalid axis."""
    name = archive.name
    if (up or "z") not in TURNS:
        raise UnknownName("up", str(up), TURNS)
    poses = archive.table(POSES) if archive.first((POSES,)) else _of_parts(archive)
    member = smpl_skeleton.tree_of(poses.shape[1] // 3) if poses.shape[1] % 3 == 0 else None
    if member is None:
        raise InvalidFile(f"columns of {POSES} of {name}", poses.shape[1], "72 (SMPL), 156 (SMPL-H, AMASS) or 165 (SMPL-X)")
    trans = archive.table(TRANS, 3)
    if len(trans) != len(poses):
        raise InvalidFile(f"frames of {TRANS} of {name}", len(trans), f"{len(poses)}, as of {POSES}")
    matching.require_within(name, "place of the root", np.abs(trans).max(axis=1), 0.0, matching.FARTHEST, "m")
    for k, (joint, _) in enumerate(smpl_skeleton.TREES[member]):
        turns = np.abs(poses[:, 3 * k : 3 * k + 3]).max(axis=1)
        matching.require_within(name, f"turn of {joint}", turns, 0.0, MANY_TURNS, "rad")
    notes = [f'{name}: world taken as {up or "z"} up' + ("" if up else ', as in AMASS; up="y" says otherwise')]
    if offsets is None:
        skeleton, pelvis = smpl_skeleton.approximate(member, smpl_skeleton.STATURE if stature is None else stature)
        notes.append(
            f"{name}: joints stand where an approximate skeleton of our own has them, for a stature of "
            f"{stature or smpl_skeleton.STATURE:g} m; betas are not used. offsets=FILE.npz with J (n, 3) of a body model places "
            "them exactly"
        )
    else:
        skeleton, pelvis = smpl_skeleton.measured(member, _rest_joints(Path(offsets), member))
    times = times_of(archive, len(poses), rate)
    caps.require_frames(name, len(poses), len(skeleton.bones))
    upright = np.array(TURNS[up or "z"])
    found = object_of(archive, times, "wxyz", upright)
    return SmplFile(
        archive, times, poses.reshape(len(poses), -1, 3), trans, skeleton, pelvis, upright,
        BODY_MASS if mass is None else mass, limits is not False,
        sentences=[*notes, *matching.pickles_note(archive), *object_note(name, found)], object=found,
    )


def _of_parts(archive: Archive) -> Array:
    """Return the poses (F, 165) of a file that has them in parts; joints whose part is missing are not turned."""
    found = {key: archive.table(key, 3 * count) for key, count in PARTS.items() if archive.first((key,))}
    frames = {key: len(values) for key, values in found.items()}
    if "root_orient" not in found or len(set(frames.values())) != 1:
        raise InvalidFile(f"poses of {archive.name}", frames, "root_orient and pose_body of as many frames")
    count = len(found["root_orient"])
    return np.concatenate([found.get(key, np.zeros((count, 3 * n))) for key, n in PARTS.items()], axis=1)


def _rest_joints(path: Path, member: str) -> Array:
    """Return J (n, 3) [m] of a body model's file. Raises InvalidFile."""
    archive = open_archive(path)
    joints = archive.numbers("J")
    count = len(smpl_skeleton.TREES[member])
    if joints.ndim != 2 or joints.shape[1] != 3 or len(joints) < count or not np.abs(joints).max() < 10.0:
        raise InvalidFile(f"J of {path.name}", joints.shape, f"({count}, 3), places of the joints at rest [m]")
    if not np.ptp(joints[:, 1]) > 0.1:
        raise InvalidFile(f"height of J of {path.name} [m]", float(np.ptp(joints[:, 1])), "above 0.1, along y")
    return joints


def _nearer(vectors: Array, near: Array) -> Array:
    """Return the rotation vectors (n, 3) or their equivalents the long way round, whichever is nearer to `near` (n, 3)."""
    lengths = np.linalg.norm(vectors, axis=1, keepdims=True)
    others = vectors * (1.0 - 2.0 * np.pi / np.where(lengths > 0.0, lengths, np.inf))
    is_nearer = np.linalg.norm(others - near, axis=1) < np.linalg.norm(vectors - near, axis=1)
    return np.where(is_nearer[:, None], others, vectors)


@dataclass(frozen=True, eq=False)
class SmplFile(Notes):
    """A file of a body of the family: a MotionFile.

    times (F,) [s]; poses (F, joints, 3) [rad], trans (F, 3) [m], as in the file; `pelvis` (3,) [m] its place at rest; `upright`
    (4,) turns the file's world to z up; mass [kg] and limits of the avatar"""

    archive: Archive
    times: Array
    poses: Array
    trans: Array
    skeleton: Skeleton
    pelvis: Array
    upright: Array
    mass: float
    limits: bool
    format: str = "npz"

    @property
    def name(self) -> str:
        """Name of the file."""
        return self.archive.name

    def model(self) -> Model:
        """Return the avatar of the file's skeleton, with flesh and limits of a mean human."""
        return self._model

    @cached_property
    def _model(self) -> Model:
        whole = self._recorded
        few = np.unique(np.linspace(0, len(whole) - 1, POSTURES).round().astype(np.int64))
        looked_at = Motion(whole.times[few], whole.positions[few], whole.rotations[few], whole.angles[few])
        built = human(self.skeleton, float(np.ptp(self.skeleton.rest[:, 2])), looked_at, self.mass, self.limits)
        assert built.avatar is not None
        return replace(built, notes=(*built.notes, *limits_note(self.name, built.avatar, whole)))

    @cached_property
    def _recorded(self) -> Motion:
        """Return the motion of the skeleton's own avatar, whose links have x forward and z up."""
        turns = rotation.from_rotation_vector(smpl_skeleton.from_smpl_axes(self.poses))
        root = rotation.multiply(rotation.from_rotation_vector(self.poses[:, 0]), AXES)
        turns[:, 0] = rotation.multiply(self.upright, root)
        places = np.zeros((*turns.shape[:2], 3))
        places[:, 0] = rotation.rotate(self.upright, self.trans + self.pelvis)
        return Motion(self.times, places, rotation.continuous(rotation.normalised(turns)), np.zeros((len(turns), 0)))

    def motion(self, model: Model) -> Motion:
        """Return the motion for an avatar whose joints have the family's names, its root free and the others balls.

        Raises InvalidFile for other joints, by name."""
        slots = self._slots(model)
        coordinates = matching.coordinates_of_model(self.name, model)
        caps.require_frames(self.name, len(self.times), coordinates.links)
        frames = len(self.times)
        positions = np.zeros((frames, coordinates.links, 3))
        rotations = np.tile(np.array(rotation.IDENTITY), (frames, coordinates.links, 1))
        for joint, link in slots.items():
            rotations[:, link] = self._recorded.rotations[:, joint]
        positions[:, slots[0]] = self._recorded.positions[:, 0]
        return Motion(self.times, positions, rotations, np.zeros((frames, coordinates.hinges)))

    def _slots(self, model: Model) -> dict[int, int]:
        """Return the avatar's link for each of the family's joints that it has."""
        coordinates = matching.coordinates_of_model(self.name, model)
        assert model.avatar is not None
        numbers = {bone.name: k for k, bone in enumerate(self.skeleton.bones)}
        found: dict[int, int] = {}
        unknown = []
        for slot in coordinates.slots:
            if slot.kind == "fixed":
                continue
            link = model.avatar.links[slot.link].name
            joint = 0 if slot.kind == "free" else numbers.get(slot.name, numbers.get(link, -1))
            if joint < 0 or slot.kind == "hinge":
                unknown.append(slot.name)
            else:
                found[joint] = slot.link
        if unknown or 0 not in found:
            names = matching.shortened(list(numbers))
            valid = f"a free root and balls called {names}; others than these: {matching.shortened(unknown) or 'none'}"
            raise InvalidFile(f"joints for {self.name}", matching.shortened(coordinates.names), valid)
        return found

    def written(self, motion: Motion, model: Model) -> bytes:
        """Return the file with this motion; joints of unchanged frames keep the file's numbers, to the bit."""
        slots, before = self._slots(model), self.motion(model)
        same_times = len(motion) == len(before) and bool((motion.times == before.times).all())
        nearest = np.abs(np.searchsorted(self.times, motion.times - 1e-9)).clip(0, len(self.times) - 1)
        poses, trans = self.poses[nearest].copy(), self.trans[nearest].copy()
        down = rotation.conjugate(self.upright)
        for joint, link in slots.items():
            turns = motion.rotations[:, link]
            if joint == 0:
                turns = rotation.multiply(rotation.multiply(down, turns), rotation.conjugate(AXES))
                vectors = rotation.to_rotation_vector(turns)
            else:
                vectors = smpl_skeleton.to_smpl_axes(rotation.to_rotation_vector(turns))
            moved = (motion.rotations[:, link] != before.rotations[nearest, link]).any(axis=1)
            poses[moved, joint] = _nearer(vectors[moved], poses[moved, joint])
        place = rotation.rotate(down, motion.positions[:, slots[0]]) - self.pelvis
        moved = (motion.positions[:, slots[0]] != before.positions[nearest, slots[0]]).any(axis=1)
        trans[moved] = place[moved]
        if same_times and (poses == self.poses).all() and (trans == self.trans).all():
            return npz_bytes(self.archive.arrays, self.archive.compressed)
        return self._encoded(poses.reshape(len(poses), -1), trans, {} if same_times else
                            restated(self.archive, motion) | at_times(self.archive, self.times, motion.times))

    def _encoded(self, poses: Array, trans: Array, times: Mapping[str, AnyArray]) -> bytes:
        """Return the archive with these poses, whole and in parts, as the file has them."""
        now = {POSES: poses, TRANS: trans}
        first = 0
        for key, count in PARTS.items():
            # in a file of SMPL-H the parts are not those of SMPL-X
            if poses.shape[1] == 165:
                now[key] = poses[:, first : first + 3 * count]
            first += 3 * count
        arrays = self.archive.arrays
        now = {key: values for key, values in now.items() if key in arrays and arrays[key].shape[1:] == values.shape[1:]}
        return npz_bytes(self.archive.rewritten(now, times, DERIVED, len(self.times) if times else None), self.archive.compressed)
