"""State of the broad phase between calls: fat AABBs, cells and candidate pairs.

Every body has a fat box, which holds its box and some room to move. As long as it does, the body's cell and the candidates, which
are the pairs of bodies whose fat boxes overlap, stay valid. The pairs that a call returns do not depend on this state.
"""

from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from avatarsim.jit.layout import FlagLine, Grid, IndexGrid, IndexLine

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

LEVEL, KEY, BEHIND, AT, BORN, PRESENT, LISTED = range(7)
"""Rows of `SweepMemory.body`: level of its cell; key of its cell; the next body of its chain, -1 if none; the one before it,
or -1 - place in the table; the sweep in which it got its fat box; 1 if it is there. The last row is a list of its own:
the bodies that left their fat boxes in this sweep."""

CANDIDATES, SWEEP, STALE, CALM, LOWEST_USED, HIGHEST_USED, ON_LEVEL = range(7)
"""Places in `SweepMemory.used`: number of candidates; sweeps so far; 1 if candidates of absent bodies are about; the sweep from
which on bodies may get more room to move; the lowest and the highest level used so far; from here on the number of bodies on each
level."""

ROOM: Final = 3
"""Column of `SweepMemory.lead`: see there."""

LOOKED: Final = 32
"""Cells that are visited together. A box has 1 to 12 cells around it on its level; more are visited in portions."""


class SweepMemory(NamedTuple):
    """For nb bodies, about 150 bytes each, and ``room`` candidates, 16 bytes each.

    fat          (nb, 6) lowest and highest coordinates [m]; +inf, -inf for a body that has none yet
    lead         (nb, 4) by how much the fat box is wider than the box was, along each axis [m]: on the high side if positive,
                 else on the low one; then how much it may be, as a part of the box
    body         (7, nb) see LEVEL: one after the other in a row, as a search reads one or two of the rows for many bodies
    known        (nb) bodies that are there and whose candidates are known
    head         (2^k + 1) first body of every chain, -1 if none; the last is the chain of the BEYOND ones
    looked       (LOOKED, 2) cells that are being looked into: key, first body of the chain
    candidates   (room) pairs i < k whose fat boxes meet, as i << 32 | k, in ascending order
    fresh        (room) those found in this sweep
    used         (ON_LEVEL + LEVELS + 1) see CANDIDATES
    """

    fat: Grid
    lead: Grid
    body: IndexGrid
    known: FlagLine
    head: IndexLine
    looked: IndexGrid
    candidates: IndexLine
    fresh: IndexLine
    used: IndexLine


def make_sweep_memory(count: int, room: int, present: bool = True) -> SweepMemory:
    """Fresh memory for ``count`` bodies, all there or all absent, and ``room`` candidates."""
    table = 1 << max(count - 1, 1).bit_length()
    body = np.zeros((7, count), np.int64)
    body[LEVEL], body[PRESENT] = NOWHERE, int(present)
    fat = np.tile([np.inf] * 3 + [-np.inf] * 3, (count, 1))
    lead = np.zeros((count, 4))
    lead[:, ROOM] = 0.5
    used = np.zeros(ON_LEVEL + LEVELS + 1, np.int64)
    used[LOWEST_USED] = LEVELS + 1
    return SweepMemory(
        fat, lead, body, np.zeros(count, np.bool_), np.full(table + 1, -1), np.zeros((LOOKED, 2), np.int64),
        np.zeros(room, np.int64), np.zeros(room, np.int64), used,
    )
