"""Signed distance of two cores, one of them an ellipsoid: GJK or EPA first, then Newton's method, whose result is proved."""

from math import nan

from avatarsim.collide.closed_forms import Answer
from avatarsim.collide.gjk import CLOSE_ENOUGH, NOWHERE, closest_in_simplex, closest_points, first_direction, gjk_from
from avatarsim.collide.scratch import Scratch
from avatarsim.collide.smooth import polish
from avatarsim.collide.smooth_depth import FEATURE, START, smooth_depth
from avatarsim.collide.smooth_proof import proves_itself, rolling_radius
from avatarsim.collide.status import CONVERGED, NOT_FINITE
from avatarsim.jit.kernel import kernel
from avatarsim.spatial.vec3 import Rows, Vec3, along, neg
from avatarsim.world.shapes import POINTS, Shapes


@kernel
def same_feature(vertices: Rows, shapes: Shapes, a: int, b: int, n: Vec3, scratch: Scratch) -> Answer:
    """Newton from normal n (out of b into a) and the feature whose rows are in the first three points of the scratch.

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
    """As `core_distance`, if one of the two is an ellipsoid.

    GJK and EPA see the ellipsoids without the largest balls that roll inside them. What is left is smaller and less round:
    shallow overlaps are distances, and of deep ones fewer facets come nearer. Newton sees the whole.

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
