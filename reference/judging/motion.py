"""Bounds on a distance from one measured at another moment: a body that has moved a millimetre is at most a millimetre nearer.

Along any axis the gap between the shadows of two bodies changes by no more than their origins move against each other and
their points move by turning. So does the signed distance, which is the largest of these gaps, whether they overlap or not.
"""

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from reference.judging.geometry import Pieces
from reference.judging.near import Near

Array = NDArray[np.float64]
Indices = NDArray[np.int64]
Measure = Callable[[Near], Array]
"""Signed distances (k,) [m] of near pairs."""

STRIDES = (16, 4, 1)
"""Strides over the states in which a pair is near. A first stride of 64: the proofs are too weak for moving bodies; without one
of 4: fast bodies are measured in every state."""


class Moves:
    """Motion bounds of the pieces of a scene between the states placed at (F, p, 3) [m] and turned by (F, p, 3, 3)."""

    def __init__(self, pieces: Pieces, at: Array, turned: Array) -> None:
        self._centres = at + np.einsum("fpij,pj->fpi", turned, pieces.centres)
        self._turned, self._swings = turned, pieces.swings

    def between(self, near: Near, then: Indices) -> Array:
        """Return (k,) [m] most by which the signed distance of each near pair may differ from that in the state `then` (k,)."""
        now, a, b = near
        middles = self._centres[now, a] - self._centres[now, b] - self._centres[then, a] + self._centres[then, b]
        return np.asarray(np.linalg.norm(middles, axis=1) + self._turning(now, then, a) + self._turning(now, then, b))

    def _turning(self, now: Indices, then: Indices, piece: Indices) -> Array:
        """Return (k,) [m] most that a point of each piece moves when it turns about its middle: the spectral norm of the
        difference of two rotations is that of Frobenius by the root of 2."""
        moved = np.zeros(len(piece))
        # balls, of which there may be thousands, have nothing that turns
        k = np.flatnonzero(self._swings[piece])
        turns = self._turned[now[k], piece[k]] - self._turned[then[k], piece[k]]
        moved[k] = self._swings[piece[k]] * np.sqrt(0.5 * np.einsum("kij,kij->k", turns, turns))
        return moved


def where_deep(near: Near, moves: Moves, measure: Measure, deepest_only: bool) -> Array:
    """Return signed distances (k,) [m] of near pairs where they overlap; where not, a number that is not negative.

    With `deepest_only` only the least of all is right, and none is below it. Pairs without a distance are nan.
    """
    place, order, rank = _places(near)
    least, floor = np.full(len(order), -np.inf), 0.0
    for k, stride in enumerate(STRIDES):
        there = np.flatnonzero(place % stride == 0)
        if k:
            # those of the stride before are known already
            there = there[place[there] % STRIDES[k - 1] != 0]
            before = order[rank[there] - place[there] % STRIDES[k - 1]]
            least[there] = least[before] - moves.between(near.at(there), near.state[before])
        # non-finite ones are measured, too
        measured = there[~(least[there] >= floor)]
        least[measured] = measure(near.at(measured))
        if deepest_only and len(measured):
            floor = min(floor, float(np.min(least[measured])))
    return least


def _places(near: Near) -> tuple[Indices, Indices, Indices]:
    """Return each row's number (k,) among its pair's states; the rows pair by pair; and where among these each is."""
    order = np.lexsort((near.state, near.second, near.first))
    first, second = near.first[order], near.second[order]
    begins = np.flatnonzero(np.append(True, (first[1:] != first[:-1]) | (second[1:] != second[:-1]))[: len(order)])
    place, rank = np.empty_like(order), np.empty_like(order)
    rank[order] = np.arange(len(order))
    place[order] = np.arange(len(order)) - np.repeat(begins, np.diff(np.append(begins, len(order))))
    return place, order, rank
