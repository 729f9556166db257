"""Newton's method on the unit normal: nearest point of A - B to the origin where an ellipsoid makes its surface smooth.

Depth and distance are one problem: the least value over unit m of the support function h(m) of A - B, a depth if positive, minus
a distance if negative. Near the answer the other shape, if it has corners, takes part with one feature: a vertex, an edge (m
stays at right angles to it) or a face (m is its normal). GJK or EPA bring m near and name the feature; Newton's result counts
only with a proof, see below.

Optimality proofs for the depth of two cores, one of them an ellipsoid: lower bounds of the support function of A - B.

All bounds are of h, the support function of A - B on unit vectors, whose least value is the depth.
"""

from math import inf, sqrt

from avatarsim.collision.gjk import NOWHERE
from avatarsim.collision.support import reach
from avatarsim.jit.kernel import kernel
from avatarsim.model.geometry import POINTS, Shapes
from avatarsim.spatial.vec3 import Rows, Vec3, add, along, cross, dot, neg, norm, perpendicular, row, scale, sub, unit
from avatarsim.tolerances import COARSE_ROUNDING, GRAIN, LAST_PLACES, PROOF, ROUNDING, SHORT_TURN

Found = tuple[bool, Vec3, float, Vec3, Vec3]
"""(whether stationary, unit normal m of A - B, h(m) [m], point of A, point of B)."""

STEPS_CAP = 20
"""Newton steps: from a coarse start 4 to 6. Fewer: flat minima are given up too early."""

HALVINGS = 20
"""Cones tried, from a right angle on, each with half of the last one's 1 - cosine; the last is 0.1 degrees wide. Fewer:
none is found for slim ellipsoids."""

STATIONARY = GRAIN
"""Relative to the shapes' size: a gradient this small is rounding."""

NEARLY = COARSE_ROUNDING
"""Relative to the shapes' size: a gradient that is accepted when rounding leaves no smaller one."""

PROVED = PROOF
"""Relative to the shapes' size: largest difference of the bounds above and below. Larger: a wrong answer by as much."""

SLACK = ROUNDING
"""Relative: a radius or a condition this small is rounding. That for the largest ball holds with equality at the centre."""


@kernel
def stretched(vertices: Rows, shapes: Shapes, s: int, d: Vec3) -> Vec3:
    """Return E d: the products of d with the semi-axes of ellipsoid s; zero for points, which do not bend."""
    if shapes.kind[s] == POINTS:
        return NOWHERE
    f = shapes.start[s]
    return (dot(row(vertices, f + 1), d), dot(row(vertices, f + 2), d), dot(row(vertices, f + 3), d))


@kernel
def gathered(vertices: Rows, shapes: Shapes, s: int, e: Vec3) -> Vec3:
    """Return E^T e: the sum of the semi-axes of ellipsoid s with weights e; zero for points."""
    if shapes.kind[s] == POINTS:
        return NOWHERE
    f = shapes.start[s]
    x, y, z = row(vertices, f + 1), row(vertices, f + 2), row(vertices, f + 3)
    return along(along(scale(x, e[0]), e[1], y), e[2], z)


@kernel
def curvature(s: Vec3, u: Vec3, v: Vec3) -> float:
    """Return the second derivative along E^-1 u and E^-1 v of |E m|, given s = E m."""
    length = norm(s)
    if not (length > 0.0):
        return 0.0
    return (dot(u, v) - dot(s, u) * dot(s, v) / (length * length)) / length


@kernel
def newton(
    vertices: Rows, shapes: Shapes, a: int, b: int, m: Vec3, centre: Vec3, edge: Vec3, free: int, size: float
) -> tuple[bool, Vec3, Vec3]:
    """Find where h(m) = centre.m + |A m| + |B m| is stationary, m on the unit sphere and at right angles to ``edge``.

    Args:
        free: directions in which m may turn: 2, or 1 along a great circle, or 0.

    Returns (whether found, m, point of A - B with outward normal m, for the feature of ``centre``).
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
        least, wanted = half - apart, SLACK * size + 0.01 * steep
        if least < wanted:
            shift = max(-2.0 * least, wanted - least)
            uu, vv = uu + shift, vv + shift
        det = uu * vv - uv * uv
        t_u, t_v = -(vv * g_u - uv * g_v) / det, -(uu * g_v - uv * g_u) / det
        length = sqrt(t_u * t_u + t_v * t_v)
        if length > SHORT_TURN:
            # a longer step leaves the neighbourhood in which the quadratic model means anything
            t_u, t_v = t_u * SHORT_TURN / length, t_v * SHORT_TURN / length
        m = unit(along(along(m, t_u, u), t_v, v))
    return steep <= NEARLY * size, m, w


@kernel
def polish(vertices: Rows, shapes: Shapes, a: int, b: int, m: Vec3, i: int, j: int, k: int) -> Found:
    """Refine a direction m near the answer, with vertex rows i j k of the shape with corners, to the answer.

    Equal rows make an edge or a vertex; two ellipsoids need none. Found is a value h(m) of the support function together with
    points of A and B that differ by h(m) m. If h(m) < 0 that is a proof: the shapes are no nearer than h and no farther than the
    points. If not, it may be a way out that is only locally the shortest.
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
    # The rest of w across m is made up for along the feature.
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
    # Far from the origin the coordinates themselves are no finer than LAST_PLACES times their size.
    return missed <= PROVED * size + LAST_PLACES * (abs(above) + norm(on_a)), m, above, on_a, on_b


@kernel
def rolling_radius(vertices: Rows, shapes: Shapes, s: int) -> float:
    """Return the radius [m] of the largest ball that rolls inside ellipsoid s everywhere; zero for points.

    It is the least radius of curvature, short^2 / long: the rest after taking it off is convex, and swept by it is the ellipsoid
    again (Blaschke).
    """
    if shapes.kind[s] == POINTS:
        return 0.0
    f = shapes.start[s]
    x, y, z = row(vertices, f + 1), row(vertices, f + 2), row(vertices, f + 3)
    xx, yy, zz = dot(x, x), dot(y, y), dot(z, z)
    longest = sqrt(max(xx, yy, zz))
    return min(xx, yy, zz) / longest if longest > 0.0 else 0.0


@kernel
def proves_itself(vertices: Rows, shapes: Shapes, a: int, b: int, found: bool, m: Vec3, height: float, rolled: float) -> bool:
    """Return True if a stationary point is known to be the answer without looking elsewhere.

    It is if the shapes without the balls that roll in them, of radius ``rolled`` together, are apart: there is but one
    nearest point of two convex shapes.
    """
    return found and (height < rolled or ball_fits(vertices, shapes, a, b, m, height))


@kernel
def ball_fits(vertices: Rows, shapes: Shapes, a: int, b: int, m: Vec3, depth: float) -> bool:
    """Return True if the ball about the origin that touches the surface of A - B from inside at normal m lies in A - B.

    For one ellipsoid E around a point of the other shape: {x: x.Q^-1 x <= 1}, Q = E^T E, the nearest point of its surface
    minimises |x|^2 under one quadratic condition, and a stationary point is the global one if and only if
    Q - depth |E m| I has no negative eigenvalue. For two, A - B holds every ellipsoid of matrix A + T B, T orthogonal,
    because |A m| + |B m| >= |A m + T B m|; the T taken turns B m onto A m, so that this one touches at m too, and else
    leaves as much of it as can be. The condition holds with equality at a common centre, so it is missed by rounding.
    """
    # Far from the origin a depth is no finer than the coordinates it was measured with.
    depth = (1.0 - SLACK) * depth - LAST_PLACES * norm(row(vertices, shapes.start[a]))
    am, bm = stretched(vertices, shapes, a, m), stretched(vertices, shapes, b, m)
    if shapes.kind[a] == POINTS or shapes.kind[b] == POINTS:
        s = b if shapes.kind[a] == POINTS else a
        f = shapes.start[s]
        x, y, z = row(vertices, f + 1), row(vertices, f + 2), row(vertices, f + 3)
        return min(dot(x, x), dot(y, y), dot(z, z)) >= depth * (norm(am) + norm(bm))
    reaching = norm(am) + norm(bm)
    am, bm = unit(am), unit(bm)
    p, q = perpendicular(am), perpendicular(bm)
    a_0, b_0 = gathered(vertices, shapes, a, am), gathered(vertices, shapes, b, bm)
    a_1, b_1 = gathered(vertices, shapes, a, p), gathered(vertices, shapes, b, q)
    a_2, b_2 = gathered(vertices, shapes, a, cross(am, p)), gathered(vertices, shapes, b, cross(bm, q))
    c_11, c_12, c_21, c_22 = dot(a_1, b_1), dot(a_1, b_2), dot(a_2, b_1), dot(a_2, b_2)
    # The best rotation about m, or reflection through it: the one with the larger trace.
    cos, sin, mirror = c_11 + c_22, c_21 - c_12, 1.0
    if (c_11 - c_22) * (c_11 - c_22) + (c_12 + c_21) * (c_12 + c_21) > cos * cos + sin * sin:
        cos, sin, mirror = c_11 - c_22, c_12 + c_21, -1.0
    length = sqrt(cos * cos + sin * sin)
    cos, sin = (cos / length, sin / length) if length > 0.0 else (1.0, 0.0)
    x = add(a_0, b_0)
    y = along(along(a_1, cos, b_1), -sin * mirror, b_2)
    z = along(along(a_2, sin, b_1), cos * mirror, b_2)
    return not_negative(x, y, z, depth * reaching, SLACK * reaching * reaching)


@kernel
def not_negative(x: Vec3, y: Vec3, z: Vec3, shift: float, rounding: float) -> bool:
    """Return True if x x^T + y y^T + z z^T - shift I has no eigenvalue below -``rounding``, by the pivots of its elimination."""
    shift -= rounding
    xx = x[0] * x[0] + y[0] * y[0] + z[0] * z[0] - shift
    yy = x[1] * x[1] + y[1] * y[1] + z[1] * z[1] - shift
    zz = x[2] * x[2] + y[2] * y[2] + z[2] * z[2] - shift
    xy = x[0] * x[1] + y[0] * y[1] + z[0] * z[1]
    xz = x[0] * x[2] + y[0] * y[2] + z[0] * z[2]
    yz = x[1] * x[2] + y[1] * y[2] + z[1] * z[2]
    if not (xx > 0.0):
        return False
    yy, yz, zz = yy - xy * xy / xx, yz - xy * xz / xx, zz - xz * xz / xx
    if not (yy > 0.0):
        return False
    return zz - yz * yz / yy >= 0.0


@kernel
def least_cosine(vertices: Rows, shapes: Shapes, a: int, b: int, m: Vec3, depth: float) -> float:
    """Return the cosine of a cone about stationary normal m in which h is nowhere below ``depth`` = h(m); above 1: unknown.

    Stationary means that the point of A - B at m is depth m, so that h(d) >= depth + (radius - depth) (1 - cos t).
    """
    from_one = 1.0
    for _ in range(HALVINGS):
        if least_curvature(vertices, shapes, a, b, m, 1.0 - from_one) * (1.0 - SLACK) >= depth:
            return 1.0 - from_one
        from_one *= 0.5
    return 2.0


@kernel
def is_depth_kept(vertices: Rows, shapes: Shapes, a: int, b: int, m: Vec3, w: Vec3, cos: float, depth: float) -> bool:
    """Return True if h is nowhere below ``depth`` in a cone about m, which need not be stationary.

    Args:
        w: the point of A - B farthest along m.
        cos: cosine of the cone's half angle.
    """
    if not (cos > 0.0):
        return False
    height, sin = dot(w, m), sqrt(1.0 - cos * cos)
    across, radius = norm(along(w, -height, m)), least_curvature(vertices, shapes, a, b, m, cos) * (1.0 - SLACK)
    # At an angle t, w.d >= height cos t - across sin t; with the radius that is a sine, lowest at the rim or before it.
    sag = height - radius
    lowest = sag * cos - across * sin if sag * sin + across * cos > 0.0 else -sqrt(sag * sag + across * across)
    return radius + lowest >= depth


@kernel
def least_curvature(vertices: Rows, shapes: Shapes, a: int, b: int, m: Vec3, cos: float) -> float:
    """Return a length K [m], as large as is known, with h(d) >= w.d + K (1 - cos t) for all d at angles t up to arccos ``cos``.

    w is the point of A - B farthest along m. Let x be the point of an ellipsoid E with normal m, r = |E m|, and k its radius of
    curvature towards d: |E d|^2 = (x.d)^2 + r k sin^2 t, so |E d| - x.d = k (1 - cos t) r (1 + cos t) / (|E d| + x.d). Each
    shape's curvature counts by the least value of the last factor, and K is the least of their sum towards any side.
    """
    u = perpendicular(m)
    v = cross(m, u)
    am, au, av = stretched(vertices, shapes, a, m), stretched(vertices, shapes, a, u), stretched(vertices, shapes, a, v)
    bm, bu, bv = stretched(vertices, shapes, b, m), stretched(vertices, shapes, b, u), stretched(vertices, shapes, b, v)
    share_a, share_b = least_share(vertices, shapes, a, m, am, cos), least_share(vertices, shapes, b, m, bm, cos)
    uu = share_a * curvature(am, au, au) + share_b * curvature(bm, bu, bu)
    vv = share_a * curvature(am, av, av) + share_b * curvature(bm, bv, bv)
    uv = share_a * curvature(am, au, av) + share_b * curvature(bm, bu, bv)
    return 0.5 * (uu + vv) - sqrt(0.25 * (uu - vv) * (uu - vv) + uv * uv)


@kernel
def least_share(vertices: Rows, shapes: Shapes, s: int, m: Vec3, e: Vec3, cos: float) -> float:
    """Return the least r (1 + cos t) / (|E d| + x.d) in a cone about m, for `least_curvature`, e = E m. 1 at m, 0 for points.

    With s the length of x across m and L the longest semi-axis, x.d <= r cos t + s sin t and
    |E d|^2 <= r^2 cos^2 t + 2 r s sin t cos t + L^2 sin^2 t. The rest of it falls with t, so the rim decides.
    """
    r = norm(e)
    if not (r > 0.0):
        return 0.0
    sin, longest = sqrt(1.0 - cos * cos), longest_axis(vertices, shapes, s)
    x = gathered(vertices, shapes, s, scale(e, 1.0 / r))
    across = norm(along(x, -r, m))
    farthest = sqrt(r * cos * (r * cos + 2.0 * across * sin) + longest * longest * sin * sin)
    return r * (1.0 + cos) / (r * cos + across * sin + farthest)


@kernel
def longest_axis(vertices: Rows, shapes: Shapes, s: int) -> float:
    """Return the longest semi-axis of ellipsoid s [m]; 0 for points."""
    if shapes.kind[s] == POINTS:
        return 0.0
    f = shapes.start[s]
    return max(norm(row(vertices, f + 1)), norm(row(vertices, f + 2)), norm(row(vertices, f + 3)))
