"""Motors that add to Bullet's limits of ball joints, whose cones have four corners and end at 85 degrees (urdf.py): each holds
harder while its joint is beyond our limits.

A motor's target is within the limits, so that its torque brings the joint back; the load that pushed it out is as a rule stronger
than the torque by which a limb follows its user.
"""

from collections.abc import Sequence

import numpy as np
import pybullet
from numpy.typing import NDArray

from avatarsim.scene.joint import SwingTwist
from avatarsim.spatial import rotation
from reference.target_kernels import beyond_stops

Array = NDArray[np.float64]


class BallStops:
    """The balls of one multibody that have limits: `joints`, and their `rows` among all motors of balls. rests (n, 4) are the
    links' orientations at rest; Bullet states a turn of ours as left turn frame, `lefts` and `frames` (n, 4)."""

    def __init__(self, client: int, body: int, joints: list[int], rows: list[int], limits: Sequence[SwingTwist], rests: Array,
                 lefts: Array, frames: Array) -> None:
        self._client, self._body, self._joints, self._rows = client, body, joints, rows
        centred = [rotation.conjugate(rotation.between(limit.axis, limit.centre)) for limit in limits]
        self._left = rotation.multiply(rotation.multiply(np.array(centred), rests), rotation.conjugate(lefts))
        self._right = rotation.conjugate(frames)
        self._axis = np.array([limit.axis for limit in limits], dtype=np.float64)
        self._stops = np.array([(limit.swing, *limit.twist) for limit in limits], dtype=np.float64)
        self._found = np.zeros(len(joints), dtype=np.bool_)

    def harden(self, torques: list[list[float]], usual: list[float], hard: list[float]) -> None:
        """Put `hard` [N m] into the rows of `torques` whose joints are beyond their limits now, `usual` into the others."""
        states = pybullet.getJointStatesMultiDof(self._body, self._joints, physicsClientId=self._client)
        turns = np.array([state[0] for state in states])
        beyond_stops(turns, self._left, self._right, self._axis, self._stops, self._found)
        for row, beyond in zip(self._rows, self._found.tolist(), strict=True):
            torques[row] = hard if beyond else usual
