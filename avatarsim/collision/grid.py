"""Hierarchical hash grid of the broad phase (Ericson 2005, chapter 7).

A box lies in one cell, that of its low corner, on the level whose cells are 2 to 8 times as long as the box. The cells of all
levels share one hash table with chaining.

State of the broad phase between calls: fat AABBs, cells and candidate pairs.

Every body has a fat box, which holds its box and some room to move. As long as it does, the body's cell and the candidates, which
are the pairs of bodies whose fat boxes overlap, stay valid. The pairs that a call returns do not depend on this state.

Query of the broad phase: boxes that overlap that of one body, from the grid cells around it, or from all if they are few.
"""

from math import frexp
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from avatarsim.jit.kernel import kernel
from avatarsim.jit.layout import FlagLine, Grid, IndexGrid, IndexLine
from avatarsim.model.geometry import PairFilter, may_meet
from avatarsim.tolerances import NOTHING

Index = NDArray[np.int64]
Array = NDArray[np.float64]

LOWEST: Final = -20
"""Level 0 holds boxes up to 2^-20 m (1 micrometre) long, each further one 4 times as long ones; many smaller ones would share
cells."""

LEVELS: Final = 32
"""Levels of cells. A factor of 2 instead of 4 between them: twice as many cells to visit, fewer bodies in each."""

BEYOND: Final = LEVELS
"""The level of boxes that are too large or too far away for cells."""

NOWHERE: Final = -1
"""The level of a body that is in no cell."""

ROOM: Final = 3
"""Column of `SweepMemory.lead` for the room to move."""

LOOKED: Final = 32
"""Cells that are visited together. A box has 1 to 12 cells around it on its level; more are visited in portions."""


class SweepMemory(NamedTuple):
    """For nb bodies, about 150 bytes each, and ``room`` candidates, 16 bytes each.

    fat          (nb, 6) lowest and highest coordinates [m]; +inf, -inf for a body that has none yet
    lead         (nb, 4) by how much the fat box is wider than the box was, along each axis [m]: on the high side if positive,
                 else on the low one; then how much it may be, as a part of the box
    level, key   (nb) of the cell of each body; NOWHERE: in none
    next_of, at  (nb) the next body of its chain, -1 if none; the one before it, or -1 - place in the table
    born         (nb) sweep in which it got its fat box
    is_present   (nb) 1 if it is there
    listed       (nb) a list: the bodies that left their fat boxes in this sweep
    known        (nb) bodies that are there and whose candidates are known
    head         (2^k + 1) first body of every chain, -1 if none; the last is the chain of the BEYOND ones
    looked       (LOOKED, 2) cells that are being looked into: key, first body of the chain
    candidates   (room) pairs i < k whose fat boxes meet, as i << 32 | k, in ascending order
    fresh        (room) those found in this sweep
    found        (1) number of candidates
    sweep        (1) sweeps so far
    is_stale     (1) 1 if candidates of absent bodies are about
    calm         (1) the sweep from which on bodies may get more room to move
    lowest       (1) lowest level used so far, and highest (1) the highest one
    on_level     (LEVELS + 1) number of bodies on each level
    """

    fat: Grid
    lead: Grid
    level: IndexLine
    key: IndexLine
    next_of: IndexLine
    at: IndexLine
    born: IndexLine
    is_present: IndexLine
    listed: IndexLine
    known: FlagLine
    head: IndexLine
    looked: IndexGrid
    candidates: IndexLine
    fresh: IndexLine
    found: IndexLine
    sweep: IndexLine
    is_stale: IndexLine
    calm: IndexLine
    lowest: IndexLine
    highest: IndexLine
    on_level: IndexLine


def make_sweep_memory(count: int, room: int, present: bool = True) -> SweepMemory:
    """Return fresh memory for ``count`` bodies, all there or all absent, and ``room`` candidates."""
    table = 1 << max(count - 1, 1).bit_length()
    fat = np.tile([np.inf] * 3 + [-np.inf] * 3, (count, 1))
    lead = np.zeros((count, 4))
    lead[:, ROOM] = 0.5
    key, next_of, at, born, listed = (np.zeros(count, np.int64) for _ in range(5))
    found, sweep, is_stale, calm, highest = (np.zeros(1, np.int64) for _ in range(5))
    return SweepMemory(
        fat, lead, np.full(count, NOWHERE, np.int64), key, next_of, at, born, np.full(count, int(present), np.int64), listed,
        np.zeros(count, np.bool_), np.full(table + 1, -1), np.zeros((LOOKED, 2), np.int64), np.zeros(room, np.int64),
        np.zeros(room, np.int64), found, sweep, is_stale, calm, np.full(1, LEVELS + 1, np.int64), highest,
        np.zeros(LEVELS + 1, np.int64),
    )


Boxes = NDArray[np.float64]
"""(nb, 6): lowest x y z, highest x y z [m]."""

FARTHEST = 2.0**40
"""Boxes that reach beyond this [m] are in no cell but in one chain that every query searches. Larger: cell numbers of small boxes
no longer fit 64 bits."""

PER_METRE = 2.0 ** -(LOWEST + 2.0 * np.arange(LEVELS + 1.0))
"""Half cells per metre on each level."""

AXIS_BITS = 19
AXIS_MASK = (1 << AXIS_BITS) - 1
"""Bits of a cell number that the key keeps per axis. Cells that far apart share a key, which costs time and gives no wrong pair,
as long as one search does not span so many."""

SPREAD = 0x9E3779B97F4A7C1
POSITIVE = 2**62 - 1
"""Multiplier that spreads keys over the table; the bits that are the same whether integers wrap (compiled) or grow (Python)."""


@kernel
def level_of(fat: Boxes, b: int) -> int:
    """Return the level of box b: lengths up to 2^(LOWEST + 2 level); BEYOND if it is too far away."""
    length, far = 0.0, 0.0
    for k in range(3):
        length = max(length, fat[b, k + 3] - fat[b, k])
        far = max(far, abs(fat[b, k]), abs(fat[b, k + 3]))
    if not (far < FARTHEST):
        return BEYOND
    # a hair more than its length, so that rounding never lets a box reach over half a cell
    power: int = frexp(length * (1.0 + NOTHING))[1]
    return max((power - LOWEST + 1) // 2, 0) if length > 0.0 else 0


@kernel
def half_cell(x: float, level: int) -> int:
    """Return the number of the half cell that x lies in on one axis: exact, as cells are powers of two long."""
    return int(np.floor(x * PER_METRE[level]))


@kernel
def key_of(x: int, y: int, z: int, level: int) -> int:
    """Return the cell x, y, z of a level as one number."""
    return (((level << AXIS_BITS | z & AXIS_MASK) << AXIS_BITS | y & AXIS_MASK) << AXIS_BITS) | x & AXIS_MASK


@kernel
def place_of(key: int, table: int) -> int:
    """Return where the chain of a cell begins: neighbours along x are adjacent in memory. ``table``: a power of two."""
    row = ((key >> AXIS_BITS) * SPREAD) & POSITIVE
    return ((row >> 24) + key) & (table - 1)


@kernel
def unlink(memory: SweepMemory, b: int) -> None:
    """Take body b out of its cell, if it is in one."""
    head = memory.head
    level = memory.level[b]
    if level == NOWHERE:
        return
    after, before = memory.next_of[b], memory.at[b]
    if before >= 0:
        memory.next_of[before] = after
    else:
        head[-1 - before] = after
    if after >= 0:
        memory.at[after] = before
    memory.on_level[level] -= 1
    memory.level[b] = NOWHERE


@kernel
def link(memory: SweepMemory, b: int) -> None:
    """Put body b into the cell of its fat box, out of the one it is in."""
    head, fat = memory.head, memory.fat
    table = head.shape[0] - 1
    level = level_of(fat, b)
    key, place = -1, table
    if level != BEYOND:
        key = key_of(half_cell(fat[b, 0], level) >> 1, half_cell(fat[b, 1], level) >> 1, half_cell(fat[b, 2], level) >> 1, level)
        place = place_of(key, table)
    if level == memory.level[b] and key == memory.key[b]:
        return
    unlink(memory, b)
    first = head[place]
    memory.level[b], memory.key[b], memory.next_of[b], memory.at[b] = level, key, first, -1 - place
    if first >= 0:
        memory.at[first] = b
    head[place] = b
    memory.on_level[level] += 1
    memory.lowest[0] = min(memory.lowest[0], level)
    memory.highest[0] = max(memory.highest[0], level)


FEW = 64
"""Up to so many bodies all are tested and no cells are kept. More: slower in scenes of some hundred; fewer: in small ones."""

LOOK = 3
"""Boxes in sequence that can be tested in the time of one cell. Another: slower, with the same pairs."""

ALL = -1
"""In place of a key: all bodies of a chain, whatever their cells."""


@kernel
def boxes_meet(boxes: Boxes, i: int, j: int) -> bool:
    """Return True if boxes i and j share a point; boxes that only touch do."""
    # `|` and not `or`: a mispredicted branch costs more than testing all three axes
    x = (boxes[i, 0] > boxes[j, 3]) | (boxes[j, 0] > boxes[i, 3])
    y = (boxes[i, 1] > boxes[j, 4]) | (boxes[j, 1] > boxes[i, 4])
    z = (boxes[i, 2] > boxes[j, 5]) | (boxes[j, 2] > boxes[i, 5])
    return not (x | y | z)


@kernel
def consider(boxes: Boxes, wanted: PairFilter, memory: SweepMemory, b: int, k: int, found: int) -> int:
    """Add the pair of b and k to the fresh ones if their boxes meet; return how many were found so far.

    A pair of two bodies that both left is found twice, and taken once.
    """
    if boxes_meet(boxes, b, k) and k != b and (k > b or memory.known[k]) and may_meet(wanted, b, k):
        if found < memory.fresh.shape[0]:
            memory.fresh[found] = min(b, k) << 32 | max(b, k)
        return found + 1
    return found


@kernel
def first_cell(boxes: Boxes, b: int, axis: int, level: int) -> int:
    """Return the first cell of a level, along one axis, in which the low corner of a box can lie that meets box b.

    Boxes of this level are less than half a cell long, so a low corner is at most one half cell below that of b.
    """
    return (half_cell(boxes[b, axis], level) - 1) >> 1


@kernel
def last_cell(boxes: Boxes, b: int, axis: int, level: int) -> int:
    """Return the last of these cells."""
    return half_cell(boxes[b, axis + 3], level) >> 1


@kernel
def cells_around(boxes: Boxes, memory: SweepMemory, b: int) -> float:
    """Return the number of cells that a query of box b visits; inf if there are more than keys can distinguish."""
    cells = 0.0
    for level in range(memory.lowest[0], min(memory.highest[0] + 1, LEVELS)):
        if memory.on_level[level] > 0:
            block = 1.0
            for axis in range(3):
                # as floats: these numbers can be as large as they like
                across = float(last_cell(boxes, b, axis, level) - first_cell(boxes, b, axis, level) + 1)
                block = block * across if across < AXIS_MASK else np.inf
            cells += block
    return cells


@kernel
def partners(boxes: Boxes, wanted: PairFilter, memory: SweepMemory, b: int, found: int) -> int:
    """Add the pairs of body b to the ``found`` fresh ones; return how many there are, whether they fit or not.

    ``boxes``: the fat boxes, or boxes inside them.
    """
    count = boxes.shape[0]
    if count <= FEW or not (LOOK * cells_around(boxes, memory, b) < count):
        for k in range(count):
            found = consider(boxes, wanted, memory, b, k, found)
        return found
    table, looked, many = memory.head.shape[0] - 1, memory.looked, 0
    for level in range(memory.lowest[0], memory.highest[0] + 1):
        if memory.on_level[level] == 0:
            continue
        if level == BEYOND:
            looked[many, 0], looked[many, 1] = ALL, memory.head[table]
            many += 1
            break
        x0, x1 = first_cell(boxes, b, 0, level), last_cell(boxes, b, 0, level)
        y0, y1 = first_cell(boxes, b, 1, level), last_cell(boxes, b, 1, level)
        for z in range(first_cell(boxes, b, 2, level), last_cell(boxes, b, 2, level) + 1):
            for y in range(y0, y1 + 1):
                for x in range(x0, x1 + 1):
                    key = key_of(x, y, z, level)
                    looked[many, 0], looked[many, 1] = key, memory.head[place_of(key, table)]
                    many += 1
                    if many == LOOKED - 1:
                        found = look(boxes, wanted, memory, b, many, found)
                        many = 0
    return look(boxes, wanted, memory, b, many, found)


@kernel
def look(boxes: Boxes, wanted: PairFilter, memory: SweepMemory, b: int, many: int, found: int) -> int:
    """Add the pairs of body b with those in the ``many`` cells of ``memory.looked``.

    Separate from the look-up of the chains, so that the memory latencies of these overlap.
    """
    for c in range(many):
        key, k = memory.looked[c, 0], memory.looked[c, 1]
        while k >= 0:
            if memory.key[k] == key or key == ALL:
                found = consider(boxes, wanted, memory, b, k, found)
            k = memory.next_of[k]
    return found
