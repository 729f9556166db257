"""Simulation islands, connected components (union-find) of bodies that may meet before the frame ends, each with its own clock.

The island whose clock is farthest behind steps next, so events inside a frame are handled in order of time. A segment is carried
out at once and the state at its start is kept: if a body of another island comes near before its end, the island is rolled back
along its path to that time (timewarp: Mirtich 2000).
"""

from math import inf
from typing import Annotated, NamedTuple

import numpy as np
from numpy.typing import NDArray

from avatarsim.jit.kept import COUNT, COUNT_OR_NONE, FLAG, NOT_KEPT
from avatarsim.jit.kernel import kernel
from avatarsim.jit.layout import IndexGrid, IndexLine, Line, Vectors

Array = NDArray[np.float64]
Index = NDArray[np.int64]


class Islands(NamedTuple):
    """Groups of the nb bodies of a world; fixed and sleeping bodies belong to none and hold none together.

    found (1) how many; order (nb) members of island i at first[i] <= m < first[i + 1]; pairs (room, 2) near pairs, those of
    island i at pair_first[i] <= p < pair_first[i + 1]; label (nb) island of a body, -1 for none; mark (nb) working memory;
    charged (nb) number of the last segment of a body in this frame; spent (nb) segments that its island has spent of its budget;
    earliest (nb) of the island that a body leads, the number of the near pair that had the first event last;
    begun, due (nb) [s] since the frame began at which the last segment of a body began, and its present local time;
    linear, angular, received, owed_linear, owed_angular (nb, 3): state when it began; the pose is in `Memory.began`.
    linear_before, angular_before (nb, 3): the same velocities, but as they were before a substep changed them at once;
    at_once (nb) flag: a substep did, and the velocity at the end is another than that of the path.
    """

    found: Annotated[IndexLine, NOT_KEPT]
    order: Annotated[IndexLine, NOT_KEPT]
    first: Annotated[IndexLine, NOT_KEPT]
    pairs: Annotated[IndexGrid, NOT_KEPT]
    pair_first: Annotated[IndexLine, NOT_KEPT]
    label: Annotated[IndexLine, NOT_KEPT]
    mark: Annotated[IndexLine, NOT_KEPT]
    charged: Annotated[IndexLine, COUNT_OR_NONE]
    spent: Annotated[IndexLine, COUNT]
    earliest: Annotated[IndexLine, COUNT_OR_NONE]
    begun: Line
    due: Line
    linear: Vectors
    angular: Vectors
    received: Vectors
    owed_linear: Vectors
    owed_angular: Vectors
    linear_before: Vectors
    angular_before: Vectors
    at_once: Annotated[IndexLine, FLAG]


def make_islands(bodies: int, room: int) -> Islands:
    """Allocate for so many bodies and near pairs."""
    def whole(fill: int = 0) -> Index:
        return np.full(bodies, fill, np.int64)

    def vectors() -> Array:
        return np.zeros((bodies, 3))

    return Islands(
        found=np.zeros(1, np.int64), order=whole(), first=np.zeros(bodies + 1, np.int64), pairs=np.zeros((room, 2), np.int64),
        pair_first=np.zeros(bodies + 1, np.int64), label=whole(-1), mark=whole(), charged=whole(), spent=whole(),
        earliest=whole(-1), begun=np.zeros(bodies), due=np.zeros(bodies), linear=vectors(), angular=vectors(), received=vectors(),
        owed_linear=vectors(), owed_angular=vectors(), linear_before=vectors(), angular_before=vectors(), at_once=whole(),
    )


@kernel
def root_of(parent: Index, b: int) -> int:
    """Return the representative of the group of b (union-find with path halving)."""
    while parent[b] != b:
        parent[b] = parent[parent[b]]
        b = parent[b]
    return b


@kernel
def part(islands: Islands, near: Index, count: int, moving: Index, joins: Index, tied: Index) -> None:
    """Form the islands anew from ``count`` near pairs (count, 2).

    Args:
        moving: (nb) 1 for bodies that move. joins: (nb) 1 for bodies that connect others: moving or driven. tied: (nb) body that
            a body moves with, itself without any.
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
    for b in range(bodies):
        if tied[b] != b and moving[b] + moving[tied[b]] == 2:
            i, k = root_of(parent, b), root_of(parent, tied[b])
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
    """Return the earliest local time [s] of the members of island i."""
    earliest = inf
    for m in range(islands.first[i], islands.first[i + 1]):
        earliest = min(earliest, islands.due[islands.order[m]])
    return earliest


@kernel
def next_island(islands: Islands, dt: float, now: float, start: int) -> int:
    """Return the island with the earliest local time before ``dt``, searched from number ``start`` on; -1 if none is left.

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
