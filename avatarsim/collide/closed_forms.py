"""Closed-form distances of the simplest cores: two segments or points, and a point and a box (Ericson 2005, chapter 5).

A sphere is a point and a capsule a segment, swept by their radii, which are left out here. Pairs that these formulas cannot
answer with certainty (cores that touch, boxes bent by rounding) are left to GJK and EPA.
"""

from math import inf

from avatarsim.collide.gjk import ACCEPTED, CLOSE_ENOUGH, NOWHERE, ROUNDING, TOUCHING
from avatarsim.collide.simplex import Share2, closest_on_triangle
from avatarsim.jit.kernel import kernel
from avatarsim.spatial.vec3 import Rows, Vec3, along, cross, dot, neg, norm, row, scale, sub
from avatarsim.world.shapes import POINTS, Shapes

Answer = tuple[bool, float, Vec3, Vec3, Vec3]
"""(whether known, signed distance of the cores [m], unit normal out of b into a, point of a, point of b)."""

BOX_CORNERS = 8
"""Points of a box, in the order of three nested loops over low and high x, y, z: corner 0 is opposite to corner 7."""

NONE, TWO_POINTS, TWO_SEGMENTS, POINT_AND_BOX, BOX_AND_POINT = 0, 1, 2, 3, 4
"""What `form` says: nothing but iterations; two spheres; sphere or capsule and capsule; sphere and what may be a box,
in both orders."""

UNKNOWN = (False, 0.0, NOWHERE, NOWHERE, NOWHERE)
"""The answer where no formula gives one."""

SQUARE = 1e-11
"""Relative to a box's size: how far eight points may be off a box and still be taken for one. Larger: a wrong distance
by as much; smaller: boxes whose corners are rounded, far from the origin, are missed, and only take longer."""


@kernel
def form(shapes: Shapes, a: int, b: int) -> int:
    """Which formula there is for shapes a and b.

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
    """Distance of two points; not known if they coincide."""
    p, q = row(vertices, shapes[a].start), row(vertices, shapes[b].start)
    v = sub(p, q)
    length = norm(v)
    if not (TOUCHING * max(shapes[a].extent, shapes[b].extent) < length < inf):
        return UNKNOWN
    return True, length, scale(v, 1.0 / length), p, q


@kernel
def between_segments(vertices: Rows, shapes: Shapes, a: int, b: int) -> Answer:
    """Distance of two segments or points: that of the origin from the parallelogram of their differences.

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
    # The least of four heights: p - r and what the other ends add to it.
    proved = dot(n, between) + min(dot(n, u), 0.0) - max(dot(n, v), 0.0)
    if not (length - proved <= CLOSE_ENOUGH * size + ROUNDING * length):
        return between_segments_by_triangles(p, q, r, s, size)
    return True, length, n, along(p, of_q, u), along(r, of_s, v)


@kernel
def shares(u: Vec3, v: Vec3, between: Vec3) -> Share2:
    """Shares t, x in [0, 1] of the nearest points p + t u and r + x v of two segments; between = p - r.

    Each is the best for the other, t for the lines first. What rounding makes of nearly parallel ones is the caller's matter.
    Without branches, which a processor would guess wrong half of the time. A segment of no length has share 0.
    """
    uu, vv, uv, u_p, v_p = dot(u, u), dot(v, v), dot(u, v), dot(u, between), dot(v, between)
    across = uu * vv - uv * uv
    t = within((uv * v_p - vv * u_p) / (across if across > 0.0 else 1.0))
    x = within((uv * t + v_p) / (vv if vv > 0.0 else 1.0))
    return within((uv * x - u_p) / (uu if uu > 0.0 else 1.0)), x


@kernel
def within(share: float) -> float:
    """The nearest number from 0 to 1."""
    share = share if share > 0.0 else 0.0
    return share if share < 1.0 else 1.0


@kernel
def between_segments_by_triangles(p: Vec3, q: Vec3, r: Vec3, s: Vec3, size: float) -> Answer:
    """As `between_segments`, of p q and r s, however nearly parallel they are: the parallelogram as two triangles."""
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
    """Signed distance of a point a from the surface of a box b; not known if b is no box or a is on its surface."""
    first, size, extent = shapes[b].start, max(shapes[a].extent, shapes[b].extent), shapes[b].extent
    low, three, five, six = row(vertices, first), row(vertices, first + 3), row(vertices, first + 5), row(vertices, first + 6)
    x, y, z = sub(row(vertices, first + 4), low), sub(row(vertices, first + 2), low), sub(row(vertices, first + 1), low)
    # The fourth corner of a face beside the first, three times, and the corner opposite to it.
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
    """How far a coordinate is above 1 or below 0; nan stays."""
    return share if share < 0.0 else (share - 1.0 if not (share <= 1.0) else 0.0)


@kernel
def point_in_box(p: Vec3, d: Vec3, x: Vec3, y: Vec3, z: Vec3, size: float) -> Answer:
    """Depth of a point p, d from a corner with edges x y z, in the box, which may be sheared: the nearest of six planes.

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
    """Largest coordinate difference of a corner from u + v."""
    d = sub(sub(corner, u), v)
    return max(abs(d[0]), abs(d[1]), abs(d[2]))
