"""Warm start of pairs: a hash table with open addressing of what is known of pairs of pieces (Knuth 1973, section 6.4).

Separating directions hardly change from step to step. The one that last held proves most pairs apart with two supports.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from avatarsim.jit.kernel import kernel
from avatarsim.jit.layout import IndexLine, Line, Vectors
from avatarsim.spatial.vec3 import Vec3, put_row, row

Array = NDArray[np.float64]
Index = NDArray[np.int64]

SLOTS_PER_PIECE = 32
"""Slots for each driven piece. A hand of 24 hinges has some ten near pairs a piece."""

PROBES = 8
"""Slots looked at for a pair; if all are taken the one unused for longest is given up, which costs a query and nothing else."""

EMPTY = -1


class PairCache(NamedTuple):
    """key (n) of the pair in a slot, or EMPTY; used (n) step in which it was last asked for; axis (n, 3) the direction that last
    held, out of the second piece into the first, zero if none has; axis_gap (n) its gap [m] at the shown state, right if
    axis_step (n) is the present one; normal (n, 3), gap (n) nearest direction and gap at the shown state, right if gap_step (n)
    is the present one; step (1): number of the present step; pieces (1): how many there are."""

    key: IndexLine
    used: IndexLine
    axis: Vectors
    axis_gap: Line
    axis_step: IndexLine
    normal: Vectors
    gap: Line
    gap_step: IndexLine
    step: IndexLine
    pieces: IndexLine


def make_pair_cache(driven: int, pieces: int) -> PairCache:
    """An empty table for so many driven pieces among all."""
    n = 64
    while n < SLOTS_PER_PIECE * driven:
        n *= 2
    return PairCache(
        np.full(n, EMPTY, dtype=np.int64), np.zeros(n, dtype=np.int64), np.zeros((n, 3)), np.zeros(n), np.full(n, -1,
        dtype=np.int64),
        np.zeros((n, 3)), np.zeros(n), np.full(n, -1, dtype=np.int64), np.zeros(1, dtype=np.int64),
        np.full(1, pieces, dtype=np.int64),
    )


@kernel
def slot_of(cache_out: PairCache, a: int, b: int) -> int:
    """The slot of a pair, made empty for it if it had none."""
    c = cache_out
    key, mask, now = a * c.pieces[0] + b, c.key.shape[0] - 1, c.step[0]
    # the golden ratio spreads neighbours, which scene files make of pieces that belong together
    place = ((key * 0x9E3779B1) >> 8) & mask
    oldest, found = now + 1, place
    for probe in range(PROBES):
        at = (place + probe) & mask
        if c.key[at] == key:
            c.used[at] = now
            return int(at)
        age = -1 if c.key[at] == EMPTY else c.used[at]
        if age < oldest:
            oldest, found = age, at
    c.key[found], c.used[found], c.axis_step[found], c.gap_step[found] = key, now, -1, -1
    put_row(c.axis, found, (0.0, 0.0, 0.0))
    return int(found)


@kernel
def axis_at(cache: PairCache, at: int) -> Vec3:
    """The direction that last held for the pair in a slot."""
    return row(cache.axis, at)


@kernel
def keep_axis(cache_out: PairCache, at: int, n: Vec3) -> None:
    """Keep n as the pair's direction; its gap at the shown state is not known yet."""
    put_row(cache_out.axis, at, n)
    cache_out.axis_step[at] = -1


@kernel
def forget_pairs(cache_out: PairCache) -> None:
    """Drop all that is known."""
    cache_out.key[:] = EMPTY
