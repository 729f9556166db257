"""Motions of moving bodies: poses by time, while hands stay where they begin."""

from collections.abc import Callable, Mapping
from dataclasses import replace

import numpy as np

from avatarsim.scene.checks import Quaternion
from avatarsim.scene.moving import Pose, with_moving
from avatarsim.scene.scene import Scene
from scenarios.scenario import RENDERED, Motion


def given(poses: Callable[[float], Mapping[str, Pose]]) -> Callable[[Scene, int], Motion]:
    """Return the motion of moving bodies whose poses are those of `poses` at every time [s]."""

    def motion(scene: Scene, seed: int) -> Motion:
        start = scene.first_sample
        return lambda frame: with_moving(
            scene.avatars, replace(start, time=(frame + 1) * RENDERED), poses((frame + 1) * RENDERED), start
        )

    return motion


def about_z(angle: float) -> Quaternion:
    """A rotation by an angle [rad]."""
    return float(np.cos(0.5 * angle)), 0.0, 0.0, float(np.sin(0.5 * angle))
