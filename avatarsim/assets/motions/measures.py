"""Up axis and unit of length of a file that states neither: by the extent of the skeleton at rest and in its clip."""

import math
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from avatarsim.assets.models.anthropometry import parts
from avatarsim.assets.models.stance import Stance, stance
from avatarsim.assets.motions.recording import Axes, Recording
from avatarsim.errors import InvalidFile

Array = NDArray[np.float64]

UNITS = {1.0: "metres", 0.01: "centimetres", 0.0254: "inches", 0.0254 / 0.45: "inches / 0.45, as CMU's"}
"""Common units of recordings [m]."""

STANDING, SHORTEST, TALLEST = 1.7, 1.2, 2.2
"""Standing height [m] of humans: the chosen unit brings the skeleton's nearest to the first, within the other two."""

POSTURES = 64
"""Postures, evenly through a clip, among which a standing one is searched."""

LOOKED_AT = 32
"""Frames, evenly through a clip, whose extent decides the up axis."""

DECISIVE = 1.3
"""Ratio of the extents along two axes from which one of them counts as up: standing humans have 3, crouching ones 1.5."""


def guessed(
    thing: str, made: Callable[[Axes], Recording], angle: float, scale: float | None, up: str | None
) -> tuple[Axes, list[str]]:
    """Return the axes of a file whose recording `made` gives for any axes, and sentences on the guesses.

    `angle` is the file's unit of angle [rad]; `scale` [m] and `up` are the user's, None to guess. Raises InvalidFile."""
    if scale is not None and not (isinstance(scale, (int, float)) and math.isfinite(scale) and scale > 0.0):
        raise InvalidFile(f"scale of {thing} [m per unit]", scale, "a finite number above 0")
    if up not in (None, "y", "z"):
        raise InvalidFile(f"up axis of {thing}", up, '"y" or "z"')
    if scale is not None and up is not None:
        return Axes(scale, angle, up), []
    rest, clip = _points(made(Axes(1.0, angle, "z")))
    notes = []
    if up is None:
        up, reason = _up(rest, clip)
        notes.append(f"up axis guessed of {thing}: {up}, by {reason}; up= says it")
    if scale is None:
        height = standing(made(Axes(1.0, angle, up)))
        fitting = [unit for unit in UNITS if SHORTEST <= unit * height <= TALLEST]
        if not fitting:
            found = ", ".join(f"{unit * height:.3g} m in {name}" for unit, name in UNITS.items())
            valid = f"a standing human of {SHORTEST} to {TALLEST} m in one of them; scale= says the metres of a unit"
            raise InvalidFile(f"height of the skeleton of {thing}", found, valid)
        scale = min(fitting, key=lambda unit: abs(math.log(unit * height / STANDING)))
        tall = f"with which it stands {scale * height:.2f} m tall"
        notes.append(f"unit of length guessed of {thing}: {UNITS[scale]}, {tall}; scale= says it")
    return Axes(scale, angle, up), notes


def _points(recording: Recording) -> tuple[Array, Array]:
    """Return joints and tips at rest (points, 3) and in some frames (frames, points, 3)."""
    motion = recording.at(recording.evenly(LOOKED_AT)).motion
    return recording.skeleton.rest, recording.skeleton.points(motion.positions, motion.rotations, motion.angles)


def _up(rest: Array, clip: Array) -> tuple[str, str]:
    """Return "y" or "z", and the reason."""
    extents = np.median(np.ptp(clip, axis=1), axis=0)
    resting = np.ptp(rest, axis=0)
    for (_, y, z), reason in ((extents, "the extent of its postures"), (resting, "the extent of its skeleton at rest")):
        if max(y, z) >= DECISIVE * min(y, z) and max(y, z) > 0.0:
            return ("y" if y > z else "z"), reason
    return "y", "custom, as its extents along y and z are alike"


def home_frame(recording: Recording) -> tuple[Stance | None, int | None]:
    """Find the standing posture of a recording, and its frame; None for an upright rest pose, and without any upright frame."""
    chosen = recording.evenly(POSTURES)
    found, frame = stance(recording.skeleton, parts(recording.skeleton), recording.at(chosen).motion)
    return found, None if frame is None else chosen[frame]


def standing(recording: Recording) -> float:
    """Return the standing height in the recording's unit: from the lowest foot to the top of the head, if names identify them.
    It is measured at rest; in the most upright frame if the skeleton is folded at rest; the maximum of the clip without any."""
    named = parts(recording.skeleton)
    kinds = [part.kind for part in named]
    owners = np.array([kinds[bone] for bone in recording.skeleton.owners])
    body = np.isin(owners, ("head", "face", "neck", "foot", "toe", "shank"))
    if not (np.isin(owners, ("head", "neck")).any() and np.isin(owners, ("foot", "toe")).any()):
        body[:] = True
    upright, frame = home_frame(recording)
    rest, clip = _points(recording if frame is None else recording.at([frame]))
    if upright is not None and frame is None:
        return float(np.ptp(rest[body, np.argmax(np.abs(upright.up))]))
    if upright is not None:
        return float(np.ptp(clip[0, body, 2]))
    return float(max(np.ptp(rest[body, 2]), np.ptp(clip[:, body, 2], axis=1).max()))
