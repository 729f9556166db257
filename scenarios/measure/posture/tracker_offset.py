"""Tracking error: how far the shown avatar is from the tracker sample, by link origins, by joint angles, and as one body."""

import numpy as np
from numpy.typing import NDArray

from avatarsim.scene.joint import Rigid
from avatarsim.scene.scene import Scene
from runfiles.record import Recording
from scenarios.measure.posture.joints import angle_between, places, relative
from scenarios.measure.value import Missing, Values

Array = NDArray[np.float64]


def offsets(recording: Recording) -> Array:
    """Return (F, L) distance [m] of each link's frame from the raw tracker's, without the first state."""
    shown = recording.positions[1:, recording.links]
    return np.asarray(np.linalg.norm(shown - recording.raw_positions[1:], axis=-1))


def angle_offsets(recording: Recording, scene: Scene) -> Array:
    """Return (F, joints) angle [rad] between each joint's rotation and the raw tracker's; a free root counts as one joint."""
    shown, raw = recording.orientations[1:, recording.links], recording.raw_orientations[1:]
    offsets = [
        angle_between(relative(place, shown), relative(place, raw))
        for place in places(scene) if not isinstance(place.joint, Rigid)
    ]
    return np.array(offsets, dtype=np.float64).reshape(len(offsets), recording.frames).T


def rms(values: Array) -> float:
    """Return the root of the mean square over everything."""
    return float(np.sqrt(np.mean(values**2)))


def tracker_offset(recording: Recording, scene: Scene, free: NDArray[np.bool_]) -> Values:
    """Return tracker_offset_max [m], the farthest link origin of any frame; tracker_offset_rms [m], tracker_angle_rms [deg],
    their _free twins, and free_frames [%], the share of frames that these are of; `free` (F+1,): the raw posture is possible.

    Empty without avatars."""
    if not scene.links or recording.frames == 0:
        return {}
    offset, angle, chosen = offsets(recording), np.degrees(angle_offsets(recording, scene)), free[1:]
    none = Missing("in no frame that was run is the raw tracker's own posture free", "scene")
    return {
        "free_frames": 100.0 * float(np.mean(chosen)),
        "tracker_offset_max": float(offset.max()),
        "tracker_offset_rms": rms(offset),
        "tracker_offset_rms_free": rms(offset[chosen]) if chosen.any() else none,
        **({} if angle.shape[1] == 0 else {
            "tracker_angle_rms": rms(angle),
            "tracker_angle_rms_free": rms(angle[chosen]) if chosen.any() else none,
        }),
    }
