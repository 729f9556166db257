"""Global penetration depth of two bodies of several convex pieces (Schmidl and Lin 2004, eq. 1)."""

import numpy as np
from numpy.typing import NDArray

from avatarsim.collide.gjk import NOWHERE
from avatarsim.collide.scratch import PIECES_CAP, Scratch
from avatarsim.collide.signed_distance import signed_distance_up_to
from avatarsim.collide.status import CANCELLING, CONVERGED, NOT_FINITE, OUT_OF_ROOM
from avatarsim.jit.kernel import kernel
from avatarsim.spatial.vec3 import Rows, Vec3, along, norm, put_row, row, scale
from avatarsim.world.shapes import Shapes

CANCELLED = 1e-6
"""Relative to sum pd_i^2: a shorter sum of pd_i^2 n_i has no trustworthy direction. Smaller: rounding picks
the way out; larger: pieces that nearly oppose each other are given up too early."""


@kernel
def global_penetration_depth(depth: NDArray[np.float64], direction: Rows, count: int) -> tuple[int, Vec3]:
    """Eq. (1): PD_g = sum_i(pd_i^2 n_i) / |sum_i pd_i|.

    Symbols: pd_i ``depth`` (count,) [m], at least 0; n_i ``direction`` (count, 3), unit, out of body B into
    body A.

    k equal pieces with one normal give exactly their depth; N orthogonal walls of equal depth give 1/N of
    what is needed along each, so the caller repeats; opposite normals cancel (Figure 4b).

    Returns:
        (status, PD_g [m]): moving A by PD_g, out of B. CANCELLING: the sum has no direction, PD_g is zero
        although pieces overlap. No piece: CONVERGED and zero.
    """
    total, squares, pushed = 0.0, 0.0, NOWHERE
    for i in range(count):
        square = depth[i] * depth[i]
        total += depth[i]
        squares += square
        pushed = along(pushed, square, row(direction, i))
    if total == 0.0:
        return CONVERGED, NOWHERE
    if not (norm(pushed) > CANCELLED * squares):
        return (CANCELLING if squares > 0.0 else NOT_FINITE), NOWHERE
    return CONVERGED, scale(pushed, 1.0 / abs(total))


@kernel
def global_depth(
    vertices: Rows,
    shapes: Shapes,
    shape_start_of_body: NDArray[np.int64],
    a: int,
    b: int,
    scratch: Scratch,
) -> tuple[int, Vec3, int]:
    """Global penetration depth of bodies a and b: eq. 1 over every overlapping pair of their pieces.

    Args:
        vertices: (nv, 3) world coordinates [m].
        shape_start_of_body: (n_bodies + 1,) body k owns shapes start[k] .. start[k + 1].

    Returns:
        (status, PD_g, count): PD_g [m] moves a out of b; count overlapping piece pairs, whose depths and
        normals are in the scratch. Status: that of eq. 1, or the first of a piece pair that did not converge,
        in which case eq. 1 still holds what was found. OUT_OF_ROOM: more pairs than the scratch holds;
        NOT_FINITE: PD_g is zero.
    """
    worst, count = CONVERGED, 0
    for i in range(shape_start_of_body[a], shape_start_of_body[a + 1]):
        for j in range(shape_start_of_body[b], shape_start_of_body[b + 1]):
            status, gap, n, _, _ = signed_distance_up_to(vertices, shapes, i, j, NOWHERE, 0.0, scratch)
            if status == NOT_FINITE:
                return status, NOWHERE, count
            if status != CONVERGED and worst == CONVERGED:
                worst = status
            if gap < 0.0:
                if count == PIECES_CAP:
                    return OUT_OF_ROOM, NOWHERE, count
                scratch.depth[count] = -gap
                put_row(scratch.direction, count, n)
                count += 1
    status, pushed = global_penetration_depth(scratch.depth, scratch.direction, count)
    return (status if worst == CONVERGED else worst), pushed, count
