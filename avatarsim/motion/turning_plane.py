"""Vertices of one shape as seen over a plane that touches another and turns with it."""

from math import sqrt

import numpy as np
from numpy.typing import NDArray

from avatarsim.collide.support import reach as reach_along
from avatarsim.kernel import kernel
from avatarsim.motion.path import STILL, Paths, angular_acceleration
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
def follow(geometry: Geometry, trial: Poses, paths: Paths, s: int, f: int, spin: Vec3, twist: Vec3, m: Vec3, out: Array) -> int:
    """Vertices of shape s as seen from shape f, over the plane that touches f with outward normal m and turns with it.

    Whatever the plane does, a vertex above it has not touched f; turning with f, it stays on a face of it, so that neither a
    spinning face nor two boxes that topple together seem to approach. ``spin`` and ``twist`` are the plane's angular velocity
    and acceleration.

    Writes rows (height over the plane, its velocity, its acceleration, distance from the own centre, from that of f, speed
    seen from f) and returns how many. An ellipsoid is one row whose acceleration is a bound already.
    """
    shapes, vertices = geometry.shapes, trial.vertices
    b, c = geometry.body[s], geometry.body[f]
    first, last = shapes.start[s], shapes.start[s + 1]
    base = height(geometry, trial, f, m) + shapes.radius[s]
    centre, home = row(trial.position, b), row(trial.position, c)
    v, w = sub(row(paths.v, b), row(paths.v, c)), row(paths.w, b)
    a, alpha = sub(row(paths.linear, b), row(paths.linear, c)), angular_acceleration(paths, trial.rotation, b)
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
        # the support of an ellipsoid that turns by w: its second derivative is at most w^2 (a^2/c + a) + alpha a
        speed, gain = norm(sub(w, spin)), norm(sub(alpha, twist))
        bulge = speed * speed * (largest / sqrt(smallest) + sqrt(largest)) + gain * sqrt(largest)
        bulge += norm(sub(middle, centre)) * (speed * speed + gain)
        d = sub(lowest, home)
        out[0, 0] = dot(m, d) - base
        out[0, 1] = dot(m, add(v, cross(w, sub(lowest, centre)))) + dot(m1, d)
        out[0, 2] = dot(m, a) + 2.0 * dot(m1, v) + dot(m2, sub(centre, home)) - 1.5 * bulge
        out[0, 3], out[0, 4], out[0, 5] = 0.0, norm(d), norm(v)
        return 1
    count = 0
    for i in range(first, last):
        d = sub(row(vertices, i), home)
        r = sub(row(vertices, i), centre)
        around = cross(w, r)
        u = add(v, around)
        out[count, 0] = dot(m, d) - base
        out[count, 1] = dot(m, u) + dot(m1, d)
        out[count, 2] = dot(m, add(a, add(cross(w, around), cross(alpha, r)))) + 2.0 * dot(m1, u) + dot(m2, d)
        out[count, 3], out[count, 4], out[count, 5] = norm(r), norm(d), norm(u)
        count += 1
    return count


@kernel
def plane_motion(paths: Paths, trial: Poses, b: int, ball: bool) -> tuple[Vec3, Vec3]:
    """Angular velocity and acceleration of the plane that touches body b; none for a ball."""
    if ball or paths.kind[b] == STILL:
        return (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)
    return row(paths.w, b), angular_acceleration(paths, trial.rotation, b)
