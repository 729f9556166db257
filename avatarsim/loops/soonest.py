"""Event queue of the fallback step: tournament tree of near pairs by the time of their event, and a list of pairs per body."""

from math import inf
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from avatarsim.jit.kernel import kernel
from avatarsim.jit.layout import IndexGrid, IndexLine

Array = NDArray[np.float64]
Index = NDArray[np.int64]

NONE = -1
"""In place of a pair: there is no other."""


class Soonest(NamedTuple):
    """tree (2 room): of count pairs, node j holds the one of nodes 2 j and 2 j + 1 that is sooner, and pair p is node count + p;
    head (nb), after (room, 2): the first pair of a body, and the next one of the body on either side of a pair."""

    tree: IndexLine
    head: IndexLine
    after: IndexGrid


def make_soonest(bodies: int, room: int) -> Soonest:
    """Allocate for so many bodies and near pairs."""
    return Soonest(np.zeros(2 * room, np.int64), np.full(bodies, NONE, np.int64), np.full((room, 2), NONE, np.int64))


@kernel
def sooner(when: Array, p: int, q: int) -> int:
    """Of pairs p and q the one with the earlier time, or of two at once the one with the lower number."""
    return p if when[p] < when[q] or (when[p] == when[q] and p < q) else q


@kernel
def line_up(soonest: Soonest, pairs: Index, when: Array) -> None:
    """Build tree and lists from pairs (count, 2) and times (count) [s] of their events; a pair at inf is in no body's list."""
    tree, count = soonest.tree, pairs.shape[0]
    for p in range(count):
        tree[count + p] = p
        for side in range(2):
            soonest.head[pairs[p, side]] = NONE
    for j in range(count - 1, 0, -1):
        tree[j] = sooner(when, tree[2 * j], tree[2 * j + 1])
    for p in range(count - 1, -1, -1):
        for side in range(2 if when[p] < inf else 0):
            soonest.after[p, side] = soonest.head[pairs[p, side]]
            soonest.head[pairs[p, side]] = p


@kernel
def changed(soonest: Soonest, when: Array, p: int, count: int) -> None:
    """Update the tree after the time of pair p of ``count`` has changed."""
    j = (count + p) // 2
    while j > 0:
        soonest.tree[j] = sooner(when, soonest.tree[2 * j], soonest.tree[2 * j + 1])
        j //= 2


@kernel
def next_of(soonest: Soonest, pairs: Index, p: int, b: int) -> int:
    """The pair of body b after pair p; NONE if that was the last."""
    return int(soonest.after[p, 0] if pairs[p, 0] == b else soonest.after[p, 1])
