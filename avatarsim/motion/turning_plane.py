"""Heights of the vertices of one shape over a supporting plane of another that turns with it, with exact derivatives."""

from math import sqrt

import numpy as np
from numpy.typing import NDArray

from avatarsim.collide.support import reach as reach_along
from avatarsim.jit.kernel import kernel
from avatarsim.motion.path import Paths, acceleration
from avatarsim.motion.safe_step import arm_about
from avatarsim.spatial.vec3 import Vec3, add, along, cross, dot, norm, row, sub
from avatarsim.world.geometry import Geometry, Poses
from avatarsim.world.shapes import POINTS

Array = NDArray[np.float64]


@kernel
def height(geometry: Geometry, trial: Poses, s: int, m: Vec3) -> float:
    """How far shape s reaches along m beyond its body's centre of mass [m], radius included."""
    shapes, vertices = geometry.shapes, trial.vertices
    reach = reach_along(vertices, shapes, s, m) + shapes.radius[s]
    return float(reach - dot(m, row(trial.position, geometry.body[s])))


@kernel
def follow(
    geometry: Geometry, trial: Poses, paths: Paths, s: int, f: int, own_spin: Vec3, own_twist: Vec3, spin: Vec3, twist: Vec3,
    own_most: Vec3, plane_most: Vec3, horizon: float, m: Vec3, out: Array,
) -> int:
    """Vertices of shape s as seen from shape f, over the plane that touches f with outward normal m and turns with it.

    Whatever the plane does, a vertex above it has not touched f; turning with f, it stays on a face of it, so that neither a
    spinning face nor two boxes that topple together seem to approach. ``own_spin`` and ``own_twist`` are angular velocity and
    acceleration of the body of s, ``spin`` and ``twist`` those of the plane; ``own_most`` and ``plane_most`` their bounds over
    the horizon, from ``turning``.

    Writes rows (height over the plane, its velocity, its acceleration, arm of its bounds, distance from the centre of f, speed
    seen from f) and returns how many. An ellipsoid is one row whose acceleration is a bound already.
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
        out[0, 0] = dot(m, d) - base
        out[0, 1] = dot(m, add(v, cross(own_spin, sub(lowest, centre)))) + dot(m1, d)
        out[0, 2] = dot(m, a) + 2.0 * dot(m1, v) + dot(m2, away) - bulge
        out[0, 3], out[0, 4], out[0, 5] = 0.0, norm(away), norm(v)
        return 1
    count = 0
    for i in range(first, last):
        d = sub(row(vertices, i), home)
        r = sub(row(vertices, i), centre)
        around = cross(own_spin, r)
        u = add(v, around)
        out[count, 0] = dot(m, d) - base
        out[count, 1] = dot(m, u) + dot(m1, d)
        out[count, 2] = dot(m, add(a, add(cross(own_spin, around), cross(own_twist, r)))) + 2.0 * dot(m1, u) + dot(m2, d)
        out[count, 3], out[count, 4], out[count, 5] = arm_about(paths, b, r, horizon), norm(d), norm(u)
        count += 1
    return count


@kernel
def follow_ball(
    geometry: Geometry, trial: Poses, paths: Paths, radius: float, b: int, f: int, spin: Vec3, twist: Vec3, m: Vec3, out: Array
) -> None:
    """As ``follow``, for the ball of ``radius`` about the centre of body b: however it tumbles, it stays in there. One row."""
    c = geometry.body[f]
    d = sub(row(trial.position, b), row(trial.position, c))
    v, a = sub(row(paths.v, b), row(paths.v, c)), sub(acceleration(paths, b), acceleration(paths, c))
    m1 = cross(spin, m)
    m2 = add(cross(twist, m), cross(spin, m1))
    out[0, 0] = dot(m, d) - height(geometry, trial, f, m) - radius
    out[0, 1] = dot(m, v) + dot(m1, d)
    out[0, 2] = dot(m, a) + 2.0 * dot(m1, v) + dot(m2, d)
    out[0, 3], out[0, 4], out[0, 5] = 0.0, norm(d), norm(v)


@kernel
def follow_centres(geometry: Geometry, trial: Poses, paths: Paths, radii: float, b: int, c: int, out: Array) -> None:
    """The balls about two bodies, ``radii`` together, along the line of their centres. One row; no plane turns."""
    d = sub(row(trial.position, b), row(trial.position, c))
    v, a = sub(row(paths.v, b), row(paths.v, c)), sub(acceleration(paths, b), acceleration(paths, c))
    far = norm(d)
    out[0, 0], out[0, 1], out[0, 2] = far - radii, 0.0, 0.0
    if far > 0.0:
        out[0, 1], out[0, 2] = dot(d, v) / far, dot(d, a) / far
    out[0, 3], out[0, 4], out[0, 5] = 0.0, far, norm(v)
