"""Time of impact by advancement with true accelerations: never late, and exact to the tolerance.

At an instant the normal of two shapes is kept and every vertex is followed along it: position, velocity and acceleration are
the true ones, what comes after is bounded. The gap along any fixed direction is at most the true gap, so no vertex pair of it
that is still apart can have touched. Without rotation the bound is the motion itself and two or three rounds find the impact.
"""

from math import inf, sqrt

import numpy as np
from numpy.typing import NDArray

from avatarsim.collide.scratch import Scratch
from avatarsim.collide.signed_distance import signed_distance_up_to
from avatarsim.collide.status import NOT_FINITE
from avatarsim.kernel import kernel
from avatarsim.motion.free_rotation import Series
from avatarsim.motion.path import FREE, HELD, STILL, Paths, angular_acceleration, move_along
from avatarsim.spatial.vec3 import Vec3, along, cross, dot, norm, row, sub
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
def follow(
    geometry: Geometry, trial: Poses, paths: Paths, s: int, side: float, n: Vec3, out: Array
) -> int:
    """Rows (position, velocity, acceleration along n, distance from the centre of mass) of the vertices of shape s; return how
    many.

    ``side`` is -1 for shape A, whose lowest points along n count, and +1 for B, whose highest do.
    An ellipsoid is one row whose acceleration is a bound already.
    """
    b = geometry.body[s]
    shapes, vertices = geometry.shapes, trial.vertices
    first, last = shapes.start[s], shapes.start[s + 1]
    radius = side * shapes.radius[s]
    if paths.kind[b] == STILL:
        # what does not move is one plane
        top = -inf
        if shapes.kind[s] == POINTS:
            for i in range(first, last):
                top = max(top, side * dot(n, row(vertices, i)))
            out[0, 0] = side * top + radius
        else:
            dx, dy = dot(row(vertices, first + 1), n), dot(row(vertices, first + 2), n)
            dz = dot(row(vertices, first + 3), n)
            out[0, 0] = dot(n, row(vertices, first)) + side * sqrt(dx * dx + dy * dy + dz * dz)
        out[0, 1], out[0, 2], out[0, 3] = 0.0, 0.0, 0.0
        return 1
    centre, v, w = row(trial.position, b), dot(n, row(paths.v, b)), row(paths.w, b)
    a, alpha = dot(n, row(paths.linear, b)), angular_acceleration(paths, trial.rotation, b)
    speed, gain = norm(w), norm(alpha)
    if shapes.kind[s] != POINTS:
        x, y, z = row(vertices, first + 1), row(vertices, first + 2), row(vertices, first + 3)
        dx, dy, dz = dot(x, n), dot(y, n), dot(z, n)
        length = sqrt(dx * dx + dy * dy + dz * dz)
        middle = row(vertices, first)
        r = sub(along(along(along(middle, side * dx / length, x), side * dy / length, y), side * dz / length, z), centre)
        xx, yy, zz = dot(x, x), dot(y, y), dot(z, z)
        largest, smallest = max(xx, yy, zz), min(xx, yy, zz)
        # the support of a turning ellipsoid: its second derivative is at most w^2 (a^2/c + a) + alpha a, plus the centre's own
        bulge = 1.5 * (speed * speed * (largest / sqrt(smallest) + sqrt(largest)) + gain * sqrt(largest))
        off = norm(sub(middle, centre))
        bulge += 1.5 * off * (speed * speed + gain)
        out[0, 0] = dot(n, centre) + dot(n, r)
        out[0, 1] = v + dot(n, cross(w, r))
        out[0, 2] = a + side * bulge
        out[0, 3] = 0.0
        return 1
    count = 0
    for i in range(first, last):
        r = sub(row(vertices, i), centre)
        spin = cross(w, r)
        out[count, 0] = dot(n, centre) + dot(n, r) + radius
        out[count, 1] = v + dot(n, spin)
        out[count, 2] = a + dot(n, cross(w, spin)) + dot(n, cross(alpha, r))
        out[count, 3] = norm(r)
        count += 1
    return count


@kernel
def jerk_rate(paths: Paths, trial: Poses, b: int, horizon: float) -> float:
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
def safe_step(
    a_rows: Array, count_a: int, b_rows: Array, count_b: int, jerk_a: float, jerk_b: float, target: float, h: float
) -> float:
    """A time <= h during which no vertex of A comes closer than ``target`` to one of B along the normal."""
    step = h
    for i in range(count_a):
        ja = jerk_a * a_rows[i, 3]
        for k in range(count_b):
            gap = a_rows[i, 0] - b_rows[k, 0] - target
            v, a = a_rows[i, 1] - b_rows[k, 1], a_rows[i, 2] - b_rows[k, 2]
            jerk = ja + jerk_b * b_rows[k, 3]
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
        trial: poses, overwritten. a_rows, b_rows: (most vertices of a shape, 4) working memory.

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
        count_a = follow(geometry, trial, paths, sa, -1.0, n, a_rows)
        count_b = follow(geometry, trial, paths, sb, 1.0, n, b_rows)
        if rounds == 0 and gap < TOUCH:
            slowest = inf
            for i in range(count_a):
                for k in range(count_b):
                    if a_rows[i, 0] - b_rows[k, 0] < TOUCH:
                        slowest = min(slowest, a_rows[i, 1] - b_rows[k, 1])
            if slowest > LEAVING:
                target = min(stand_off, gap)
            elif slowest > RESTING:
                target, event = min(DIP, gap - CREEP), DIPPED
        horizon = min(left, longest_horizon(geometry, paths, sa), longest_horizon(geometry, paths, sb))
        step = 0.0
        for _ in range(HORIZONS):
            found = safe_step(
                a_rows, count_a, b_rows, count_b, jerk_rate(paths, trial, a, horizon), jerk_rate(paths, trial, b, horizon),
                target, horizon,
            )
            step = max(step, found)
            if found >= 0.7 * horizon:
                break
            horizon = max(2.0 * step, 0.2 * horizon) if 2.0 * step < horizon else 0.5 * horizon
        if t + step >= h:
            return CLEAR, h
        if step < 1e-13 and rounds > 0:
            return event, t
        t += step
    return event, t
