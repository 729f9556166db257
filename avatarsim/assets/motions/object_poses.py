"""Poses of an object in addition to a recorded motion, such as a carried box: entries of archives of holosoma and OMOMO.

A file has places (F, 3) [m] with rotations, quaternions (F, 4) or matrices (F, 3, 3), and may state the object's name, its size
and the scale of its mesh. Its shape is in another file.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from avatarsim.assets import caps
from avatarsim.assets.motions import matching
from avatarsim.assets.motions.archive import AnyArray, Archive, narrowed
from avatarsim.errors import InvalidFile
from avatarsim.scene.motion import Motion
from avatarsim.scene.tracker import from_xyzw
from avatarsim.spatial import rotation
from avatarsim.spatial.rotation import Array

PLACES = ("object_pos_w", "object_pos", "object_positions", "object_trans", "obj_pos", "obj_trans")
TURNS = ("object_quat_w", "object_quat", "object_rot", "object_rotations", "obj_quat", "obj_rot")
NAMES, SIZES, SCALES = ("object_name", "obj_name"), ("object_size", "obj_size"), ("object_scale", "obj_scale")
SPEEDS = ("object_lin_vel_w", "object_ang_vel_w", "object_lin_vel", "object_ang_vel")
"""Entries that follow from the poses: left out where these are written at other times."""

EVEN = 1e-3
"""Share by which a scale may differ from frame to frame, and a matrix from a rotation: the error of fits of recordings."""


@dataclass(frozen=True, eq=False)
class ObjectPoses:
    """The object of a file.

    Attributes:
        name: the file's, else "object".
        motion: its poses, as of an avatar of one link.
        size: full lengths [m] of a box, where the file states them.
        scale: metres a unit of length of its mesh, where the file states it.
    """

    name: str
    motion: Motion
    size: tuple[float, float, float] | None = None
    scale: float | None = None


def object_of(archive: Archive, times: Array, order: str, upright: ArrayLike = rotation.IDENTITY) -> ObjectPoses | None:
    """Return the object of an archive, None without any.

    Args:
        archive: the file.
        times: (F,) [s] of its frames.
        order: of quaternions, "wxyz" or "xyzw".
        upright: rotation of the file's world to z up.

    Raises:
        InvalidFile: for places without rotations, another number of frames, and values that are not a pose of one object.
    """
    keys = archive.first(PLACES), archive.first(TURNS)
    if keys == (None, None):
        return None
    for key, known in zip(keys, (PLACES, TURNS), strict=True):
        if key is None:
            raise InvalidFile(f"object in {archive.name}", "places alone" if known is TURNS else "rotations alone",
                              f"both: one of {', '.join(known)}")
    placed, turned = str(keys[0]), str(keys[1])
    places, frames = archive.numbers(placed), len(times)
    if places.shape not in ((frames, 3), (frames, 1, 3), (frames, 3, 1)):
        raise InvalidFile(f"shape of {placed} in {archive.name}", places.shape, f"({frames}, 3), one object a frame")
    places = places.reshape(frames, 3)
    matching.require_within(archive.name, "place of the object", np.abs(places).max(axis=1), 0.0, matching.FARTHEST, "m")
    turns = rotation.multiply(upright, rotation.continuous(_turns(archive, turned, frames, order)))
    none = np.zeros((frames, 0))
    motion = Motion(times, rotation.rotate(upright, places)[:, None], rotation.normalised(turns)[:, None], none)
    key = archive.first(NAMES)
    return ObjectPoses("object" if key is None else _name(archive, key), motion, _size(archive), _scale(archive))


def _turns(archive: Archive, key: str, frames: int, order: str) -> Array:
    """Return unit quaternions (F, 4), w first."""
    found = archive.numbers(key)
    if found.size == 9 * frames and found.shape[-2:] == (3, 3):
        matrices = found.reshape(frames, 3, 3)
        off = np.abs(matrices @ matrices.transpose(0, 2, 1) - np.eye(3)).max(axis=(1, 2))
        off = np.where(np.linalg.det(matrices) > 0.0, off, 1.0)
        matching.require_within(archive.name, f"difference of {key} from a rotation", off, 0.0, EVEN, "")
        return np.asarray(rotation.from_matrix(matrices))
    if found.shape not in ((frames, 4), (frames, 1, 4)):
        valid = f"({frames}, 4) quaternions or ({frames}, 3, 3) matrices, one object a frame"
        raise InvalidFile(f"shape of {key} in {archive.name}", found.shape, valid)
    found = found.reshape(frames, 4)
    lengths = np.linalg.norm(found, axis=1)
    matching.require_within(archive.name, f"length of the quaternions of {key}", lengths, 0.5, 2.0, "")
    return rotation.normalised(found) if order == "wxyz" else from_xyzw(found)


def _name(archive: Archive, key: str) -> str:
    values = archive.arrays.get(key)
    if values is None or values.size != 1 or values.dtype.kind not in "US":
        raise InvalidFile(f"{key} in {archive.name}", "no name" if values is None else values.shape, "one name")
    return caps.require_name(f"{key} in {archive.name}", str(values.astype("U").ravel()[0]))


def _size(archive: Archive) -> tuple[float, float, float] | None:
    key = archive.first(SIZES)
    if key is None:
        return None
    found = archive.numbers(key).ravel()
    if found.shape != (3,) or not ((found > 0.0) & (found < matching.FARTHEST)).all():
        raise InvalidFile(f"{key} in {archive.name} [m]", found.tolist()[:4], "three full lengths above 0")
    x, y, z = found.tolist()
    return x, y, z


def _scale(archive: Archive) -> float | None:
    key = archive.first(SCALES)
    if key is None:
        return None
    found = archive.numbers(key).ravel()
    if not found.size or not found.min() > 0.0 or np.ptp(found) > EVEN * found.min():
        raise InvalidFile(f"{key} in {archive.name}", found.tolist()[:4], "one scale above 0 in all frames: the object is rigid")
    return float(np.median(found))


def at_times(archive: Archive, before: Array, after: Array) -> dict[str, AnyArray]:
    """Return the entries of an object's poses at other instants than the file's: straight lines, and turns by slerp.

    Args:
        archive: the file.
        before: (F,) [s] its instants.
        after: (G,) [s] those of the written file.
    """
    found: dict[str, AnyArray] = {}
    later = np.clip(np.searchsorted(before, after, side="right"), 1, max(len(before) - 1, 1))
    share = (after - before[later - 1]) / (before[later] - before[later - 1]) if len(before) > 1 else np.zeros(len(after))
    for key in (*PLACES, *TURNS, *SCALES):
        like = archive.arrays.get(key)
        if like is None or like.ndim == 0 or len(like) != len(before) or like.dtype.kind not in "iuf":
            continue
        one, other = (like[np.minimum(k, len(like) - 1)].astype(np.float64) for k in (later - 1, later))
        if key not in TURNS:
            found[key] = narrowed(one + share.reshape(-1, *(1,) * (like.ndim - 1)) * (other - one), like)
            continue
        is_matrix = like.shape[-2:] == (3, 3)
        start, end = (rotation.from_matrix(turns) if is_matrix else rotation.normalised(turns) for turns in (one, other))
        shares = np.broadcast_to(share.reshape(-1, *(1,) * (start.ndim - 2)), start.shape[:-1])
        mixed = rotation.normalised(rotation.slerp(start, end, shares))
        found[key] = narrowed(rotation.to_matrix(mixed) if is_matrix else mixed, like)
    return found


def object_note(name: str, found: ObjectPoses | None) -> list[str]:
    """Return a sentence on an object whose shape another file has to give."""
    if found is None or found.size is not None:
        return []
    return [f"{name}: has the poses of an object, {found.name}; its shape is that of object=FILE, else it is left out"]
