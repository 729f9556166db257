"""Bounds check of a posture solver's state that comes from bytes: may every place that it names be read and written?

Kernels look up what they themselves wrote without asking. Here is asked, once, what holds between numbers; what holds of a single
number stands in the ranges of `loops.ik_loop`.
"""

import numpy as np
from numpy.typing import NDArray

from avatarsim.ik.state import Avatars, IkState
from avatarsim.world.geometry import Geometry
from avatarsim.world.skeleton import Skeleton


def names_pieces(geo: Geometry, skel: Skeleton, pairs: NDArray[np.int64]) -> bool:
    """Whether every pair (k, 2) is a driven piece and a piece."""
    first, pieces = int(geo.first_shape[skel.first]), len(geo.body)
    driven, other = pairs[:, 0], pairs[:, 1]
    return bool(((driven >= first) & (driven < pieces) & (other >= 0) & (other < pieces)).all())


def state_is_sound(geo: Geometry, skel: Skeleton, avatars: Avatars, state: IkState) -> bool:
    """Whether all that the state names is there: pairs in contact, bodies in reach, islands."""
    for listed, room in ((state.contacts, len(state.contacts.pair)), (state.touching, len(state.touching.pair))):
        count = int(listed.used[0])
        if not 0 <= count <= room or not names_pieces(geo, skel, listed.pair[:count]):
            return False
    islands = state.tracking["island"]
    if not ((islands >= 0) & (islands <= np.arange(len(islands)))).all():
        return False
    return all(
        count <= len(row) and bool((row[:count] < skel.first).all())
        for row, count in zip(state.near, state.near_count.tolist(), strict=True)
    )
