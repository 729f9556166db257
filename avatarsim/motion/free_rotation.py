"""Torque-free rotation, exact to rounding: Taylor series of Euler's equations and of the orientation quaternion."""

from math import sqrt
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from avatarsim.jit.kernel import kernel
from avatarsim.jit.layout import Grid, Vectors
from avatarsim.spatial.tangent import Columns, about, product, straightened, turned, turned_back
from avatarsim.spatial.vec3 import Vec3, add, cross, dot, norm, put_row, row, scale

Array = NDArray[np.float64]

ORDER = 24
"""Terms of the series. With steps of TURN the last ones are below rounding; fewer lose energy, more cost nothing (early stop)."""

TURN = 0.5
"""Largest angle [rad] of one step of the series. Larger: the series needs more terms than ORDER; smaller: more steps."""

STEPS_CAP = 2000
"""Most steps of the series at once. A body that turns farther, by 1000 rad at a time (60,000 rad/s in a frame), keeps its
angular velocity instead: without a cap a finite input could take for ever."""

NEGLIGIBLE = 1e-17
"""The series ends when a whole term is below this part of its first."""


class Series(NamedTuple):
    """Taylor coefficients: momentum and rate in body axes (ORDER + 1, 3), quaternion (ORDER + 1, 4)."""

    momentum: Vectors
    rate: Vectors
    quaternion: Grid


def make_series() -> Series:
    """Allocate the coefficients; one per thread."""
    return Series(np.zeros((ORDER + 1, 3)), np.zeros((ORDER + 1, 3)), np.zeros((ORDER + 1, 4)))


@kernel
def spun(turn: Columns, w: Vec3, t: float) -> Columns:
    """Rotation after t seconds at the constant angular velocity w [rad/s], world axes."""
    speed = norm(w)
    if speed * t == 0.0:
        return turn
    axis = scale(w, 1.0 / speed)
    angle = speed * t
    return straightened((about(axis, angle, turn[0]), about(axis, angle, turn[1]), about(axis, angle, turn[2])))


@kernel
def from_quaternion(w: float, x: float, y: float, z: float) -> Columns:
    """Rotation matrix of a quaternion that need not be of unit length."""
    s = 2.0 / (w * w + x * x + y * y + z * z)
    return (
        (1.0 - s * (y * y + z * z), s * (x * y + z * w), s * (x * z - y * w)),
        (s * (x * y - z * w), 1.0 - s * (x * x + z * z), s * (y * z + x * w)),
        (s * (x * z + y * w), s * (y * z - x * w), 1.0 - s * (x * x + y * y)),
    )


@kernel
def series_step(inverse_inertia: Columns, momentum: Vec3, h: float, series: Series) -> Columns:
    """Rotation of the body during h seconds, in its own axes at the start.

    m' = m x w, w = I^-1 m, q' = q w / 2, in units of h: products of series are sums of products of their coefficients.
    """
    m, w, q = series.momentum, series.rate, series.quaternion
    put_row(m, 0, momentum)
    put_row(w, 0, scale(turned(inverse_inertia, momentum), h))
    q[0, 0], q[0, 1], q[0, 2], q[0, 3] = 1.0, 0.0, 0.0, 0.0
    s0, s1, s2, s3 = 1.0, 0.0, 0.0, 0.0
    size = norm(momentum)
    for n in range(ORDER):
        dm = (0.0, 0.0, 0.0)
        d0, d1, d2, d3 = 0.0, 0.0, 0.0, 0.0
        for i in range(n + 1):
            r = row(w, n - i)
            dm = add(dm, cross(row(m, i), r))
            q0, q1, q2, q3 = q[i, 0], q[i, 1], q[i, 2], q[i, 3]
            d0 -= q1 * r[0] + q2 * r[1] + q3 * r[2]
            d1 += q0 * r[0] + q2 * r[2] - q3 * r[1]
            d2 += q0 * r[1] + q3 * r[0] - q1 * r[2]
            d3 += q0 * r[2] + q1 * r[1] - q2 * r[0]
        f = 1.0 / (n + 1)
        dm = scale(dm, f)
        put_row(m, n + 1, dm)
        put_row(w, n + 1, scale(turned(inverse_inertia, dm), h))
        f *= 0.5
        q[n + 1, 0], q[n + 1, 1], q[n + 1, 2], q[n + 1, 3] = f * d0, f * d1, f * d2, f * d3
        s0, s1, s2, s3 = s0 + f * d0, s1 + f * d1, s2 + f * d2, s3 + f * d3
        if f * (abs(d0) + abs(d1) + abs(d2) + abs(d3)) < NEGLIGIBLE and norm(dm) <= NEGLIGIBLE * size:
            break
    return from_quaternion(s0, s1, s2, s3)


@kernel
def tumbled(
    inertia: Columns, inverse_inertia: Columns, turn: Columns, w: Vec3, t: float, series: Series
) -> tuple[Columns, Vec3]:
    """Rotation and angular velocity after t seconds without torque; angular momentum is conserved by construction, except
    beyond STEPS_CAP.

    Args:
        inertia, inverse_inertia: in body axes.
        turn: rotation at the start; w: angular velocity at the start [rad/s], world axes.
    """
    angle = sqrt(dot(w, w)) * t
    if not (angle < STEPS_CAP * TURN):
        return spun(turn, w, t), w
    momentum = turned(turn, turned(inertia, turned_back(turn, w)))
    steps = int(angle / TURN) + 1
    h = t / steps
    for _ in range(steps):
        turn = straightened(product(turn, series_step(inverse_inertia, turned_back(turn, momentum), h, series)))
    return turn, turned(turn, turned(inverse_inertia, turned_back(turn, momentum)))
