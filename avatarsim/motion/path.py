"""Where a body is during one segment: constant force in closed form, free rotation by its series."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from avatarsim.kernel import kernel
from avatarsim.motion.free_rotation import Series, spun, tumbled
from avatarsim.spatial.tangent import columns, put_columns, turned, turned_back
from avatarsim.spatial.vec3 import Vec3, along, cross, dot, put_row, row
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

    kind: Index
    linear: Array
    angular: Array
    round: Index
    inertia: Array
    inverse_inertia: Array
    time: Array
    v: Array
    w: Array


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
def angular_acceleration(paths: Paths, turn: Array, b: int) -> Vec3:
    """Angular acceleration [rad/s^2], world axes, of body b where ``move_along`` left it; ``turn`` (nb, 3, 3) rotations there."""
    if paths.kind[b] == HELD:
        return row(paths.angular, b)
    if paths.kind[b] == STILL or paths.round[b] == 1:
        return (0.0, 0.0, 0.0)
    return gyroscopic(paths, turn, b)


@kernel
def gyroscopic(paths: Paths, turn: Array, b: int) -> Vec3:
    """Euler's I^-1 ((I w) x w) [rad/s^2], world axes."""
    r = columns(turn, b)
    w = turned_back(r, row(paths.w, b))
    return turned(r, turned(columns(paths.inverse_inertia, b), cross(turned(columns(paths.inertia, b), w), w)))
