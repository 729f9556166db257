"""Step of conservative advancement: time in which no vertex reaches a plane, by velocity, acceleration and bounded jerk."""

from math import inf, sqrt

import numpy as np
from numpy.typing import NDArray

from avatarsim.jit.kernel import kernel
from avatarsim.motion.path import FREE, HELD, STILL, Paths, acceleration
from avatarsim.spatial.vec3 import Vec3, cross, norm, row, sub
from avatarsim.world.geometry import Geometry
from avatarsim.world.shapes import POINTS

Array = NDArray[np.float64]

HORIZONS = 8
"""Most times that the horizon of the bounds is shortened in the search of the longest safe step."""

ROUNDED = 1e-9
"""Part of an arm by which its distance from the axis may be off: rounding, with room."""

SMOOTH_TURN = 0.2
"""Largest turn [rad] over which the bounds hold for bodies that speed up by themselves and for ellipsoids. Larger: looser bounds;
smaller: more rounds."""


@kernel
def earliest_touch(gap: float, v: float, a: float, h: float) -> float:
    """Smallest t in (0, h] with gap + v t + a t^2 / 2 <= 0, else h. A gap <= 0 counts as just touching: if it opens, the touch
    looked for is the next one."""
    if gap <= 0.0:
        if v < 0.0 or (v == 0.0 and a < 0.0):
            return 0.0
        return min(h, -2.0 * v / a) if a < 0.0 else h
    if v >= 0.0 and a >= 0.0:
        return h
    root = v * v - 2.0 * a * gap
    if root < 0.0:
        return h
    if v > 0.0:
        return min(h, (v + sqrt(root)) / -a)
    # the form without cancellation for v < 0
    bottom = sqrt(root) - v
    if not (bottom > 0.0):
        return h
    t = 2.0 * gap / bottom
    return min(t, h) if t >= 0.0 else h


@kernel
def longest_horizon(geometry: Geometry, paths: Paths, s: int) -> float:
    """Longest time [s] over which the bounds of ``turning`` hold, and those of turning ellipsoids stay tight, for shape s."""
    b = geometry.body[s]
    speed = norm(row(paths.w, b))
    if paths.kind[b] == STILL:
        return inf
    smooth = geometry.shapes.kind[s] != POINTS
    longest = inf
    if speed > 0.0 and (smooth or (paths.kind[b] == FREE and paths.round[b] == 0)):
        longest = SMOOTH_TURN / speed
    gain = norm(row(paths.angular, b))
    if smooth and paths.kind[b] == HELD and gain > 0.0:
        longest = min(longest, sqrt(SMOOTH_TURN / gain))
    return longest


@kernel
def turning(paths: Paths, b: int, ball: bool, horizon: float) -> Vec3:
    """Bounds over the horizon for body b: angular speed [1/s], angular acceleration [1/s^2], |r'''| / r of its points [1/s^3].

    Nothing for a ball, whose plane need not turn and whose one vertex has no arm. Held: w^3 + 3 w alpha with w at its largest.
    Free: |w'| <= w^2 and |w''| <= 2 w^3 for every real solid (its moments obey the triangle inequality), and w grows at most to
    w / (1 - w h).
    """
    if paths.kind[b] == STILL or ball:
        return (0.0, 0.0, 0.0)
    speed = norm(row(paths.w, b))
    if paths.kind[b] == HELD:
        gain = norm(row(paths.angular, b))
        speed += gain * horizon
        return (speed, gain, speed * speed * speed + 3.0 * speed * gain)
    if paths.round[b] == 1:
        return (speed, 0.0, speed * speed * speed)
    speed /= max(0.5, 1.0 - speed * horizon)
    return (speed, speed * speed, 6.0 * speed * speed * speed)


@kernel
def arm_about(paths: Paths, b: int, r: Vec3, horizon: float) -> float:
    """Arm [m], at most |r|, by which the bounds of ``turning`` may be multiplied for the point r of body b.

    What turns about one axis moves its points by their distance from that axis. A held body does but for the part of its angular
    acceleration across the axis: that tilts the axis by 2 ``tilt`` at most since the path began, and accelerates by itself.
    """
    w, arm = row(paths.w, b), norm(r)
    speed = norm(w)
    if speed == 0.0 or paths.kind[b] == STILL or (paths.kind[b] == FREE and paths.round[b] == 0):
        return arm
    off = norm(cross(w, r)) / speed
    if paths.kind[b] == FREE:
        return min(arm, off + ROUNDED * arm)
    alpha, t = row(paths.angular, b), paths.time[b] + horizon
    gain = norm(alpha)
    least = speed - gain * t
    if not (least > 0.5 * speed):
        return arm
    across, turn = norm(cross(w, alpha)) / speed, (speed + gain * t) * t
    tilt = across * t * (1.0 + turn) * (1.0 + turn) / least
    return float(min(arm, off + arm * (ROUNDED + 2.0 * tilt + 3.0 * across / (least * least))))


@kernel
def safe_step(rows: Array, count: int, own: Vec3, plane: Vec3, slide: float, target: float, h: float) -> float:
    """A time <= h during which no vertex of ``follow`` comes closer than ``target`` to the plane.

    ``own`` and ``plane`` are bounds from ``turning`` for the body of the vertices and for the plane; ``slide`` is the
    acceleration of one centre seen from the other [m/s^2].
    """
    step = h
    for i in range(count):
        gap, v, a = rows[i, 0] - target, rows[i, 1], rows[i, 2]
        r, speed = rows[i, 3], rows[i, 5]
        pull = slide + (own[0] * own[0] + own[1]) * r
        speed += pull * h
        jerk = own[2] * r + 3.0 * plane[0] * pull + 3.0 * (plane[0] * plane[0] + plane[1]) * speed
        jerk += plane[2] * (rows[i, 4] + speed * h)
        if gap > 0.0 and gap + step * (min(v, 0.0) + step * (min(a, 0.0) * 0.5 - jerk * step / 6.0)) > 0.0:
            continue
        # gap + v t + a t^2/2 - jerk t^3/6, the last term by its value at the end of the step
        found = earliest_touch(gap, v - jerk * step * step / 6.0, a, step)
        if v > 0.0 and jerk > 0.0 and found < step:
            # swamped by the bound: over a shorter time half of v is more than the jerk can take away
            short = min(step, sqrt(3.0 * v / jerk))
            found = max(found, min(short, earliest_touch(gap, 0.5 * v, a, short)))
        step = min(step, found)
        if step == 0.0:
            return 0.0
    return step


@kernel
def longest_safe_step(
    rows: Array, count: int, paths: Paths, b: int, c: int, ball: bool, plane_of_ball: bool, target: float, h: float
) -> float:
    """``safe_step`` over the horizon, at most h, whose bounds leave the longest step; vertices of body b, plane of body c."""
    slide = norm(sub(acceleration(paths, b), acceleration(paths, c)))
    horizon, step = h, 0.0
    for _ in range(HORIZONS):
        own, plane = turning(paths, b, ball, horizon), turning(paths, c, plane_of_ball, horizon)
        found = safe_step(rows, count, own, plane, slide, target, horizon)
        step = max(step, found)
        if found >= 0.7 * horizon:
            break
        horizon = max(2.0 * step, 0.2 * horizon) if 2.0 * step < horizon else 0.5 * horizon
    return step
