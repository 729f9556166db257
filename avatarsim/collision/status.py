"""Status codes of collision kernels. Every kernel that can fail returns one of these, and callers never drop it."""

from typing import Final

CONVERGED: Final = 0
"""The answer holds to the stated tolerance."""

OUT_OF_ITERATIONS: Final = 1
"""A cap was reached: the depth is an upper bound along the returned normal, so moving by it still
separates."""

DEGENERATE: Final = 2
"""Rounding stopped progress before the tolerance was met: the result is the best one seen."""

NOT_FINITE: Final = 3
"""A vertex is nan or infinite: nothing in the result may be used."""

CANCELLING: Final = 4
"""Eq. 1: the pieces push in opposite directions and their sum has no direction (the paper's Figure 4b)."""

OUT_OF_ROOM: Final = 5
"""More pairs were found than the caller's array can hold."""

NAMES: Final = {
    CONVERGED: "converged",
    OUT_OF_ITERATIONS: "out of iterations",
    DEGENERATE: "degenerate",
    NOT_FINITE: "not finite",
    CANCELLING: "cancelling",
    OUT_OF_ROOM: "out of room",
}
"""Text to print for each status."""
