"""Hierarchical hash grid of the broad phase (Ericson 2005, chapter 7).

A box lies in one cell, that of its low corner, on the level whose cells are 2 to 8 times as long as the box. The cells of all
levels share one hash table with chaining.
"""

from math import frexp

import numpy as np
from numpy.typing import NDArray

from avatarsim.collide.sweep_memory import (
    AT,
    BEHIND,
    BEYOND,
    HIGHEST_USED,
    KEY,
    LEVEL,
    LEVELS,
    LOWEST,
    LOWEST_USED,
    NOWHERE,
    ON_LEVEL,
    SweepMemory,
)
from avatarsim.jit.kernel import kernel

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
    """The level of box b: lengths up to 2^(LOWEST + 2 level); BEYOND if it is too far away."""
    length, far = 0.0, 0.0
    for k in range(3):
        length = max(length, fat[b, k + 3] - fat[b, k])
        far = max(far, abs(fat[b, k]), abs(fat[b, k + 3]))
    if not (far < FARTHEST):
        return BEYOND
    # a hair more than its length, so that rounding never lets a box reach over half a cell
    power: int = frexp(length * (1.0 + 1e-9))[1]
    return max((power - LOWEST + 1) // 2, 0) if length > 0.0 else 0


@kernel
def half_cell(x: float, level: int) -> int:
    """Number of the half cell that x lies in on one axis: exact, as cells are powers of two long."""
    return int(np.floor(x * PER_METRE[level]))


@kernel
def key_of(x: int, y: int, z: int, level: int) -> int:
    """The cell x, y, z of a level as one number."""
    return (((level << AXIS_BITS | z & AXIS_MASK) << AXIS_BITS | y & AXIS_MASK) << AXIS_BITS) | x & AXIS_MASK


@kernel
def place_of(key: int, table: int) -> int:
    """Where the chain of a cell begins: neighbours along x lie side by side in memory. ``table``: a power of two."""
    row = ((key >> AXIS_BITS) * SPREAD) & POSITIVE
    return ((row >> 24) + key) & (table - 1)


@kernel
def unlink(memory: SweepMemory, b: int) -> None:
    """Take body b out of its cell, if it is in one."""
    body, head = memory.body, memory.head
    level = body[LEVEL, b]
    if level == NOWHERE:
        return
    after, before = body[BEHIND, b], body[AT, b]
    if before >= 0:
        body[BEHIND, before] = after
    else:
        head[-1 - before] = after
    if after >= 0:
        body[AT, after] = before
    memory.used[ON_LEVEL + level] -= 1
    body[LEVEL, b] = NOWHERE


@kernel
def link(memory: SweepMemory, b: int) -> None:
    """Put body b into the cell of its fat box, out of the one it is in."""
    body, head, fat = memory.body, memory.head, memory.fat
    table = head.shape[0] - 1
    level = level_of(fat, b)
    key, place = -1, table
    if level != BEYOND:
        key = key_of(half_cell(fat[b, 0], level) >> 1, half_cell(fat[b, 1], level) >> 1, half_cell(fat[b, 2], level) >> 1, level)
        place = place_of(key, table)
    if level == body[LEVEL, b] and key == body[KEY, b]:
        return
    unlink(memory, b)
    first = head[place]
    body[LEVEL, b], body[KEY, b], body[BEHIND, b], body[AT, b] = level, key, first, -1 - place
    if first >= 0:
        body[AT, first] = b
    head[place] = b
    memory.used[ON_LEVEL + level] += 1
    memory.used[LOWEST_USED] = min(memory.used[LOWEST_USED], level)
    memory.used[HIGHEST_USED] = max(memory.used[HIGHEST_USED], level)
