"""Tracking error: how far the shown avatar is from the tracker sample, by link origins, by joint angles, and as one body."""

import numpy as np
from numpy.typing import NDArray

from avatarsim.scene.body import Mass
from avatarsim.scene.joint import Rigid
from avatarsim.scene.scene import Scene
from avatarsim.spatial import rotation
from runfiles.record import Recording
from scenarios.measure.posture.joints import angle_between, places, relative
from scenarios.measure.value import Missing, Values

Array = NDArray[np.float64]


def offsets(recording: Recording) -> Array:
    """(F, L) distance [m] of each link's frame from the raw tracker's, without the first state."""
    shown = recording.positions[1:, recording.links]
    return np.asarray(np.linalg.norm(shown - recording.raw_positions[1:], axis=-1))


def angle_offsets(recording: Recording, scene: Scene) -> Array:
    """(F, joints) angle [rad] between each joint's rotation and the raw tracker's; a free root counts as one joint."""
    shown, raw = recording.orientations[1:, recording.links], recording.raw_orientations[1:]
    found = [
        angle_between(relative(place, shown), relative(place, raw))
        for place in places(scene) if not isinstance(place.joint, Rigid)
    ]
    return np.array(found, dtype=np.float64).reshape(len(found), recording.frames).T


def rms(values: Array) -> float:
    """Root of the mean square over everything."""
    return float(np.sqrt(np.mean(values**2)))


def tracker_offset(recording: Recording, scene: Scene, free: NDArray[np.bool_]) -> Values:
    """tracker_offset_max [m], the farthest link origin of any frame; tracker_offset_rms [m], tracker_angle_rms [deg], their _free
    twins, and free_frames [%], the share of frames that these stand on; `free` (F+1,): the raw posture is possible.

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


def second_moments(mass: Mass) -> Array:
    """(3, 3) mean of x x^T [m^2] over a body's mass, about its centre of mass, from its inertia J = tr(S) 1 - S."""
    return np.asarray((0.5 * np.trace(mass.inertia) * np.eye(3) - mass.inertia) / mass.mass)


def body_offset(mass: Mass, shift: Array, change: Array) -> Array:
    """(F,) root mean square [m], over the mass of one body, of the way between where its points are in two poses.

    A point x of the body is `shift` (F, 3) [m] plus `change` x away, where `change` (F, 3, 3) is the difference of the two
    rotation matrices: mean |shift + change x|^2 = |shift + change c|^2 + tr(change S change^T)."""
    centre = shift + change @ np.array(mass.centre)
    spread = np.einsum("fij,jk,fik->f", change, second_moments(mass), change)
    return np.asarray(np.sqrt((centre**2).sum(axis=1) + np.maximum(spread, 0.0)))


def body_offsets(recording: Recording, scene: Scene) -> Array:
    """(F, L) root mean square distance [m] of each link's points from where the raw tracker has them, without the first state.

    The figure of what is seen: a hand that turns in order to bring its middle nearer carries its fingers away."""
    shown, raw = recording.orientations[1:, recording.links], recording.raw_orientations[1:]
    shift = recording.positions[1:, recording.links] - recording.raw_positions[1:]
    change = rotation.to_matrix(shown) - rotation.to_matrix(raw)
    found = [body_offset(link.mass, shift[:, k], change[:, k]) for k, link in enumerate(scene.links)]
    return np.array(found, dtype=np.float64).reshape(len(found), recording.frames).T
