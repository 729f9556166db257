"""Options on how files are read, checked and put together."""

import argparse
from pathlib import Path

from avatarsim.assets.models.smpl_skeleton import LEAST_STATURE, MOST_STATURE
from avatarsim.assets.models.spec_scale import LARGEST, SMALLEST
from avatarsim.assets.motions.frame_times import HIGHEST, LOWEST
from avatarsim.clips.wishes import Reading
from avatarsim.errors import InvalidInput
from avatarsim.scene.checks import within

MASSES = (1e-3, 1e4)
"""Masses [kg] of a human that a recorded skeleton gets, dolls and giants included."""
RANGES = {
    "file_rate": (LOWEST, HIGHEST), "scale": (SMALLEST, LARGEST), "avatar_scale": (SMALLEST, LARGEST),
    "room_scale": (SMALLEST, LARGEST), "stature": (LEAST_STATURE, MOST_STATURE), "mass": MASSES,
}
"""What numbers of options of readers may be, in the units of their help."""


def reading_of(asked: argparse.Namespace) -> Reading:
    """How files are read by these options. Raises InvalidInput for numbers out of range, and for options without their file."""
    for name, (least, most) in RANGES.items():
        if getattr(asked, name, None) is not None:
            within(f"--{name.replace('_', '-')}", getattr(asked, name), least, most, InvalidInput)
    for names, what in ((("fix", "couplings", "root", "leave", "avatar_scale"), "avatar"), (("room_scale", "room_up"), "room")):
        for name in names:
            if getattr(asked, name) and getattr(asked, what) is None:
                raise InvalidInput(f"--{name.replace('_', '-')}", getattr(asked, name), f"an option beside --{what}")
    return Reading(
        scale=asked.scale, up=asked.up, file_rate=asked.file_rate, quaternion=asked.quaternion, joints=asked.joints,
        mass=asked.mass, limits=not asked.no_limits,
        offsets=asked.offsets if asked.offsets in (None, "mean") else str(Path(asked.offsets).absolute()), stature=asked.stature,
        asf=absolute(asked.asf), fix=_listed(asked.fix), couplings=asked.couplings, root=asked.root, leave=_listed(asked.leave),
        folder=absolute(asked.folder), meshes=asked.meshes, repair=asked.repair,
        avatar_scale=asked.avatar_scale, room_scale=asked.room_scale, room_up=asked.room_up,
    )


def absolute(path: Path | None) -> str | None:
    return None if path is None else str(path.absolute())


def _listed(text: str) -> tuple[str, ...]:
    """Names with commas between."""
    return tuple(name.strip() for name in text.split(",") if name.strip())
