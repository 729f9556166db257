"""Path of a rigid body over one segment: constant accelerations in closed form, torque-free rotation by Taylor series."""

from math import cos, sin, sqrt
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from avatarsim.jit.kernel import kernel
from avatarsim.jit.layout import IndexLine, Line, Matrices, Vectors
from avatarsim.motion.free_rotation import Series, spun, tumbled
from avatarsim.spatial.tangent import columns, put_columns, turned, turned_back
from avatarsim.spatial.vec3 import Vec3, add, along, cross, dot, put_row, row, scale
from avatarsim.world.geometry import Geometry, Poses, place

Array = NDArray[np.float64]
Index = NDArray[np.int64]

STILL, FREE, HELD = 0, 1, 2
"""Kind of a path: at rest; only gravity acts; contact forces act too and both accelerations are constant."""


class Paths(NamedTuple):
    """One path per body, from the velocities at the start of the segment.

    kind (nb); linear, angular (nb, 3) accelerations [m/s^2], [rad/s^2]; round (nb) 1 if no torque arises from spinning;
    inertia, inverse_inertia (nb, 3, 3) in body axes; time (nb) [s] at which `trial` poses stand; v, w (nb, 3) velocities then.
    """

    kind: IndexLine
    linear: Vectors
    angular: Vectors
    round: IndexLine
    inertia: Matrices
    inverse_inertia: Matrices
    time: Line
    v: Vectors
    w: Vectors


def make_paths(inertia: Array, inverse_inertia: Array, round_: Index) -> Paths:
    """Paths of bodies at rest."""
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
    """Angular velocity and acceleration of exp(theta), whose rotation vector changes by ``rate`` and that by ``gain``.

    w = rate + B theta x rate + C theta x (theta x rate) with B = (1 - cos f) / f^2, C = (f - sin f) / f^3, f = |theta|, and its
    derivative. Only while theta and rate are parallel is w the rate itself.
    """
    ff = dot(theta, theta)
    if ff > 0.25:
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
    """Of body b on its path [m/s^2]; none of a body at rest, be it that it stopped on a path that goes on."""
    return (0.0, 0.0, 0.0) if paths.kind[b] == STILL else row(paths.linear, b)


@kernel
def spinning(paths: Paths, angular: Array, turn: Array, b: int) -> tuple[Vec3, Vec3]:
    """True angular velocity and acceleration, world axes, of body b where ``move_along`` left it.

    ``angular`` (nb, 3) velocities at the start of the segment; ``turn`` (nb, 3, 3) rotations now. That of a held body differs
    from ``paths.w`` where it does not turn about one axis: its rotation vector is what grows evenly.
    """
    if paths.kind[b] == HELD:
        t, w, alpha = paths.time[b], row(angular, b), row(paths.angular, b)
        return of_rotation_vector(along(scale(w, t), 0.5 * t * t, alpha), along(w, t, alpha), alpha)
    if paths.kind[b] == STILL or paths.round[b] == 1:
        return row(paths.w, b), (0.0, 0.0, 0.0)
    return row(paths.w, b), gyroscopic(paths, turn, b)


@kernel
def gyroscopic(paths: Paths, turn: Array, b: int) -> Vec3:
    """Euler's I^-1 ((I w) x w) [rad/s^2], world axes."""
    r = columns(turn, b)
    w = turned_back(r, row(paths.w, b))
    return turned(r, turned(columns(paths.inverse_inertia, b), cross(turned(columns(paths.inertia, b), w), w)))
