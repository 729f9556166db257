"""Frames at rest and frames in motion, told apart by poses alone, by the same rule for every engine."""

import numpy as np
from numpy.typing import NDArray

from avatarsim.scene.body import Role
from avatarsim.scene.scene import Scene
from scenarios.measure.stillness import movement
from scenarios.record import Recording

STILL = 6e-3
"""Speed [m/s] up to which a body or link counts as resting over a frame: 0.1 mm in a sixtieth of a second. Ten times less, and
contacts that give way by design would never rest; ten times more, and a slow hand would."""


def resting(recording: Recording, scene: Scene) -> NDArray[np.bool_]:
    """(F,) whether no simulated body and no link moves faster than STILL in the frame, on the mean: way of its origin, plus its
    turn times a lever of 0.1 m. A pose that is no number does not rest."""
    moving = [k for k, role in enumerate(scene.roles) if role is not Role.FIXED]
    if not moving or recording.frames == 0:
        return np.ones(recording.frames, dtype=np.bool_)
    way = movement(recording.positions[:, moving], recording.orientations[:, moving])
    return np.asarray(way <= STILL * recording.dt)
