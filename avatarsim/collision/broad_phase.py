"""Broad phase (Algorithm 1, step 1): overlapping AABBs, from pairs that are cached while bodies stay in their fat AABBs.

Sorted list of pairs: heapsort of the new ones, then a merge.

Insertion and removal of bodies in the broad phase, in constant time: slots of fixed arrays are taken and freed.
"""

from math import inf

import numpy as np
from numpy.typing import NDArray

from avatarsim.collision.grid import (
    FARTHEST,
    FEW,
    ROOM,
    Boxes,
    SweepMemory,
    boxes_meet,
    link,
    partners,
    unlink,
)
from avatarsim.collision.status import CONVERGED, NOT_FINITE, OUT_OF_ROOM
from avatarsim.jit.by_reference import refer
from avatarsim.jit.kernel import kernel
from avatarsim.model.geometry import PairFilter, may_meet

Index = NDArray[np.int64]


@kernel
def sort_ascending(keys: Index, count: int) -> None:
    """Sort the first ``count`` keys in place by heapsort; lists of a few by insertion."""
    if count <= 16:
        for k in range(1, count):
            key, at = keys[k], k
            while at > 0 and keys[at - 1] > key:
                keys[at] = keys[at - 1]
                at -= 1
            keys[at] = key
        return
    for root in range(count // 2 - 1, -1, -1):
        sift_down(keys, root, count)
    for last in range(count - 1, 0, -1):
        keys[0], keys[last] = keys[last], keys[0]
        sift_down(keys, 0, last)


@kernel
def sift_down(keys: Index, root: int, count: int) -> None:
    """Let the key at ``root`` sink to its place in the heap of the first ``count`` keys."""
    key, at = keys[root], root
    while True:
        child = 2 * at + 1
        if child >= count:
            break
        if child + 1 < count and keys[child + 1] > keys[child]:
            child += 1
        if keys[child] <= key:
            break
        keys[at] = keys[child]
        at = child
    keys[at] = key


@kernel
def merge_ascending(keys: Index, count: int, fresh: Index, more: int) -> None:
    """Merge ``more`` ascending fresh keys into the first ``count`` of ``keys``, which has room for both."""
    left, right = count - 1, more - 1
    while right >= 0:
        if left >= 0 and keys[left] > fresh[right]:
            keys[left + right + 1] = keys[left]
            left -= 1
        else:
            keys[left + right + 1] = fresh[right]
            right -= 1


@kernel
def forget(memory: SweepMemory, b: int) -> None:
    """Drop the fat box of body b, so that the next broad phase searches its pairs anew: its pair filter has changed."""
    for k in range(3):
        memory.fat[b, k], memory.fat[b, 3 + k] = inf, -inf


@kernel
def insert(memory: SweepMemory, b: int) -> None:
    """Mark slot b as taken from the next broad phase on; no effect if it is already."""
    if memory.is_present[b] == 0:
        memory.is_present[b] = 1
        forget(memory, b)


@kernel
def remove(memory: SweepMemory, b: int) -> None:
    """Mark slot b as free from the next broad phase on, so that its box is not read; no effect if it is already."""
    if memory.is_present[b] == 1:
        unlink(memory, b)
        memory.is_present[b], memory.known[b] = 0, False
        memory.is_stale[0] = 1
        forget(memory, b)


__all__ = ["all_pairs", "boxes_meet", "forget", "sweep_and_prune"]

STAY = 128.0
"""A fat box has room for so many calls at the body's own speed, and up to twice that, by its number: else bodies that start to
move together would leave their boxes together. Larger: fewer searches, but more candidates for bodies that move."""

SLOW, SHARE = 2.0, 0.125
"""Factor on that room for slow bodies, up to this share of the most room that the body may have. Larger: more candidates;
smaller: bodies that tremble leave their boxes more often."""

TIGHT, WIDE = 0.5, 64.0
"""Limits of the room to move on one side, as parts of the box's length that way: so it takes the same share of candidates more on
any side, for slabs and rods too. It doubles when a body leaves its fat box and is LONELY in the next one, and halves when it is
in a CROWD: room costs candidates where bodies are many, and nothing where they are few."""

THIN = 1.0 / WIDE
"""A box counts as no thinner than this part of its length, so that one without thickness has room for its own length at most. 0:
a moving one is searched for in every sweep."""

LONELY, CROWD = 1, 4
"""Candidates found for a body: up to the one there is room to spare, from above the other on there is too much. Larger: more
candidates in crowds; smaller: more searches."""

PATIENCE = 1024
"""Calls during which no fat box is enlarged after the candidates did not fit. Fewer: fat boxes of a fast crowd grow and shrink
again and again, and each time the pairs of all bodies are searched twice."""

BACKWARD = 0.25
"""The room to move backward, as a part of that forward. Smaller: trembling bodies leave their boxes again and again."""

SECOND_HALF = 2**32 - 1


@kernel
def holds(fat: Boxes, boxes: Boxes, b: int) -> bool:
    """Return True if the fat box of body b holds its box; not if a bound is not finite."""
    # low <= high keeps out a low bound of +inf; `&` and not `and`: one branch for all nine
    inside = (boxes[b, 0] >= fat[b, 0]) & (boxes[b, 1] >= fat[b, 1]) & (boxes[b, 2] >= fat[b, 2])
    inside &= (boxes[b, 0] <= boxes[b, 3]) & (boxes[b, 1] <= boxes[b, 4]) & (boxes[b, 2] <= boxes[b, 5])
    inside &= (boxes[b, 3] <= fat[b, 3]) & (boxes[b, 4] <= fat[b, 4]) & (boxes[b, 5] <= fat[b, 5])
    return bool(inside)


@kernel
def find_leavers(boxes: Boxes, fat: Boxes, is_present: Index, listed_out: Index) -> int:
    """List the bodies that are no longer in their fat boxes; return how many, or -1 if a bound is not finite.

    Takes arrays and not the whole memory, since passing that takes as long as testing twenty boxes.
    """
    count = 0
    for b in range(boxes.shape[0]):
        if not holds(fat, boxes, b) and is_present[b] == 1:
            for k in range(6):
                if not (abs(boxes[b, k]) < inf):
                    return -1
            listed_out[count] = b
            count += 1
    return count


@kernel
def fatten(boxes: Boxes, memory: SweepMemory, b: int) -> None:
    """Make the fat box of body b anew, with room by its speed so far, mostly ahead; none for a new body, which may be at rest."""
    fat, lead = memory.fat, memory.lead
    sweeps = memory.sweep[0] - memory.born[b]
    memory.born[b] = memory.sweep[0]
    length, far = 0.0, 0.0
    for k in range(3):
        low, high = boxes[b, k], boxes[b, k + 3]
        length, far = max(length, high - low), max(far, abs(low), abs(high))
    room = lead[b, ROOM] if fat[b, 0] < inf and far < FARTHEST else 0.0
    stay = STAY * (1.0 + (b * 5 % 16) / 16.0) / max(sweeps, 1)
    for k in range(3):
        low, high = boxes[b, k], boxes[b, k + 3]
        margin, most = 0.0, room * max(high - low, THIN * length)
        if most > 0.0:
            # how far each face has come since the body got the box that it leaves now
            downwards = fat[b, k] - low + below(lead[b, k])
            upwards = high - fat[b, k + 3] + below(-lead[b, k])
            ahead = stay * max(downwards, upwards)
            # half of the last lead at least: a body that reverses its motion is slow for a moment only
            margin = min(max(ahead, min(SLOW * ahead, SHARE * most), 0.5 * abs(lead[b, k])), most)
            margin = margin if upwards > downwards else -margin
        lead[b, k] = margin
        fat[b, k], fat[b, k + 3] = min(low, high) - below(margin), max(low, high) + below(-margin)


@kernel
def below(lead: float) -> float:
    """Return by how much a fat box with this lead is wider on the low side; with the lead's sign changed: on the high side."""
    return -lead if lead < 0.0 else BACKWARD * lead


@kernel
def drop_candidates(memory: SweepMemory) -> int:
    """Keep only candidates of two known bodies; return how many."""
    kept = 0
    for c in range(memory.found[0]):
        key = memory.candidates[c]
        if memory.known[key >> 32] and memory.known[key & SECOND_HALF]:
            memory.candidates[kept] = key
            kept += 1
    return kept


@kernel
def renew_candidates(boxes: Boxes, wanted: PairFilter, memory: SweepMemory, leavers: int) -> bool:
    """Update the candidates of the bodies that left their fat boxes; False if there is no room for them."""
    for n in range(leavers):
        b = memory.listed[n]
        memory.known[b] = False
        fatten(boxes, memory, b)
        if boxes.shape[0] > FEW:
            link(memory, b)
    kept, fresh = drop_candidates(memory), 0
    for n in range(leavers):
        b, before = memory.listed[n], fresh
        fresh = partners(memory.fat, wanted, memory, b, fresh)
        if fresh - before <= LONELY and memory.sweep[0] >= memory.calm[0]:
            memory.lead[b, ROOM] = min(2.0 * memory.lead[b, ROOM], WIDE)
        elif fresh - before > CROWD:
            memory.lead[b, ROOM] = max(0.5 * memory.lead[b, ROOM], TIGHT)
    memory.found[0], memory.is_stale[0] = kept, 0
    fits: bool = kept + fresh <= memory.candidates.shape[0]
    if fits:
        sort_ascending(memory.fresh, fresh)
        merge_ascending(memory.candidates, kept, memory.fresh, fresh)
        memory.found[0] = kept + fresh
    for n in range(leavers):
        memory.known[memory.listed[n]] = True
    return fits


@kernel
def search_everything(boxes: Boxes, wanted: PairFilter, memory: SweepMemory, pairs_out: NDArray[np.int64]) -> tuple[int, int]:
    """Find all pairs without candidates, where these do not fit; the next call starts anew, with smaller fat boxes."""
    memory.found[0], memory.calm[0], found = 0, memory.sweep[0] + PATIENCE, 0
    memory.known[:] = False
    for b in range(boxes.shape[0]):
        if memory.is_present[b] == 1:
            found = partners(boxes, wanted, memory, b, found)
    written = min(found, memory.fresh.shape[0])
    sort_ascending(memory.fresh, written)
    for p in range(min(written, pairs_out.shape[0])):
        pairs_out[p, 0], pairs_out[p, 1] = memory.fresh[p] >> 32, memory.fresh[p] & SECOND_HALF
    for b in range(boxes.shape[0]):
        if memory.is_present[b] == 1:
            memory.lead[b, ROOM] = max(0.5 * memory.lead[b, ROOM], TIGHT)
            forget(memory, b)
    return (CONVERGED if found <= pairs_out.shape[0] else OUT_OF_ROOM), found


@kernel
def sweep_and_prune(boxes: Boxes, wanted: PairFilter, memory: SweepMemory, pairs_out: NDArray[np.int64]) -> tuple[int, int]:
    """Find all pairs of boxes that meet.

    The pairs depend on the boxes, the filter and the bodies present only, not on earlier calls. The cost is one test per box, one
    search per body that left its fat box, and one test per candidate.

    Args:
        boxes: (nb, 6) lowest and highest coordinates [m]; those of absent bodies are not read.
        wanted: pairs of interest. A change of it for a body must be followed by `forget` for that body.
        memory: of `make_sweep_memory`, kept by the caller from call to call, with at least as much room as ``pairs_out``.
        pairs_out: (cap, 2) the pairs, i < j, in ascending order of i, then of j.

    Returns:
        (status, count). OUT_OF_ROOM: count is the number found, of which cap were written.
        NOT_FINITE: a bound is nan or infinite, nothing was written.
    """
    wanted, memory = refer(wanted), refer(memory)
    leavers = find_leavers(boxes, memory.fat, memory.is_present, memory.listed)
    if leavers < 0:
        return NOT_FINITE, 0
    memory.sweep[0] += 1
    if leavers > 0 or memory.is_stale[0] > 0:
        if not renew_candidates(boxes, wanted, memory, leavers):
            return search_everything(boxes, wanted, memory, pairs_out)
    count = 0
    for c in range(memory.found[0]):
        key = memory.candidates[c]
        i, j = key >> 32, key & SECOND_HALF
        if boxes_meet(boxes, i, j):
            if count < pairs_out.shape[0]:
                pairs_out[count, 0], pairs_out[count, 1] = i, j
            count += 1
    return (CONVERGED if count <= pairs_out.shape[0] else OUT_OF_ROOM), count


@kernel
def all_pairs(boxes: Boxes, wanted: PairFilter, pairs_out: NDArray[np.int64]) -> tuple[int, int]:
    """Find the pairs of `sweep_and_prune` with all bodies present, as its reference: every pair is tested; the same order."""
    count = 0
    for i in range(boxes.shape[0]):
        for j in range(i + 1, boxes.shape[0]):
            if boxes_meet(boxes, i, j) and may_meet(wanted, i, j):
                if count < pairs_out.shape[0]:
                    pairs_out[count, 0], pairs_out[count, 1] = i, j
                count += 1
    return (CONVERGED if count <= pairs_out.shape[0] else OUT_OF_ROOM), count
