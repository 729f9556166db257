"""Compile the kernels of the harness ahead: adapters of other engines.

`python -m avatarsim compile` runs this in a checkout. No other engine is imported, since some of them may not be installed.
"""

import numpy as np

from avatarsim.compile_ahead import part_scene
from reference.reading_kernels import about_own_centres, body_frames
from reference.target_kernels import beyond_stops
from reference.targets import Followed, Targets


def compile_kernels() -> None:
    """Call every kernel of this package once, from Python, with arguments of the types that its callers pass."""
    compile_targets()
    compile_readings()


def compile_targets() -> None:
    """Follow a motion of the scene that has a ball joint with limits and a hinge."""
    scene, _ = part_scene("posture")
    targets = Targets(scene, clamp=True)
    sample = targets.within_limits(scene.first_sample)
    goals = targets.between(sample, sample, np.array([0.5, 1.0]))
    targets.posture(sample)
    targets.ahead(goals, 1.0)
    turn = np.array([[1.0, 0.0, 0.0, 0.0]])
    Followed([1], turn, turn).aimed(goals.turns, 0.5)
    beyond_stops(turn, turn, turn, np.zeros((1, 3)), np.zeros((1, 3)), np.zeros(1, dtype=np.bool_))


def compile_readings() -> None:
    """Read the state of no instant of one body."""
    place, turn, motion, body = np.zeros((0, 1, 3)), np.zeros((0, 1, 4)), np.zeros((0, 1, 6)), np.zeros(1, dtype=np.int64)
    body_frames(np.zeros((0, 1, 13)), np.zeros((1, 4)), np.zeros((1, 3)), place, turn, place, place)
    about_own_centres(place, turn, motion, place, place, body, body, place, turn, place, place)
