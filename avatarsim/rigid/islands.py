"""Simulation islands, connected components (union-find) of bodies that may meet before the frame ends, each with its own clock.

The island whose clock is farthest behind steps next, so events inside a frame are handled in order of time. A segment is carried
out at once and the state at its start is kept: if a body of another island comes near before its end, the island is rolled back
along its path to that time (timewarp: Mirtich 2000).
"""

from math import inf
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from avatarsim.jit.kernel import kernel
from avatarsim.jit.layout import IndexGrid, IndexLine, Line, Vectors

Array = NDArray[np.float64]
Index = NDArray[np.int64]


class Islands(NamedTuple):
    """Groups of the nb bodies of a world; fixed and sleeping bodies belong to none and hold none together.

    found (1) how many; order (nb) members of island i at first[i] <= m < first[i + 1]; pairs (room, 2) near pairs, those of
    island i at pair_first[i] <= p < pair_first[i + 1]; label (nb) island of a body, -1 for none; mark (nb) working memory;
    charged (nb) number of the last segment of a body in this frame; spent (nb) segments that its island has spent of its budget;
    late (nb) 1 for members of an island in which the fallback step stopped a body in the last frame;
    earliest (nb) of the island that a body leads, the number of the near pair that had the first event last;
    begun, due (nb) [s] since the frame began at which the last segment of a body began, and at which it stands now;
    stops (nb) [s] since then from which it stays where it is, inf if it goes on: see `rigid.budget_fallback`;
    linear, angular, received, owed_linear, owed_angular (nb, 3): state when it began; the pose is in `Memory.began`.
    linear_before, angular_before (nb, 3): the same velocities, but as they were before a fallback step changed them at once.
    """

    found: IndexLine
    order: IndexLine
    first: IndexLine
    pairs: IndexGrid
    pair_first: IndexLine
    label: IndexLine
    mark: IndexLine
    charged: IndexLine
    spent: IndexLine
    late: IndexLine
    earliest: IndexLine
    begun: Line
    due: Line
    stops: Line
    linear: Vectors
    angular: Vectors
    received: Vectors
    owed_linear: Vectors
    owed_angular: Vectors
    linear_before: Vectors
    angular_before: Vectors


def make_islands(bodies: int, room: int) -> Islands:
    """Allocate for so many bodies and near pairs."""
    n, vectors = bodies, (bodies, 3)
    return Islands(
        np.zeros(1, np.int64), np.zeros(n, np.int64), np.zeros(n + 1, np.int64), np.zeros((room, 2), np.int64),
        np.zeros(n + 1, np.int64), np.full(n, -1, np.int64), np.zeros(n, np.int64), np.zeros(n, np.int64), np.zeros(n, np.int64),
        np.zeros(n, np.int64), np.full(n, -1, np.int64), np.zeros(n),
        np.zeros(n), np.zeros(n), np.zeros(vectors), np.zeros(vectors), np.zeros(vectors), np.zeros(vectors), np.zeros(vectors),
        np.zeros(vectors), np.zeros(vectors),
    )


@kernel
def root_of(parent: Index, b: int) -> int:
    """Representative of the group of b (union-find with path halving)."""
    while parent[b] != b:
        parent[b] = parent[parent[b]]
        b = parent[b]
    return b


@kernel
def part(islands: Islands, near: Index, count: int, moving: Index, joins: Index) -> None:
    """Form the islands anew from ``count`` near pairs (count, 2).

    Args:
        moving: (nb) 1 for bodies that move. joins: (nb) 1 for bodies that connect others: moving or driven.
    """
    parent, label, first, order = islands.mark, islands.label, islands.first, islands.order
    bodies = parent.shape[0]
    for b in range(bodies):
        parent[b] = b
        label[b] = -1
    for p in range(count):
        a, b = near[p, 0], near[p, 1]
        if joins[a] == 1 and joins[b] == 1 and moving[a] + moving[b] > 0:
            i, k = root_of(parent, a), root_of(parent, b)
            # the lower number represents the group, so islands are numbered in the order of their first bodies
            parent[max(i, k)] = min(i, k)
    found = 0
    for b in range(bodies):
        if moving[b] == 1:
            root = root_of(parent, b)
            if label[root] < 0:
                label[root] = found
                found += 1
    islands.found[0] = found
    first[: found + 1] = 0
    for b in range(bodies):
        if joins[b] == 1:
            label[b] = label[root_of(parent, b)]
            if label[b] >= 0:
                first[label[b] + 1] += 1
    for i in range(found):
        first[i + 1] += first[i]
    at = islands.pair_first
    for i in range(found):
        at[i] = first[i]
    for b in range(bodies):
        if label[b] >= 0:
            order[at[label[b]]] = b
            at[label[b]] += 1
    share(islands, near, count, moving)


@kernel
def share(islands: Islands, near: Index, count: int, moving: Index) -> None:
    """Sort the near pairs with a moving body by island (stable counting sort)."""
    at, label, found = islands.pair_first, islands.label, islands.found[0]
    at[: found + 1] = 0
    for p in range(count):
        a, b = near[p, 0], near[p, 1]
        if moving[a] + moving[b] > 0:
            at[label[a if moving[a] == 1 else b] + 1] += 1
    for i in range(found):
        at[i + 1] += at[i]
    # fill from the back, so that each start ends where it was
    for p in range(count - 1, -1, -1):
        a, b = near[p, 0], near[p, 1]
        if moving[a] + moving[b] > 0:
            i = label[a if moving[a] == 1 else b]
            at[i + 1] -= 1
            islands.pairs[at[i + 1], 0], islands.pairs[at[i + 1], 1] = a, b
    total = 0
    for p in range(count):
        total += 1 if moving[near[p, 0]] + moving[near[p, 1]] > 0 else 0
    for i in range(found):
        at[i] = at[i + 1]
    at[found] = total


@kernel
def due_of(islands: Islands, i: int) -> float:
    """Earliest local time [s] of the members of island i."""
    earliest = inf
    for m in range(islands.first[i], islands.first[i + 1]):
        earliest = min(earliest, islands.due[islands.order[m]])
    return earliest


@kernel
def behind(islands: Islands, dt: float, now: float, start: int) -> int:
    """The island with the earliest local time before ``dt``, searched from number ``start`` on; -1 if none is left.

    No local time is before ``now`` [s], so the first island found at ``now`` is taken.
    """
    chosen, earliest, count = -1, dt, islands.found[0]
    for tried in range(count):
        i = start + tried if start + tried < count else start + tried - count
        due = islands.due[islands.order[islands.first[i]]]
        if due < earliest:
            chosen, earliest = i, due
            if due <= now:
                break
    return chosen


NONE = -1
"""In place of a pair: there is no other."""


# Event queue of the fallback step: tournament tree of near pairs by the time of their event, and a list of pairs per body.

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
def build_tree(soonest: Soonest, pairs: Index, when: Array) -> None:
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
