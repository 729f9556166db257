"""Signed distance of two cores, one of them an ellipsoid: GJK or EPA first, then Newton's method, whose result is proved.

Depth of two overlapping cores, one of them an ellipsoid: branch and bound with EPA's facets and Newton's method.

EPA alone approaches a smooth surface facet by facet. Here a facet is excluded once a stationary point that Newton's method found
near it explains it: in a cone around that point the support function is proved to be nowhere lower, and the facet cannot hide a
direction outside that cone. When every facet is high enough or excluded, the lowest stationary point is the global depth.
"""

from math import inf, nan, sqrt
from typing import NamedTuple

from avatarsim.collision.ellipsoid import is_depth_kept, least_cosine, polish, proves_itself, rolling_radius
from avatarsim.collision.epa import SMOOTH, VISIBLE, cone_to, deepest_points, epa_to, find_horizon, points_agree
from avatarsim.collision.gjk import (
    CLOSE_ENOUGH,
    NOWHERE,
    WHOLE,
    Balls,
    add_support,
    closest_in_simplex,
    closest_points,
    first_direction,
    gjk_from,
)
from avatarsim.collision.primitives import Answer
from avatarsim.collision.scratch import FACES_CAP, POINTS_CAP, Scratch, number
from avatarsim.collision.status import CONVERGED, DEGENERATE, NOT_FINITE, OUT_OF_ITERATIONS
from avatarsim.jit.kernel import kernel
from avatarsim.model.geometry import POINTS, Shapes
from avatarsim.spatial.vec3 import Rows, Vec3, along, dot, neg, put_row, row
from avatarsim.tolerances import NOTHING, PROOF

START = 0.03
"""Relative to the shapes' size: how near GJK and EPA come before Newton is tried. Larger: it is tried in vain; smaller: they are
slower than it."""

NEARER = 0.5
"""Part of its distance by which EPA comes nearer before Newton is tried again, if it found nothing new. Larger: it is tried in
vain; smaller: EPA is slower than it."""

FEATURE = 3
"""Points in which the rows of a vertex, an edge or a face are passed: rows may repeat."""

MINIMA_KEPT = 24
"""Stationary points kept in one query, in the last slots of the scratch. Fewer: symmetric pairs converge slowly."""

SAME = NOTHING
"""One minus the cosine of two normals that are the same stationary point."""

EXPLAINED = PROOF
"""Relative to the shapes' size: a facet lower than the answer by less needs no explanation."""

OF_POLYTOPE = -1
"""In place of a count of minima: the depth is EPA's own."""


class Minimum(NamedTuple):
    """Least depth found so far.

    depth [m] along n; on_a, on_b: deepest points; minima: stationary points kept, or OF_POLYTOPE; i, j, k: rows of the feature.
    """

    depth: float
    n: Vec3
    on_a: Vec3
    on_b: Vec3
    minima: int
    i: int
    j: int
    k: int


@kernel
def explained(f: int, minima: int, depth: float, scratch: Scratch) -> bool:
    """Return True if the directions that face f may hide at less than ``depth`` lie in the cone of a stationary point.

    A direction d with h(d) < depth has the point depth d outside the polytope, beyond the plane of a face of height H
    and normal n, so n.d > H / depth; hence d is at most the sum of two angles from the stationary normal.
    """
    n, height = row(scratch.normal, f), scratch.height[f]
    off = min(height / depth, 1.0)
    if not (off > 0.0):
        return False
    for i in range(minima):
        near = min(dot(n, row(scratch.w, POINTS_CAP - 2 - i)), 1.0)
        if near > 0.0:
            cos = near * off - sqrt((1.0 - near * near) * (1.0 - off * off))
            if cos >= scratch.height[FACES_CAP - 1 - i]:
                return True
    return False


@kernel
def already_found(m: Vec3, minima: int, scratch: Scratch) -> bool:
    """Return True if m is one of the stationary points kept."""
    for i in range(minima):
        if dot(m, row(scratch.w, POINTS_CAP - 2 - i)) > 1.0 - SAME:
            return True
    return False


@kernel
def first_polytope(
    vertices: Rows, shapes: Shapes, a: int, b: int, seed: Vec3, balls: Balls, count: int, try_at: float, scratch: Scratch
) -> tuple[int, Vec3, float, int, int, Balls]:
    """Run `epa_to` with the balls, or without them where nothing with facets is left of a ball written as an ellipsoid."""
    status, m, depth, points, faces, _ = epa_to(vertices, shapes, a, b, seed, balls, count, try_at, scratch)
    if faces == 0 and balls[0] + balls[1] > 0.0:
        balls = WHOLE
        add_support(vertices, shapes, a, b, m, balls, 0, scratch)
        status, m, depth, points, faces, _ = epa_to(vertices, shapes, a, b, seed, balls, 1, try_at, scratch)
    return status, m, depth, points, faces, balls


@kernel
def smooth_depth(
    vertices: Rows, shapes: Shapes, a: int, b: int, seed: Vec3, balls: Balls, count: int, scratch: Scratch
) -> tuple[int, float, Vec3, Vec3, Vec3, int, int]:
    """Return `core_distance` of cores, one an ellipsoid, that GJK left with ``count`` points and no gap but for the balls.

    Heights and depths in here are those without the balls, and so are the points of the polytope.

    Points returned: FEATURE if Newton gave the answer, and the scratch then holds the rows of the feature; else 0.
    """
    size = max(shapes.extent[a], shapes.extent[b])
    side = 0 if shapes.kind[a] == POINTS else 1
    flat_a, flat_b = closest_points(count, scratch)
    try_at = START * size
    status, m, depth, points, faces, balls = first_polytope(vertices, shapes, a, b, seed, balls, count, try_at, scratch)
    rolled = balls[0] + balls[1]
    corner = scratch.rows[0, side]
    best = Minimum(inf, m, flat_a, flat_b, 0, corner, corner, corner)
    while status == CONVERGED and faces > 0:
        f, lowest = lowest_face(faces, size, best, scratch)
        if f < 0:
            break
        m = row(scratch.normal, f)
        w = add_support(vertices, shapes, a, b, m, balls, points, scratch)
        depth = dot(w, m)
        if not (abs(depth) < inf):
            status = NOT_FINITE
            break
        if best.depth > 0.0 and best.depth < inf:
            whole_w = along(w, rolled, m)
            if is_depth_kept(vertices, shapes, a, b, m, whole_w, lowest / best.depth, best.depth + rolled - EXPLAINED * size):
                scratch.settled[f] = 1
                continue
        if depth - lowest <= try_at or depth < 0.0:
            best, new, is_proved = polish_face(vertices, shapes, a, b, f, m, side, rolled, best, scratch)
            if is_proved:
                break
            if not new:
                try_at = max(NEARER * (depth - lowest), SMOOTH * size)
                if depth - lowest <= SMOOTH * size or depth < 0.0:
                    # Newton has nothing to add: EPA's own answer.
                    best = of_polytope(best, depth, m, best.depth)
                    break
        if depth - lowest <= EXPLAINED * size:
            # The face is one of A - B's own, which has faces where a core is a polytope and the other a mere ball.
            if depth < best.depth - EXPLAINED * size:
                best = of_polytope(best, depth, m, inf)
                break
            scratch.settled[f] = 1
            continue
        if points >= POINTS_CAP - 2 - MINIMA_KEPT:
            status = OUT_OF_ITERATIONS
            best = of_polytope(best, depth, m, best.depth)
            break
        points += 1
        edges, marked = find_horizon(f, w, VISIBLE * size, scratch)
        whole, faces = cone_to(points - 1, edges, marked, faces, scratch)
        if not whole:
            status = DEGENERATE
            best = of_polytope(best, depth, m, best.depth)
    return smooth_answer(status, best, m, depth, flat_a, flat_b, faces, size, side, balls, scratch)


@kernel
def of_polytope(best: Minimum, depth: float, m: Vec3, above: float) -> Minimum:
    """Return the polytope's own depth along m as the least, if it is less than ``above`` [m]."""
    return Minimum(depth, m, best.on_a, best.on_b, OF_POLYTOPE, best.i, best.j, best.k) if depth < above else best


@kernel
def lowest_face(faces: int, size: float, best: Minimum, scratch: Scratch) -> tuple[int, float]:
    """Return the lowest face that may hide less depth than the best, or -1, and its height."""
    f, lowest = -1, inf
    for g in range(faces):
        if scratch.alive[g] == 1 and scratch.settled[g] == 0 and scratch.height[g] < lowest:
            if scratch.height[g] < best.depth - EXPLAINED * size and not explained(g, best.minima, best.depth, scratch):
                f, lowest = g, scratch.height[g]
    return f, lowest


@kernel
def polish_face(
    vertices: Rows, shapes: Shapes, a: int, b: int, f: int, m: Vec3, side: int, rolled: float, best: Minimum, scratch: Scratch
) -> tuple[Minimum, bool, bool]:
    """Return the least depth after Newton from face f along m, whether its minimum is a new one, and whether it is proved."""
    x, y, z = number(scratch.corner[f, 0]), number(scratch.corner[f, 1]), number(scratch.corner[f, 2])
    i, j, k = scratch.rows[x, side], scratch.rows[y, side], scratch.rows[z, side]
    found, better, height, p, q = polish(vertices, shapes, a, b, m, i, j, k)
    count = best.minima
    if not found or already_found(better, count, scratch):
        return best, False, False
    if height - rolled < best.depth:
        best = Minimum(height - rolled, better, p, q, count, i, j, k)
        if proves_itself(vertices, shapes, a, b, found, better, height, rolled):
            return best, True, True
    if count < MINIMA_KEPT:
        put_row(scratch.w, POINTS_CAP - 2 - count, better)
        scratch.height[FACES_CAP - 1 - count] = least_cosine(vertices, shapes, a, b, better, height)
        best = Minimum(best.depth, best.n, best.on_a, best.on_b, count + 1, best.i, best.j, best.k)
    return best, True, False


@kernel
def smooth_answer(
    status: int, best: Minimum, m: Vec3, depth: float, flat_a: Vec3, flat_b: Vec3, faces: int, size: float, side: int,
    balls: Balls, scratch: Scratch,
) -> tuple[int, float, Vec3, Vec3, Vec3, int, int]:
    """Return `smooth_depth` from the least depth found; m, depth, flat_a, flat_b: without one, of the flat core."""
    rolled, n = balls[0] + balls[1], best.n
    if status == NOT_FINITE:
        return status, nan, NOWHERE, NOWHERE, NOWHERE, 0, 0
    if not (best.depth < inf):
        # A - B is flat, or EPA could not even begin
        if faces > 0:
            flat_a, flat_b = deepest_points(m, depth, faces, size, scratch)
        return status, -depth - rolled, neg(m), along(flat_a, balls[0], m), along(flat_b, -balls[1], m), 0, 0
    if best.minima == OF_POLYTOPE:
        on_a, on_b = deepest_points(n, best.depth, faces, size, scratch)
        if status == CONVERGED and best.depth < 0.0 and not points_agree(on_a, on_b, n, best.depth, size):
            status = DEGENERATE
        return status, -best.depth - rolled, neg(n), along(on_a, balls[0], n), along(on_b, -balls[1], n), 0, 0
    for slot in range(FEATURE):
        scratch.rows[slot, 0] = scratch.rows[0, 0]
        scratch.rows[slot, 1] = scratch.rows[0, 1]
    scratch.rows[0, side], scratch.rows[1, side], scratch.rows[2, side] = best.i, best.j, best.k
    return status, -best.depth - rolled, neg(n), best.on_a, best.on_b, FEATURE, 0


@kernel
def same_feature(vertices: Rows, shapes: Shapes, a: int, b: int, n: Vec3, scratch: Scratch) -> Answer:
    """Run Newton from normal n (out of b into a) and the feature whose rows are in the first three points of the scratch.

    The answer counts as known only if it is proved.
    """
    side = 0 if shapes.kind[a] == POINTS else 1
    i, j, k = scratch.rows[0, side], scratch.rows[1, side], scratch.rows[2, side]
    found, m, height, on_a, on_b = polish(vertices, shapes, a, b, neg(n), i, j, k)
    rolled = rolling_radius(vertices, shapes, a) + rolling_radius(vertices, shapes, b)
    return proves_itself(vertices, shapes, a, b, found, m, height, rolled), -height, neg(m), on_a, on_b


@kernel
def smooth_distance(
    vertices: Rows, shapes: Shapes, a: int, b: int, seed: Vec3, margin: float, scratch: Scratch
) -> tuple[int, float, Vec3, Vec3, Vec3, int, int]:
    """Return `core_distance` if one of the two is an ellipsoid.

    GJK and EPA see the ellipsoids without the largest balls that roll inside them. The rest is smaller and less round: shallow
    overlaps are distances, and of deep ones fewer facets come nearer. Newton sees the whole.

    Points returned: FEATURE if Newton gave the answer, and the scratch then holds the rows of the feature; else 0.
    """
    v = first_direction(vertices, shapes, a, b, seed)
    balls = (rolling_radius(vertices, shapes, a), rolling_radius(vertices, shapes, b))
    rolled = balls[0] + balls[1]
    margin = margin + rolled
    size = max(shapes.extent[a], shapes.extent[b])
    start = START * max(shapes.extent[a] - 2.0 * balls[0], shapes.extent[b] - 2.0 * balls[1]) / size
    side = 0 if shapes.kind[a] == POINTS else 1
    status, n, distance, count = gjk_from(vertices, shapes, a, b, v, balls, 0, margin, start, scratch)
    for closer in range(2):
        if status == NOT_FINITE:
            return status, nan, NOWHERE, NOWHERE, NOWHERE, 0, 0
        if distance > margin:
            # Proved along n, whatever the tolerance of GJK.
            return status, distance - rolled, n, NOWHERE, NOWHERE, 0, 0
        if not (distance > 0.0):
            return smooth_depth(vertices, shapes, a, b, seed, balls, count, scratch)
        last = count - 1
        i, j, k = scratch.rows[0, side], scratch.rows[min(last, 1), side], scratch.rows[last, side]
        known, m, height, on_a, on_b = polish(vertices, shapes, a, b, neg(n), i, j, k)
        if known and height < rolled:
            a_row, b_row = scratch.rows[last, 0], scratch.rows[last, 1]
            for p in range(FEATURE):
                scratch.rows[p, 0] = a_row
                scratch.rows[p, 1] = b_row
            scratch.rows[0, side], scratch.rows[1, side], scratch.rows[2, side] = i, j, k
            return CONVERGED, -height, neg(m), on_a, on_b, FEATURE, 0
        if closer == 0:
            # From afar GJK may not see which feature it is, or Newton may go elsewhere.
            _, v, count = closest_in_simplex(count, scratch)
            status, n, distance, count = gjk_from(vertices, shapes, a, b, v, balls, count, margin, CLOSE_ENOUGH, scratch)
    on_a, on_b = closest_points(count, scratch)
    return status, distance - rolled, n, along(on_a, -balls[0], n), along(on_b, balls[1], n), 0, 0
