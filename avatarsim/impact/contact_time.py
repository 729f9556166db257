"""Recorded time of an impact: when the surfaces meet, extrapolated over the stand-off at which the bodies were stopped."""

from math import inf, sqrt

import numpy as np
from numpy.typing import NDArray

from avatarsim.impact.contacts import NOT_DRIVEN, Contacts, axis, velocity_at
from avatarsim.impact.relative_velocity import normal_velocity
from avatarsim.jit.kernel import kernel
from avatarsim.spatial.vec3 import add, cross, dot, row, sub

Array = NDArray[np.float64]


@kernel
def time_to_close(gap: float, v: float, a: float) -> float:
    """First t with gap + v t + a t^2 / 2 = 0 for v < 0; the instant of least gap if that stays above 0."""
    return 2.0 * gap / (sqrt(max(0.0, v * v - 2.0 * a * gap)) - v)


@kernel
def time_to_contact(contacts: Contacts, head: int, linear: Array, angular: Array, pull: Array, twist: Array) -> float:
    """Seconds from now until the pair of contact ``head`` would touch, moving as it does.

    Args:
        contacts: ``bend`` filled by `curvature`.
        linear, angular: (nb, 3) velocities before the impact. pull, twist: (nb, 3) accelerations.

    Returns:
        Least time over the pair's approaching points, to third order in the stand-off: below 1e-11 s from 2 m/s on. 0 if they
        touch already, and for a driven body, whose surface is its own, larger stand-off.
    """
    a, b = contacts.body[head, 0], contacts.body[head, 1]
    soonest = inf
    for k in range(contacts.used[0]):
        if contacts.body[k, 0] != a or contacts.body[k, 1] != b or contacts.driven[k] != NOT_DRIVEN:
            continue
        n = axis(contacts, k, 0)
        v = normal_velocity(n, velocity_at(contacts, k, linear, angular))
        if v < 0.0:
            turning = sub(cross(row(twist, a), row(contacts.arm_a, k)), cross(row(twist, b), row(contacts.arm_b, k)))
            free = sub(row(pull, a), row(pull, b))
            closing = dot(n, add(add(free, turning), row(contacts.bend, k)))
            soonest = min(soonest, time_to_close(max(0.0, contacts.gap[k]), v, closing))
    return soonest if soonest < inf else 0.0
