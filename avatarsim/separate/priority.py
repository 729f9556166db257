"""Priority in separation: shares of the displacement of two overlapping bodies; fixed bodies none, driven before simulated."""

from avatarsim.jit.kernel import kernel
from avatarsim.world.dynamics import DRIVEN, FIXED


@kernel
def shares(role_a: int, role_b: int, must: bool) -> tuple[float, float]:
    """Shares of PD_g by which A and B move apart; they add up to 1, or to 0 if neither may move.

    Bodies of one role move by half each (the rule under eq. 1). A driven body moves and a simulated one stays, unless ``must``:
    the driven one could not be freed, so the simulated one takes all that is left.
    """
    if role_a == role_b:
        return (0.0, 0.0) if role_a == FIXED else (0.5, 0.5)
    if role_a == FIXED:
        return 0.0, 1.0
    if role_b == FIXED:
        return 1.0, 0.0
    return (1.0, 0.0) if (role_a == DRIVEN) != must else (0.0, 1.0)
