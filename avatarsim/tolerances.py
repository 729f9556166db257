"""Ladders of tolerances: what rounding leaves, and the gaps that a posture keeps, which are shares of the one that it aims at."""

from avatarsim.jit.kernel import kernel

GRAIN = 1e-14
"""[a share, m, or rad] what a few products may be off by in double precision, some fifty roundings."""

ROUNDING = 100.0 * GRAIN
"""[m, or a share] what sums of a frame's products may be off by, a hundred times over."""

NOTHING = 1e-9
"""[m, rad, their rates, s, or a share] far below what is shown or judged (1e-6 m), and far above rounding: an overlap of a start,
an excess, an offset or a difference that is taken for none."""

PROOF = NOTHING / 10.0
"""[a share, rad, or m/s] what a proof may leave open. Larger: wrong answers by as much; smaller: rounding decides."""

SAME_DIRECTION = 1e-6
"""Sine of the angle below which two directions count as one, and share below which a sum of directions has none."""

REGULAR = NOTHING
"""Share of its own by which the diagonal of a Gram matrix is raised (Tikhonov): rows that say the same then share the load, and a
row without any lever divides by something. 1e-6: the certificate sees what they leave open."""

assert 0.0 < GRAIN < ROUNDING < PROOF < NOTHING < SAME_DIRECTION

LEAST_SHARE = 0.25
"""[stand-offs] gap that is accepted. Between it and the stand-off there is room for the curvature of a step and for the solver's
error; it may not be 1. The share is that of the settings which it replaces, and was not tuned anew."""

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
