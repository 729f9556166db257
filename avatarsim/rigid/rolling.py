"""Kinematics of rolling contact (Montana 1988): how contact points move on smooth surfaces, by their radii of curvature.

A's surface has the outward normal -n where it touches, B's has n. A turn of a normal q against its body moves the point of the
surface that has it by the radii of curvature there, H: r' = w x r + H (q' - w x q). A corner has H = 0 and stays with its body;
of a ball on a floor, whose normal does not turn, r' = 0. How n turns follows from the bodies staying in touch.

Curvature at contacts: radii of curvature of both surfaces, and edges across which the normal stays.
"""

import numpy as np
from numpy.typing import NDArray

from avatarsim.collision.ellipsoid import gathered, stretched
from avatarsim.collision.support import foremost
from avatarsim.jit.kernel import kernel
from avatarsim.model.geometry import POINTS, Poses, Shapes
from avatarsim.rigid.contact_law import point_velocity, tangential_velocity
from avatarsim.rigid.contacts import (
    NORMAL_OF_ANOTHER,
    NOT_DRIVEN,
    ROUND_A,
    ROUND_B,
    SHARP,
    TWO_BALLS,
    Contacts,
    axis,
    velocity_at,
)
from avatarsim.spatial.tangent import Columns, columns, turned
from avatarsim.spatial.vec3 import Rows, Vec3, add, along, cross, dot, neg, norm, perpendicular, put_row, row, scale, sub
from avatarsim.tolerances import JUDGED, ROUGH, SLIM

Array = NDArray[np.float64]

@kernel
def normal_of_edges(e: Vec3, f: Vec3, n: Vec3, turn_a: Vec3, turn_b: Vec3) -> Vec3:
    """Return n' [1/s] while n stays at right angles to both edges, e of A and f of B; ``turn_a``, ``turn_b``: their w x n."""
    wide = dot(n, cross(e, f))
    return along(scale(cross(f, n), dot(turn_a, e) / wide), dot(turn_b, f) / wide, cross(n, e))


@kernel
def normal_of_edge(e: Vec3, n: Vec3, turn: Vec3, radii: Columns, gap: float, drive: Vec3) -> Vec3:
    """Return n' [1/s] while n stays at right angles to an edge, unit e, that turns by ``turn``; see `normal_of_points`."""
    g = cross(n, e)
    along_e = dot(turn, e)
    across = (dot(g, drive) - along_e * dot(g, turned(radii, e))) / (dot(g, turned(radii, g)) + gap)
    return along(scale(e, along_e), across, g)


@kernel
def normal_of_points(n: Vec3, radii: Columns, gap: float, drive: Vec3) -> Vec3:
    """Return n' [1/s] of two points with curvature, across n: (H_a + H_b + gap) n' = drive: u + H_a (w_a x n) + H_b (w_b x n)."""
    p = perpendicular(n)
    q = cross(n, p)
    radii_p, radii_q = turned(radii, p), turned(radii, q)
    pp, pq, qq = dot(p, radii_p) + gap, dot(p, radii_q), dot(q, radii_q) + gap
    det = pp * qq - pq * pq
    x, y = dot(p, drive), dot(q, drive)
    return along(scale(p, (qq * x - pq * y) / det), (pp * y - pq * x) / det, q)


@kernel
def roll_on(contacts: Contacts, k: int, linear: Array, angular: Array) -> tuple[Vec3, Vec3, Vec3]:
    """Return (n' [1/s], rates of the arms of A and B [m/s]) at contact k, of which a side at least is smooth.

    Both arms lead to one point throughout, so that forces at their midpoints keep angular momentum.
    """
    a, b = contacts.body[k, 0], contacts.body[k, 1]
    n, w_a, w_b = axis(contacts, k, 0), row(angular, a), row(angular, b)
    arm_a, arm_b = row(contacts.arm_a, k), row(contacts.arm_b, k)
    turn_a, turn_b, apart = cross(w_a, n), cross(w_b, n), sub(row(linear, a), row(linear, b))
    radii_a, radii_b = columns(contacts.radii_a, k), columns(contacts.radii_b, k)
    u = tangential_velocity(n, sub(add(apart, cross(w_a, arm_a)), cross(w_b, arm_b)))
    drive = add(u, add(turned(radii_a, turn_a), turned(radii_b, turn_b)))
    gap = max(0.0, contacts.gap[k])
    e, f = row(contacts.edge_a, k), row(contacts.edge_b, k)
    long_e, long_f = norm(e), norm(f)
    of_a, more = True, 0.0
    if contacts.smooth[k] & NORMAL_OF_ANOTHER:
        turns, of_a = (0.0, 0.0, 0.0), bool(contacts.smooth[k] & ROUND_A)
    elif contacts.face[k] == 1:
        turns, of_a = turn_a, False
    elif contacts.face[k] == 2:
        turns = turn_b
    elif long_e > 0.0 and long_f > 0.0 and norm(cross(e, f)) > SLIM * long_e * long_f:
        turns = normal_of_edges(e, f, n, turn_a, turn_b)
        # the point runs along e by the rest of the way over B's edge
        rest = sub(add(turned(radii_a, turns), turned(radii_b, turns)), drive)
        more = dot(rest, cross(f, n)) / dot(n, cross(e, f))
    else:
        radii = (add(radii_a[0], radii_b[0]), add(radii_a[1], radii_b[1]), add(radii_a[2], radii_b[2]))
        if long_e > 0.0:
            turns, of_a = normal_of_edge(scale(e, 1.0 / long_e), n, turn_a, radii, gap, drive), long_f > 0.0
        elif long_f > 0.0:
            turns = normal_of_edge(scale(f, 1.0 / long_f), n, turn_b, radii, gap, drive)
        else:
            turns = normal_of_points(n, radii, gap, drive)
    if of_a:
        sway_a = along(add(cross(w_a, arm_a), turned(radii_a, sub(turn_a, turns))), more, e)
        return turns, sway_a, add(sway_a, apart)
    sway_b = add(cross(w_b, arm_b), turned(radii_b, sub(turns, turn_b)))
    return turns, sub(sway_b, apart), sway_b


@kernel
def pace_of_arm(arm: Vec3, sway: Vec3, turns: Vec3) -> float:
    """Return how fast a contact of a smooth surface changes [rad/s]: its arm or its normal, whichever turns faster."""
    return max(norm(turns), norm(sway) / max(norm(arm), 1e-300))


@kernel
def curvature(contacts: Contacts, linear: Array, angular: Array) -> None:
    """Fill ``bias_acceleration``: that of A's contact point as seen from B's [m/s^2] without any force; ``sway`` and ``turns``.

    Gap' = n . (v_a + w_a x r_a - v_b - w_b x r_b), so gap'' = n . (w_a x r_a' - w_b x r_b') + n' . u and the effect of forces.
    """
    for k in range(contacts.used[0]):
        if contacts.smooth[k] == TWO_BALLS:
            put_row(contacts.bias_acceleration, k, bias_of_balls(contacts, k, linear, angular))
            contacts.turns[k, 0], contacts.turns[k, 1] = 0.0, 0.0
            continue
        a, b = contacts.body[k, 0], contacts.body[k, 1]
        n, w_a, w_b = axis(contacts, k, 0), row(angular, a), row(angular, b)
        if contacts.smooth[k] == SHARP:
            bias = bias_of_corners(contacts, k, linear, angular)
            contacts.turns[k, 0], contacts.turns[k, 1] = norm(w_a), norm(w_b)
        else:
            turns, sway_a, sway_b = roll_on(contacts, k, linear, angular)
            on_a = point_velocity(row(linear, a), w_a, row(contacts.arm_a, k))
            u = sub(on_a, point_velocity(row(linear, b), w_b, row(contacts.arm_b, k)))
            bias = along(sub(cross(w_a, sway_a), cross(w_b, sway_b)), dot(turns, u), n)
            if contacts.driven[k] == NOT_DRIVEN:
                put_row(contacts.sway_a, k, sway_a)
                put_row(contacts.sway_b, k, sway_b)
            round_a, round_b = contacts.smooth[k] & ROUND_A, contacts.smooth[k] & ROUND_B
            contacts.turns[k, 0] = pace_of_arm(row(contacts.arm_a, k), sway_a, turns) if round_a else norm(w_a)
            contacts.turns[k, 1] = pace_of_arm(row(contacts.arm_b, k), sway_b, turns) if round_b else norm(w_b)
        put_row(contacts.bias_acceleration, k, bias)


@kernel
def bias_of_balls(contacts: Contacts, k: int, linear: Array, angular: Array) -> Vec3:
    """Return the bias acceleration of two balls: |v_t|^2 / distance along n, across it the effect of a spin about n."""
    a, b = contacts.body[k, 0], contacts.body[k, 1]
    n, across = axis(contacts, k, 0), sub(row(linear, a), row(linear, b))
    across = tangential_velocity(n, across)
    radius_a, radius_b = norm(row(contacts.arm_a, k)), norm(row(contacts.arm_b, k))
    turns = scale(across, 1.0 / (radius_a + radius_b + contacts.gap[k]))
    spin = dot(n, along(scale(row(angular, a), radius_a), radius_b, row(angular, b)))
    return along(scale(n, dot(across, turns)), -spin, cross(n, turns))


@kernel
def bias_of_corners(contacts: Contacts, k: int, linear: Array, angular: Array) -> Vec3:
    """Return the bias acceleration of a contact of corners, edges and faces; fills ``sway``.

    A corner that pivots moves on a circle, w x (w x r). A body that slides with u over a face that turns with w meets or leaves
    it by 2 (w x n) . u (Coriolis).
    """
    a, b = contacts.body[k, 0], contacts.body[k, 1]
    w_a, w_b = row(angular, a), row(angular, b)
    sway_a, sway_b = cross(w_a, row(contacts.arm_a, k)), cross(w_b, row(contacts.arm_b, k))
    bias = sub(cross(w_a, sway_a), cross(w_b, sway_b))
    if contacts.driven[k] == NOT_DRIVEN:
        put_row(contacts.sway_a, k, sway_a)
        put_row(contacts.sway_b, k, sway_b)
    e, f = row(contacts.edge_a, k), row(contacts.edge_b, k)
    wide = norm(cross(e, f))
    if wide > 0.0:
        # the plane along both edges turns: N'' of `collision.edge_edge` without the points' own acceleration
        n, u = axis(contacts, k, 0), velocity_at(contacts, k, linear, angular)
        turns = add(cross(cross(w_a, e), f), cross(e, cross(w_b, f)))
        sign = 1.0 if dot(cross(e, f), n) > 0.0 else -1.0
        bias = along(bias, sign * 2.0 * dot(turns, u) / wide, n)
    if contacts.face[k] != 0:
        n, w = axis(contacts, k, 0), w_a if contacts.face[k] == 1 else w_b
        slip = tangential_velocity(n, velocity_at(contacts, k, linear, angular))
        bias = along(bias, 2.0 * dot(cross(w, n), slip), n)
    return bias


EVEN = ROUGH
"""Corners that are lower along a normal than the farthest by no more than this part of a shape's size touch as well. Larger:
balls near a corner count as on its edge; smaller than the accuracy of the normal: balls on a face count as on its edge."""

INSIDE = JUDGED
"""A point of a segment that is farther from both of its ends than this part of its length is no end."""

CORNER, EDGE, FACE = 1, 2, 3
"""Number of farthest corners; three stand for all more."""


@kernel
def is_smooth(shapes: Shapes, s: int) -> bool:
    """Return True if the surface of shape s has radii of curvature."""
    return bool(shapes.kind[s] != POINTS or shapes.radius[s] > 0.0)


@kernel
def facing(vertices: Rows, shapes: Shapes, s: int, m: Vec3, touching: Vec3) -> tuple[int, Vec3]:
    """Return (CORNER, EDGE or FACE of shape s that is farthest along m, direction of the edge) where it touches at ``touching``.

    Where an edge ends it is a corner, and its direction is given all the same. The ball around the points does not matter.
    """
    none = (0.0, 0.0, 0.0)
    if shapes.kind[s] != POINTS:
        return CORNER, none
    count, p, q = foremost(vertices, shapes, s, m, EVEN * shapes.extent[s])
    if count == 1:
        return CORNER, none
    if count > 2:
        return FACE, none
    edge = sub(q, p)
    length = norm(edge)
    place = dot(sub(touching, p), edge) / (length * length)
    return EDGE if INSIDE < place < 1.0 - INSIDE else CORNER, edge


@kernel
def is_lone(shapes: Shapes, s: int) -> bool:
    """Return True if shape s touches in one point on any shape: a ball or an ellipsoid."""
    return bool(shapes.kind[s] != POINTS or shapes.start[s + 1] - shapes.start[s] == 1)


@kernel
def put_radius(radius: float, m: Vec3, out: Array) -> None:
    """Run `put_radii` for points swept by a ball."""
    for i in range(3):
        e = (1.0 if i == 0 else 0.0, 1.0 if i == 1 else 0.0, 1.0 if i == 2 else 0.0)
        put_row(out, i, scale(along(e, -m[i], m), radius))


@kernel
def put_radii(vertices: Rows, shapes: Shapes, s: int, m: Vec3, out: Array) -> None:
    """Compute the second derivative of shape s's support function at unit normal m [m], (3, 3): its point's motion per turn."""
    if shapes.kind[s] == POINTS:
        put_radius(shapes.radius[s], m, out)
        return
    weights = stretched(vertices, shapes, s, m)
    length = norm(weights)
    point = gathered(vertices, shapes, s, scale(weights, 1.0 / length))
    first = shapes.start[s]
    for i in range(3):
        squares = gathered(vertices, shapes, s, (vertices[first + 1, i], vertices[first + 2, i], vertices[first + 3, i]))
        put_row(out, i, scale(along(squares, -point[i], point), 1.0 / length))


@kernel
def note_smooth(
    vertices: Rows, shapes: Shapes, contacts: Contacts, poses: Poses, sa: int, sb: int, raw: Vec3, first: int
) -> None:
    """Fill what `rigid.rolling` needs for the contacts of shapes sa and sb, from ``first`` on; ``raw``: normal of the query.

    Two points that are of no face are those of edges along each other: both count as edges to their very ends. The manifold takes
    any surface that a ball touches for a face; it may be an edge or a corner.
    """
    smooth = (ROUND_A if is_smooth(shapes, sa) else 0) + (ROUND_B if is_smooth(shapes, sb) else 0)
    lone, several = is_lone(shapes, sa) or is_lone(shapes, sb), contacts.used[0] - first > 1
    for k in range(first, contacts.used[0]):
        n = axis(contacts, k, 0)
        contacts.smooth[k] = smooth
        put_radii(vertices, shapes, sa, neg(n), contacts.radii_a[k])
        put_radii(vertices, shapes, sb, n, contacts.radii_b[k])
        if contacts.face[k] != 0 and not lone:
            continue
        on_a = add(row(poses.position, contacts.body[k, 0]), row(contacts.arm_a, k))
        on_b = add(row(poses.position, contacts.body[k, 1]), row(contacts.arm_b, k))
        kind_a, e = facing(vertices, shapes, sa, neg(raw), on_a)
        kind_b, f = facing(vertices, shapes, sb, raw, on_b)
        contacts.face[k] = 1 if kind_a == FACE else (2 if kind_b == FACE else 0)
        if kind_a == EDGE or (kind_a == CORNER and several):
            put_row(contacts.edge_a, k, e)
        if kind_b == EDGE or (kind_b == CORNER and several):
            put_row(contacts.edge_b, k, f)
