"""Path of a rigid body over one segment: constant accelerations in closed form, torque-free rotation by Taylor series.

Torque-free rotation, exact to rounding: Taylor series of Euler's equations and of the orientation quaternion.
"""

from math import cos, sin, sqrt
from typing import Annotated, NamedTuple

import numpy as np
from numpy.typing import NDArray

from avatarsim.jit.kept import NOT_KEPT, Whole
from avatarsim.jit.kernel import kernel
from avatarsim.jit.layout import Grid, IndexLine, Line, Matrices, Vectors
from avatarsim.model.geometry import Geometry, Poses, place
from avatarsim.spatial.tangent import Columns, about, columns, product, put_columns, straightened, turned, turned_back
from avatarsim.spatial.vec3 import Vec3, add, along, cross, dot, norm, put_row, row, scale
from avatarsim.tolerances import LAST_PLACES, SHORT_TURN

Array = NDArray[np.float64]

ORDER = 24
"""Terms of the series. With steps of TURN the last ones are below rounding; fewer lose energy, more cost nothing (early stop)."""

TURN = SHORT_TURN
"""Largest angle [rad] of one step of the series. Larger: the series needs more terms than ORDER; smaller: more steps."""

STEPS_CAP = 2000
"""Most steps of the series at once. A body that turns farther, by 1000 rad at a time (60,000 rad/s in a frame), keeps its
angular velocity instead: without a cap a finite input could take for ever."""

NEGLIGIBLE = LAST_PLACES / 100.0
"""The series ends when a whole term is below this part of its first: all that follow together then change no digit."""


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
    """Return the rotation after t seconds at the constant angular velocity w [rad/s], world axes."""
    speed = norm(w)
    if speed * t == 0.0:
        return turn
    axis = scale(w, 1.0 / speed)
    angle = speed * t
    return straightened((about(axis, angle, turn[0]), about(axis, angle, turn[1]), about(axis, angle, turn[2])))


@kernel
def from_quaternion(w: float, x: float, y: float, z: float) -> Columns:
    """Return the rotation matrix of a quaternion that need not be of unit length."""
    s = 2.0 / (w * w + x * x + y * y + z * z)
    return (
        (1.0 - s * (y * y + z * z), s * (x * y + z * w), s * (x * z - y * w)),
        (s * (x * y - z * w), 1.0 - s * (x * x + z * z), s * (y * z + x * w)),
        (s * (x * z + y * w), s * (y * z - x * w), 1.0 - s * (x * x + y * y)),
    )


@kernel
def series_step(inverse_inertia: Columns, momentum: Vec3, h: float, series: Series) -> Columns:
    """Return the rotation of the body during h seconds, in its own axes at the start.

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
    """Return rotation and angular velocity after t seconds without torque; conserves angular momentum, except beyond STEPS_CAP.

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


Index = NDArray[np.int64]

STILL, FREE, HELD = 0, 1, 2
"""Kind of a path: at rest; only gravity acts; contact forces act too and both accelerations are constant."""


class Paths(NamedTuple):
    """One path per body, from the velocities at the start of the segment.

    kind (nb); linear, angular (nb, 3) accelerations [m/s^2], [rad/s^2]; round (nb) 1 if no torque arises from spinning; inertia,
    inverse_inertia (nb, 3, 3) in body axes; time (nb) [s] of the `trial` poses; v, w (nb, 3) velocities then.
    """

    kind: Annotated[IndexLine, Whole(STILL, HELD)]
    linear: Vectors
    angular: Vectors
    round: Annotated[IndexLine, NOT_KEPT]
    inertia: Annotated[Matrices, NOT_KEPT]
    inverse_inertia: Annotated[Matrices, NOT_KEPT]
    time: Line
    v: Vectors
    w: Vectors


def make_paths(inertia: Array, inverse_inertia: Array, round_: Index) -> Paths:
    """Return paths of bodies at rest."""
    n = len(round_)
    return Paths(
        np.zeros(n, np.int64), np.zeros((n, 3)), np.zeros((n, 3)), round_, inertia, inverse_inertia, np.zeros(n),
        np.zeros((n, 3)), np.zeros((n, 3)),
    )


@kernel
def move_along(
    geometry: Geometry, start: Poses, linear: Array, angular: Array, paths: Paths, series: Series, b: int, t: float, trial: Poses
) -> None:
    """Put body b of ``trial``, and its velocities ``paths.v``, ``paths.w``, where its path leads in t seconds from ``start``.

    A body at rest stays where ``trial`` has it.
    """
    if paths.kind[b] == STILL:
        put_row(paths.v, b, (0.0, 0.0, 0.0))
        put_row(paths.w, b, (0.0, 0.0, 0.0))
        return
    if paths.time[b] == t:
        return
    paths.time[b] = t
    x, v, a = row(start.position, b), row(linear, b), row(paths.linear, b)
    put_row(trial.position, b, along(along(x, t, v), 0.5 * t * t, a))
    put_row(paths.v, b, along(v, t, a))
    w, turn = row(angular, b), columns(start.rotation, b)
    if paths.kind[b] == HELD:
        alpha = row(paths.angular, b)
        turn = spun(turn, along(w, 0.5 * t, alpha), t)
        w = along(w, t, alpha)
    elif dot(w, w) > 0.0 and paths.kind[b] == FREE:
        if paths.round[b] == 1:
            turn = spun(turn, w, t)
        else:
            turn, w = tumbled(columns(paths.inertia, b), columns(paths.inverse_inertia, b), turn, w, t, series)
    put_columns(trial.rotation, b, turn)
    put_row(paths.w, b, w)
    place(geometry, trial, b)


@kernel
def of_rotation_vector(theta: Vec3, rate: Vec3, gain: Vec3) -> tuple[Vec3, Vec3]:
    """Return the angular velocity and acceleration of exp(theta), whose rotation vector changes by ``rate`` and that by ``gain``.

    w = rate + B theta x rate + C theta x (theta x rate) with B = (1 - cos f) / f^2, C = (f - sin f) / f^3, f = |theta|, and its
    derivative. Only while theta and rate are parallel is w the rate itself.
    """
    ff = dot(theta, theta)
    if ff > SHORT_TURN * SHORT_TURN:
        f = sqrt(ff)
        s, c = sin(f), 1.0 - cos(f)
        b, k = c / ff, (f - s) / (ff * f)
        # their derivatives by f, over f
        db, dk = (f * s - 2.0 * c) / (ff * ff), (f * c - 3.0 * (f - s)) / (ff * ff * f)
    else:
        b = 1.0 / 2.0 - ff * (1.0 / 24.0 - ff * (1.0 / 720.0 - ff * (1.0 / 40320.0 - ff / 3628800.0)))
        k = 1.0 / 6.0 - ff * (1.0 / 120.0 - ff * (1.0 / 5040.0 - ff * (1.0 / 362880.0 - ff / 39916800.0)))
        db = -(1.0 / 12.0 - ff * (1.0 / 180.0 - ff * (1.0 / 6720.0 - ff / 453600.0)))
        dk = -(1.0 / 60.0 - ff * (1.0 / 1260.0 - ff * (1.0 / 60480.0 - ff / 4989600.0)))
    one = cross(theta, rate)
    two = cross(theta, one)
    grows = dot(theta, rate)
    w = add(rate, add(scale(one, b), scale(two, k)))
    one_rate = cross(theta, gain)
    two_rate = add(cross(rate, one), cross(theta, one_rate))
    alpha = add(gain, add(scale(one_rate, b), scale(two_rate, k)))
    return w, add(alpha, add(scale(one, db * grows), scale(two, dk * grows)))


@kernel
def acceleration(paths: Paths, b: int) -> Vec3:
    """Return the acceleration of body b on its path [m/s^2]; none of a body at rest, even if its path continues."""
    return (0.0, 0.0, 0.0) if paths.kind[b] == STILL else row(paths.linear, b)


@kernel
def spinning(paths: Paths, angular: Array, turn: Array, b: int) -> tuple[Vec3, Vec3]:
    """Return the true angular velocity and acceleration, world axes, of body b where ``move_along`` left it.

    ``angular`` (nb, 3) velocities at the start of the segment; ``turn`` (nb, 3, 3) rotations now. That of a held body differs
    from ``paths.w`` where it does not turn about one axis: its rotation vector grows evenly.
    """
    if paths.kind[b] == HELD:
        t, w, alpha = paths.time[b], row(angular, b), row(paths.angular, b)
        return of_rotation_vector(along(scale(w, t), 0.5 * t * t, alpha), along(w, t, alpha), alpha)
    if paths.kind[b] == STILL or paths.round[b] == 1:
        return row(paths.w, b), (0.0, 0.0, 0.0)
    return row(paths.w, b), gyroscopic(paths, turn, b)


@kernel
def gyroscopic(paths: Paths, turn: Array, b: int) -> Vec3:
    """Return Euler's I^-1 ((I w) x w) [rad/s^2], world axes."""
    r = columns(turn, b)
    w = turned_back(r, row(paths.w, b))
    return turned(r, turned(columns(paths.inverse_inertia, b), cross(turned(columns(paths.inertia, b), w), w)))
