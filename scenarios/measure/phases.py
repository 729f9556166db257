"""Frames at rest and frames in motion, separated by poses alone, by the same rule for every engine."""

import numpy as np
from numpy.typing import NDArray

from avatarsim.scene.body import Role
from avatarsim.scene.scene import Scene
from runfiles.record import Recording
from runfiles.visible_motion import STILL
from scenarios.measure.posture.stillness import movement


def resting(recording: Recording, scene: Scene) -> NDArray[np.bool_]:
    """Return (F,) whether no simulated body and no link moves faster than STILL in the frame, on the mean: way of its origin,
    plus its turn times a lever of 0.1 m. A pose that is no number does not rest."""
    moving = [k for k, role in enumerate(scene.roles) if role is not Role.FIXED]
    if not moving or recording.frames == 0:
        return np.ones(recording.frames, dtype=np.bool_)
    way = movement(recording.positions[:, moving], recording.orientations[:, moving])
    return np.asarray(way <= STILL * recording.dt)
