"""Push two overlapping bodies apart by their global penetration depth (Schmidl and Lin 2004, eq. 1), by pure translation.

Overlap test: sweep and prune over the bodies' boxes, then signed distances of pieces (Schmidl and Lin 2004, Algorithm 1).

Steps 1 and 2 of the algorithm. For every state that method `paper` shows `find_overlaps` returned 0: in each wanted pair of
bodies with at least one link the boxes of all pieces are apart or their signed distance is not negative. The motion between two
shown states is not tested: a body thinner than a frame's motion may be passed through, as stated in the paper's conclusion.

Global penetration depth of two bodies of several convex pieces (Schmidl and Lin 2004, eq. 1).

Priority in separation: shares of the displacement of two overlapping bodies; fixed bodies none, driven before simulated.
"""

from typing import Annotated, Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from avatarsim.collision.broad_phase import boxes_meet, forget, sweep_and_prune
from avatarsim.collision.gjk import NOWHERE
from avatarsim.collision.grid import SweepMemory, make_sweep_memory
from avatarsim.collision.scratch import PIECES_CAP, Scratch, make_scratch
from avatarsim.collision.signed_distance import signed_distance_up_to
from avatarsim.collision.status import CANCELLING, CONVERGED, NOT_FINITE, OUT_OF_ROOM
from avatarsim.jit.kept import NOT_KEPT
from avatarsim.jit.kernel import kernel
from avatarsim.jit.layout import Cube, FlagLine, IndexGrid, IndexLine
from avatarsim.model.dynamics import DRIVEN, FIXED
from avatarsim.model.geometry import OPEN, Geometry, PairFilter, Poses, Shapes, allowed_depth, rest_depth
from avatarsim.spatial.vec3 import Rows, Vec3, along, norm, put_row, row, scale
from avatarsim.tolerances import SAME_DIRECTION

Flags = NDArray[np.bool_]

NOT_CHECKED: Final = -1
"""A pose is not finite, or there are more pairs than room: the state is not checked and must not be shown."""

NOTHING_KNOWN: Final = (0.0, 0.0, 0.0)

PAIRS_PER_LINK: Final = 8
"""Room for so many more pairs per link than links with bodies: for pairs of simulated bodies that were pushed."""

CANDIDATES_MORE: Final = 4
"""Room for so many times the number of bodies more candidates than pairs: boxes have room to move, and so more of them meet."""

OBSTACLE: Final = 0
"""Family of the bodies that are no links: pairs among them are not tested by the lower loop."""

# places in Overlaps.tally
QUERIED, DOUBTED = 0, 1


class Overlaps(NamedTuple):
    """Memory of the search, for nb bodies of which the last are links, with D pieces of links among ns pieces.

    tested  pairs that this loop tests: wanted, and one of the two is a link (or a simulated body that was pushed)
    sweep   state of sweep and prune from call to call
    pairs   (cap, 2) pairs whose boxes meet, found (cap, 2) those that overlap
    hit     (nb) bodies that overlap another
    seed    (D, ns, 3) the last normal of each pair of pieces
    tally   (2) signed-distance queries since it was set to zero, and those that did not converge
    """

    tested: PairFilter
    sweep: Annotated[SweepMemory, NOT_KEPT]
    pairs: Annotated[IndexGrid, NOT_KEPT]
    found: Annotated[IndexGrid, NOT_KEPT]
    hit: FlagLine
    seed: Cube
    tally: Annotated[IndexLine, NOT_KEPT]
    scratch: Scratch


def make_overlaps(geo: Geometry, first_link: int) -> Overlaps:
    """Return fresh memory; bodies from ``first_link`` on are links."""
    nb, ns = len(geo.first_shape) - 1, len(geo.body)
    family = geo.wanted.family.copy()
    family[:first_link] = OBSTACLE
    tested = PairFilter(family, geo.wanted.first.copy(), geo.wanted.never.copy())
    cap = (nb - first_link) * (nb + PAIRS_PER_LINK)
    return Overlaps(
        tested, make_sweep_memory(nb, cap + CANDIDATES_MORE * nb),
        np.zeros((cap, 2), dtype=np.int64), np.zeros((cap, 2), dtype=np.int64),
        np.zeros(nb, dtype=np.bool_), np.zeros((ns - int(geo.first_shape[first_link]), ns, 3)), np.zeros(2, dtype=np.int64),
        make_scratch(),
    )


@kernel
def answer_for(body: int, moved: bool, overlaps_out: Overlaps) -> None:
    """Add the pairs of a simulated body to those tested, because it was moved, or take them out again."""
    overlaps_out.tested.family[body] = OPEN if moved else OBSTACLE
    forget(overlaps_out.sweep, body)


@kernel
def pieces_overlap(geo: Geometry, poses: Poses, s: int, t: int, overlaps_out: Overlaps) -> bool:
    """Return True if pieces s < t overlap deeper than they may: their signed distance is negative, or not a number."""
    if not boxes_meet(poses.boxes, s, t):
        return False
    remembered = t - (geo.body.shape[0] - overlaps_out.seed.shape[0])
    seed = NOTHING_KNOWN
    if remembered >= 0:
        seed = row(overlaps_out.seed[remembered], s)
    status, gap, n, _, _ = signed_distance_up_to(poses.vertices, geo.shapes, s, t, seed, 0.0, overlaps_out.scratch)
    overlaps_out.tally[QUERIED] += 1
    if status != CONVERGED:
        overlaps_out.tally[DOUBTED] += 1
    if remembered >= 0:
        put_row(overlaps_out.seed[remembered], s, n)
    return not (gap + allowed_depth(geo, s, t) >= 0.0)


@kernel
def bodies_overlap(geo: Geometry, poses: Poses, a: int, b: int, overlaps_out: Overlaps) -> bool:
    """Return True if any piece of body a overlaps one of body b > a; stops at the first that does."""
    for s in range(geo.first_shape[a], geo.first_shape[a + 1]):
        for t in range(geo.first_shape[b], geo.first_shape[b + 1]):
            if pieces_overlap(geo, poses, s, t, overlaps_out):
                return True
    return False


@kernel
def find_overlaps(geo: Geometry, poses: Poses, overlaps_out: Overlaps) -> int:
    """Find every overlapping pair of those that this loop tests; return how many, or NOT_CHECKED."""
    overlaps_out.hit[:] = False
    status, count = sweep_and_prune(poses.hulls, overlaps_out.tested, overlaps_out.sweep, overlaps_out.pairs)
    if status != CONVERGED:
        return NOT_CHECKED
    found = 0
    for k in range(count):
        a, b = overlaps_out.pairs[k, 0], overlaps_out.pairs[k, 1]
        if bodies_overlap(geo, poses, a, b, overlaps_out):
            overlaps_out.found[found, 0] = a
            overlaps_out.found[found, 1] = b
            overlaps_out.hit[a] = True
            overlaps_out.hit[b] = True
            found += 1
    return found


CANCELLED = SAME_DIRECTION
"""Relative to sum pd_i^2: a shorter sum of pd_i^2 n_i has no trustworthy direction. Smaller: rounding picks
the way out; larger: pieces that nearly oppose each other are given up too early."""


@kernel
def global_penetration_depth(depth: NDArray[np.float64], direction: Rows, count: int) -> tuple[int, Vec3]:
    """Return PD_g = sum_i(pd_i^2 n_i) / |sum_i pd_i| (eq. 1).

    Symbols: pd_i ``depth`` (count,) [m], at least 0; n_i ``direction`` (count, 3), unit, out of body B into
    body A.

    k equal pieces with one normal give exactly their depth; N orthogonal walls of equal depth give 1/N of the need along each, so
    the caller repeats; opposite normals cancel (Figure 4b).

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
    """Return the global penetration depth of bodies a and b: eq. 1 over every overlapping pair of their pieces.

    Args:
        vertices: (nv, 3) world coordinates [m].
        shape_start_of_body: (n_bodies + 1,) body k owns shapes start[k] .. start[k + 1].

    Returns:
        (status, PD_g, count): PD_g [m] moves a out of b; count overlapping piece pairs, whose depths and
        normals are in the scratch. Status: that of eq. 1, or the first of a piece pair that did not converge,
        in which case eq. 1 still holds the pairs found. OUT_OF_ROOM: more pairs than the scratch holds;
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


@kernel
def shares(role_a: int, role_b: int, must: bool) -> tuple[float, float]:
    """Return shares of PD_g by which A and B move apart; they add up to 1, or to 0 if neither may move.

    Bodies of one role move by half each (the rule under eq. 1). A driven body moves and a simulated one stays, unless ``must``:
    the driven one could not be freed, so the simulated one takes the rest.
    """
    if role_a == role_b:
        return (0.0, 0.0) if role_a == FIXED else (0.5, 0.5)
    if role_a == FIXED:
        return 0.0, 1.0
    if role_b == FIXED:
        return 1.0, 0.0
    return (1.0, 0.0) if (role_a == DRIVEN) != must else (0.0, 1.0)


STAY: Vec3 = (0.0, 0.0, 0.0)


@kernel
def lengthened(depth: Vec3, stand_off: float) -> Vec3:
    """Return ``depth`` made longer by ``stand_off`` [m] along itself; zero stays zero: it has no direction."""
    length = norm(depth)
    return scale(depth, 1.0 + stand_off / length) if length > 0.0 else depth


@kernel
def push_apart(
    geo: Geometry, poses: Poses, a: int, b: int, share_a: float, share_b: float, stand_off: float, scratch: Scratch
) -> tuple[int, Vec3, Vec3]:
    """Return translations [m] of bodies a and b that diminish their overlap: +share_a PD_g and -share_b PD_g, PD_g by eq. (1).

    PD_g is lengthened by ``stand_off``. One push clears two convex bodies; a corner between N equal walls of one body loses
    1/N of its depth, so the caller repeats. Returns (status of eq. 1, move of a, move of b); both stay where PD_g has no
    direction (CANCELLING) or cannot be had, and where nothing overlaps.
    """
    status, depth, count = global_depth(poses.vertices, geo.shapes, geo.first_shape, a, b, scratch)
    if count == 0 or status == CANCELLING or status == NOT_FINITE or status == OUT_OF_ROOM:
        return status, STAY, STAY
    depth = lengthened(depth, stand_off - rest_depth(geo.rest, a, b))
    return status, scale(depth, share_a), scale(depth, -share_b)
