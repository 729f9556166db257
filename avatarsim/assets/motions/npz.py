"""NumPy archives of motion, distinguished by their entries: robot trajectories, and bodies of the SMPL family."""

from collections.abc import Mapping, Sequence
from pathlib import Path

from avatarsim.assets.motions import archive, matching, smpl, trajectory
from avatarsim.assets.motions.motion_file import MotionFile
from avatarsim.errors import InvalidFile, InvalidInput


def read_npz(
    path: str | Path, *, rate: float | None = None, quaternion: str | None = None, joints: str | Sequence[str] | None = None,
    offsets: str | Path | None = None, up: str | None = None, stature: float | None = None, mass: float | None = None,
    limits: bool | None = None,
) -> MotionFile:
    """Read the motion in an archive. Raises InvalidFile for an invalid one, and InvalidInput for an option of the other kind.

    rate        frames a second [1/s], where the file states none or a wrong one

    Of a trajectory:
    quaternion  "wxyz" or "xyzw"
    joints      names of the joints in the file's order, where it has none; a text of names with commas between

    Of a body of the SMPL family:
    offsets     a file with the rest joints J (n, 3) [m]; else the approximate skeleton
    up          "z" (AMASS) or "y": the axis of the world that points up
    stature     [m] of the approximate skeleton
    mass        [kg] of the avatar
    limits      whether its joints get their range of motion"""
    found = archive.open_archive(Path(path))
    of_robot = {"quaternion": quaternion, "joints": joints}
    of_body = {"offsets": offsets, "up": up, "stature": stature, "mass": mass, "limits": limits}
    if smpl.is_one(found):
        _refuse(found.name, of_robot, "a body of the SMPL family", ("rate", *of_body))
        return smpl.of_archive(found, rate, offsets, up, stature, mass, limits)
    if found.first(trajectory.KEYS) is None:
        valid = f"one of {', '.join(dict.fromkeys(trajectory.KEYS))} (a robot), or trans with poses (a body of the SMPL family)"
        raise InvalidFile(f"entries of {found.name}", [*found.arrays, *found.left_out], valid)
    _refuse(found.name, of_body, "a robot's trajectory", ("rate", *of_robot))
    return trajectory.of_archive(found, rate, quaternion, matching.listed(joints))


def _refuse(name: str, options: Mapping[str, object], kind: str, valid: tuple[str, ...]) -> None:
    """Raise InvalidInput for a given option that does not apply to this kind of file."""
    for option, value in options.items():
        if value is not None:
            raise InvalidInput(f"option for {name}, {kind},", option, f"one of {', '.join(valid)}")
