"""Gaps at which the certificate accepts a step, as shares of the stand-off; see `avatarsim/tolerances.py`."""

from avatarsim.jit.kernel import kernel
from avatarsim.model.geometry import Geometry, allowed_depth
from avatarsim.tolerances import LEAST_SHARE, POSTURE_GAP, WEDGED_SHARE


@kernel
def stand_off_of(geo: Geometry, stand_off: float, a: int, b: int) -> float:
    """Return the gap [m] that the step of pieces a and b aims at: `stand_off`, or less where they are closer at home."""
    return min(stand_off, POSTURE_GAP) if allowed_depth(geo, a, b) > 0.0 else stand_off


@kernel
def least_gap(stand_off: float) -> float:
    """Return the gap [m] accepted of a pair whose step aims at `stand_off` [m]."""
    return LEAST_SHARE * stand_off


@kernel
def wedged_gap(stand_off: float) -> float:
    """Return the gap [m] accepted of a pair that is squeezed from two sides."""
    return WEDGED_SHARE * stand_off
