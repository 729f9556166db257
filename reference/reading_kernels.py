"""Compiled kernels that turn the states of all bodies at some instants, as an engine states them, into body frames.

A kernel of each engine: for the few rows of a frame numpy's overhead per call is more than a tenth of the cost of the engine's
own steps. The plain twins are in the tests. Quaternions are (w, x, y, z) unless stated otherwise.
"""

import numpy as np
from numpy.typing import NDArray

from avatarsim.jit.kernel import kernel

Array = NDArray[np.float64]
Integers = NDArray[np.int64]


@kernel
def body_frames(rows: Array, frames: Array, centres: Array, positions: Array, orientations: Array, velocities: Array,
                spins: Array) -> int:
    """Write the states `rows` (n, bodies, 13) of mass centres as poses of body frames and velocities; 0 on return.

    A row holds place [m], turn (x, y, z, w), velocity [m/s] and spin [rad/s]. `frames` (bodies, 4) turn a body's frame back out
    of the principal one, `centres` (bodies, 3) [m] are the mass centres in body frames."""
    for i in range(rows.shape[0]):
        for k in range(rows.shape[1]):
            row, frame, centre = rows[i, k], frames[k], centres[k]
            px, py, pz, pw = row[3], row[4], row[5], row[6]
            qw, qx, qy, qz = frame[0], frame[1], frame[2], frame[3]
            w = pw * qw - px * qx - py * qy - pz * qz
            x = pw * qx + px * qw + py * qz - pz * qy
            y = pw * qy - px * qz + py * qw + pz * qx
            z = pw * qz + px * qy - py * qx + pz * qw
            # the centre turned by a unit quaternion: v + 2 w (u x v) + 2 u x (u x v)
            tx = 2.0 * (y * centre[2] - z * centre[1])
            ty = 2.0 * (z * centre[0] - x * centre[2])
            tz = 2.0 * (x * centre[1] - y * centre[0])
            positions[i, k, 0] = row[0] - (centre[0] + w * tx + (y * tz - z * ty))
            positions[i, k, 1] = row[1] - (centre[1] + w * ty + (z * tx - x * tz))
            positions[i, k, 2] = row[2] - (centre[2] + w * tz + (x * ty - y * tx))
            orientations[i, k, 0], orientations[i, k, 1] = w, x
            orientations[i, k, 2], orientations[i, k, 3] = y, z
            for c in range(3):
                velocities[i, k, c], spins[i, k, c] = row[7 + c], row[10 + c]
    return 0


@kernel
def about_own_centres(places: Array, turns: Array, motions: Array, centres: Array, trees: Array, ids: Integers, roots: Integers,
                      positions: Array, orientations: Array, velocities: Array, spins: Array) -> int:
    """Write the bodies `ids` from the states of all (n, all, .), with velocities about their own mass centres; 0 on return.

    `motions` hold spin [rad/s] and the velocity [m/s] of the body extended to `trees`, the mass centre [m] of the tree whose
    root is in `roots`; `centres` [m] are the bodies' own mass centres."""
    for i in range(places.shape[0]):
        for k in range(len(ids)):
            body, root = ids[k], roots[k]
            sx, sy, sz = motions[i, body, 0], motions[i, body, 1], motions[i, body, 2]
            ax = centres[i, body, 0] - trees[i, root, 0]
            ay = centres[i, body, 1] - trees[i, root, 1]
            az = centres[i, body, 2] - trees[i, root, 2]
            spins[i, k, 0], spins[i, k, 1], spins[i, k, 2] = sx, sy, sz
            velocities[i, k, 0] = motions[i, body, 3] + (sy * az - sz * ay)
            velocities[i, k, 1] = motions[i, body, 4] + (sz * ax - sx * az)
            velocities[i, k, 2] = motions[i, body, 5] + (sx * ay - sy * ax)
            for c in range(3):
                positions[i, k, c] = places[i, body, c]
            for c in range(4):
                orientations[i, k, c] = turns[i, body, c]
    return 0
