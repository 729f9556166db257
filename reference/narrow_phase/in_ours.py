"""Our query as three contenders: within one compiled call, the same with the vertices placed on the way, and call by call."""

import numpy as np
from numpy.typing import NDArray

from reference.narrow_phase.cells import Mode, Sequence
from reference.narrow_phase.contender import Identity
from reference.narrow_phase.ours import Pairs, coherent_queries, cold_queries, place_pairs

Array = NDArray[np.float64]

WITHIN = Identity(
    "ours", "avatarsim", False, "all pairs of a frame in one compiled call, as the engine does it; world vertices given"
)
PLACED = Identity(
    "ours+place", "avatarsim", False, "the same, with the world vertices of both shapes computed within the time; the engine "
    "does this once per body and frame, however many pairs the body is in"
)
CALLED = Identity("ours/call", "avatarsim", True, "one call from Python per query; world vertices given")


class Ours:
    """All three: which one is the identity's matter."""

    def __init__(self, identity: Identity) -> None:
        self.identity = identity

    def load(self, sequence: Sequence, mode: Mode) -> None:
        """See Contender."""
        self._sequence, self._pairs = sequence, Pairs(sequence.shapes)
        self._query = cold_queries if mode == "cold" else coherent_queries

    load_call = load

    def begin(self) -> None:
        """See Contender."""
        self._pairs.forget()

    def pose(self, frame: int) -> None:
        """See Contender."""
        turns, at = self._sequence.turns[frame], self._sequence.at[frame]
        if self.identity is PLACED:
            self._pairs.pose(turns, at)
        else:
            self._pairs.place(turns, at)

    def ask(self) -> None:
        """See Contender."""
        words, count, query = self._pairs.words, self._pairs.count, self._query
        if self.identity is CALLED:
            for k in range(count):
                query(words, k, k + 1)
            return
        if self.identity is PLACED:
            place_pairs(words, 0, count)
        query(words, 0, count)

    def answers(self) -> Array:
        """See Contender."""
        return np.array(self._pairs.table.gaps)


def contenders() -> tuple[Ours, ...]:
    """All of them."""
    return Ours(WITHIN), Ours(PLACED), Ours(CALLED)
