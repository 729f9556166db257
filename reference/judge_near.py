"""Which pairs of pieces are near enough to be measured, for many states of the world at once."""

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Indices = NDArray[np.int64]
Flags = NDArray[np.bool_]
Pairs = tuple[Indices, Indices]

MOST_PAIRS = 3000
"""Pairs up to which all are compared in all states at once. Above, sorting along one axis, state by state, is faster."""

AT_ONCE = 1_000_000
"""Comparisons made in one go; more would fill memory and not be faster."""


def near_pairs(may_meet: Flags, low: Array, high: Array, reach: float) -> list[Pairs]:
    """For each of F states the pairs of p pieces that `may_meet` (p, p), each pair once, and whose boxes low, high (F, p, 3) [m]
    come within `reach` [m]."""
    first, second = np.nonzero(np.triu(may_meet, 1))
    if len(first) > MOST_PAIRS:
        return [by_sorting(may_meet, lower, upper, reach) for lower, upper in zip(low, high, strict=True)]
    found: list[Pairs] = []
    chunk = max(1, AT_ONCE // max(1, len(first)))
    for start in range(0, len(low), chunk):
        lower, upper = low[start : start + chunk], high[start : start + chunk] + reach
        near = np.ones((len(lower), len(first)), dtype=bool)
        for axis in range(3):
            near &= lower[:, first, axis] <= upper[:, second, axis]
            near &= lower[:, second, axis] <= upper[:, first, axis]
        found += [(first[row], second[row]) for row in near]
    return found


def by_sorting(may_meet: Flags, low: Array, high: Array, reach: float) -> Pairs:
    """The same for one state (p, 3): sweep along the axis on which the boxes are spread widest."""
    axis = int(np.argmax(np.ptp(low, axis=0)))
    order = np.argsort(low[:, axis], kind="stable")
    # in this order the partners of a piece are the next ones, up to the first that begins beyond its end
    ends = np.searchsorted(low[order, axis], high[order, axis] + reach, side="right")
    counts = np.maximum(ends - np.arange(len(order)) - 1, 0)
    first = np.repeat(np.arange(len(order)), counts)
    second = first + 1 + np.arange(len(first)) - np.repeat(np.cumsum(counts) - counts, counts)
    first, second = order[first], order[second]
    near = may_meet[first, second]
    for k in range(3):
        near &= (low[first, k] <= high[second, k] + reach) & (low[second, k] <= high[first, k] + reach)
    return first[near], second[near]
