"""Distances of the simplest cores without iterations: two segments or points, and a point and a box.

A sphere is a point and a capsule a segment, swept by their radii, which are left out here. What these formulas cannot
answer with certainty (cores that touch, boxes bent by rounding) is left to GJK and EPA.
"""

from math import inf

from avatarsim.collide.gjk import ACCEPTED, NOWHERE, TOUCHING
from avatarsim.collide.simplex import closest_on_segment, closest_on_triangle
from avatarsim.kernel import kernel
from avatarsim.spatial.vec3 import Rows, Vec3, along, cross, dot, neg, norm, row, scale, sub, unit
from avatarsim.world.shapes import POINTS, Shapes

Answer = tuple[bool, float, Vec3, Vec3, Vec3]
"""(whether known, signed distance of the cores [m], unit normal out of b into a, point of a, point of b)."""

BOX_CORNERS = 8
"""Points of a box, in the order of three nested loops over low and high x, y, z: corner 0 is opposite to corner 7."""

SQUARE = 1e-11
"""Relative to a box's size: how far eight points may be off a box and still be taken for one. Larger: a wrong distance
by as much; smaller: boxes whose corners are rounded, far from the origin, are missed, and only take longer."""


@kernel
def closed_form(vertices: Rows, shapes: Shapes, a: int, b: int) -> Answer:
    """Signed distance of the cores of shapes a and b if a formula gives it."""
    if shapes.kind[a] != POINTS or shapes.kind[b] != POINTS:
        return False, 0.0, NOWHERE, NOWHERE, NOWHERE
    many_a, many_b = shapes.start[a + 1] - shapes.start[a], shapes.start[b + 1] - shapes.start[b]
    if many_a <= 2 and many_b <= 2:
        return between_segments(vertices, shapes, a, b)
    if many_a == 1 and many_b == BOX_CORNERS:
        return point_and_box(vertices, shapes, a, b)
    if many_b == 1 and many_a == BOX_CORNERS:
        known, distance, n, on_b, on_a = point_and_box(vertices, shapes, b, a)
        return known, distance, neg(n), on_a, on_b
    return False, 0.0, NOWHERE, NOWHERE, NOWHERE


@kernel
def between_segments(vertices: Rows, shapes: Shapes, a: int, b: int) -> Answer:
    """Distance of two segments or points: that of the origin from the parallelogram of their differences.

    Not known if they touch, or if no plane proves the distance.
    """
    p, q = row(vertices, shapes.start[a]), row(vertices, shapes.start[a + 1] - 1)
    r, s = row(vertices, shapes.start[b]), row(vertices, shapes.start[b + 1] - 1)
    one_a, one_b = shapes.start[a + 1] - shapes.start[a] == 1, shapes.start[b + 1] - shapes.start[b] == 1
    pr, qr, ps, qs = sub(p, r), sub(q, r), sub(p, s), sub(q, s)
    # Shares of q in the point of a and of s in the point of b.
    v, of_q, of_s = pr, 0.0, 0.0
    if one_b and not one_a:
        v, two = closest_on_segment(pr, qr)
        of_q = two[1]
    elif one_a and not one_b:
        v, two = closest_on_segment(pr, ps)
        of_s = two[1]
    elif not one_a:
        v, x = closest_on_triangle(pr, qr, qs)
        u, y = closest_on_triangle(pr, qs, ps)
        of_q, of_s = x[1] + x[2], x[2]
        if dot(u, u) < dot(v, v):
            v, of_q, of_s = u, y[1], y[1] + y[2]
    length, size = norm(v), max(shapes.extent[a], shapes.extent[b])
    if not (TOUCHING * size < length < inf):
        return False, 0.0, NOWHERE, NOWHERE, NOWHERE
    n = scale(v, 1.0 / length)
    proved = min(dot(n, pr), dot(n, qr), dot(n, ps), dot(n, qs))
    if not (length - proved <= ACCEPTED * size + ACCEPTED * length):
        return False, 0.0, NOWHERE, NOWHERE, NOWHERE
    return True, length, n, along(p, of_q, sub(q, p)), along(r, of_s, sub(s, r))


@kernel
def point_and_box(vertices: Rows, shapes: Shapes, a: int, b: int) -> Answer:
    """Signed distance of a point a from the surface of a box b; not known if b is no box or a is on its surface."""
    first, size = shapes.start[b], max(shapes.extent[a], shapes.extent[b])
    low, high = row(vertices, first), row(vertices, first + 7)
    x, y, z = sub(row(vertices, first + 4), low), sub(row(vertices, first + 2), low), sub(row(vertices, first + 1), low)
    across = sub(high, low)
    # The fourth corner of a face beside the first, three times, and the corner opposite to it.
    bent = max(
        off(sub(row(vertices, first + 6), low), x, y), off(sub(row(vertices, first + 5), low), x, z),
        off(sub(row(vertices, first + 3), low), y, z), off(across, x, sub(row(vertices, first + 3), low)),
    )
    # Longest edge first: it gives its direction best, and the others are put at right angles to it.
    if dot(y, y) > dot(x, x):
        x, y = y, x
    if dot(z, z) > dot(x, x):
        x, z = z, x
    if dot(z, z) > dot(y, y):
        y, z = z, y
    lx, ly, lz = norm(x), norm(y), norm(z)
    skew = max(abs(dot(x, y)), abs(dot(z, x))) / lx
    if not (bent <= SQUARE * shapes.extent[b] and max(skew, abs(dot(y, z)) / ly) <= SQUARE * shapes.extent[b] and lz > 0.0):
        return False, 0.0, NOWHERE, NOWHERE, NOWHERE
    x = scale(x, 1.0 / lx)
    y = unit(along(y, -dot(y, x), x))
    z = cross(x, y)
    p = row(vertices, shapes.start[a])
    d = sub(p, along(low, 0.5, across))
    # Coordinates in the box, and how far each is beyond the nearer of its two faces.
    px, py, pz = dot(d, x), dot(d, y), dot(d, z)
    ex, ey, ez = abs(px) - 0.5 * lx, abs(py) - 0.5 * ly, abs(pz) - 0.5 * lz
    x, y, z = scale(x, 1.0 if px > 0.0 else -1.0), scale(y, 1.0 if py > 0.0 else -1.0), scale(z, 1.0 if pz > 0.0 else -1.0)
    out = max(ex, ey, ez)
    if not (TOUCHING * size < abs(out) < inf):
        return False, 0.0, NOWHERE, NOWHERE, NOWHERE
    if out < 0.0:
        n = x if ex == out else (y if ey == out else z)
        return True, out, n, p, along(p, -out, n)
    v = along(along(scale(x, max(ex, 0.0)), max(ey, 0.0), y), max(ez, 0.0), z)
    length = norm(v)
    return True, length, scale(v, 1.0 / length), p, sub(p, v)


@kernel
def off(corner: Vec3, u: Vec3, v: Vec3) -> float:
    """Largest coordinate difference of a corner from u + v."""
    d = sub(sub(corner, u), v)
    return max(abs(d[0]), abs(d[1]), abs(d[2]))
