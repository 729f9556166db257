"""Time of impact by advancement with true accelerations: never late, and exact to the tolerance.

At an instant a plane that touches one shape is made to turn with it, and every vertex of the other is followed over that plane:
height, velocity and acceleration are the true ones, what comes after is bounded. While all are above, the shapes are apart.
Without rotation the bound is the motion itself and two or three rounds find the impact.
"""

from math import inf, sqrt

import numpy as np
from numpy.typing import NDArray

from avatarsim.collide.scratch import Scratch
from avatarsim.collide.signed_distance import signed_distance_up_to
from avatarsim.collide.status import NOT_FINITE
from avatarsim.kernel import kernel
from avatarsim.motion.free_rotation import Series
from avatarsim.motion.path import FREE, HELD, STILL, Paths, move_along
from avatarsim.motion.turning_plane import follow, plane_motion
from avatarsim.spatial.vec3 import Vec3, neg, norm, row, sub
from avatarsim.world.geometry import Geometry, Poses
from avatarsim.world.shapes import POINTS

Array = NDArray[np.float64]

STAND_OFF = 2e-8
"""Gap [m] at which the forward motion stops: bodies never overlap by rounding. A bounce of height h has its apex off by
2e-8/h."""

FAR_OUT = 1e3 * 2.220446049250313e-16
"""The stand-off is at least this part of the coordinates, or rounding would swallow it (beyond 90 km from the origin)."""

TOLERANCE = 2e-9
"""Accuracy [m] of the gap found: above rounding, a tenth of the stand-off."""

DIP = -2.5e-7
"""How far [m] bodies that rest or roll on each other may dip before that is an event. Nearer to 0: a hundred segments a frame for
rocking boxes; lower: overlap that one can measure, the promise being 1e-6."""

CREEP = 4e-9
"""How much lower [m] a pair that has dipped already may go before the next event. Above the tolerance, or such a pair has an
event at once, for ever; resting forces lift it in the meantime."""

TOUCH = 1e-6
"""Gap [m] below which a pair counts as touching at the start of its path."""

LEAVING, RESTING = 1e-4, -1.5e-3
"""Normal velocities [m/s]: above the first a touching pair separates, between the two it rests or rolls."""

ROUNDS = 200
"""Advancement rounds per pair; spheres need 3, tumbling boxes 5 to 20. If spent, the last safe time is the event."""

HORIZONS = 8
"""Times the horizon of the bounds is shortened when looking for the longest safe step."""

CLEAR, IMPACT, DIPPED, BROKEN = 0, 1, 2, 3
"""Outcome: no event before the horizon; two bodies met; resting bodies came too close; a pose is not finite."""


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
    # the form without cancellation for v < 0; for v > 0, a < 0 the sum is positive all the same
    bottom = sqrt(root) - v
    if not (bottom > 0.0):
        return h
    t = 2.0 * gap / bottom
    return min(t, h) if t >= 0.0 else h


@kernel
def jerk_rate(paths: Paths, b: int, horizon: float) -> float:
    """Bound of |r'''| / r [1/s^3] of the points of body b over the horizon.

    Held: w^3 + 3 w alpha with w at its largest. Free: |w'| <= w^2 and |w''| <= 2 w^3 for every real solid (its moments obey the
    triangle inequality), and w grows at most to w / (1 - w h).
    """
    speed = norm(row(paths.w, b))
    if paths.kind[b] == STILL or speed + norm(row(paths.angular, b)) == 0.0:
        return 0.0
    if paths.kind[b] == HELD:
        gain = norm(row(paths.angular, b))
        speed += gain * horizon
        return speed * speed * speed + 3.0 * speed * gain
    if paths.round[b] == 1:
        return speed * speed * speed
    speed /= max(0.5, 1.0 - speed * horizon)
    return 6.0 * speed * speed * speed


@kernel
def longest_horizon(geometry: Geometry, paths: Paths, s: int) -> float:
    """Longest time [s] over which the bounds of ``jerk_rate`` and of turning ellipsoids hold for shape s."""
    b = geometry.body[s]
    speed = norm(row(paths.w, b))
    if paths.kind[b] == STILL or speed == 0.0:
        return inf
    smooth = geometry.shapes.kind[s] != POINTS
    return 0.2 / speed if smooth or (paths.kind[b] == FREE and paths.round[b] == 0) else inf


@kernel
def turning(paths: Paths, b: int, ball: bool, horizon: float) -> Vec3:
    """Bounds over the horizon for body b: (angular speed, angular acceleration, ``jerk_rate``); nothing for a ball, whose plane
    need not turn and whose one vertex has no arm."""
    if paths.kind[b] == STILL or ball:
        return (0.0, 0.0, 0.0)
    speed = norm(row(paths.w, b))
    if paths.kind[b] == HELD:
        gain = norm(row(paths.angular, b))
        return (speed + gain * horizon, gain, jerk_rate(paths, b, horizon))
    if paths.round[b] == 1:
        return (speed, 0.0, jerk_rate(paths, b, horizon))
    speed /= max(0.5, 1.0 - speed * horizon)
    return (speed, speed * speed, jerk_rate(paths, b, horizon))


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
    slide = norm(sub(row(paths.linear, b), row(paths.linear, c)))
    horizon, step = h, 0.0
    for _ in range(HORIZONS):
        own, plane = turning(paths, b, ball, horizon), turning(paths, c, plane_of_ball, horizon)
        found = safe_step(rows, count, own, plane, slide, target, horizon)
        step = max(step, found)
        if found >= 0.7 * horizon:
            break
        horizon = max(2.0 * step, 0.2 * horizon) if 2.0 * step < horizon else 0.5 * horizon
    return step


@kernel
def slowest_touch(rows: Array, count: int) -> float:
    """Least velocity [m/s] over the plane of the vertices that touch it; inf if none does."""
    slowest = inf
    for i in range(count):
        if rows[i, 0] < TOUCH:
            slowest = min(slowest, rows[i, 1])
    return slowest


@kernel
def reach_of(geometry: Geometry, paths: Paths, reach: Array, b: int, h: float) -> float:
    """How far [m] any point of body b can get in h seconds; ``reach`` (nb) is its largest radius about the centre of mass."""
    if paths.kind[b] == STILL:
        return 0.0
    way = h * (norm(row(paths.v, b)) + 0.5 * h * norm(row(paths.linear, b)))
    speed = norm(row(paths.w, b)) + (h * norm(row(paths.angular, b)) if paths.kind[b] == HELD else 0.0)
    # a free body may spin faster later, but no point goes farther than across the body
    turn = 2.0 if paths.kind[b] != HELD and paths.round[b] == 0 and speed > 0.0 else min(2.0, speed * h)
    return float(way + turn * reach[b])


@kernel
def time_of_impact(
    geometry: Geometry, start: Poses, linear: Array, angular: Array, paths: Paths, series: Series, reach: Array, sa: int, sb: int,
    h: float, trial: Poses, a_rows: Array, b_rows: Array, scratch: Scratch,
) -> tuple[int, float]:
    """First event of shapes sa and sb on the paths of their bodies within h seconds.

    Args:
        start, linear, angular: poses and velocities at the start of the segment.
        reach: (nb) largest distance of a body's points from its centre of mass, rounding radii left out [m].
        trial: poses, overwritten. a_rows, b_rows: (most vertices of a shape, 6) working memory.

    Returns:
        (CLEAR, h), or (IMPACT, t) when the gap came down to the stand-off, or (DIPPED, t) when a resting pair reached DIP, or
        (BROKEN, 0). Up to t the gap is never below its target.
    """
    a, b = geometry.body[sa], geometry.body[sb]
    t, target, n = 0.0, STAND_OFF, (0.0, 0.0, 0.0)
    far = max(abs(start.position[a, 0]), abs(start.position[a, 1]), abs(start.position[a, 2]))
    stand_off = max(STAND_OFF, FAR_OUT * far)
    target, event = stand_off, IMPACT
    for rounds in range(ROUNDS):
        move_along(geometry, start, linear, angular, paths, series, a, t, trial)
        move_along(geometry, start, linear, angular, paths, series, b, t, trial)
        left = h - t
        margin = reach_of(geometry, paths, reach, a, left) + reach_of(geometry, paths, reach, b, left) + 2.0 * stand_off
        status, gap, n, _, _ = signed_distance_up_to(trial.vertices, geometry.shapes, sa, sb, n, margin, scratch)
        if status == NOT_FINITE:
            return BROKEN, 0.0
        if gap > margin:
            return CLEAR, h
        if rounds > 0 and gap <= target + TOLERANCE:
            return event, t
        # planes that turn with B and with A: each proves a safe step, the longer one holds
        spin_a, twist_a = plane_motion(paths, trial, a, reach[a] == 0.0)
        spin_b, twist_b = plane_motion(paths, trial, b, reach[b] == 0.0)
        count_a = follow(geometry, trial, paths, sa, sb, spin_b, twist_b, n, a_rows)
        count_b = follow(geometry, trial, paths, sb, sa, spin_a, twist_a, neg(n), b_rows)
        if rounds == 0 and gap < TOUCH:
            slowest = max(slowest_touch(a_rows, count_a), slowest_touch(b_rows, count_b))
            if slowest > LEAVING:
                target = min(stand_off, gap)
            elif slowest > RESTING:
                target, event = min(DIP, gap - CREEP), DIPPED
        horizon = min(left, longest_horizon(geometry, paths, sa), longest_horizon(geometry, paths, sb))
        ball_a, ball_b = reach[a] == 0.0, reach[b] == 0.0
        step = longest_safe_step(a_rows, count_a, paths, a, b, ball_a, ball_b, target, horizon)
        if step < horizon:
            step = max(step, longest_safe_step(b_rows, count_b, paths, b, a, ball_b, ball_a, target, horizon))
        if t + step >= h:
            return CLEAR, h
        if step < 1e-13 and rounds > 0:
            return event, t
        t += step
    return event, t
