"""Equation 6 of Schmidl and Lin 2004: the spring between tracker and driven body, solved exactly for any frame time."""

from math import cos, exp, sin, sqrt

from avatarsim.jit.kernel import kernel
from avatarsim.spatial.vec3 import Vec3, add, along, scale

NEARLY_CRITICAL = 1e-3
"""|frequency x time| below which sin x/x is taken by its series; x^6/5040 is then far below rounding. Larger: the
series is off; smaller: differences cancel."""


@kernel
def decay(mass: float, spring: float, damping: float, t: float) -> tuple[float, float]:
    """Return the two solutions of m x'' = -K x - R x': (C, S) with C = (1, rate -s) and S = (0, rate 1) at t = 0.

    With s = R / 2m and w^2 = K/m - s^2: C = e^(-st) cos wt and S = e^(-st) sin(wt)/w, cosh and sinh when over-damped
    (written with decaying exponentials only, which cannot overflow), and their common limit when critically damped.
    """
    s = 0.5 * damping / mass
    square = spring / mass - s * s
    w = sqrt(abs(square))
    x = w * t
    if x < NEARLY_CRITICAL:
        q = square * t * t
        fade = exp(-s * t)
        return fade * (1.0 - q / 2.0 + q * q / 24.0), fade * t * (1.0 - q / 6.0 + q * q / 120.0)
    if square > 0.0:
        fade = exp(-s * t)
        return fade * cos(x), fade * sin(x) / w
    # w - s would cancel for a weak spring
    slow, fast = exp(-spring / mass / (s + w) * t), exp(-(s + w) * t)
    return 0.5 * (slow + fast), 0.5 * (slow - fast) / w


@kernel
def coupled(
    mass: float, spring: float, damping: float, offset: Vec3, velocity: Vec3, t: float
) -> tuple[Vec3, Vec3]:
    """Return offset [m] and velocity [m/s] after ``t`` seconds of m x'' = -K x - R x' (eq. 6), exact and stable for any t.

    ``offset`` is the driven body's position relative to the tracker's; mass > 0 [kg], spring K > 0 [N/m], damping R >= 0.
    """
    c, s = decay(mass, spring, damping, t)
    half = 0.5 * damping / mass
    moved = add(scale(offset, c + half * s), scale(velocity, s))
    return moved, along(scale(velocity, c - half * s), -spring / mass * s, offset)
