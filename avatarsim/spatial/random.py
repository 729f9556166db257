"""Minimal standard generator of pseudo-random numbers (Park and Miller 1988), seeded: equal in compiled and in plain Python."""

from typing import Final

import numpy as np
from numpy.typing import NDArray

from avatarsim.jit.kernel import kernel

Index = NDArray[np.int64]

MULTIPLIER: Final = 48271
MODULUS: Final = 2**31 - 1
"""s <- 48271 s mod (2^31 - 1). Its products fit a 64-bit integer, so compiled and plain Python give the same numbers."""

WARM_UP: Final = 8
"""Draws thrown away after seeding: the first ones of small neighbouring seeds are nearly proportional to the seed."""


def seeded(seed: int) -> Index:
    """State (1,) of the generator; every seed that differs modulo 2^31 - 2 begins elsewhere."""
    state = np.array([1 + seed % (MODULUS - 1)], dtype=np.int64)
    for _ in range(WARM_UP):
        draw(state, 1)
    return state


@kernel
def draw(state_out: Index, below: int) -> int:
    """A whole number in 0 .. below - 1, as good as equally likely for small `below`."""
    state_out[0] = state_out[0] * MULTIPLIER % MODULUS
    return int(state_out[0] * below // MODULUS)
