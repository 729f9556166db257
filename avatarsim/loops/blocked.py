"""Extra corner contacts for touching pairs at which conservative advancement stalls although they do not approach.

Two edges that cross at a small angle and slip: a corner beyond the contact area passes through the separating plane, which turns
with one of the bodies, beside the other's face, so no motion is proved free. For some frames such corners count as contacts with
that plane; the bodies then move as if the face were a little larger, instead of not at all.
"""

from math import inf

import numpy as np
from numpy.typing import NDArray

from avatarsim.collide.support import reach as reach_along
from avatarsim.impact.contacts import NOT_DRIVEN, Contacts, add_contact
from avatarsim.impact.relative_velocity import point_velocity
from avatarsim.jit.kernel import kernel
from avatarsim.motion.time_of_impact import TOUCH
from avatarsim.spatial.vec3 import Vec3, along, dot, neg, row, sub
from avatarsim.world.dynamics import Velocities
from avatarsim.world.geometry import Geometry, Poses
from avatarsim.world.shapes import POINTS

Index = NDArray[np.int64]

LASTS = 10
"""Frames for which a pair counts as blocked. Fewer: it stops again and again; more: faces are larger than they are for longer."""

MOST = 8
"""Corners of one pair that are added."""


@kernel
def block(blocked: Index, a: int, b: int, frame: int) -> bool:
    """Record the pair as blocked; False if it was already, or if there is no room. ``blocked`` (room, 3): a, b, last frame."""
    free = -1
    for k in range(blocked.shape[0]):
        if blocked[k, 2] >= frame:
            if blocked[k, 0] == a and blocked[k, 1] == b:
                return False
        elif free < 0:
            free = k
    if free < 0:
        return False
    blocked[free, 0], blocked[free, 1], blocked[free, 2] = a, b, frame + LASTS
    return True


@kernel
def is_blocked(blocked: Index, a: int, b: int, frame: int) -> bool:
    """Whether the pair is recorded as blocked in this frame."""
    for k in range(blocked.shape[0]):
        if blocked[k, 2] >= frame and blocked[k, 0] == a and blocked[k, 1] == b:
            return True
    return False


@kernel
def slowest_corner(geometry: Geometry, poses: Poses, velocities: Velocities, s: int, f: int, m: Vec3) -> float:
    """Least velocity [m/s] along m, seen from shape f, of the corners of shape s that touch the plane which f touches with m."""
    shapes, vertices = geometry.shapes, poses.vertices
    top, slowest = reach_along(vertices, shapes, f, m) + shapes.radius[f] + shapes.radius[s], inf
    for i in range(shapes.start[s], shapes.start[s + 1]):
        p = row(vertices, i)
        if dot(m, p) - top < TOUCH:
            slowest = min(slowest, dot(m, corner_velocity(poses, velocities, geometry.body[s], geometry.body[f], p)))
    return slowest


@kernel
def corner_velocity(poses: Poses, velocities: Velocities, a: int, b: int, p: Vec3) -> Vec3:
    """Velocity [m/s] of the point of body a at p, seen from the point of body b there."""
    on_a = point_velocity(row(velocities.linear, a), row(velocities.angular, a), sub(p, row(poses.position, a)))
    on_b = point_velocity(row(velocities.linear, b), row(velocities.angular, b), sub(p, row(poses.position, b)))
    return sub(on_a, on_b)


@kernel
def add_corners(
    geometry: Geometry, poses: Poses, velocities: Velocities, contacts: Contacts, sa: int, sb: int, n: Vec3
) -> bool:
    """Add as contacts the corners of that one of two touching shapes that approaches the other's plane less; False without room.

    ``n`` is the normal out of B into A; coefficients and keys of the points are left to the caller.
    """
    shapes, vertices = geometry.shapes, poses.vertices
    if shapes.kind[sa] != POINTS or shapes.kind[sb] != POINTS:
        return True
    of_a = slowest_corner(geometry, poses, velocities, sa, sb, n) >= slowest_corner(geometry, poses, velocities, sb, sa, neg(n))
    s, f, m = (sa, sb, n) if of_a else (sb, sa, neg(n))
    a, b = geometry.body[sa], geometry.body[sb]
    top, added = reach_along(vertices, shapes, f, m) + shapes.radius[f] + shapes.radius[s], 0
    for i in range(shapes.start[s], shapes.start[s + 1]):
        p = row(vertices, i)
        gap = dot(m, p) - top
        if gap < TOUCH and added < MOST:
            middle = along(p, -shapes.radius[s] - 0.5 * gap, m)
            if not add_contact(
                contacts, a, b, NOT_DRIVEN, n, sub(middle, row(poses.position, a)), sub(middle, row(poses.position, b)), gap
            ):
                return False
            added += 1
    return True
