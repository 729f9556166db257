"""Pairs of bodies that may meet, as memberships and masks of 32 bits, the form that game engines take."""

import numpy as np
from numpy.typing import NDArray

BITS = 32
"""Groups that a mask of 32 bits can name."""


def collision_groups(meets: NDArray[np.bool_]) -> list[tuple[int, int]] | None:
    """Return (membership, mask) of each body, so that two meet exactly where `meets` (n, n) is True; None where 32 groups are
    too few.

    Bodies share a group if they meet the same others, and if either all of the group meet one another or none do.
    """
    n = len(meets)
    groups: list[list[int]] = []
    for k in range(n):
        for group in groups:
            others = np.ones(n, dtype=np.bool_)
            others[[*group, k]] = False
            inside = meets[np.ix_([*group, k], [*group, k])][~np.eye(len(group) + 1, dtype=np.bool_)]
            if (meets[k, others] == meets[group[0], others]).all() and (inside.all() or not inside.any()):
                group.append(k)
                break
        else:
            groups.append([k])
    if len(groups) > BITS:
        return None
    masks = [(0, 0)] * n
    for at, group in enumerate(groups):
        mask = sum(1 << other for other, members in enumerate(groups) if meets[group[0], members[-1]])
        for k in group:
            masks[k] = (1 << at, mask)
    return masks
