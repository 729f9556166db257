"""NumPy archives of motion, told apart by their entries: robot trajectories, and bodies of the SMPL family."""

from collections.abc import Sequence
from pathlib import Path

from avatarsim.assets.motions import archive, smpl, trajectory
from avatarsim.assets.motions.motion_file import MotionFile
from avatarsim.errors import InvalidFile


def read_npz(
    path: str | Path, *, rate: float | None = None, quaternion: str | None = None, joints: str | Sequence[str] | None = None,
    offsets: str | Path | None = None, up: str | None = None, stature: float | None = None,
) -> MotionFile:
    """The motion in an archive. Raises InvalidFile.

    rate        frames a second [1/s], where the file states none or another is meant
    quaternion  "wxyz" or "xyzw", of a trajectory
    joints      names of a trajectory's joints in the file's order, where it has none; a text of names with commas between
    offsets     a file with the rest joints J (n, 3) [m] of a body of the SMPL family; else an approximate skeleton of our own
    up          "z" (AMASS) or "y": the axis of the world that points up, of a body of the SMPL family
    stature     [m] of the approximate skeleton"""
    found = archive.opened(Path(path))
    if smpl.is_one(found):
        return smpl.of_archive(found, rate=rate, offsets=offsets, up=up, stature=stature)
    if found.first(trajectory.KEYS) is None:
        valid = f"one of {', '.join(dict.fromkeys(trajectory.KEYS))} (a robot), or trans with poses (a body of the SMPL family)"
        raise InvalidFile(f"entries of {found.name}", [*found.arrays, *found.left_out], valid)
    names = [name.strip() for name in joints.split(",")] if isinstance(joints, str) else joints
    return trajectory.of_archive(found, rate, quaternion, names)
