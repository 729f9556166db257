"""Users of rigid hands that are led without turning: where the hands are at any time."""

from collections.abc import Callable, Sequence

import numpy as np

from avatarsim.scene.checks import Vector
from avatarsim.scene.scene import Scene
from avatarsim.scene.tracker import TrackerSample
from avatarsim.spatial import rotation
from scenarios.motion.keyframes import minimum_jerk
from scenarios.scenario import RENDERED, Motion

Places = Callable[[float], Sequence[Vector]]
"""Origins of all hands [m] at a time [s]."""


def hands_at(places: Sequence[Vector], time: float = 0.0) -> TrackerSample:
    """Return the sample of hands that are there, upright."""
    return TrackerSample(time, np.array(places), np.tile(rotation.IDENTITY, (len(places), 1)), np.zeros(0))


def led(places: Places) -> Callable[[Scene, int], Motion]:
    """Return the motion of hands that are where `places` says at every time."""
    return lambda scene, seed: lambda frame: hands_at(places((frame + 1) * RENDERED), (frame + 1) * RENDERED)


def eased(time: float, begin: float, end: float) -> float:
    """Return the share gone at `time` of a way from rest to rest between the times `begin` and `end` [s]: minimum jerk."""
    return float(minimum_jerk(np.clip([(time - begin) / (end - begin)], 0.0, 1.0))[0])
