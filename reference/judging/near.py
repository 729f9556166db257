"""Pairs of pieces near enough to be measured, for many states of the world at once."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Indices = NDArray[np.int64]
Flags = NDArray[np.bool_]

MAX_PAIRS = 3000
"""Pairs up to which all are compared in all states at once. Above, sorting along one axis finds first those that may meet."""

CROWD_AT_ONCE = 16
"""States of such a crowd that are sorted together: in more, boxes round all of them are wide and keep pairs that never meet."""

AT_ONCE = 1_000_000
"""Comparisons made in one go; more would fill memory and not be faster."""


class Near(NamedTuple):
    """k near pairs in order of their states: index of the state, of the first piece and of the second (k,) each."""

    state: Indices
    first: Indices
    second: Indices

    def at(self, rows: Indices | Flags) -> "Near":
        """Return some of them."""
        return Near(self.state[rows], self.first[rows], self.second[rows])


def near_pairs(may_meet: Flags, low: Array, high: Array, reach: float) -> Near:
    """Return for each of F states the pairs of p pieces that `may_meet` (p, p), each pair once, and whose boxes low, high (F, p,
    3) [m] come within `reach` [m]."""
    first, second = np.nonzero(np.triu(may_meet, 1))
    crowd = len(first) > MAX_PAIRS
    chunk = CROWD_AT_ONCE if crowd else max(1, AT_ONCE // max(1, len(first)))
    parts = [Near(*(np.zeros(0, dtype=np.int64),) * 3)]
    for start in range(0, len(low), chunk):
        # piece by piece in one line of memory each, so that a pair's states lie side by side
        lower, upper = (np.ascontiguousarray(box[start : start + chunk].transpose(2, 1, 0)) for box in (low, high + reach))
        # a box that is no number meets nothing, and hides no state in which it is one
        begins, ends = np.fmin.reduce(lower, axis=2), np.fmax.reduce(upper, axis=2)
        if crowd:
            first, second = by_sorting(may_meet, begins.T, ends.T)
        pairs = np.flatnonzero(((begins[:, first] <= ends[:, second]) & (begins[:, second] <= ends[:, first])).all(axis=0))
        near = np.ones((len(pairs), lower.shape[2]), dtype=bool)
        for along, end in zip(lower, upper, strict=True):
            one, other = first[pairs], second[pairs]
            near &= (along[one] <= end[other]) & (along[other] <= end[one])
            # most pairs are far apart along one axis in every state
            crowded = near.any(axis=1)
            pairs, near = pairs[crowded], near[crowded]
        state, row = np.nonzero(near.T)
        parts.append(Near(state + start, first[pairs[row]], second[pairs[row]]))
    return Near(*(np.concatenate(columns) for columns in zip(*parts, strict=True)))


def by_sorting(may_meet: Flags, low: Array, high: Array) -> tuple[Indices, Indices]:
    """Return pairs near each other in one state (p, 3): sweep along the axis on which the boxes are spread widest."""
    axis = int(np.argmax(np.ptp(low, axis=0)))
    order = np.argsort(low[:, axis], kind="stable")
    # in this order the partners of a piece are the next ones, up to the first that begins beyond its end
    ends = np.searchsorted(low[order, axis], high[order, axis], side="right")
    counts = np.maximum(ends - np.arange(len(order)) - 1, 0)
    first = np.repeat(np.arange(len(order)), counts)
    second = first + 1 + np.arange(len(first)) - np.repeat(np.cumsum(counts) - counts, counts)
    first, second = order[first], order[second]
    near = may_meet[first, second]
    for k in range(3):
        near &= (low[first, k] <= high[second, k]) & (low[second, k] <= high[first, k])
    return first[near], second[near]
