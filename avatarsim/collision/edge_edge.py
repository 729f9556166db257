"""Conservative advancement of two crossing edges: the separating plane spanned by both, which turns with neither body alone.

Through a plane that turns with one body an end of the other's edge passes at once, although it is beyond the contact. The plane
spanned by both edges always holds both ends of each; two bounds remain: the distance of the edges' lines, and that no other
corner reaches the plane.
"""

from math import sqrt

import numpy as np
from numpy.typing import NDArray

from avatarsim.collision.motion_bounds import ENOUGH, LEAST, earliest_touch, turning
from avatarsim.collision.path import Paths, acceleration
from avatarsim.jit.kernel import kernel
from avatarsim.model.geometry import POINTS, Geometry, Poses, Shapes
from avatarsim.spatial.vec3 import Rows, Vec3, add, cross, dot, norm, row, scale, sub
from avatarsim.tolerances import JUDGED, NOTHING

Array = NDArray[np.float64]

ON_PLANE = JUDGED
"""Height [m] up to which a corner lies on the plane. Larger: edges that lie on faces count as edges that cross."""

HORIZONS = 6
"""Most times that the horizon of the bounds is shortened in the search of the longest safe step. Fewer: shorter steps, and more
rounds; more: rounds take longer."""

TURN_LEFT = 0.6
"""Part of a corner's slope over the plane by which the plane may turn: c (1 - f^2 / 2) >= d f for f = 0.6 c / d, c <= d.
Larger than sqrt(3) - 1: not proved; smaller: shorter steps."""


@kernel
def lone_edge(vertices: Rows, shapes: Shapes, s: int, m: Vec3) -> tuple[bool, Vec3, Vec3]:
    """Return (whether exactly two corners of shape s are farthest along m, one of them, the way to the other)."""
    first, last = shapes.start[s], shapes.start[s + 1]
    none = (0.0, 0.0, 0.0)
    if shapes.kind[s] != POINTS or last - first < 2 or shapes.radius[s] > 0.0:
        return False, none, none
    top = dot(m, row(vertices, first))
    for i in range(first + 1, last):
        top = max(top, dot(m, row(vertices, i)))
    p, q, found = none, none, 0
    for i in range(first, last):
        x = row(vertices, i)
        if dot(m, x) >= top - ON_PLANE:
            found += 1
            p, q = (x, q) if found == 1 else (p, x)
    return found == 2, p, sub(q, p)


@kernel
def least_slope(vertices: Rows, shapes: Shapes, s: int, m: Vec3, on: Vec3, edge: Vec3) -> float:
    """Return the least height / distance below the plane at ``on`` with normal m of all corners of shape s but its ``edge``'s."""
    least, length = 1.0, norm(edge)
    for i in range(shapes.start[s], shapes.start[s + 1]):
        d = sub(row(vertices, i), on)
        # the two ends lie along the edge, whatever their height by rounding
        if norm(cross(d, edge)) > ON_PLANE * length:
            least = min(least, -dot(m, d) / norm(d))
    return least


@kernel
def triple(a: Vec3, b: Vec3, c: Vec3) -> float:
    """Return (a x b) . c."""
    return dot(cross(a, b), c)


@kernel
def point_rates(arm: Vec3, spin: Vec3, twist: Vec3) -> tuple[Vec3, Vec3]:
    """Return the first and second derivative of a vector that turns with a body."""
    once = cross(spin, arm)
    return once, add(cross(twist, arm), cross(spin, once))


@kernel
def edges_apart(
    geometry: Geometry, trial: Poses, paths: Paths, sa: int, sb: int, n: Vec3, on_a: Vec3, on_b: Vec3, spin_a: Vec3,
    twist_a: Vec3, spin_b: Vec3, twist_b: Vec3, rows_out: Array,
) -> bool:
    """Return True if two edges face each other along n; then ``rows_out[0]`` and ``rows_out[1]`` hold the input of `edge_step`.

    With e, f along the edges and p from B's line to A's, N = (e x f) . p is their distance times |e x f|. First row: N, N', N'',
    |e x f|, |e| |f|, least slope of the other corners. Second: |e|, |f|, |p|, |p'|, distances of the points from the centres.
    """
    shapes, vertices = geometry.shapes, trial.vertices
    there_a, _, e = lone_edge(vertices, shapes, sa, (-n[0], -n[1], -n[2]))
    if not there_a:
        return False
    there_b, _, f = lone_edge(vertices, shapes, sb, n)
    if not there_b:
        return False
    if triple(e, f, n) < 0.0:
        f = scale(f, -1.0)
    across = cross(e, f)
    wide, full = norm(across), norm(e) * norm(f)
    if not (wide > NOTHING * full):
        return False
    m = scale(across, 1.0 / wide)
    a, b = geometry.body[sa], geometry.body[sb]
    slope = min(least_slope(vertices, shapes, sa, scale(m, -1.0), on_a, e), least_slope(vertices, shapes, sb, m, on_b, f))
    if not (slope > 0.0):
        return False
    arm_a, arm_b = sub(on_a, row(trial.position, a)), sub(on_b, row(trial.position, b))
    e1, e2 = point_rates(e, spin_a, twist_a)
    f1, f2 = point_rates(f, spin_b, twist_b)
    a1, a2 = point_rates(arm_a, spin_a, twist_a)
    b1, b2 = point_rates(arm_b, spin_b, twist_b)
    p = sub(on_a, on_b)
    p1 = sub(add(row(paths.v, a), a1), add(row(paths.v, b), b1))
    p2 = sub(add(acceleration(paths, a), a2), add(acceleration(paths, b), b2))
    out = rows_out
    out[0, 0] = dot(across, p)
    out[0, 1] = triple(e1, f, p) + triple(e, f1, p) + dot(across, p1)
    out[0, 2] = triple(e2, f, p) + triple(e, f2, p) + dot(across, p2)
    out[0, 2] += 2.0 * (triple(e1, f1, p) + triple(e1, f, p1) + triple(e, f1, p1))
    out[0, 3], out[0, 4], out[0, 5] = wide, full, slope
    out[1, 0], out[1, 1], out[1, 2], out[1, 3] = norm(e), norm(f), norm(p), norm(p1)
    out[1, 4], out[1, 5] = norm(arm_a), norm(arm_b)
    return True


@kernel
def edge_step(
    paths: Paths, a: int, b: int, spin: float, slide: float, rows: Array, target: float, left: float
) -> float:
    """Return a time <= left [s] during which two edges surely keep the distance ``target``; ``rows`` from `edges_apart`.

    ``spin`` is the angular speed of one body seen from the other [rad/s], ``slide`` the acceleration of one centre seen from the
    other [m/s^2].
    """
    best, horizon = 0.0, left
    wide, full, slope = rows[0, 3], rows[0, 4], rows[0, 5]
    e, f, p, u, arm_a, arm_b = rows[1, 0], rows[1, 1], rows[1, 2], rows[1, 3], rows[1, 4], rows[1, 5]
    for _ in range(HORIZONS):
        x, y = turning(paths, a, False, horizon), turning(paths, b, False, horizon)
        turn = spin + (x[1] + y[1]) * horizon
        # the plane turns by at most turn / sin(angle between the edges) in either body, while that sine is half of its own
        h = min(horizon, 0.5 * TURN_LEFT * slope * wide / (turn * full)) if turn > 0.0 else horizon
        gained = slide + (x[0] * x[0] + x[1]) * arm_a + (y[0] * y[0] + y[1]) * arm_b
        p1 = u + gained * h
        p0, p3 = p + p1 * h, x[2] * arm_a + y[2] * arm_b
        e1, e2, e3 = x[0], x[0] * x[0] + x[1], x[2]
        f1, f2, f3 = y[0], y[0] * y[0] + y[1], y[2]
        jerk = e3 * p0 + f3 * p0 + p3 + 3.0 * (e2 * f1 * p0 + e1 * f2 * p0 + e2 * p1 + e1 * gained + f2 * p1 + f1 * gained)
        jerk = (jerk + 6.0 * e1 * f1 * p1) * e * f
        goal = target * (full if target > 0.0 else max(0.0, wide - turn * h * full))
        gap, v = rows[0, 0] - goal, rows[0, 1]
        found = earliest_touch(gap, v - jerk * h * h / 6.0, rows[0, 2], h)
        if v > 0.0 and jerk > 0.0 and found < h:
            short = min(h, sqrt(3.0 * v / jerk))
            found = max(found, min(short, earliest_touch(gap, 0.5 * v, rows[0, 2], short)))
        best = max(best, found)
        if found >= ENOUGH * h:
            break
        horizon = max(2.0 * best, LEAST * h) if 2.0 * best < h else 0.5 * h
    return best
