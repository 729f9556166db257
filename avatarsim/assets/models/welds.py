"""Welds of MJCF that attach a loose body to a link or to a moving body."""

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from avatarsim.assets.models.compiled import Compiled, EqualityKind, ObjectKind
from avatarsim.spatial import rotation

Array = NDArray[np.float64]

SAME = 1e-4
"""Difference [m, and of half the angle, rad] up to which the pose of a weld equals that of the reference. Files give both in
a few digits. Larger: the body jumps at the start; smaller: welds of such files do not attach."""


def attaching_welds(
    model: Compiled, carried: Mapping[int, str], carrying: Mapping[int, str]
) -> dict[int, tuple[str, str]]:
    """Return names of loose bodies and of their carriers, by the number of the weld.

    carried   names of loose bodies, by their number
    carrying  names of links and moving bodies, by the number of their body

    The first weld of a body counts, and only one with the pose of the reference: others are left to the caller.
    """
    found: dict[int, tuple[str, str]] = {}
    welds = (model.eq_type == EqualityKind.WELD) & (model.eq_objtype == ObjectKind.BODY) & (model.eq_active0 != 0)
    for k in np.flatnonzero(welds).tolist():
        one, two = int(model.eq_obj1id[k]), int(model.eq_obj2id[k])
        for body, link in ((one, two), (two, one)):
            taken = carried.get(body) in [name for name, _ in found.values()]
            if body in carried and link in carrying and not taken and _holds_reference(model, k):
                found[k] = carried[body], carrying[link]
    return found


def _holds_reference(model: Compiled, k: int) -> bool:
    """Return True if the pose of weld `k` is that of the reference."""
    if not model.eq_data[k, 10] > 0.0:
        # turns are free
        return False
    (place, turn), (other_place, other_turn) = (model.pose(int(body)) for body in (model.eq_obj1id[k], model.eq_obj2id[k]))
    anchor, offset, relative = model.eq_data[k, :3], model.eq_data[k, 3:6], rotation.normalised(model.eq_data[k, 6:10])
    away = place + rotation.rotate(turn, offset) - other_place - rotation.rotate(other_turn, anchor)
    cosine = abs(float(np.dot(rotation.multiply(turn, relative), other_turn)))
    return float(np.linalg.norm(away)) <= SAME and 1.0 - cosine <= SAME**2
