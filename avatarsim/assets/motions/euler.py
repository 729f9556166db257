"""Cardan (Tait-Bryan) angles of any order: three turns about three different axes, and back, on the branch nearest a given one.

Closed form of the angles as in Shuster, *A Survey of Attitude Representations* (1993). The last angle is taken from the rest
after the first two, so that their product is the rotation to rounding, also where the first and the last turn share an axis
(gimbal lock).
"""

import numpy as np
from numpy.typing import NDArray

from avatarsim.spatial import rotation

Array = NDArray[np.float64]

LOCKED = 1e-11
"""Cosine of the middle angle below which the first angle is free and the given one is kept: by then it turns the body by less
than 1e-11 rad about anything but the last axis."""


def quaternion(axes: tuple[int, ...], angles: Array) -> Array:
    """Return the quaternion (..., 4) of turns by `angles` (..., n) [rad] about `axes` (0 to 2), the first one outermost."""
    turned = np.zeros((*angles.shape[:-1], 4))
    turned[..., 0] = 1.0
    for k, axis in enumerate(axes):
        turned = rotation.multiply(turned, rotation.from_axis_angle(np.eye(3)[axis], angles[..., k]))
    return turned


def cardan(axes: tuple[int, int, int], turned: Array, near: Array) -> Array:
    """Return angles (..., 3) [rad] about `axes`, the first one outermost, whose product is the unit quaternion `turned` (..., 4).

    Of the two branches, and all whole turns added to each angle, those nearest the angles `near` (..., 3)."""
    i, j, k = axes
    sign = 1.0 if (j - i) % 3 == 1 else -1.0
    m = rotation.to_matrix(turned)
    level = np.hypot(m[..., i, i], m[..., i, j])
    middle = np.arctan2(sign * m[..., i, k], level)
    first = np.arctan2(-sign * m[..., j, k], m[..., k, k])
    branches = []
    for a, b in ((first, middle), (first + np.pi, np.pi - middle)):
        a = near[..., 0] + _wrapped(np.where(level < LOCKED, near[..., 0], a) - near[..., 0])
        b = near[..., 1] + _wrapped(b - near[..., 1])
        done = quaternion((i, j), np.stack([a, b], axis=-1))
        left = rotation.multiply(rotation.conjugate(done), turned)
        c = 2.0 * np.arctan2(left[..., 1 + k], left[..., 0])
        branches.append(np.stack([a, b, near[..., 2] + _wrapped(c - near[..., 2])], axis=-1))
    away = [np.abs(branch - near).sum(axis=-1) for branch in branches]
    return np.where((away[0] <= away[1])[..., None], branches[0], branches[1])


def _wrapped(angle: Array) -> Array:
    """Return the angle [rad] less whole turns, from -pi to pi."""
    return np.asarray(angle - 2.0 * np.pi * np.round(angle / (2.0 * np.pi)))
