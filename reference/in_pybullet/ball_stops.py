"""Limits of ball joints where createMultiBody has no word for them: a motor that holds harder while its joint is beyond them.

Bullet has such limits for models in URDF files (`<limit lower upper twist>` of a spherical joint).

What a motor is asked for is within the limits, so that its torque brings the joint back; what pushed it out is as a rule stronger
than the torque by which a limb follows its user.
"""

import math
from collections.abc import Sequence

import numpy as np
import pybullet
from numpy.typing import NDArray

from avatarsim.jit.kernel import kernel
from avatarsim.scene.joint import SwingTwist
from avatarsim.spatial import rotation

Array = NDArray[np.float64]

BEYOND = 1e-3
"""Excess [rad] from which a motor holds: at 0, one that is asked for its very limit would hold at every step."""


@kernel
def beyond_stops(states: Array, left: Array, right: Array, axis: Array, stops: Array, found: NDArray[np.bool_]) -> int:
    """Write which of `states` (n, 4), joint turns (x, y, z, w) as Bullet has them, are beyond `stops` (n, 3) [rad]: swing, lower
    and upper twist; 0 on return. left turn right, (n, 4) each, is the turn away from the cone's centre, of a limb along `axis`
    (n, 3)."""
    for k in range(len(states)):
        w, x, y, z = states[k, 3], states[k, 0], states[k, 1], states[k, 2]
        pw, px, py, pz = left[k, 0], left[k, 1], left[k, 2], left[k, 3]
        w, x, y, z = (pw * w - px * x - py * y - pz * z, pw * x + px * w + py * z - pz * y,
                      pw * y - px * z + py * w + pz * x, pw * z + px * y - py * x + pz * w)
        qw, qx, qy, qz = right[k, 0], right[k, 1], right[k, 2], right[k, 3]
        w, x, y, z = (w * qw - x * qx - y * qy - z * qz, w * qx + x * qw + y * qz - z * qy,
                      w * qy - x * qz + y * qw + z * qx, w * qz + x * qy - y * qx + z * qw)
        along = x * axis[k, 0] + y * axis[k, 1] + z * axis[k, 2]
        across = math.sqrt(max(0.0, x * x + y * y + z * z - along * along))
        swing = 2.0 * math.atan2(across, math.sqrt(w * w + along * along))
        twist = 2.0 * math.atan2(along, w)
        if twist > math.pi:
            twist -= 2.0 * math.pi
        elif twist < -math.pi:
            twist += 2.0 * math.pi
        found[k] = swing > stops[k, 0] + BEYOND or not stops[k, 1] - BEYOND <= twist <= stops[k, 2] + BEYOND
    return 0


class BallStops:
    """Those balls of one multibody that have limits: `joints`, and their `rows` among all motors of balls. rests (n, 4) are the
    links' orientations at rest, frames (n, 4) Bullet's frames against ours."""

    def __init__(self, client: int, body: int, joints: list[int], rows: list[int], limits: Sequence[SwingTwist], rests: Array,
                 frames: Array) -> None:
        self._client, self._body, self._joints, self._rows = client, body, joints, rows
        centred = [rotation.conjugate(rotation.between(limit.axis, limit.centre)) for limit in limits]
        self._left = rotation.multiply(rotation.multiply(np.array(centred), rests), frames)
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
