"""Distance subalgorithm of GJK: point of a segment, triangle or tetrahedron closest to the origin, in barycentric coordinates."""

from math import inf, sqrt

from avatarsim.jit.kernel import kernel
from avatarsim.spatial.vec3 import Vec3, along, cross, dot, neg, scale, sub

Share2 = tuple[float, float]
Share4 = tuple[float, float, float, float]

THIN = 1e-3
"""Sine of an angle: below it the edges of a triangle are put at right angles before they are multiplied. Smaller: of a sine
x, a normal by vector product alone is off by 1e-16 / x; larger: only costs time."""

FLAT = 1e-14
"""Relative to the product of three edges: below this volume of a tetrahedron the side of a plane on which the origin lies is
rounding noise, and it is treated as the union of its faces. Larger: well-formed thin ones lose their inside."""

NOISE = 2e-15
"""Relative: what rounding may do to a product of three lengths. A face of a tetrahedron is passed over only if the origin is
on its inner side by more."""


@kernel
def across(v: Vec3, u: Vec3) -> Vec3:
    """The part of v at right angles to u.

    Taken off twice, because the first time leaves as much along u as rounding does to v, which may be more than there is
    across.
    """
    uu = dot(u, u)
    v = along(v, -dot(u, v) / uu, u)
    return along(v, -dot(u, v) / uu, u)


@kernel
def upright(u: Vec3, v: Vec3) -> Vec3:
    """u x v, at right angles to both but for the rounding of their lengths, however nearly parallel they are."""
    n, uu, vv = cross(u, v), dot(u, u), dot(v, v)
    if dot(n, n) > THIN * THIN * uu * vv or not (uu > 0.0 and vv > 0.0):
        return n
    return cross(u, across(v, u)) if uu >= vv else cross(across(u, v), v)


@kernel
def closest_on_segment(a: Vec3, b: Vec3) -> tuple[Vec3, Share2]:
    """Closest point to the origin on the segment a b, and its shares of a and b."""
    ab = sub(b, a)
    square, t = dot(ab, ab), -dot(a, ab)
    if not (t > 0.0):
        return a, (1.0, 0.0)
    if t >= square:
        return b, (0.0, 1.0)
    t /= square
    p = along(a, t, ab)
    # Taken once more off the edge: |p| may be far below the rounding of a + t ab, and p is used as a
    # direction.
    return along(p, -dot(p, ab) / square, ab), (1.0 - t, t)


@kernel
def closest_on_triangle(a: Vec3, b: Vec3, c: Vec3) -> tuple[Vec3, Vec3]:
    """Closest point to the origin on the triangle a b c, and its shares of a, b and c.

    Sub-areas n.(p x q) are formed with an edge as one factor, n.(p x (q - p)): far from the origin, p x q
    would cancel. If one is not positive the closest point lies on that edge, or on another such edge, and the
    nearest of them is it.
    """
    ab, bc, ca = sub(b, a), sub(c, b), sub(a, c)
    n = cross(ab, bc)
    area, longest = dot(n, n), max(dot(ab, ab), dot(bc, bc), dot(ca, ca))
    if not (area > THIN * THIN * longest * longest):
        return closest_on_thin_triangle(a, b, c)
    for_c, for_a, for_b = dot(n, cross(a, ab)), dot(n, cross(b, bc)), dot(n, cross(c, ca))
    if for_a > 0.0 and for_b > 0.0 and for_c > 0.0:
        total = for_a + for_b + for_c
        return scale(n, dot(n, a) / area), (for_a / total, for_b / total, for_c / total)
    nearest, best, share = inf, a, (1.0, 0.0, 0.0)
    if not (for_c > 0.0):
        p, s = closest_on_segment(a, b)
        if dot(p, p) < nearest:
            nearest, best, share = dot(p, p), p, (s[0], s[1], 0.0)
    if not (for_a > 0.0):
        p, s = closest_on_segment(b, c)
        if dot(p, p) < nearest:
            nearest, best, share = dot(p, p), p, (0.0, s[0], s[1])
    if not (for_b > 0.0):
        p, s = closest_on_segment(c, a)
        if dot(p, p) < nearest:
            nearest, best, share = dot(p, p), p, (s[1], 0.0, s[0])
    return best, share


@kernel
def closest_on_thin_triangle(a: Vec3, b: Vec3, c: Vec3) -> tuple[Vec3, Vec3]:
    """As `closest_on_triangle`, for any triangle, flat ones too.

    With u an edge and v the other part of another across it, the origin's foot is a + t (c - a) + s u, t from v alone and s
    from what t leaves: an error of t, which is large where v is short, moves the foot across v only.
    """
    p, two = closest_on_segment(a, b)
    nearest, best, share = dot(p, p), p, (two[0], two[1], 0.0)
    p, two = closest_on_segment(b, c)
    if dot(p, p) < nearest:
        nearest, best, share = dot(p, p), p, (0.0, two[0], two[1])
    p, two = closest_on_segment(c, a)
    if dot(p, p) < nearest:
        nearest, best, share = dot(p, p), p, (two[1], 0.0, two[0])
    ab, ac, bc = sub(b, a), sub(c, a), sub(c, b)
    ab_2, ac_2, bc_2 = dot(ab, ab), dot(ac, ac), dot(bc, bc)
    # The longest edge is u; w is the third corner seen from where u begins.
    turn = 0 if ab_2 >= ac_2 and ab_2 >= bc_2 else (1 if bc_2 >= ac_2 else 2)
    start = b if turn == 1 else a
    u, w = (ab, ac) if turn == 0 else ((bc, neg(ab)) if turn == 1 else (ac, ab))
    uu = max(ab_2, ac_2, bc_2)
    if not (uu > 0.0):
        return best, share
    v = across(w, u)
    vv = dot(v, v)
    if not (vv > 0.0):
        return best, share
    t = -dot(across(start, u), v) / vv
    s = -dot(along(start, t, w), u) / uu
    if not (t > 0.0 and s > 0.0 and s + t < 1.0):
        return best, share
    n = cross(u, v)
    p = scale(n, dot(n, start) / dot(n, n))
    if turn == 0:
        return p, (1.0 - s - t, s, t)
    return (p, (t, 1.0 - s - t, s)) if turn == 1 else (p, (1.0 - s - t, t, s))


@kernel
def closest_on_tetrahedron(a: Vec3, b: Vec3, c: Vec3, d: Vec3) -> tuple[bool, Vec3, Share4]:
    """Whether the origin is strictly inside the tetrahedron; else the closest point to it, and its four
    shares.

    Inside, the shares are those of the origin itself. A face is tested if the origin is not certainly on its inner side.
    """
    ab, ac, ad = sub(b, a), sub(c, a), sub(d, a)
    over_d, over_b, over_c = cross(ab, ac), cross(ac, ad), cross(ad, ab)
    over_a = cross(sub(d, b), sub(c, b))
    volume = dot(over_d, ad)
    side = 1.0 if volume > 0.0 else -1.0
    # Six times the sub-volumes spanned by the origin and each face, positive on the inner side.
    for_d, for_b, for_c = -dot(over_d, a) * side, -dot(over_b, a) * side, -dot(over_c, a) * side
    for_a = -dot(over_a, b) * side
    b_2, c_2, d_2, a_2 = dot(ab, ab), dot(ac, ac), dot(ad, ad), dot(a, a)
    flat = not (abs(volume) > FLAT * sqrt(b_2 * c_2 * d_2))
    # Every edge is at most twice the longest of the three, and every corner that much farther off than a.
    edge_2 = max(b_2, c_2, d_2)
    noise = NOISE * edge_2 * sqrt(a_2 + edge_2)
    if not flat and for_a > noise and for_b > noise and for_c > noise and for_d > noise:
        total = for_a + for_b + for_c + for_d
        return True, (0.0, 0.0, 0.0), (for_a / total, for_b / total, for_c / total, for_d / total)
    nearest, best, share = inf, a, (1.0, 0.0, 0.0, 0.0)
    if flat or not (for_d > noise):
        p, s = closest_on_triangle(a, b, c)
        if dot(p, p) < nearest:
            nearest, best, share = dot(p, p), p, (s[0], s[1], s[2], 0.0)
    if flat or not (for_b > noise):
        p, s = closest_on_triangle(a, c, d)
        if dot(p, p) < nearest:
            nearest, best, share = dot(p, p), p, (s[0], 0.0, s[1], s[2])
    if flat or not (for_c > noise):
        p, s = closest_on_triangle(a, d, b)
        if dot(p, p) < nearest:
            nearest, best, share = dot(p, p), p, (s[0], s[2], 0.0, s[1])
    if flat or not (for_a > noise):
        p, s = closest_on_triangle(b, c, d)
        if dot(p, p) < nearest:
            nearest, best, share = dot(p, p), p, (0.0, s[0], s[1], s[2])
    return False, best, share
