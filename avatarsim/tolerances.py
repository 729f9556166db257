"""Ladder of the gaps that a posture keeps: shares of the one that it aims at."""

from avatarsim.kernel import kernel

LEAST_SHARE = 0.25
"""[stand-offs] gap that is accepted. Between it and the stand-off there is room for the curvature of a step and for the solver's
error: with a half, a fifth more rounds of corrections; it may not be 1."""

WEDGED_SHARE = 0.01
"""[stand-offs] gap to which a pair may go that is squeezed from two sides; 0 would let a wedged link never move again."""

assert 0.0 < WEDGED_SHARE < LEAST_SHARE < 1.0


@kernel
def least_gap(stand_off: float) -> float:
    """Gap [m] accepted of a pair whose step aims at `stand_off` [m]."""
    return LEAST_SHARE * stand_off


@kernel
def wedged_gap(stand_off: float) -> float:
    """Gap [m] accepted of a pair that is squeezed from two sides."""
    return WEDGED_SHARE * stand_off
