"""Warm-started signed distance (temporal coherence): a query starts from the simplex, polytope or feature of the pair's last one.

Apart: GJK continues from the last simplex. Overlapping: EPA continues from the whole last polytope around the origin. With an
ellipsoid: Newton's method continues from the last normal and feature. If the features are unchanged, one pair of supports proves
the answer, by the same test that ends the cold algorithms: they accept any points of A - B, so a wrong cache cannot make a wrong
answer. A query that the cache does not lead to an answer starts cold.
"""

from math import inf

from avatarsim.collision.ellipsoid_distance import FEATURE, same_feature
from avatarsim.collision.epa import EXACT, SAME_FACE, deepest_points, expand, points_agree
from avatarsim.collision.gjk import (
    CLOSE_ENOUGH,
    NOWHERE,
    TOUCHING,
    WHOLE,
    closest_in_simplex,
    closest_on_segment,
    closest_on_triangle,
    closest_points,
    gjk_from,
)
from avatarsim.collision.primitives import (
    BOX_AND_POINT,
    POINT_AND_BOX,
    TWO_POINTS,
    TWO_SEGMENTS,
    UNKNOWN,
    are_boxes,
    between_points,
    between_segments,
    box_depth,
    form,
    point_and_box,
)
from avatarsim.collision.scratch import Scratch, number
from avatarsim.collision.signed_distance import core_distance, with_radii
from avatarsim.collision.status import CONVERGED, NOT_FINITE
from avatarsim.collision.support import reach
from avatarsim.collision.warm_start import (
    PairMemory,
    PairRecord,
    deepest_kept,
    keep_axis,
    lowest_kept,
    recall_axis,
    recall_differences,
    recall_faces,
    recall_points,
    remember_points,
    remember_polytope,
)
from avatarsim.jit.kernel import kernel
from avatarsim.model.geometry import POINTS, Shapes
from avatarsim.spatial.vec3 import Rows, Vec3, along, neg, norm, row, scale, sub
from avatarsim.tolerances import LAST_PLACES, NOTHING

CLEARLY_DEEP = NOTHING
"""Relative to the shapes' size: below this depth a query starts cold, with GJK first. Smaller: rounding decides on which side of
a cached face the origin is."""


@kernel
def signed_distance_coherent(
    vertices: Rows, shapes: Shapes, a: int, b: int, margin: float, scratch: Scratch, memory_out: PairMemory, pair: int
) -> tuple[int, float, Vec3, Vec3, Vec3]:
    """Return `signed_distance_up_to`, faster if the relative pose of shapes a and b has changed little since the last call.

    Args:
        margin: stop as soon as a gap > margin [m] is proved; inf: the exact distance.
        memory_out: read and updated at number ``pair``, which is the caller's name for the ordered pair (a, b). Any
            content only costs time.
    """
    status, kind = CONVERGED, form(shapes, a, b)
    known, distance, n, on_a, on_b = UNKNOWN
    if kind == TWO_POINTS:
        known, distance, n, on_a, on_b = between_points(vertices, shapes, a, b)
    elif kind == TWO_SEGMENTS:
        known, distance, n, on_a, on_b = between_segments(vertices, shapes, a, b)
    elif kind == POINT_AND_BOX:
        known, distance, n, on_a, on_b = point_and_box(vertices, shapes, a, b)
    elif kind == BOX_AND_POINT:
        known, distance, n, on_b, on_a = point_and_box(vertices, shapes, b, a)
        n = neg(n)
    if not known:
        wanted = margin + (shapes[a].radius + shapes[b].radius)
        status, distance, n, on_a, on_b = core_distance_coherent(vertices, shapes, a, b, wanted, scratch, memory_out[pair])
    return with_radii(shapes, a, b, status, distance, n, on_a, on_b, margin)


@kernel
def core_distance_coherent(
    vertices: Rows, shapes: Shapes, a: int, b: int, margin: float, scratch: Scratch, memory_out: PairRecord
) -> tuple[int, float, Vec3, Vec3, Vec3]:
    """Return `core_distance`, warm-started from the cache of the pair where that gives an answer."""
    smooth, used = shapes[a].kind != POINTS or shapes[b].kind != POINTS, memory_out.used[0]
    if used > FEATURE and not smooth:
        known, distance, n, on_a, on_b = same_facet(vertices, shapes, a, b, scratch, memory_out)
        if known:
            return CONVERGED, distance, n, on_a, on_b
    if used == 0 and are_boxes(shapes, a, b):
        # Overlapping boxes have no cache: their closed form is faster than the check of a polytope.
        known, distance, n, on_a, on_b = box_depth(vertices, shapes, a, b)
        if known:
            keep_axis(n, memory_out)
            return CONVERGED, distance, n, on_a, on_b
    if 0 < used <= FEATURE and not smooth:
        known, distance, n, on_a, on_b = same_simplex(vertices, shapes, a, b, margin, memory_out)
        if known:
            keep_axis(n, memory_out)
            return CONVERGED, distance, n, on_a, on_b
    seed = recall_axis(memory_out)
    count = recall_points(vertices, shapes, a, b, memory_out, scratch)
    known, distance, n, on_a, on_b = UNKNOWN
    if smooth:
        if count == FEATURE:
            known, distance, n, on_a, on_b = same_feature(vertices, shapes, a, b, seed, scratch)
            keep_axis(n, memory_out)
    elif count > FEATURE:
        known, distance, n, on_a, on_b = still_overlapping(vertices, shapes, a, b, count, scratch, memory_out)
    elif count > 0:
        known, distance, n, on_a, on_b = still_apart(vertices, shapes, a, b, count, margin, scratch, memory_out)
    if known:
        return CONVERGED, distance, n, on_a, on_b
    status, distance, n, on_a, on_b, points, faces = core_distance(vertices, shapes, a, b, seed, margin, scratch)
    if status != CONVERGED and status != NOT_FINITE:
        # From a cached direction rounding may keep GJK or EPA from converging: try once more without.
        status, distance, n, on_a, on_b, points, faces = core_distance(vertices, shapes, a, b, NOWHERE, margin, scratch)
    if status != CONVERGED:
        points, faces = 0, 0
    if faces > 0:
        remember_polytope(shapes, a, b, n, points, faces, scratch, memory_out)
    else:
        remember_points(shapes, a, b, n, points, scratch, memory_out)
    return status, distance, n, on_a, on_b


@kernel
def still_apart(
    vertices: Rows, shapes: Shapes, a: int, b: int, count: int, margin: float, scratch: Scratch, memory_out: PairRecord
) -> tuple[bool, float, Vec3, Vec3, Vec3]:
    """Return the distance of the cores by GJK from the ``count`` cached points in the scratch; not known if they touch."""
    _, v, count = closest_in_simplex(count, scratch)
    if not (0.0 < norm(v) < inf):
        return UNKNOWN
    status, n, distance, count = gjk_from(vertices, shapes, a, b, v, WHOLE, count, margin, CLOSE_ENOUGH, scratch)
    if status != CONVERGED or not (distance > 0.0):
        return UNKNOWN
    on_a, on_b = closest_points(count, scratch)
    remember_points(shapes, a, b, n, count, scratch, memory_out)
    return True, distance, n, on_a, on_b


@kernel
def same_simplex(
    vertices: Rows, shapes: Shapes, a: int, b: int, margin: float, memory: PairRecord
) -> tuple[bool, float, Vec3, Vec3, Vec3]:
    """Return the distance of the cores if the cached 1 to 3 points of A - B, at the present poses, still hold its nearest point.

    The result of the first step of GJK, by the same test, in less time and without writing the simplex.
    """
    first_a, first_b, last = shapes[a].start, shapes[b].start, memory.used[0] - 1
    i_a, i_b = number(memory.rows[0, 0]), number(memory.rows[0, 1])
    j_a, j_b = number(memory.rows[min(1, last), 0]), number(memory.rows[min(1, last), 1])
    k_a, k_b = number(memory.rows[last, 0]), number(memory.rows[last, 1])
    if not (max(i_a, j_a, k_a) < shapes[a + 1].start - first_a and max(i_b, j_b, k_b) < shapes[b + 1].start - first_b):
        return UNKNOWN
    p_a, p_b = row(vertices, first_a + i_a), row(vertices, first_b + i_b)
    q_a, q_b = row(vertices, first_a + j_a), row(vertices, first_b + j_b)
    r_a, r_b = row(vertices, first_a + k_a), row(vertices, first_b + k_b)
    v, share = sub(p_a, p_b), (1.0, 0.0, 0.0)
    if last == 1:
        v, two = closest_on_segment(v, sub(q_a, q_b))
        share = (two[0], two[1], 0.0)
    elif last == 2:
        v, share = closest_on_triangle(v, sub(q_a, q_b), sub(r_a, r_b))
    length, size = norm(v), max(shapes[a].extent, shapes[b].extent)
    if not (TOUCHING * size < length < inf):
        return UNKNOWN
    n = scale(v, 1.0 / length)
    proved = -reach(vertices, shapes, a, neg(n)) - reach(vertices, shapes, b, n)
    if proved > margin:
        return True, proved, n, NOWHERE, NOWHERE
    if not (proved > 0.0 and length - proved <= CLOSE_ENOUGH * size + LAST_PLACES * length):
        return UNKNOWN
    on_a = along(along(scale(p_a, share[0]), share[1], q_a), share[2], r_a)
    on_b = along(along(scale(p_b, share[0]), share[1], q_b), share[2], r_b)
    return True, min(length, margin), n, on_a, on_b


@kernel
def same_facet(
    vertices: Rows, shapes: Shapes, a: int, b: int, scratch: Scratch, memory: PairRecord
) -> tuple[bool, float, Vec3, Vec3, Vec3]:
    """Return the depth of the cores if the cached polytope, at the present poses, proves it: its lowest face is one of A - B's.

    The proof is that of `expand`, in less time and without writing: two supports, and a surface around the origin without a
    lower face.
    """
    size = max(shapes.extent[a], shapes.extent[b])
    points = recall_differences(vertices, shapes, a, b, memory, scratch)
    lowest, m = lowest_kept(points, memory, scratch)
    if not (lowest > CLEARLY_DEEP * size):
        return UNKNOWN
    depth = reach(vertices, shapes, a, m) + reach(vertices, shapes, b, neg(m))
    if not (depth - lowest <= EXACT * size):
        return UNKNOWN
    on_a, on_b = deepest_kept(vertices, shapes, a, b, m, depth, SAME_FACE * size, memory, scratch)
    if not points_agree(on_a, on_b, m, depth, size):
        return UNKNOWN
    return True, -depth, neg(m), on_a, on_b


@kernel
def still_overlapping(
    vertices: Rows, shapes: Shapes, a: int, b: int, count: int, scratch: Scratch, memory_out: PairRecord
) -> tuple[bool, float, Vec3, Vec3, Vec3]:
    """Return the depth of the cores by EPA from the cached polytope over the ``count`` points in the scratch.

    Not known if the polytope is not closed or does not hold the origin. The answer is proved by `expand` alone.
    """
    size = max(shapes.extent[a], shapes.extent[b])
    before = recall_faces(count, memory_out, scratch)
    if before == 0:
        return UNKNOWN
    status, m, depth, points, faces, _ = expand(vertices, shapes, a, b, WHOLE, count, before, EXACT * size, scratch)
    if status != CONVERGED or not (depth > CLEARLY_DEEP * size):
        return UNKNOWN
    on_a, on_b = deepest_points(m, depth, faces, size, scratch)
    if not points_agree(on_a, on_b, m, depth, size):
        return UNKNOWN
    if points > count:
        remember_polytope(shapes, a, b, neg(m), points, faces, scratch, memory_out)
    return True, -depth, neg(m), on_a, on_b
