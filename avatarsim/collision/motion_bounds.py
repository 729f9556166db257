"""Step of conservative advancement: time in which no vertex reaches a plane, by velocity, acceleration and bounded jerk.

Heights of the vertices of one shape over a supporting plane of another that turns with it, with exact derivatives.
"""

from math import inf, sqrt

import numpy as np
from numpy.typing import NDArray

from avatarsim.collision.path import FREE, HELD, STILL, Paths, acceleration
from avatarsim.collision.support import reach as reach_along
from avatarsim.jit.kernel import kernel
from avatarsim.model.geometry import POINTS, Geometry, Poses
from avatarsim.spatial.vec3 import Vec3, add, along, cross, dot, norm, row, sub
from avatarsim.tolerances import NOTHING

Array = NDArray[np.float64]

HEIGHT, VELOCITY, ACCELERATION, ARM, DISTANCE, SPEED = range(6)
"""Columns of a row of `follow`, one vertex over a plane: height over it [m], its velocity [m/s] and acceleration [m/s^2], arm of
its bounds [m], distance from the centre of the plane's body [m], speed seen from there [m/s]."""

HORIZONS = 8
"""Most times that the horizon of the bounds is shortened in the search of the longest safe step. Fewer: shorter steps, and more
rounds; more: rounds take longer."""

ENOUGH, LEAST = 0.7, 0.2
"""Parts of a horizon: a safe step that takes this much of it is taken, and the next horizon is at least the other.
Larger: more horizons are tried; smaller: shorter steps, and more rounds."""

ROUNDED = NOTHING
"""Part of an arm by which its distance from the axis may be off: rounding, with room."""

SMOOTH_TURN = 0.2
"""Largest turn [rad] over which the bounds hold for bodies that speed up by themselves and for ellipsoids. Larger: looser bounds;
smaller: more rounds."""


@kernel
def earliest_touch(gap: float, v: float, a: float, h: float) -> float:
    """Return the smallest t in (0, h] with gap + v t + a t^2 / 2 <= 0, else h. A gap <= 0 counts as just touching: if it opens,
    the touch looked for is the next one."""
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
    """Return the longest time [s] over which bounds of ``turning`` hold, and are tight for turning ellipsoids, for shape s."""
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
    """Return bounds over the horizon for body b: angular speed [1/s] and acceleration [1/s^2], |r'''| / r of its points [1/s^3].

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
    """Return the arm [m], at most |r|, by which the bounds of ``turning`` may be multiplied for the point r of body b.

    A turn about one axis moves points by their distance from that axis. A held body does but for the part of its angular
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
    """Return a time <= h during which no vertex of ``follow`` comes closer than ``target`` to the plane.

    ``own`` and ``plane`` are bounds from ``turning`` for the body of the vertices and for the plane; ``slide`` is the
    acceleration of one centre seen from the other [m/s^2].
    """
    step = h
    for i in range(count):
        gap, v, a = rows[i, HEIGHT] - target, rows[i, VELOCITY], rows[i, ACCELERATION]
        r, speed = rows[i, ARM], rows[i, SPEED]
        acceleration = slide + (own[0] * own[0] + own[1]) * r
        speed += acceleration * h
        jerk = own[2] * r + 3.0 * plane[0] * acceleration + 3.0 * (plane[0] * plane[0] + plane[1]) * speed
        jerk += plane[2] * (rows[i, DISTANCE] + speed * h)
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
    """Return ``safe_step`` for the horizon, at most h, whose bounds leave the longest step; vertices of body b, plane of c."""
    slide = norm(sub(acceleration(paths, b), acceleration(paths, c)))
    horizon, step = h, 0.0
    for _ in range(HORIZONS):
        own, plane = turning(paths, b, ball, horizon), turning(paths, c, plane_of_ball, horizon)
        found = safe_step(rows, count, own, plane, slide, target, horizon)
        step = max(step, found)
        if found >= ENOUGH * horizon:
            break
        horizon = max(2.0 * step, LEAST * horizon) if 2.0 * step < horizon else 0.5 * horizon
    return step


@kernel
def height(geometry: Geometry, trial: Poses, s: int, m: Vec3) -> float:
    """Return how far shape s reaches along m beyond its body's centre of mass [m], radius included."""
    shapes, vertices = geometry.shapes, trial.vertices
    reach = reach_along(vertices, shapes, s, m) + shapes.radius[s]
    return float(reach - dot(m, row(trial.position, geometry.body[s])))


@kernel
def follow(
    geometry: Geometry, trial: Poses, paths: Paths, s: int, f: int, own_spin: Vec3, own_twist: Vec3, spin: Vec3, twist: Vec3,
    own_most: Vec3, plane_most: Vec3, horizon: float, m: Vec3, out: Array,
) -> int:
    """Return vertices of shape s as seen from shape f, over the plane that touches f with outward normal m and turns with it.

    Whatever the plane does, a vertex above it has not touched f; turning with f, it stays on a face of it, so that neither a
    spinning face nor two boxes that topple together seem to approach. ``own_spin`` and ``own_twist`` are angular velocity and
    acceleration of the body of s, ``spin`` and ``twist`` those of the plane; ``own_most`` and ``plane_most`` their bounds over
    the horizon, from ``turning``.

    Writes rows and returns how many. An ellipsoid is one row whose acceleration is a bound already.
    """
    shapes, vertices = geometry.shapes, trial.vertices
    b, c = geometry.body[s], geometry.body[f]
    first, last = shapes.start[s], shapes.start[s + 1]
    base = height(geometry, trial, f, m) + shapes.radius[s]
    centre, home = row(trial.position, b), row(trial.position, c)
    v, a = sub(row(paths.v, b), row(paths.v, c)), sub(acceleration(paths, b), acceleration(paths, c))
    m1 = cross(spin, m)
    m2 = add(cross(twist, m), cross(spin, m1))
    if shapes.kind[s] != POINTS:
        x, y, z = row(vertices, first + 1), row(vertices, first + 2), row(vertices, first + 3)
        dx, dy, dz = dot(x, m), dot(y, m), dot(z, m)
        length = sqrt(dx * dx + dy * dy + dz * dz)
        middle = row(vertices, first)
        lowest = along(along(along(middle, -dx / length, x), -dy / length, y), -dz / length, z)
        xx, yy, zz = dot(x, x), dot(y, y), dot(z, z)
        largest, smallest = max(xx, yy, zz), min(xx, yy, zz)
        # Seen from the plane the ellipsoid turns by w = own - plane, whose rate there is own' - plane' - plane x own. The second
        # derivative of its support is at most w^2 (a^2/c + a) + w' a, that of its centre's height w^2 q + w' q.
        gain = own_most[1] + plane_most[1] + own_most[0] * plane_most[0]
        speed = min(own_most[0] + plane_most[0], norm(sub(own_spin, spin)) + gain * horizon)
        arm = sqrt(largest) + norm(sub(middle, centre))
        bulge = speed * speed * (largest / sqrt(smallest) + arm) + gain * arm
        d, away = sub(lowest, home), sub(centre, home)
        out[0, HEIGHT] = dot(m, d) - base
        out[0, VELOCITY] = dot(m, add(v, cross(own_spin, sub(lowest, centre)))) + dot(m1, d)
        out[0, ACCELERATION] = dot(m, a) + 2.0 * dot(m1, v) + dot(m2, away) - bulge
        out[0, ARM], out[0, DISTANCE], out[0, SPEED] = 0.0, norm(away), norm(v)
        return 1
    count = 0
    for i in range(first, last):
        d = sub(row(vertices, i), home)
        r = sub(row(vertices, i), centre)
        around = cross(own_spin, r)
        u = add(v, around)
        out[count, HEIGHT] = dot(m, d) - base
        out[count, VELOCITY] = dot(m, u) + dot(m1, d)
        speeding = add(a, add(cross(own_spin, around), cross(own_twist, r)))
        out[count, ACCELERATION] = dot(m, speeding) + 2.0 * dot(m1, u) + dot(m2, d)
        out[count, ARM], out[count, DISTANCE], out[count, SPEED] = arm_about(paths, b, r, horizon), norm(d), norm(u)
        count += 1
    return count


@kernel
def follow_ball(
    geometry: Geometry, trial: Poses, paths: Paths, radius: float, b: int, f: int, spin: Vec3, twist: Vec3, m: Vec3, out: Array
) -> None:
    """Do as ``follow`` for the ball of ``radius`` about the centre of body b: however it tumbles, it stays in there. One row."""
    c = geometry.body[f]
    d = sub(row(trial.position, b), row(trial.position, c))
    v, a = sub(row(paths.v, b), row(paths.v, c)), sub(acceleration(paths, b), acceleration(paths, c))
    m1 = cross(spin, m)
    m2 = add(cross(twist, m), cross(spin, m1))
    out[0, HEIGHT] = dot(m, d) - height(geometry, trial, f, m) - radius
    out[0, VELOCITY] = dot(m, v) + dot(m1, d)
    out[0, ACCELERATION] = dot(m, a) + 2.0 * dot(m1, v) + dot(m2, d)
    out[0, ARM], out[0, DISTANCE], out[0, SPEED] = 0.0, norm(d), norm(v)


@kernel
def follow_centres(geometry: Geometry, trial: Poses, paths: Paths, radii: float, b: int, c: int, out: Array) -> None:
    """Write the row of the balls about two bodies, ``radii`` together, along the line of their centres. No plane turns."""
    d = sub(row(trial.position, b), row(trial.position, c))
    v, a = sub(row(paths.v, b), row(paths.v, c)), sub(acceleration(paths, b), acceleration(paths, c))
    far = norm(d)
    out[0, HEIGHT], out[0, VELOCITY], out[0, ACCELERATION] = far - radii, 0.0, 0.0
    if far > 0.0:
        out[0, VELOCITY], out[0, ACCELERATION] = dot(d, v) / far, dot(d, a) / far
    out[0, ARM], out[0, DISTANCE], out[0, SPEED] = 0.0, far, norm(v)
