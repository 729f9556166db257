"""GJK (Gilbert, Johnson and Keerthi 1988): distance of two convex cores, as the distance of A - B from the origin.

GJK proposes and the support function decides: a distance is returned only when two supports along the final direction prove that
the cores are apart. Where rounding leaves no proof the answer is distance 0, and `epa` finds the sign.

Distance subalgorithm of GJK: point of a segment, triangle or tetrahedron closest to the origin, in barycentric coordinates.
"""

from math import inf, sqrt

from avatarsim.collision.scratch import Scratch
from avatarsim.collision.status import CONVERGED, DEGENERATE, NOT_FINITE, OUT_OF_ITERATIONS
from avatarsim.collision.support import reach, support
from avatarsim.jit.kernel import kernel
from avatarsim.model.geometry import Shapes
from avatarsim.spatial.vec3 import Rows, Vec3, along, cross, dot, neg, norm, put_row, row, scale, sub
from avatarsim.tolerances import GRAIN, GRAINS, LAST_PLACES, PROOF, ROUNDING, SLIM

Share2 = tuple[float, float]
Share4 = tuple[float, float, float, float]

FLAT = GRAIN
"""Relative to the product of three edges: below this volume of a tetrahedron the side of a plane on which the origin lies is
rounding noise, and it is treated as the union of its faces. Larger: well-formed thin ones lose their inside."""

NOISE = 2.0 * LAST_PLACES
"""Relative: error of a product of three lengths by rounding. A face of a tetrahedron is passed over only if the origin is on its
inner side by more."""


@kernel
def across(v: Vec3, u: Vec3) -> Vec3:
    """Return the part of v at right angles to u.

    Taken off twice, because the first time leaves as much along u as rounding does to v, which may be more than there is
    across.
    """
    uu = dot(u, u)
    v = along(v, -dot(u, v) / uu, u)
    return along(v, -dot(u, v) / uu, u)


@kernel
def upright(u: Vec3, v: Vec3) -> Vec3:
    """Return u x v, at right angles to both but for the rounding of their lengths, however nearly parallel they are."""
    n, uu, vv = cross(u, v), dot(u, u), dot(v, v)
    if dot(n, n) > SLIM * SLIM * uu * vv or not (uu > 0.0 and vv > 0.0):
        return n
    return cross(u, across(v, u)) if uu >= vv else cross(across(u, v), v)


@kernel
def closest_on_segment(a: Vec3, b: Vec3) -> tuple[Vec3, Share2]:
    """Return the closest point to the origin on the segment a b, and its shares of a and b."""
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
    """Return the closest point to the origin on the triangle a b c, and its shares of a, b and c.

    Sub-areas n.(p x q) are formed with an edge as one factor, n.(p x (q - p)): far from the origin, p x q
    would cancel. If one is not positive the closest point lies on that edge, or on another such edge, and the
    nearest of them is it.
    """
    ab, bc, ca = sub(b, a), sub(c, b), sub(a, c)
    n = cross(ab, bc)
    area, longest = dot(n, n), max(dot(ab, ab), dot(bc, bc), dot(ca, ca))
    if not (area > SLIM * SLIM * longest * longest):
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
    """Return `closest_on_triangle` for any triangle, flat ones too.

    With u an edge and v the other part of another across it, the origin's foot is a + t (c - a) + s u, t from v alone and s from
    the rest: an error of t, which is large where v is short, moves the foot across v only.
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
    """Return True if the origin is strictly inside the tetrahedron; else the closest point to it, and its four shares.

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


ITERATIONS_CAP = 128
"""Polytopes end below 20, smooth shapes below 60. Too low: OUT_OF_ITERATIONS; too high: only costs time on a
failure."""

CLOSE_ENOUGH = GRAINS
"""Relative to the shapes' size: largest difference between the distance found and the one proved. Below rounding (2e-16 times the
coordinates) smooth shapes would never end; polytopes end exactly with any value."""

ACCEPTED = PROOF
"""Relative to the shapes' size: when rounding stops progress, a larger difference than this is reported as
DEGENERATE."""

TOUCHING = ROUNDING
"""Relative to the shapes' size: closer cores are passed to `epa`, whose normal does not come from the vanishing distance."""

STALLS_CAP = 8
"""Times that rounding may leave a point no nearer than the last. Fewer: a pair with nearly parallel edges, where the next
support would have mattered, is given up; more: only costs time on a failure."""

NOWHERE = (0.0, 0.0, 0.0)

Balls = tuple[float, float]
"""Radii [m] of balls taken off the cores of A and B: a core is then the rest, and swept by the ball it is the core again. Zero
for points. At most the least radius of curvature, see `ellipsoid.rolling_radius`, or the rest is not convex."""

WHOLE: Balls = (0.0, 0.0)
"""Nothing taken off."""


@kernel
def closest_in_simplex(count: int, scratch: Scratch) -> tuple[bool, Vec3, int]:
    """Keep those of the first ``count`` points that span the one closest to the origin.

    Returns (whether the origin is inside, the closest point, points kept).
    """
    w, share = scratch.w, scratch.share
    inside = False
    if count == 1:
        v, shares = row(w, 0), (1.0, 0.0, 0.0, 0.0)
    elif count == 2:
        v, two = closest_on_segment(row(w, 0), row(w, 1))
        shares = (two[0], two[1], 0.0, 0.0)
    elif count == 3:
        v, three = closest_on_triangle(row(w, 0), row(w, 1), row(w, 2))
        shares = (three[0], three[1], three[2], 0.0)
    else:
        inside, v, shares = closest_on_tetrahedron(row(w, 0), row(w, 1), row(w, 2), row(w, 3))
    kept = 0
    for i in range(count):
        if shares[i] > 0.0:
            put_row(w, kept, row(w, i))
            put_row(scratch.on_a, kept, row(scratch.on_a, i))
            put_row(scratch.on_b, kept, row(scratch.on_b, i))
            scratch.rows[kept, 0] = scratch.rows[i, 0]
            scratch.rows[kept, 1] = scratch.rows[i, 1]
            share[kept] = shares[i]
            kept += 1
    return inside, v, kept


@kernel
def add_support(vertices: Rows, shapes: Shapes, a: int, b: int, d: Vec3, balls: Balls, slot: int, scratch: Scratch) -> Vec3:
    """Write the farthest point of A - B along d, but for the balls, into a slot of the scratch, and return it."""
    on_a, row_a = support(vertices, shapes, a, d)
    on_b, row_b = support(vertices, shapes, b, neg(d))
    if balls[0] > 0.0 or balls[1] > 0.0:
        length = norm(d)
        on_a, on_b = along(on_a, -balls[0] / length, d), along(on_b, balls[1] / length, d)
    w = sub(on_a, on_b)
    put_row(scratch.w, slot, w)
    put_row(scratch.on_a, slot, on_a)
    put_row(scratch.on_b, slot, on_b)
    scratch.rows[slot, 0] = row_a
    scratch.rows[slot, 1] = row_b
    return w


@kernel
def known(slot: int, scratch: Scratch) -> bool:
    """Return True if the point in ``slot`` equals one of those before it."""
    for i in range(slot):
        if (
            scratch.w[i, 0] == scratch.w[slot, 0]
            and scratch.w[i, 1] == scratch.w[slot, 1]
            and scratch.w[i, 2] == scratch.w[slot, 2]
        ):
            return True
    return False


@kernel
def proved_by_facet(
    vertices: Rows, shapes: Shapes, a: int, b: int, v: Vec3, balls: Balls, scratch: Scratch
) -> tuple[Vec3, float]:
    """Return the unit normal of the first three points of A - B, towards v, and the distance along it that two supports prove.

    Of a gap of 1e-8 of the size v is the difference of two places a hundred million times as long: it leans by as many
    times their rounding. A facet's own normal does not. Zero for points on a line.
    """
    corner = row(scratch.w, 0)
    normal = cross(sub(row(scratch.w, 1), corner), sub(row(scratch.w, 2), corner))
    area = norm(normal)
    if not (area > 0.0):
        return NOWHERE, 0.0
    n = scale(normal, (1.0 if dot(normal, v) > 0.0 else -1.0) / area)
    return n, -reach(vertices, shapes, a, neg(n)) - reach(vertices, shapes, b, n) + balls[0] + balls[1]


@kernel
def gjk(
    vertices: Rows, shapes: Shapes, a: int, b: int, seed: Vec3, margin: float, scratch: Scratch
) -> tuple[int, Vec3, float, int]:
    """Return the distance of the cores of shapes a and b, radii left out.

    Args:
        vertices: (nv, 3) world coordinates [m].
        seed: first direction to try, out of b into a, any length; the last normal of the pair is the best.
            Zero: none known.
        margin: stop as soon as a distance > margin [m] is proved; inf: the exact distance.

    Returns:
        (status, n, distance, count). n is the unit normal out of b into a. Distance 0 means: they overlap, or
        are too close for GJK to decide, and n is zero. The simplex is in the first ``count`` rows of the
        scratch, ``scratch.share`` its barycentric coordinates. Stopped by the margin, or with another status
        than CONVERGED, distance is a proved lower bound along n and the simplex is unfinished.
    """
    v = first_direction(vertices, shapes, a, b, seed)
    return gjk_from(vertices, shapes, a, b, v, WHOLE, 0, margin, CLOSE_ENOUGH, scratch)


@kernel
def first_direction(vertices: Rows, shapes: Shapes, a: int, b: int, seed: Vec3) -> Vec3:
    """Return the seed, if it is a direction; else from the first row of b to that of a; never zero."""
    if 0.0 < dot(seed, seed) < inf:
        return seed
    v = sub(row(vertices, shapes.start[a]), row(vertices, shapes.start[b]))
    return (1.0, 0.0, 0.0) if dot(v, v) == 0.0 else v


@kernel
def gjk_from(
    vertices: Rows, shapes: Shapes, a: int, b: int, v: Vec3, balls: Balls, count: int, margin: float, close: float,
    scratch: Scratch,
) -> tuple[int, Vec3, float, int]:
    """Run `gjk` from a simplex: v is the point closest to the origin of the first ``count`` points.

    Without points v is any direction to try first. Any points of A - B will do: they cost time, not truth. A distance
    is found when it is proved but for ``close``, relative to the shapes' size. One above the margin is always proved.
    Cores, points and distance are those without the balls.
    """
    size = max(shapes.extent[a], shapes.extent[b])
    length, stalls = norm(v), 0
    for _ in range(ITERATIONS_CAP):
        w = add_support(vertices, shapes, a, b, neg(v), balls, count, scratch)
        proved = dot(v, w) / length
        if not (abs(proved) < inf):
            return NOT_FINITE, NOWHERE, 0.0, count
        if proved > margin:
            return CONVERGED, scale(v, 1.0 / length), proved, count
        measured = count > 0
        if measured:
            missing = length - proved
            # A coarse answer must at least prove the cores apart; a fine one that does not means that they touch.
            done = missing <= (close if proved > 0.0 else CLOSE_ENOUGH) * size + LAST_PLACES * length
            if done or stalls > STALLS_CAP or known(count, scratch):
                if not (proved > 0.0):
                    return CONVERGED, NOWHERE, 0.0, count
                # Far from the origin the coordinates themselves are no finer than this.
                grain = LAST_PLACES * norm(row(scratch.on_a, count))
                if missing <= max(close, ACCEPTED) * size + LAST_PLACES * length + grain:
                    # Only a proved distance may be above the margin, and this was not.
                    return CONVERGED, scale(v, 1.0 / length), min(length, margin), count
                n, facet = proved_by_facet(vertices, shapes, a, b, v, balls, scratch) if count > 1 else (NOWHERE, 0.0)
                if facet > 0.0 and length - facet <= max(close, ACCEPTED) * size + grain:
                    return CONVERGED, n, min(length, margin), count
                return DEGENERATE, scale(v, 1.0 / length), proved, count
        inside, closest, count = closest_in_simplex(count + 1, scratch)
        if inside:
            return CONVERGED, NOWHERE, 0.0, count
        closer = norm(closest)
        if closer <= TOUCHING * size:
            return CONVERGED, NOWHERE, 0.0, count
        # Rounding: no nearer than before. The new direction may still be the better one.
        if measured and not (closer < length):
            stalls += 1
        v, length = closest, closer
    n = scale(v, 1.0 / length)
    proved = -reach(vertices, shapes, a, neg(n)) - reach(vertices, shapes, b, n) + balls[0] + balls[1]
    if not (proved > 0.0):
        return CONVERGED, NOWHERE, 0.0, count
    return OUT_OF_ITERATIONS, n, proved, count


@kernel
def closest_points(count: int, scratch: Scratch) -> tuple[Vec3, Vec3]:
    """Return the points of A and of B that make the closest point of A - B, from the simplex that `gjk` left."""
    on_a, on_b = NOWHERE, NOWHERE
    for i in range(count):
        on_a = along(on_a, scratch.share[i], row(scratch.on_a, i))
        on_b = along(on_b, scratch.share[i], row(scratch.on_b, i))
    return on_a, on_b
