"""What sweep and prune keeps from call to call.

Every body has a fat box, which holds its box and some room to move. As long as it does, the body's cell and the candidates,
which are the pairs of bodies whose fat boxes meet, stay as they are. The pairs that a sweep finds do not depend on any of this.
"""

from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

Index = NDArray[np.int64]
Array = NDArray[np.float64]

LOWEST: Final = -20
"""Level 0 holds boxes up to 2^-20 m (1 micrometre) long; a crowd of smaller ones would crowd its cells."""

LEVELS: Final = 63
"""Levels of cells, each twice as long as the one before."""

BEYOND: Final = LEVELS
"""The level of boxes that are too large or too far away for cells."""

NOWHERE: Final = -1
"""The level of a body that is in no cell."""

LEVEL, KEY, BEHIND, AT, BORN, STATE, LISTED = range(7)
"""Columns of `SweepMemory.body`: level of its cell; key of its cell; the next body of its chain, -1 if none; the one before it,
or -1 - place in the table; the sweep in which it got its fat box; one of the states below. The last column is a list of its own:
the bodies that left their fat boxes in this sweep."""

ABSENT, KNOWN, LEFT = range(3)
"""A body that is not there; one whose candidates are known; one that left its fat box (or is new, or was forgotten)."""

CANDIDATES, SWEEP, STALE, ON_LEVEL = range(4)
"""Places in `SweepMemory.used`: number of candidates; sweeps so far; 1 if candidates of absent bodies are about; from here on
the number of bodies on each level."""

LOOKED: Final = 64
"""Cells that are looked into at once. A box has 8 to 27 cells around it on its level; more are looked into in portions."""


class SweepMemory(NamedTuple):
    """For nb bodies, about 150 bytes each, and ``room`` candidates, 16 bytes each.

    fat          (nb, 6) lowest and highest coordinates [m]; +inf, -inf for a body that has none yet
    lead         (nb, 3) by how much the fat box is wider than the box was [m]: on the high side if positive, else on the low one
    body         (nb, 7) see LEVEL
    head         (2^k + 1) first body of every chain, -1 if none; the last is the chain of the BEYOND ones
    looked       (LOOKED, 2) cells that are being looked into: key, first body of the chain
    candidates   (room) pairs i < k whose fat boxes meet, as i << 32 | k, in ascending order
    fresh        (room) those found in this sweep
    used         (ON_LEVEL + LEVELS + 1) see CANDIDATES
    """

    fat: Array
    lead: Array
    body: Index
    head: Index
    looked: Index
    candidates: Index
    fresh: Index
    used: Index


def make_sweep_memory(count: int, room: int, present: bool = True) -> SweepMemory:
    """Fresh memory for ``count`` bodies, all there or all absent, and ``room`` candidates."""
    table = 1 << max(count - 1, 1).bit_length()
    body = np.zeros((count, 7), np.int64)
    body[:, LEVEL], body[:, STATE] = NOWHERE, LEFT if present else ABSENT
    fat = np.tile([np.inf] * 3 + [-np.inf] * 3, (count, 1))
    return SweepMemory(
        fat, np.zeros((count, 3)), body, np.full(table + 1, -1), np.zeros((LOOKED, 2), np.int64), np.zeros(room, np.int64),
        np.zeros(room, np.int64), np.zeros(ON_LEVEL + LEVELS + 1, np.int64),
    )
