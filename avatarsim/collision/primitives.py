"""Penetration depth of two boxes over the 15 axes of the separating axis test (Gottschalk, Lin and Manocha 1996).

The Minkowski difference A - B of two boxes, sheared or not, is the sum of six segments about the difference of their centres. Its
facets are normal to a face of A, to a face of B, or to an edge of each: fifteen normals, each in two directions. The lowest facet
is the depth.

Closed-form distances of the simplest cores: two segments or points, and a point and a box (Ericson 2005, chapter 5).

A sphere is a point and a capsule a segment, swept by their radii, which are left out here. Pairs that these formulas cannot
answer with certainty (cores that touch, boxes bent by rounding) are left to GJK and EPA.
"""

from math import inf, sqrt

from avatarsim.collision.epa import EXACT
from avatarsim.collision.gjk import ACCEPTED, CLOSE_ENOUGH, NOWHERE, TOUCHING, Share2, closest_on_triangle
from avatarsim.collision.support import reach
from avatarsim.jit.kernel import kernel
from avatarsim.model.geometry import POINTS, Shapes
from avatarsim.spatial.vec3 import Rows, Vec3, along, cross, dot, neg, norm, row, scale, sub
from avatarsim.tolerances import COARSE_ROUNDING, LAST_PLACES, NOTHING, SAME_DIRECTION

Answer = tuple[bool, float, Vec3, Vec3, Vec3]
"""(whether known, signed distance of the cores [m], unit normal out of b into a, point of a, point of b)."""

BOX_CORNERS = 8
"""Points of a box, in the order of three nested loops over low and high x, y, z: corner 0 is opposite to corner 7."""

NONE, TWO_POINTS, TWO_SEGMENTS, POINT_AND_BOX, BOX_AND_POINT = 0, 1, 2, 3, 4
"""Results of `form`: no formula; two spheres; sphere or capsule and capsule; sphere and a possible box, in both orders."""

UNKNOWN = (False, 0.0, NOWHERE, NOWHERE, NOWHERE)
"""The answer where no formula gives one."""

SQUARE = COARSE_ROUNDING
"""Relative to a box's size: how far eight points may be off a box and still be taken for one. Larger: a wrong distance
by as much; smaller: boxes whose corners are rounded, far from the origin, are missed, and only take longer."""


@kernel
def form(shapes: Shapes, a: int, b: int) -> int:
    """Return the formula that there is for shapes a and b.

    The queries call the formula themselves, which saves a call for pairs that take as long as a few calls.
    """
    if shapes[a].kind != POINTS or shapes[b].kind != POINTS:
        return NONE
    many_a: int = shapes[a + 1].start - shapes[a].start
    many_b: int = shapes[b + 1].start - shapes[b].start
    if many_a <= 2 and many_b <= 2:
        return TWO_POINTS if many_a + many_b == 2 else TWO_SEGMENTS
    if many_a == 1 and many_b == BOX_CORNERS:
        return POINT_AND_BOX
    return BOX_AND_POINT if many_b == 1 and many_a == BOX_CORNERS else NONE


@kernel
def between_points(vertices: Rows, shapes: Shapes, a: int, b: int) -> Answer:
    """Return the distance of two points; not known if they coincide."""
    p, q = row(vertices, shapes[a].start), row(vertices, shapes[b].start)
    v = sub(p, q)
    length = norm(v)
    if not (TOUCHING * max(shapes[a].extent, shapes[b].extent) < length < inf):
        return UNKNOWN
    return True, length, scale(v, 1.0 / length), p, q


@kernel
def between_segments(vertices: Rows, shapes: Shapes, a: int, b: int) -> Answer:
    """Return the distance of two segments or points: that of the origin from the parallelogram of their differences.

    Not known if they touch, or if no plane proves the distance.
    """
    p, q = row(vertices, shapes[a].start), row(vertices, shapes[a + 1].start - 1)
    r, s = row(vertices, shapes[b].start), row(vertices, shapes[b + 1].start - 1)
    size = max(shapes[a].extent, shapes[b].extent)
    u, v, between = sub(q, p), sub(s, r), sub(p, r)
    of_q, of_s = shares(u, v, between)
    w = along(along(between, of_q, u), -of_s, v)
    length = norm(w)
    if not (TOUCHING * size < length < inf):
        return between_segments_by_triangles(p, q, r, s, size)
    n = scale(w, 1.0 / length)
    # The least of four heights: p - r and the additions of the other ends.
    proved = dot(n, between) + min(dot(n, u), 0.0) - max(dot(n, v), 0.0)
    if not (length - proved <= CLOSE_ENOUGH * size + LAST_PLACES * length):
        return between_segments_by_triangles(p, q, r, s, size)
    return True, length, n, along(p, of_q, u), along(r, of_s, v)


@kernel
def shares(u: Vec3, v: Vec3, between: Vec3) -> Share2:
    """Return shares t, x in [0, 1] of the nearest points p + t u and r + x v of two segments; between = p - r.

    Each is the best for the other, t for the lines first. Rounding of nearly parallel ones is the caller's matter. Without
    branches, which a processor would guess wrong half of the time. A segment of no length has share 0.
    """
    uu, vv, uv, u_p, v_p = dot(u, u), dot(v, v), dot(u, v), dot(u, between), dot(v, between)
    across = uu * vv - uv * uv
    t = within((uv * v_p - vv * u_p) / (across if across > 0.0 else 1.0))
    x = within((uv * t + v_p) / (vv if vv > 0.0 else 1.0))
    return within((uv * x - u_p) / (uu if uu > 0.0 else 1.0)), x


@kernel
def within(share: float) -> float:
    """Return the nearest number from 0 to 1."""
    share = share if share > 0.0 else 0.0
    return share if share < 1.0 else 1.0


@kernel
def between_segments_by_triangles(p: Vec3, q: Vec3, r: Vec3, s: Vec3, size: float) -> Answer:
    """Return `between_segments` of p q and r s, however nearly parallel they are: the parallelogram as two triangles."""
    pr, qr, ps, qs = sub(p, r), sub(q, r), sub(p, s), sub(q, s)
    v, x = closest_on_triangle(pr, qr, qs)
    u, y = closest_on_triangle(pr, qs, ps)
    # Shares of q in the point of a and of s in the point of b.
    of_q, of_s = x[1] + x[2], x[2]
    if dot(u, u) < dot(v, v):
        v, of_q, of_s = u, y[1], y[1] + y[2]
    length = norm(v)
    if not (TOUCHING * size < length < inf):
        return UNKNOWN
    n = scale(v, 1.0 / length)
    proved = min(dot(n, pr), dot(n, qr), dot(n, ps), dot(n, qs))
    if not (length - proved <= ACCEPTED * size + ACCEPTED * length):
        return UNKNOWN
    return True, length, n, along(p, of_q, sub(q, p)), along(r, of_s, sub(s, r))


@kernel
def point_and_box(vertices: Rows, shapes: Shapes, a: int, b: int) -> Answer:
    """Return the signed distance of a point a from the surface of a box b; not known if b is no box or a is on its surface."""
    first, size, extent = shapes[b].start, max(shapes[a].extent, shapes[b].extent), shapes[b].extent
    low, three, five, six = row(vertices, first), row(vertices, first + 3), row(vertices, first + 5), row(vertices, first + 6)
    x, y, z = sub(row(vertices, first + 4), low), sub(row(vertices, first + 2), low), sub(row(vertices, first + 1), low)
    # The fourth corner of a face next to the first, three times, and the corner opposite to it.
    bent = max(
        off(sub(six, low), x, y), off(sub(five, low), x, z), off(sub(three, low), y, z),
        off(sub(row(vertices, first + 7), low), x, sub(three, low)),
    )
    p = row(vertices, shapes[a].start)
    d = sub(p, low)
    # Coordinates in the box, from 0 to 1, and how far each is beyond that.
    xx, yy, zz, xy, xz, yz = dot(x, x), dot(y, y), dot(z, z), dot(x, y), dot(x, z), dot(y, z)
    if not (bent <= SQUARE * extent and xx > 0.0 and yy > 0.0 and zz > 0.0):
        return UNKNOWN
    out_x, out_y, out_z = beyond(dot(d, x) / xx), beyond(dot(d, y) / yy), beyond(dot(d, z) / zz)
    if out_x == 0.0 and out_y == 0.0 and out_z == 0.0:
        return point_in_box(p, d, x, y, z, size)
    # How much of an edge lies along a longer one, squared.
    little = SQUARE * extent * SQUARE * extent
    if not (xy * xy <= little * max(xx, yy) and xz * xz <= little * max(xx, zz) and yz * yz <= little * max(yy, zz)):
        return UNKNOWN
    v = along(along(scale(x, out_x), out_y, y), out_z, z)
    length = norm(v)
    if not (TOUCHING * size < length < inf):
        return UNKNOWN
    return True, length, scale(v, 1.0 / length), p, sub(p, v)


@kernel
def beyond(share: float) -> float:
    """Return how far a coordinate is above 1 or below 0; nan stays."""
    return share if share < 0.0 else (share - 1.0 if not (share <= 1.0) else 0.0)


@kernel
def point_in_box(p: Vec3, d: Vec3, x: Vec3, y: Vec3, z: Vec3, size: float) -> Answer:
    """Return the depth of a point p, d from a corner with edges x y z, in the box, which may be sheared: by the nearest plane.

    The ball about p that touches it is in the box, and so is the point where it does.
    """
    over_x, over_y, over_z = cross(y, z), cross(z, x), cross(x, y)
    volume = dot(x, over_x)
    side = 1.0 if volume > 0.0 else -1.0
    over_x = scale(over_x, side / norm(over_x))
    over_y, over_z = scale(over_y, side / norm(over_y)), scale(over_z, side / norm(over_z))
    # From the three planes through the corner, and from those opposite to them.
    low_x, low_y, low_z = dot(d, over_x), dot(d, over_y), dot(d, over_z)
    high_x, high_y, high_z = dot(x, over_x) - low_x, dot(y, over_y) - low_y, dot(z, over_z) - low_z
    least_x, least_y, least_z = min(low_x, high_x), min(low_y, high_y), min(low_z, high_z)
    depth = min(least_x, least_y, least_z)
    if not (TOUCHING * size < depth < inf):
        return UNKNOWN
    if least_x == depth:
        n = over_x if high_x == depth else neg(over_x)
    elif least_y == depth:
        n = over_y if high_y == depth else neg(over_y)
    else:
        n = over_z if high_z == depth else neg(over_z)
    return True, -depth, n, p, along(p, depth, n)


@kernel
def off(corner: Vec3, u: Vec3, v: Vec3) -> float:
    """Return the largest coordinate difference of a corner from u + v."""
    d = sub(sub(corner, u), v)
    return max(abs(d[0]), abs(d[1]), abs(d[2]))


Edges = tuple[Vec3, Vec3, Vec3]

PARALLEL = SAME_DIRECTION
"""Sine of the angle of two edges below which the boxes are left to EPA: aligned boxes have facets that are equally low and
witness points that are many, and which of them is taken should not depend on the formula. Smaller: rounding takes part in it."""

OUTSIDE = NOTHING
"""Relative to an edge: how far outside of a face or an edge rounding may put a witness point."""

CLEARLY_DEEP = NOTHING
"""Relative to the shapes' size: depths below this are left to GJK and EPA. Smaller: rounding decides whether there is one."""


@kernel
def are_boxes(shapes: Shapes, a: int, b: int) -> bool:
    """Return True if both shapes may be boxes: eight points each."""
    eight_a: bool = shapes[a].kind == POINTS and shapes[a + 1].start - shapes[a].start == BOX_CORNERS
    eight_b: bool = shapes[b].kind == POINTS and shapes[b + 1].start - shapes[b].start == BOX_CORNERS
    return eight_a and eight_b


@kernel
def edges_of(vertices: Rows, shapes: Shapes, s: int) -> tuple[bool, Edges]:
    """Return True if the eight points of shape s are a box, which may be sheared, and its edges from corner 0."""
    f = shapes[s].start
    low, three, five, six = row(vertices, f), row(vertices, f + 3), row(vertices, f + 5), row(vertices, f + 6)
    x, y, z = sub(row(vertices, f + 4), low), sub(row(vertices, f + 2), low), sub(row(vertices, f + 1), low)
    bent = max(
        off(sub(six, low), x, y), off(sub(five, low), x, z), off(sub(three, low), y, z),
        off(sub(row(vertices, f + 7), low), x, sub(three, low)),
    )
    return bent <= EXACT * shapes[s].extent, (x, y, z)


@kernel
def height(n: Vec3, c: Vec3, u: Edges, v: Edges) -> float:
    """Return the height of the lower of two opposite facets of normal n, times |n|: half A - B's width less its centre's way."""
    of_a = abs(dot(n, u[0])) + abs(dot(n, u[1])) + abs(dot(n, u[2]))
    of_b = abs(dot(n, v[0])) + abs(dot(n, v[1])) + abs(dot(n, v[2]))
    return 0.5 * (of_a + of_b) - abs(dot(n, c))


@kernel
def lowest_facet(c: Vec3, u: Edges, v: Edges) -> tuple[float, Vec3, int, int]:
    """Return the height and outward unit normal of the lowest facet of A - B, centre c, and its sources: edges i of A and j of B.

    i and -1: a face of A, which edge i leaves; -1 and j: one of B. Height 0: none holds, because A - B does not hold the origin
    or edges are parallel.
    """
    lowest, square, normal, best_i, best_j = inf, 1.0, (0.0, 0.0, 0.0), -1, -1
    for i in range(-1, 3):
        for j in range(-1, 3):
            if i < 0:
                if j < 0:
                    continue
                n = cross(v[(j + 1) % 3], v[(j + 2) % 3])
            elif j < 0:
                n = cross(u[(i + 1) % 3], u[(i + 2) % 3])
            else:
                n = cross(u[i], v[j])
                if not (dot(n, n) > PARALLEL * PARALLEL * dot(u[i], u[i]) * dot(v[j], v[j])):
                    return 0.0, normal, -1, -1
            h, nn = height(n, c, u, v), dot(n, n)
            if not (h > 0.0):
                return 0.0, normal, -1, -1
            if h * h * square < lowest * lowest * nn:
                lowest, square, normal, best_i, best_j = h, nn, n, i, j
    length = sqrt(square)
    return lowest / length, scale(normal, -1.0 / length if dot(normal, c) > 0.0 else 1.0 / length), best_i, best_j


@kernel
def corner_towards(low: Vec3, u: Edges, m: Vec3, free: int) -> Vec3:
    """Return the corner of a box farthest along m; edge ``free`` is left at its beginning."""
    p = low
    for k in range(3):
        if k != free and dot(u[k], m) > 0.0:
            p = along(p, 1.0, u[k])
    return p


@kernel
def on_face(p: Vec3, low: Vec3, u: Edges, i: int) -> bool:
    """Return True if p, in the plane of a face that edge i leaves, is on the face."""
    d, s, t = sub(p, low), u[(i + 1) % 3], u[(i + 2) % 3]
    n = cross(s, t)
    nn = dot(n, n)
    # The part of d along the edge that leaves the face is taken off: it may be at an angle.
    d = along(d, -dot(d, n) / dot(u[i], n), u[i])
    x, y = dot(cross(d, t), n) / nn, dot(cross(s, d), n) / nn
    return -OUTSIDE <= x <= 1.0 + OUTSIDE and -OUTSIDE <= y <= 1.0 + OUTSIDE


@kernel
def box_depth(vertices: Rows, shapes: Shapes, a: int, b: int) -> Answer:
    """Return the signed distance of two boxes that overlap; not known if they do not, are no boxes, or have parallel edges.

    Moving by the height of the lowest facet proves that height, and no other facet is lower.
    """
    size = max(shapes[a].extent, shapes[b].extent)
    box_a, u = edges_of(vertices, shapes, a)
    box_b, v = edges_of(vertices, shapes, b)
    if not (box_a and box_b):
        return UNKNOWN
    low_a, low_b = row(vertices, shapes[a].start), row(vertices, shapes[b].start)
    c = sub(low_a, low_b)
    for k in range(3):
        c = along(along(c, 0.5, u[k]), -0.5, v[k])
    depth, m, i, j = lowest_facet(c, u, v)
    if not (CLEARLY_DEEP * size < depth < inf):
        return UNKNOWN
    back = scale(m, -1.0)
    if not (abs(reach(vertices, shapes, a, m) + reach(vertices, shapes, b, back) - depth) <= EXACT * size):
        return UNKNOWN
    if j < 0:
        on_b = corner_towards(low_b, v, back, -1)
        on_a = along(on_b, depth, m)
        known = on_face(on_a, low_a, u, i)
    elif i < 0:
        on_a = corner_towards(low_a, u, m, -1)
        on_b = along(on_a, -depth, m)
        known = on_face(on_b, low_b, v, j)
    else:
        p, q = corner_towards(low_a, u, m, i), corner_towards(low_b, v, back, j)
        # p + s u - q - t v = depth m
        r, n = along(sub(q, p), depth, m), cross(u[i], v[j])
        s, t = dot(cross(r, v[j]), n) / dot(n, n), dot(cross(r, u[i]), n) / dot(n, n)
        on_a, on_b = along(p, within(s), u[i]), along(q, within(t), v[j])
        known = norm(along(sub(on_a, on_b), -depth, m)) <= EXACT * size
    return known, -depth, back, on_a, on_b
