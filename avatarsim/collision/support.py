"""Support functions and support points of convex shapes: all that the distance and depth algorithms use of a shape.

Support feature of a shape along a direction: vertex, edge or face.
"""

from math import sqrt

from avatarsim.jit.kernel import kernel
from avatarsim.model.geometry import POINTS, Shapes
from avatarsim.spatial.vec3 import Rows, Vec3, along, dot, neg, row


@kernel
def farthest(vertices: Rows, first: int, last: int, d: Vec3) -> int:
    """Return the row among first .. last - 1 whose product with d is largest; of equal ones the lowest.

    Most of the time of a query between hulls goes into this scan and that of `largest`. Rows are compared by twos, the better one
    with the best so far, since each of these comparisons waits for the last. Where no product is a number: the first row.
    """
    best, found, i = dot(row(vertices, first), d), first, first + 1
    while i + 1 < last:
        t, u, at = dot(row(vertices, i), d), dot(row(vertices, i + 1), d), i
        if u > t:
            t, at = u, i + 1
        if t > best:
            best, found = t, at
        i += 2
    return i if i < last and dot(row(vertices, i), d) > best else found


@kernel
def largest(vertices: Rows, first: int, last: int, d: Vec3) -> float:
    """Return the largest product of rows first .. last - 1 with d, in two thirds of the time of `farthest`.

    Odd and even rows are compared among themselves. Where the product of the first row is no number, nor is this.
    """
    best = dot(row(vertices, first), d)
    other, i = best, first + 1
    while i + 1 < last:
        t, u = dot(row(vertices, i), d), dot(row(vertices, i + 1), d)
        best = t if t > best else best
        other = u if u > other else other
        i += 2
    t = dot(row(vertices, last - 1), d)
    best = t if t > best else best
    return other if other > best else best


@kernel
def support(vertices: Rows, shapes: Shapes, s: int, d: Vec3) -> tuple[Vec3, int]:
    """Return the farthest point of the core of shape s (its radius left out) in direction d, and its row.

    Points: see `farthest`. Ellipsoid with centre c and semi-axes a_i: c + sum_i a_i (a_i.d) / sqrt(sum_i (a_i.d)^2); its row
    is that of the centre.
    """
    first = shapes[s].start
    if shapes[s].kind == POINTS:
        found = farthest(vertices, first, shapes[s + 1].start, d)
        return row(vertices, found), found
    centre, x = row(vertices, first), row(vertices, first + 1)
    y, z = row(vertices, first + 2), row(vertices, first + 3)
    dx, dy, dz = dot(x, d), dot(y, d), dot(z, d)
    length = sqrt(dx * dx + dy * dy + dz * dz)
    if length == 0.0:
        return centre, first
    return along(along(along(centre, dx / length, x), dy / length, y), dz / length, z), first


@kernel
def reach(vertices: Rows, shapes: Shapes, s: int, d: Vec3) -> float:
    """Return the support function of the core of shape s: the largest x.d over its points x."""
    first = shapes[s].start
    if shapes[s].kind == POINTS:
        return largest(vertices, first, shapes[s + 1].start, d)
    dx = dot(row(vertices, first + 1), d)
    dy = dot(row(vertices, first + 2), d)
    dz = dot(row(vertices, first + 3), d)
    return dot(row(vertices, first), d) + sqrt(dx * dx + dy * dy + dz * dz)


@kernel
def gap_along(vertices: Rows, shapes: Shapes, a: int, b: int, n: Vec3) -> float:
    """Return the signed gap [m] of shapes a and b along the unit vector n (out of b into a), radii included.

    min_A n.x - max_B n.x - r_A - r_B. For any n, a result > 0 proves that the shapes are apart by at least that much. Write the
    test as ``not (gap > 0)``: a nan in a pose reaches every vertex of the body, hence the first, hence the result.
    """
    rounding: float = shapes.radius[a] + shapes.radius[b]
    return -reach(vertices, shapes, a, neg(n)) - reach(vertices, shapes, b, n) - rounding


@kernel
def foremost(vertices: Rows, shapes: Shapes, s: int, m: Vec3, band: float) -> tuple[int, Vec3, Vec3]:
    """Return (number of corners of shape s at most ``band`` [m] behind its farthest along m, the second of them, the first).

    With one corner both are that and zero. The ball around the points does not matter.
    """
    low = reach(vertices, shapes, s, m) - band
    p, q, count = (0.0, 0.0, 0.0), (0.0, 0.0, 0.0), 0
    for i in range(shapes.start[s], shapes.start[s + 1]):
        x = row(vertices, i)
        if dot(m, x) >= low:
            count += 1
            p, q = (x, p) if count < 3 else (p, q)
    return count, p, q
