"""Gaps at which the certificate accepts a step, as shares of the stand-off; see `avatarsim/tolerances.py`."""

from avatarsim.jit.kernel import kernel
from avatarsim.tolerances import LEAST_SHARE, WEDGED_SHARE


@kernel
def least_gap(stand_off: float) -> float:
    """Gap [m] accepted of a pair whose step aims at `stand_off` [m]."""
    return LEAST_SHARE * stand_off


@kernel
def wedged_gap(stand_off: float) -> float:
    """Gap [m] accepted of a pair that is squeezed from two sides."""
    return WEDGED_SHARE * stand_off
