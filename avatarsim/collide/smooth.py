"""Newton's method on the unit normal: nearest point of A - B to the origin where an ellipsoid makes its surface smooth.

Depth and distance are one problem: the least value over unit m of the support function h(m) of A - B, a depth if
positive, minus a distance if negative. Near the answer the other shape, if it has corners, takes part with one feature:
a vertex, an edge (m stays at right angles to it) or a face (m is its normal). GJK or EPA bring m near and name the
feature; what Newton finds counts only with a proof, see `smooth_proof`.
"""

from math import inf, sqrt

from avatarsim.collide.gjk import NOWHERE, ROUNDING
from avatarsim.collide.support import reach
from avatarsim.jit.kernel import kernel
from avatarsim.spatial.vec3 import Rows, Vec3, add, along, cross, dot, neg, norm, perpendicular, row, scale, sub, unit
from avatarsim.world.shapes import POINTS, Shapes

Found = tuple[bool, Vec3, float, Vec3, Vec3]
"""(whether stationary, unit normal m of A - B, h(m) [m], point of A, point of B)."""

STEPS_CAP = 20
"""Newton steps: from a coarse start 4 to 6. Fewer: flat minima are given up too early."""

STATIONARY = 1e-14
"""Relative to the shapes' size: a gradient this small is rounding."""

NEARLY = 1e-11
"""Relative to the shapes' size: a gradient that is accepted when rounding leaves no smaller one."""

PROVED = 1e-10
"""Relative to the shapes' size: largest difference of the bounds above and below. Larger: a wrong answer by as much."""

LONGEST_STEP = 0.5
"""Radians: a longer step leaves the neighbourhood in which the quadratic model means anything."""

SLACK = 1e-12
"""Relative: a bend or a condition this small is rounding. That for the largest ball holds with equality at the centre."""


@kernel
def stretched(vertices: Rows, shapes: Shapes, s: int, d: Vec3) -> Vec3:
    """E d: the products of d with the semi-axes of ellipsoid s; zero for points, which do not bend."""
    if shapes.kind[s] == POINTS:
        return NOWHERE
    f = shapes.start[s]
    return (dot(row(vertices, f + 1), d), dot(row(vertices, f + 2), d), dot(row(vertices, f + 3), d))


@kernel
def gathered(vertices: Rows, shapes: Shapes, s: int, e: Vec3) -> Vec3:
    """E^T e: the sum of the semi-axes of ellipsoid s with weights e; zero for points."""
    if shapes.kind[s] == POINTS:
        return NOWHERE
    f = shapes.start[s]
    x, y, z = row(vertices, f + 1), row(vertices, f + 2), row(vertices, f + 3)
    return along(along(scale(x, e[0]), e[1], y), e[2], z)


@kernel
def curvature(s: Vec3, u: Vec3, v: Vec3) -> float:
    """Second derivative along E^-1 u and E^-1 v of |E m|, given s = E m."""
    length = norm(s)
    if not (length > 0.0):
        return 0.0
    return (dot(u, v) - dot(s, u) * dot(s, v) / (length * length)) / length


@kernel
def newton(
    vertices: Rows, shapes: Shapes, a: int, b: int, m: Vec3, centre: Vec3, edge: Vec3, free: int, size: float
) -> tuple[bool, Vec3, Vec3]:
    """Where h(m) = centre.m + |A m| + |B m| is stationary, m on the unit sphere and at right angles to ``edge``.

    Args:
        free: directions in which m may turn: 2, or 1 along a great circle, or 0.

    Returns (whether found, m, point of A - B with outward normal m, for the feature that ``centre`` stands for).
    """
    steep, w = inf, centre
    for _ in range(STEPS_CAP):
        am, bm = stretched(vertices, shapes, a, m), stretched(vertices, shapes, b, m)
        w = centre
        if shapes.kind[a] != POINTS:
            w = add(w, gathered(vertices, shapes, a, scale(am, 1.0 / norm(am))))
        if shapes.kind[b] != POINTS:
            w = add(w, gathered(vertices, shapes, b, scale(bm, 1.0 / norm(bm))))
        height = dot(w, m)
        u = unit(cross(edge, m)) if free == 1 else perpendicular(m)
        v = cross(m, u)
        g_u, g_v = dot(w, u) if free > 0 else 0.0, dot(w, v) if free > 1 else 0.0
        steep = sqrt(g_u * g_u + g_v * g_v)
        if not (steep > STATIONARY * size):
            break
        au, bu = stretched(vertices, shapes, a, u), stretched(vertices, shapes, b, u)
        av, bv = stretched(vertices, shapes, a, v), stretched(vertices, shapes, b, v)
        uu = curvature(am, au, au) + curvature(bm, bu, bu) - height
        uv = curvature(am, au, av) + curvature(bm, bu, bv) if free > 1 else 0.0
        vv = curvature(am, av, av) + curvature(bm, bv, bv) - height if free > 1 else uu
        # Where the surface bends the wrong way, or hardly, the matrix is shifted until it points downhill; by twice the
        # wrong bend, which makes a step as long as the surface there is wide.
        half, apart = 0.5 * (uu + vv), sqrt(0.25 * (uu - vv) * (uu - vv) + uv * uv)
        least = half - apart
        if least < SLACK * size + 0.01 * steep:
            shift = max(-2.0 * least, SLACK * size + 0.01 * steep - least)
            uu, vv = uu + shift, vv + shift
        det = uu * vv - uv * uv
        t_u, t_v = -(vv * g_u - uv * g_v) / det, -(uu * g_v - uv * g_u) / det
        length = sqrt(t_u * t_u + t_v * t_v)
        if length > LONGEST_STEP:
            t_u, t_v = t_u * LONGEST_STEP / length, t_v * LONGEST_STEP / length
        m = unit(along(along(m, t_u, u), t_v, v))
    return steep <= NEARLY * size, m, w


@kernel
def polish(vertices: Rows, shapes: Shapes, a: int, b: int, m: Vec3, i: int, j: int, k: int) -> Found:
    """From a direction m near the answer, and vertex rows i j k of the shape with corners, to the answer.

    Equal rows make an edge or a vertex; two ellipsoids need none. Found is a value h(m) of the support function together
    with points of A and B that differ by h(m) m. If h(m) < 0 that is a proof: the shapes are no nearer than h says and no
    farther than the points. If not, it may be a way out that is only locally the shortest.
    """
    size = max(shapes.extent[a], shapes.extent[b])
    cornered = a if shapes.kind[a] == POINTS else b
    sign = 1.0 if cornered == a else -1.0
    first, free, edge, other = NOWHERE, 2, NOWHERE, NOWHERE
    if shapes.kind[cornered] == POINTS:
        if i == j or i == k:
            i, j = (i, k) if i == j else (i, j)
        elif j == k:
            k = i
        # Now i is the first vertex, j another if there is one, and k a third if it differs from both.
        first = row(vertices, i)
        if j != i:
            edge, free = sub(row(vertices, j), first), 1
            if k != i and k != j:
                other, free = sub(row(vertices, k), first), 0
    if free == 1:
        m = along(m, -dot(m, edge) / dot(edge, edge), edge)
    elif free == 0:
        n = cross(edge, other)
        m = n if dot(n, m) > 0.0 else neg(n)
    if not (norm(m) > 0.0):
        return False, m, 0.0, NOWHERE, NOWHERE
    m = unit(m)
    from_a = first if shapes.kind[a] == POINTS else row(vertices, shapes.start[a])
    from_b = first if shapes.kind[b] == POINTS else row(vertices, shapes.start[b])
    found, m, w = newton(vertices, shapes, a, b, m, sub(from_a, from_b), edge, free, size)
    if not found:
        return False, m, 0.0, NOWHERE, NOWHERE
    height = dot(w, m)
    # What is left of w across m is made up for along the feature.
    left = scale(along(w, -height, m), -sign)
    if free == 1:
        t = dot(left, edge) / dot(edge, edge)
        if not (0.0 <= t <= 1.0):
            return False, m, height, NOWHERE, NOWHERE
        first = along(first, t, edge)
    elif free == 0:
        n = cross(edge, other)
        for_k, for_j = dot(n, cross(edge, left)), dot(n, cross(left, other))
        if not (for_k >= 0.0 and for_j >= 0.0 and for_k + for_j <= dot(n, n)):
            return False, m, height, NOWHERE, NOWHERE
        first = add(first, left)
    on_a, on_b = first, first
    if shapes.kind[a] != POINTS:
        on_a = add(from_a, gathered(vertices, shapes, a, unit(stretched(vertices, shapes, a, m))))
    if shapes.kind[b] != POINTS:
        on_b = sub(from_b, gathered(vertices, shapes, b, unit(stretched(vertices, shapes, b, m))))
    above = reach(vertices, shapes, a, m) + reach(vertices, shapes, b, neg(m))
    between = sub(on_a, on_b)
    missed = max(norm(along(between, -above, m)), abs(above - height))
    # Far from the origin the coordinates themselves are no finer than ROUNDING times their size.
    return missed <= PROVED * size + ROUNDING * (abs(above) + norm(on_a)), m, above, on_a, on_b
