"""Signed distance of two convex shapes, with normal and witness points: GJK where apart, EPA where they overlap.

Shapes may be cores swept by balls of radii r_A and r_B: the distance of the cores shrinks by r_A + r_B and the depth grows by as
much, along the same normal. So the algorithms see cores only, and spheres and capsules are exact.
"""

from math import inf, nan

from avatarsim.collision.ellipsoid_distance import smooth_distance
from avatarsim.collision.epa import EXACT, deepest_points, epa_to, points_agree
from avatarsim.collision.gjk import NOWHERE, WHOLE, closest_points, gjk
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
from avatarsim.collision.scratch import Scratch
from avatarsim.collision.status import CONVERGED, DEGENERATE, NOT_FINITE
from avatarsim.jit.kernel import kernel
from avatarsim.model.geometry import POINTS, Shapes
from avatarsim.spatial.vec3 import Rows, Vec3, along, neg


@kernel
def signed_distance_up_to(
    vertices: Rows, shapes: Shapes, a: int, b: int, seed: Vec3, margin: float, scratch: Scratch
) -> tuple[int, float, Vec3, Vec3, Vec3]:
    """Return `signed_distance`, but stop as soon as a gap > margin [m] is proved.

    The gap returned is then a proved lower bound > margin along n, and both points are zero.
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
        wanted = margin + (shapes.radius[a] + shapes.radius[b])
        status, distance, n, on_a, on_b, _, _ = core_distance(vertices, shapes, a, b, seed, wanted, scratch)
    return with_radii(shapes, a, b, status, distance, n, on_a, on_b, margin)


@kernel
def with_radii(
    shapes: Shapes, a: int, b: int, status: int, distance: float, n: Vec3, on_a: Vec3, on_b: Vec3, margin: float
) -> tuple[int, float, Vec3, Vec3, Vec3]:
    """Convert distance and points of the cores to those of the shapes, as `signed_distance_up_to` returns them."""
    radius_a, radius_b = shapes.radius[a], shapes.radius[b]
    if status == NOT_FINITE or distance > margin + (radius_a + radius_b):
        return status, distance - (radius_a + radius_b), n, NOWHERE, NOWHERE
    return status, distance - (radius_a + radius_b), n, along(on_a, -radius_a, n), along(on_b, radius_b, n)


@kernel
def core_distance(
    vertices: Rows, shapes: Shapes, a: int, b: int, seed: Vec3, margin: float, scratch: Scratch
) -> tuple[int, float, Vec3, Vec3, Vec3, int, int]:
    """Return the signed distance of the cores, radii left out, by GJK and, if they overlap, EPA; ellipsoids by Newton after them.

    Returns:
        (status, distance, n, point_a, point_b, points, faces). The scratch holds ``points`` points: the simplex of cores
        apart, without faces, or the corners of the surface in ``faces`` face slots. With an ellipsoid: `smooth_distance`.
    """
    if shapes.kind[a] != POINTS or shapes.kind[b] != POINTS:
        return smooth_distance(vertices, shapes, a, b, seed, margin, scratch)
    status, n, distance, points = gjk(vertices, shapes, a, b, seed, margin, scratch)
    if status == NOT_FINITE:
        return status, nan, NOWHERE, NOWHERE, NOWHERE, 0, 0
    on_a, on_b = closest_points(points, scratch)
    if distance > 0.0:
        return status, distance, n, on_a, on_b, points, 0
    size = max(shapes.extent[a], shapes.extent[b])
    if are_boxes(shapes, a, b):
        known, depth, n, on_a, on_b = box_depth(vertices, shapes, a, b)
        if known:
            return CONVERGED, depth, n, on_a, on_b, 0, 0
    status, m, depth, points, faces, _ = epa_to(vertices, shapes, a, b, seed, WHOLE, points, EXACT * size, scratch)
    if status == NOT_FINITE:
        return status, nan, NOWHERE, NOWHERE, NOWHERE, 0, 0
    if faces > 0:
        on_a, on_b = deepest_points(m, depth, faces, size, scratch)
    if status == CONVERGED and faces > 0 and not points_agree(on_a, on_b, m, depth, size):
        status = DEGENERATE
    return status, -depth, neg(m), on_a, on_b, points, faces


@kernel
def signed_distance(
    vertices: Rows, shapes: Shapes, a: int, b: int, seed: Vec3, scratch: Scratch
) -> tuple[int, float, Vec3, Vec3, Vec3]:
    """Return the signed distance of shapes a and b, radii included.

    Args:
        vertices: (nv, 3) world coordinates [m].
        seed: the last normal of the pair, or zero: only changes how fast, except where every direction is as
            good.
        scratch: working memory, overwritten.

    Returns:
        (status, gap, n, point_a, point_b). gap > 0 [m]: the distance; gap < 0: moving a by -gap n just
        separates, and no shorter move does. n: unit normal out of b into a. Points on the surfaces, with
        point_a - point_b = gap n. Status NOT_FINITE: gap is nan. Status OUT_OF_ITERATIONS or DEGENERATE: n
        and gap are the best found; a gap < 0 still separates.
    """
    return signed_distance_up_to(vertices, shapes, a, b, seed, inf, scratch)
