"""Signed distance of two cores of which one is an ellipsoid: GJK or EPA until Newton's method can finish, with a proof."""

from math import nan

from avatarsim.collide.closed_forms import Answer
from avatarsim.collide.gjk import CLOSE_ENOUGH, NOWHERE, closest_in_simplex, closest_points, first_direction, gjk_from
from avatarsim.collide.scratch import Scratch
from avatarsim.collide.smooth import polish, proves_itself
from avatarsim.collide.smooth_depth import FEATURE, START, smooth_depth
from avatarsim.collide.status import CONVERGED, NOT_FINITE
from avatarsim.kernel import kernel
from avatarsim.spatial.vec3 import Rows, Vec3, neg
from avatarsim.world.shapes import POINTS, Shapes


@kernel
def same_feature(vertices: Rows, shapes: Shapes, a: int, b: int, n: Vec3, scratch: Scratch) -> Answer:
    """Newton from normal n (out of b into a) and the feature whose rows are in the first three points of the scratch.

    Known is what is proved.
    """
    side = 0 if shapes.kind[a] == POINTS else 1
    i, j, k = scratch.rows[0, side], scratch.rows[1, side], scratch.rows[2, side]
    found, m, height, on_a, on_b = polish(vertices, shapes, a, b, neg(n), i, j, k)
    return proves_itself(vertices, shapes, a, b, found, m, height), -height, neg(m), on_a, on_b


@kernel
def smooth_distance(
    vertices: Rows, shapes: Shapes, a: int, b: int, seed: Vec3, margin: float, scratch: Scratch
) -> tuple[int, float, Vec3, Vec3, Vec3, int, int]:
    """As `core_distance`, if one of the two is an ellipsoid.

    Points returned: FEATURE if Newton gave the answer, and the scratch then holds the rows of the feature; else 0.
    """
    v = first_direction(vertices, shapes, a, b, seed)
    status, n, distance, count = gjk_from(vertices, shapes, a, b, v, 0, margin, START, scratch)
    if status == NOT_FINITE:
        return status, nan, NOWHERE, NOWHERE, NOWHERE, 0, 0
    if distance > margin:
        # Proved along n, however coarse GJK was asked to be.
        return status, distance, n, NOWHERE, NOWHERE, 0, 0
    if not (distance > 0.0):
        return smooth_depth(vertices, shapes, a, b, seed, count, scratch)
    kept = count
    last = count - 1
    a_row, b_row = scratch.rows[last, 0], scratch.rows[last, 1]
    side = 0 if shapes.kind[a] == POINTS else 1
    i, j, k = scratch.rows[0, side], scratch.rows[min(last, 1), side], scratch.rows[last, side]
    known, m, height, on_a, on_b = polish(vertices, shapes, a, b, neg(n), i, j, k)
    if known and height < 0.0:
        for p in range(FEATURE):
            scratch.rows[p, 0] = a_row
            scratch.rows[p, 1] = b_row
        scratch.rows[0, side], scratch.rows[1, side], scratch.rows[2, side] = i, j, k
        return CONVERGED, -height, neg(m), on_a, on_b, FEATURE, 0
    _, v, count = closest_in_simplex(kept, scratch)
    status, n, distance, count = gjk_from(vertices, shapes, a, b, v, count, margin, CLOSE_ENOUGH, scratch)
    if distance > 0.0:
        on_a, on_b = closest_points(count, scratch)
        return status, distance, n, on_a, on_b, 0, 0
    return smooth_depth(vertices, shapes, a, b, seed, count, scratch)
