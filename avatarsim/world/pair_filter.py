"""Pair filter: which pairs of bodies may collide, by a family per body and a sparse list of excluded pairs."""

from collections.abc import Iterable
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from avatarsim.jit.kernel import kernel
from avatarsim.jit.layout import IndexLine

Index = NDArray[np.int64]

OPEN: Final = -1
"""Family of bodies that may collide with bodies of any family."""


class PairFilter(NamedTuple):
    """For nb bodies and m pairs that never meet; memory is linear in both.

    family   (nb) two bodies of one family never meet, unless it is OPEN: all fixed bodies are one family
    first    (nb + 1) body i never meets never[first[i]] .. never[first[i + 1] - 1]
    never    (m) bodies k > i, in ascending order for each i: neighbours in a chain, the author's exclusions
    """

    family: IndexLine
    first: IndexLine
    never: IndexLine


def pair_filter(family: ArrayLike, skipped: Iterable[tuple[int, int]] = ()) -> PairFilter:
    """The filter of bodies with these families (nb) that also leaves out the pairs ``skipped``, in any order."""
    families = np.array(family, dtype=np.int64)
    known = sorted({(min(pair), max(pair)) for pair in skipped})
    pairs = np.array(known, dtype=np.int64).reshape(-1, 2)
    first = np.searchsorted(pairs[:, 0], np.arange(len(families) + 1)).astype(np.int64)
    return PairFilter(families, first, np.ascontiguousarray(pairs[:, 1]))


@kernel
def may_meet(wanted: PairFilter, a: int, b: int) -> bool:
    """Whether the pair of bodies a and b, in any order, is of interest. Logarithmic in the skipped pairs of one body."""
    if wanted.family[a] == wanted.family[b] and wanted.family[a] != OPEN:
        return False
    low, high = min(a, b), max(a, b)
    left, end = wanted.first[low], wanted.first[low + 1]
    right = end
    while left < right:
        middle = (left + right) // 2
        if wanted.never[middle] < high:
            left = middle + 1
        else:
            right = middle
    return not (left < end and wanted.never[left] == high)
