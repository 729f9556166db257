"""Overlap test: sweep and prune over the bodies' boxes, then signed distances of pieces (Schmidl and Lin 2004, Algorithm 1).

Steps 1 and 2 of the algorithm. For every state that method `paper` shows `find_overlaps` returned 0: in each wanted pair of
bodies with at least one link the boxes of all pieces are apart or their signed distance is not negative. The motion between two
shown states is not tested: a body thinner than a frame's motion may be passed through, as the paper's conclusion says.
"""

from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from avatarsim.collide.scratch import Scratch, make_scratch
from avatarsim.collide.signed_distance import signed_distance_up_to
from avatarsim.collide.status import CONVERGED
from avatarsim.collide.sweep import boxes_meet, forget, sweep_and_prune
from avatarsim.collide.sweep_memory import SweepMemory, make_sweep_memory
from avatarsim.jit.kernel import kernel
from avatarsim.jit.layout import Cube, FlagLine, IndexGrid, IndexLine
from avatarsim.spatial.vec3 import put_row, row
from avatarsim.world.geometry import Geometry, Poses
from avatarsim.world.pair_filter import OPEN, PairFilter

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
ASKED, DOUBTED = 0, 1


class Overlaps(NamedTuple):
    """Memory of the search, for nb bodies of which the last are links, with D pieces of links among ns pieces.

    ours    pairs that this loop tests: wanted, and one of the two is a link (or a simulated body that was pushed)
    sweep   what sweep and prune keeps from call to call
    pairs   (cap, 2) pairs whose boxes meet, found (cap, 2) those that overlap
    hit     (nb) bodies that overlap another
    seed    (D, ns, 3) the last normal of each pair of pieces
    tally   (2) signed-distance queries since it was set to zero, and those that did not converge
    """

    ours: PairFilter
    sweep: SweepMemory
    pairs: IndexGrid
    found: IndexGrid
    hit: FlagLine
    seed: Cube
    tally: IndexLine
    scratch: Scratch


def make_overlaps(geo: Geometry, first_link: int) -> Overlaps:
    """Fresh memory; bodies from ``first_link`` on are links."""
    nb, ns = len(geo.first_shape) - 1, len(geo.body)
    family = geo.wanted.family.copy()
    family[:first_link] = OBSTACLE
    ours = PairFilter(family, geo.wanted.first.copy(), geo.wanted.never.copy())
    cap = (nb - first_link) * (nb + PAIRS_PER_LINK)
    return Overlaps(
        ours, make_sweep_memory(nb, cap + CANDIDATES_MORE * nb),
        np.zeros((cap, 2), dtype=np.int64), np.zeros((cap, 2), dtype=np.int64),
        np.zeros(nb, dtype=np.bool_), np.zeros((ns - int(geo.first_shape[first_link]), ns, 3)), np.zeros(2, dtype=np.int64),
        make_scratch(),
    )


@kernel
def answer_for(body: int, moved: bool, overlaps_out: Overlaps) -> None:
    """Add the pairs of a simulated body to those tested, because it was moved, or take them out again."""
    overlaps_out.ours.family[body] = OPEN if moved else OBSTACLE
    forget(overlaps_out.sweep, body)


@kernel
def pieces_overlap(geo: Geometry, poses: Poses, s: int, t: int, overlaps_out: Overlaps) -> bool:
    """Whether pieces s < t overlap: their signed distance is negative, or not a number."""
    if not boxes_meet(poses.boxes, s, t):
        return False
    remembered = t - (geo.body.shape[0] - overlaps_out.seed.shape[0])
    seed = NOTHING_KNOWN
    if remembered >= 0:
        seed = row(overlaps_out.seed[remembered], s)
    status, gap, n, _, _ = signed_distance_up_to(poses.vertices, geo.shapes, s, t, seed, 0.0, overlaps_out.scratch)
    overlaps_out.tally[ASKED] += 1
    if status != CONVERGED:
        overlaps_out.tally[DOUBTED] += 1
    if remembered >= 0:
        put_row(overlaps_out.seed[remembered], s, n)
    return not (gap >= 0.0)


@kernel
def bodies_overlap(geo: Geometry, poses: Poses, a: int, b: int, overlaps_out: Overlaps) -> bool:
    """Whether any piece of body a overlaps one of body b > a; stops at the first that does."""
    for s in range(geo.first_shape[a], geo.first_shape[a + 1]):
        for t in range(geo.first_shape[b], geo.first_shape[b + 1]):
            if pieces_overlap(geo, poses, s, t, overlaps_out):
                return True
    return False


@kernel
def find_overlaps(geo: Geometry, poses: Poses, overlaps_out: Overlaps) -> int:
    """Find every overlapping pair of those that this loop tests; return how many, or NOT_CHECKED."""
    overlaps_out.hit[:] = False
    status, count = sweep_and_prune(poses.hulls, overlaps_out.ours, overlaps_out.sweep, overlaps_out.pairs)
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
