"""Penetration depth of two boxes over the 15 axes of the separating axis test (Gottschalk, Lin and Manocha 1996).

The Minkowski difference A - B of two boxes, sheared or not, is the sum of six segments about the difference of their centres. Its
facets are normal to a face of A, to a face of B, or to an edge of each: fifteen normals, each in two directions. The lowest facet
is the depth.
"""

from math import inf, sqrt

from avatarsim.collide.closed_forms import BOX_CORNERS, UNKNOWN, Answer, off, within
from avatarsim.collide.epa import EXACT
from avatarsim.collide.support import reach
from avatarsim.jit.kernel import kernel
from avatarsim.spatial.vec3 import Rows, Vec3, along, cross, dot, norm, row, scale, sub
from avatarsim.world.shapes import POINTS, Shapes

Edges = tuple[Vec3, Vec3, Vec3]

PARALLEL = 1e-6
"""Sine of the angle of two edges below which the boxes are left to EPA: aligned boxes have facets that are equally low and
witness points that are many, and which of them is taken should not depend on the formula. Smaller: rounding takes part in it."""

BESIDE = 1e-9
"""Relative to an edge: how far outside of a face or an edge rounding may put a witness point."""

CLEARLY_DEEP = 1e-9
"""Relative to the shapes' size: depths below this are left to GJK and EPA. Smaller: rounding decides whether there is one."""


@kernel
def are_boxes(shapes: Shapes, a: int, b: int) -> bool:
    """Whether both shapes may be boxes: eight points each."""
    eight_a: bool = shapes[a].kind == POINTS and shapes[a + 1].start - shapes[a].start == BOX_CORNERS
    eight_b: bool = shapes[b].kind == POINTS and shapes[b + 1].start - shapes[b].start == BOX_CORNERS
    return eight_a and eight_b


@kernel
def edges_of(vertices: Rows, shapes: Shapes, s: int) -> tuple[bool, Edges]:
    """Whether the eight points of shape s are a box, which may be sheared, and its edges from corner 0."""
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
    """Height of the lower of two opposite facets of normal n, times |n|: half the width of A - B less the way to its centre."""
    of_a = abs(dot(n, u[0])) + abs(dot(n, u[1])) + abs(dot(n, u[2]))
    of_b = abs(dot(n, v[0])) + abs(dot(n, v[1])) + abs(dot(n, v[2]))
    return 0.5 * (of_a + of_b) - abs(dot(n, c))


@kernel
def lowest_facet(c: Vec3, u: Edges, v: Edges) -> tuple[float, Vec3, int, int]:
    """Height and outward unit normal of the lowest facet of A - B, whose centre is c, and what makes it: edges i of A and j of B.

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
    """The corner of a box farthest along m; edge ``free`` is left at its beginning."""
    p = low
    for k in range(3):
        if k != free and dot(u[k], m) > 0.0:
            p = along(p, 1.0, u[k])
    return p


@kernel
def on_face(p: Vec3, low: Vec3, u: Edges, i: int) -> bool:
    """Whether p, in the plane of a face that edge i leaves, is on the face."""
    d, s, t = sub(p, low), u[(i + 1) % 3], u[(i + 2) % 3]
    n = cross(s, t)
    nn = dot(n, n)
    # What d has along the edge that leaves the face is taken off: it may be at an angle.
    d = along(d, -dot(d, n) / dot(u[i], n), u[i])
    x, y = dot(cross(d, t), n) / nn, dot(cross(s, d), n) / nn
    return -BESIDE <= x <= 1.0 + BESIDE and -BESIDE <= y <= 1.0 + BESIDE


@kernel
def box_depth(vertices: Rows, shapes: Shapes, a: int, b: int) -> Answer:
    """Signed distance of two boxes that overlap; not known if they do not, are no boxes, or have parallel edges.

    The height of the lowest facet is what moving by it proves, and no other facet is lower.
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
