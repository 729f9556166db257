"""Query of the broad phase: boxes that overlap that of one body, from the grid cells around it, or from all if they are few."""

import numpy as np

from avatarsim.collide.cells import AXIS_MASK, Boxes, half_cell, key_of, place_of
from avatarsim.collide.sweep_memory import BEHIND, BEYOND, HIGHEST_USED, KEY, LEVELS, LOOKED, LOWEST_USED, ON_LEVEL, SweepMemory
from avatarsim.jit.kernel import kernel
from avatarsim.world.pair_filter import PairFilter, may_meet

FEW = 64
"""Up to so many bodies all are tested and no cells are kept. More: slower in scenes of some hundred; fewer: in small ones."""

LOOK = 3
"""Boxes in sequence that can be tested in the time of one cell."""

ALL = -1
"""In place of a key: all bodies of a chain, whatever their cells."""


@kernel
def boxes_meet(boxes: Boxes, i: int, j: int) -> bool:
    """Whether boxes i and j share a point; boxes that only touch do."""
    # `|` and not `or`: a mispredicted branch costs more than testing all three axes
    x = (boxes[i, 0] > boxes[j, 3]) | (boxes[j, 0] > boxes[i, 3])
    y = (boxes[i, 1] > boxes[j, 4]) | (boxes[j, 1] > boxes[i, 4])
    z = (boxes[i, 2] > boxes[j, 5]) | (boxes[j, 2] > boxes[i, 5])
    return not (x | y | z)


@kernel
def consider(boxes: Boxes, wanted: PairFilter, memory: SweepMemory, b: int, k: int, found: int) -> int:
    """Add the pair of b and k to the fresh ones if their boxes meet; returns how many were found by now.

    A pair of two bodies that both left is found twice, and taken once.
    """
    if boxes_meet(boxes, b, k) and k != b and (k > b or memory.known[k]) and may_meet(wanted, b, k):
        if found < memory.fresh.shape[0]:
            memory.fresh[found] = min(b, k) << 32 | max(b, k)
        return found + 1
    return found


@kernel
def first_cell(boxes: Boxes, b: int, axis: int, level: int) -> int:
    """First cell of a level, along one axis, in which the low corner of a box can lie that meets box b.

    Boxes of this level are less than half a cell long, so a low corner is at most one half cell below that of b.
    """
    return (half_cell(boxes[b, axis], level) - 1) >> 1


@kernel
def last_cell(boxes: Boxes, b: int, axis: int, level: int) -> int:
    """The last of these cells."""
    return half_cell(boxes[b, axis + 3], level) >> 1


@kernel
def cells_around(boxes: Boxes, memory: SweepMemory, b: int) -> float:
    """Number of cells that a query of box b visits; inf if there are more than keys can distinguish."""
    cells = 0.0
    for level in range(memory.used[LOWEST_USED], min(memory.used[HIGHEST_USED] + 1, LEVELS)):
        if memory.used[ON_LEVEL + level] > 0:
            block = 1.0
            for axis in range(3):
                # as floats: these numbers can be as large as they like
                across = float(last_cell(boxes, b, axis, level) - first_cell(boxes, b, axis, level) + 1)
                block = block * across if across < AXIS_MASK else np.inf
            cells += block
    return cells


@kernel
def partners(boxes: Boxes, wanted: PairFilter, memory: SweepMemory, b: int, found: int) -> int:
    """Add the pairs of body b to the ``found`` fresh ones; returns how many there are, whether they fit or not.

    ``boxes``: the fat boxes, or boxes inside them.
    """
    count = boxes.shape[0]
    if count <= FEW or not (LOOK * cells_around(boxes, memory, b) < count):
        for k in range(count):
            found = consider(boxes, wanted, memory, b, k, found)
        return found
    table, looked, many = memory.head.shape[0] - 1, memory.looked, 0
    for level in range(memory.used[LOWEST_USED], memory.used[HIGHEST_USED] + 1):
        if memory.used[ON_LEVEL + level] == 0:
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
            if memory.body[KEY, k] == key or key == ALL:
                found = consider(boxes, wanted, memory, b, k, found)
            k = memory.body[BEHIND, k]
    return found
