"""The point of a segment, triangle or tetrahedron closest to the origin, and its barycentric coordinates."""

from math import inf, sqrt

from avatarsim.kernel import kernel
from avatarsim.spatial.vec3 import Vec3, along, cross, dot, scale, sub

Share2 = tuple[float, float]
Share4 = tuple[float, float, float, float]

FLAT = 1e-14
"""Relative: below this sine (triangle) or height over edge (tetrahedron) the side of a plane on which the
origin lies is rounding noise. Such a simplex is treated as the union of its faces or edges. Larger:
well-formed thin ones lose their inside."""


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
    for_c, for_a, for_b = dot(n, cross(a, ab)), dot(n, cross(b, bc)), dot(n, cross(c, ca))
    flat = not (area > FLAT * FLAT * longest * longest)
    if not flat and for_a > 0.0 and for_b > 0.0 and for_c > 0.0:
        total = for_a + for_b + for_c
        return scale(n, dot(n, a) / area), (for_a / total, for_b / total, for_c / total)
    nearest, best, share = inf, a, (1.0, 0.0, 0.0)
    if flat or not (for_c > 0.0):
        p, s = closest_on_segment(a, b)
        if dot(p, p) < nearest:
            nearest, best, share = dot(p, p), p, (s[0], s[1], 0.0)
    if flat or not (for_a > 0.0):
        p, s = closest_on_segment(b, c)
        if dot(p, p) < nearest:
            nearest, best, share = dot(p, p), p, (0.0, s[0], s[1])
    if flat or not (for_b > 0.0):
        p, s = closest_on_segment(c, a)
        if dot(p, p) < nearest:
            nearest, best, share = dot(p, p), p, (s[1], 0.0, s[0])
    return best, share


@kernel
def closest_on_tetrahedron(a: Vec3, b: Vec3, c: Vec3, d: Vec3) -> tuple[bool, Vec3, Share4]:
    """Whether the origin is strictly inside the tetrahedron; else the closest point to it, and its four
    shares.

    Inside, the shares are those of the origin itself. A face is looked at if the origin is not on its inner
    side.
    """
    ab, ac, ad = sub(b, a), sub(c, a), sub(d, a)
    over_d, over_b, over_c = cross(ab, ac), cross(ac, ad), cross(ad, ab)
    over_a = cross(sub(d, b), sub(c, b))
    volume = dot(over_d, ad)
    side = 1.0 if volume > 0.0 else -1.0
    # Six times the sub-volumes spanned by the origin and each face, positive on the inner side.
    for_d, for_b, for_c = -dot(over_d, a) * side, -dot(over_b, a) * side, -dot(over_c, a) * side
    for_a = -dot(over_a, b) * side
    flat = not (abs(volume) > FLAT * sqrt(dot(over_d, over_d) * max(dot(ad, ad), dot(ab, ab), dot(ac, ac))))
    if not flat and for_a > 0.0 and for_b > 0.0 and for_c > 0.0 and for_d > 0.0:
        total = for_a + for_b + for_c + for_d
        return True, (0.0, 0.0, 0.0), (for_a / total, for_b / total, for_c / total, for_d / total)
    nearest, best, share = inf, a, (1.0, 0.0, 0.0, 0.0)
    if flat or not (for_d > 0.0):
        p, s = closest_on_triangle(a, b, c)
        if dot(p, p) < nearest:
            nearest, best, share = dot(p, p), p, (s[0], s[1], s[2], 0.0)
    if flat or not (for_b > 0.0):
        p, s = closest_on_triangle(a, c, d)
        if dot(p, p) < nearest:
            nearest, best, share = dot(p, p), p, (s[0], 0.0, s[1], s[2])
    if flat or not (for_c > 0.0):
        p, s = closest_on_triangle(a, d, b)
        if dot(p, p) < nearest:
            nearest, best, share = dot(p, p), p, (s[0], s[2], 0.0, s[1])
    if flat or not (for_a > 0.0):
        p, s = closest_on_triangle(b, c, d)
        if dot(p, p) < nearest:
            nearest, best, share = dot(p, p), p, (0.0, s[0], s[1], s[2])
    return False, best, share
