"""Conversion at the ends of a frame: tracker samples to postures, poses to positions and quaternions, one kernel call each."""

from math import atan2, inf, sin, sqrt

import numpy as np
from numpy.typing import NDArray

from avatarsim.jit.kernel import kernel
from avatarsim.model.skeleton import Posture
from avatarsim.scene.tracker import UNIT_SLACK
from avatarsim.spatial.tangent import Columns, columns, turned
from avatarsim.spatial.vec3 import along, row
from avatarsim.tolerances import NOTHING

Array = NDArray[np.float64]


@kernel
def read_sample(positions: Array, rotations: Array, angles: Array, hinges: NDArray[np.int64], posture_out: Posture) -> bool:
    """Write a tracker sample into posture arrays; False if a number is not finite or a quaternion not of length 1."""
    good = True
    for link in range(rotations.shape[0]):
        w, x, y, z = rotations[link, 0], rotations[link, 1], rotations[link, 2], rotations[link, 3]
        length = sqrt(w * w + x * x + y * y + z * z)
        good = good and abs(length - 1.0) <= UNIT_SLACK
        w, x, y, z = w / length, x / length, y / length, z / length
        turn = posture_out.turn
        turn[link, 0, 0], turn[link, 0, 1], turn[link, 0, 2] = 1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)
        turn[link, 1, 0], turn[link, 1, 1], turn[link, 1, 2] = 2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)
        turn[link, 2, 0], turn[link, 2, 1], turn[link, 2, 2] = 2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)
        for k in range(3):
            good = good and abs(positions[link, k]) < inf
            posture_out.root[link, k] = positions[link, k]
    for k in range(angles.shape[0]):
        good = good and abs(angles[k]) < inf
        posture_out.angle[hinges[k]] = angles[k]
    return good


@kernel
def quaternion(m: Columns) -> tuple[float, float, float, float]:
    """Return the unit quaternion of a rotation matrix, w >= 0, from its largest component."""
    d0, d1, d2 = m[0][0], m[1][1], m[2][2]
    a, b, c = m[1][2] - m[2][1], m[2][0] - m[0][2], m[0][1] - m[1][0]
    e, f, g = m[1][0] + m[0][1], m[2][0] + m[0][2], m[2][1] + m[1][2]
    if d0 + d1 + d2 > 0.0:
        w, x, y, z = 1.0 + d0 + d1 + d2, a, b, c
    elif d0 > d1 and d0 > d2:
        w, x, y, z = a, 1.0 + d0 - d1 - d2, e, f
    elif d1 > d2:
        w, x, y, z = b, e, 1.0 + d1 - d0 - d2, g
    else:
        w, x, y, z = c, f, g, 1.0 + d2 - d0 - d1
    s = 1.0 / sqrt(w * w + x * x + y * y + z * z)
    if w < 0.0:
        s = -s
    return w * s, x * s, y * s, z * s


@kernel
def write_sample(
    posture: Posture, hinges: NDArray[np.int64], positions_out: Array, rotations_out: Array, angles_out: Array
) -> None:
    """Write a posture as a tracker sample, the inverse of `read_sample`."""
    for link in range(rotations_out.shape[0]):
        w, x, y, z = quaternion(columns(posture.turn, link))
        rotations_out[link, 0], rotations_out[link, 1], rotations_out[link, 2], rotations_out[link, 3] = w, x, y, z
        for k in range(3):
            positions_out[link, k] = posture.root[link, k]
    for k in range(angles_out.shape[0]):
        angles_out[k] = posture.angle[hinges[k]]


MEETING = NOTHING
"""Sine of the angle of two quaternions below which the arc between them is a straight line, to the last digit."""


@kernel
def mix_samples(
    positions: Array, rotations: Array, angles: Array, next_positions: Array, next_rotations: Array, next_angles: Array,
    share: float, positions_out: Array, rotations_out: Array, angles_out: Array,
) -> None:
    """Write the sample at a share of the way from one to the next: slerp (Shoemake 1985), the short way round, and lines."""
    for link in range(rotations.shape[0]):
        for k in range(3):
            positions_out[link, k] = positions[link, k] + share * (next_positions[link, k] - positions[link, k])
        cosine = 0.0
        for k in range(4):
            cosine += rotations[link, k] * next_rotations[link, k]
        sign = 1.0 if cosine >= 0.0 else -1.0
        cosine, square = abs(cosine), 0.0
        for k in range(4):
            off = sign * next_rotations[link, k] - cosine * rotations[link, k]
            square += off * off
        sine = sqrt(square)
        a, b = 1.0 - share, share
        if sine > MEETING:
            angle = atan2(sine, cosine)
            a, b = sin(a * angle) / sine, sin(b * angle) / sine
        length = 0.0
        for k in range(4):
            rotations_out[link, k] = a * rotations[link, k] + b * sign * next_rotations[link, k]
            length += rotations_out[link, k] * rotations_out[link, k]
        length = sqrt(length)
        for k in range(4):
            rotations_out[link, k] /= length
    for k in range(angles.shape[0]):
        angles_out[k] = angles[k] + share * (next_angles[k] - angles[k])


@kernel
def write_shown(
    position: Array, rotation: Array, centres: Array, first: int, positions_out: Array, orientations_out: Array
) -> bool:
    """Write body frames (n, 3) and (n, 4), from body `first` on, from centres of mass and rotation matrices; return False if a
    number of them is not finite."""
    good = True
    for b in range(first, position.shape[0]):
        frame = columns(rotation, b)
        origin = along(row(position, b), -1.0, turned(frame, row(centres, b)))
        w, x, y, z = quaternion(frame)
        orientations_out[b, 0], orientations_out[b, 1], orientations_out[b, 2], orientations_out[b, 3] = w, x, y, z
        for k in range(3):
            positions_out[b, k] = origin[k]
            good = good and abs(origin[k]) < inf
        good = good and abs(w) + abs(x) + abs(y) + abs(z) < inf
    return good
