"""Jumps: change of the shown posture from frame to frame beyond the change of the tracker's own."""

import numpy as np
from numpy.typing import NDArray

from avatarsim.scene.joint import Free, Rigid
from avatarsim.scene.scene import Scene
from runfiles.record import Recording
from scenarios.measure.posture.joints import angle_between, places, relative
from scenarios.measure.value import Values, measure

Array = NDArray[np.float64]


def _turns(orientations: Array, scene: Scene) -> Array:
    """Return (F,) largest turn [rad] of a joint from state to state, of links' orientations (F+1, L, 4)."""
    worst = np.zeros(len(orientations) - 1)
    for place in places(scene):
        if not isinstance(place.joint, Rigid):
            rotations = relative(place, orientations)
            worst = np.maximum(worst, angle_between(rotations[:-1], rotations[1:]))
    return worst


def _roots(positions: Array, scene: Scene) -> Array:
    """Return (F,) largest way [m] of a free root from state to state, of links' positions (F+1, L, 3)."""
    roots = [place.child for place in places(scene) if isinstance(place.joint, Free)]
    moved = np.linalg.norm(np.diff(positions[:, roots], axis=0), axis=-1)
    return np.asarray(moved.max(axis=1, initial=0.0))


def beyond_user(recording: Recording, scene: Scene) -> tuple[Array, Array]:
    """Return (F,) per frame the largest turn [rad] of any joint shown less the largest of any joint of the raw tracker, and the
    same of the ways [m] of free roots. Below 0 where the user did more."""
    shown, raw = recording.orientations[:, recording.links], recording.raw_orientations
    turn = _turns(shown, scene) - _turns(raw, scene)
    way = _roots(recording.positions[:, recording.links], scene) - _roots(recording.raw_positions, scene)
    return turn, way


@measure
def jumps(recording: Recording, scene: Scene) -> Values:
    """Return pose_jump_max [deg] and root_jump_max [m]: the largest of `beyond_user` over all frames, at least 0; link_jump_max
    [m]: the same of each link's origin against its own target's. Empty without avatars."""
    if not scene.links or recording.frames == 0:
        return {}
    turn, way = beyond_user(recording, scene)
    links = [
        np.linalg.norm(np.diff(places, axis=0), axis=-1)
        for places in (recording.positions[:, recording.links], recording.raw_positions)
    ]
    return {
        "link_jump_max": float(np.max(np.maximum(links[0] - links[1], 0.0))),
        "pose_jump_max": float(np.degrees(np.max(np.maximum(turn, 0.0)))),
        "root_jump_max": float(np.max(np.maximum(way, 0.0))),
    }
