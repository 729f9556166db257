"""Rotations inside kernels: matrices as three column tuples, steps in the tangent space R <- R exp(w)."""

from math import atan2, cos, sin, sqrt
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from avatarsim.jit.kernel import kernel
from avatarsim.spatial.vec3 import Vec3, add, along, cross, dot, scale, unit
from avatarsim.tolerances import GRAIN

Columns: TypeAlias = tuple[Vec3, Vec3, Vec3]
"""The columns x, y, z of a rotation matrix: where it takes the coordinate axes."""

Matrices: TypeAlias = NDArray[np.float64]
"""Rotation matrices (n, 3, 3)."""

STRAIGHT = GRAIN
"""Rotation vectors shorter than this [rad] are no rotation: dividing by their length would only make noise."""


@kernel
def columns(m: Matrices, i: int) -> Columns:
    """Columns of one matrix."""
    return (
        (m[i, 0, 0], m[i, 1, 0], m[i, 2, 0]),
        (m[i, 0, 1], m[i, 1, 1], m[i, 2, 1]),
        (m[i, 0, 2], m[i, 1, 2], m[i, 2, 2]),
    )


@kernel
def put_columns(m_out: Matrices, i: int, c: Columns) -> None:
    """Write three columns into one matrix."""
    for k in range(3):
        m_out[i, k, 0] = c[0][k]
        m_out[i, k, 1] = c[1][k]
        m_out[i, k, 2] = c[2][k]


@kernel
def turned(c: Columns, v: Vec3) -> Vec3:
    """Matrix times vector."""
    return add(add(scale(c[0], v[0]), scale(c[1], v[1])), scale(c[2], v[2]))


@kernel
def turned_back(c: Columns, v: Vec3) -> Vec3:
    """Transposed matrix times vector."""
    return (dot(c[0], v), dot(c[1], v), dot(c[2], v))


@kernel
def product(a: Columns, b: Columns) -> Columns:
    """Matrix product a b."""
    return (turned(a, b[0]), turned(a, b[1]), turned(a, b[2]))


@kernel
def about(axis: Vec3, angle: float, v: Vec3) -> Vec3:
    """v turned by `angle` [rad] about the unit `axis` (Rodrigues)."""
    c, s = cos(angle), sin(angle)
    return along(along(scale(v, c), s, cross(axis, v)), dot(axis, v) * (1.0 - c), axis)


@kernel
def stepped(c: Columns, w: Vec3) -> Columns:
    """R exp(w): the frame turned by the rotation vector w [rad], given in the frame's own axes."""
    angle = sqrt(dot(w, w))
    if angle < STRAIGHT:
        return c
    axis = scale(turned(c, w), 1.0 / angle)
    return (about(axis, angle, c[0]), about(axis, angle, c[1]), about(axis, angle, c[2]))


@kernel
def straightened(c: Columns) -> Columns:
    """The same frame with rounding removed: unit columns at right angles (Gram and Schmidt, x kept)."""
    x = unit(c[0])
    y = unit(along(c[1], -dot(x, c[1]), x))
    return (x, y, cross(x, y))


@kernel
def rotation_vector(m: Columns) -> Vec3:
    """Rotation vector of a rotation matrix [rad], the short way round; exact near 0 and near pi.

    By the quaternion with the largest component, so that nothing is divided by a small number.
    """
    d0, d1, d2 = m[0][0], m[1][1], m[2][2]
    a, b, c = m[1][2] - m[2][1], m[2][0] - m[0][2], m[0][1] - m[1][0]
    trace = d0 + d1 + d2
    if trace > 0.0:
        w, x, y, z = 1.0 + trace, a, b, c
    elif d0 > d1 and d0 > d2:
        w, x, y, z = a, 1.0 + d0 - d1 - d2, m[0][1] + m[1][0], m[2][0] + m[0][2]
    elif d1 > d2:
        w, x, y, z = b, m[0][1] + m[1][0], 1.0 + d1 - d0 - d2, m[1][2] + m[2][1]
    else:
        w, x, y, z = c, m[2][0] + m[0][2], m[1][2] + m[2][1], 1.0 + d2 - d0 - d1
    if w < 0.0:
        w, x, y, z = -w, -x, -y, -z
    s = sqrt(x * x + y * y + z * z)
    # the small-angle limit: log is twice the vector part over the scalar part
    f = 2.0 * atan2(s, w) / s if s > STRAIGHT * w else 2.0 / w
    return (f * x, f * y, f * z)


@kernel
def step_between(start: Columns, end: Columns) -> Vec3:
    """w with start exp(w) = end: the rotation vector of start^T end, in the axes of `start`."""
    return rotation_vector((turned_back(start, end[0]), turned_back(start, end[1]), turned_back(start, end[2])))


@kernel
def turn_of(before: Columns, now: Columns) -> Vec3:
    """Rotation vector, in world axes, that takes one orientation to another: log(now before^T)."""
    inverse = (
        (before[0][0], before[1][0], before[2][0]),
        (before[0][1], before[1][1], before[2][1]),
        (before[0][2], before[1][2], before[2][2]),
    )
    return rotation_vector((turned(now, inverse[0]), turned(now, inverse[1]), turned(now, inverse[2])))
