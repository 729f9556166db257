"""Bounds check of a posture solver's memory that comes from bytes: may every place that it names be read and written?

Kernels look up what they themselves wrote without asking. Here is asked, once, what holds between numbers; what holds of a single
number stands in the ranges of `loops.checked`. Nothing is said of whether the state is a likely one.
"""

import numpy as np
from numpy.typing import NDArray

from avatarsim.posture.way_memory import (
    AT,
    BLOCKED,
    BLOCKING,
    CUT_FROM,
    CUT_TO,
    LAST,
    LEAVES_USED,
    MODE,
    NODE,
    NODES_USED,
    PHASE,
    SEARCHING,
    WALKED,
    Way,
)
from avatarsim.posture.way_path import SHORT
from avatarsim.posture.way_search import AWAY_STEPS, HOME_STEPS, TO_NODE, TO_WAYPOINT
from avatarsim.posture.workspace import COUNT, FAILED, LISTED, NEARBY, Memory
from avatarsim.world.geometry import Geometry
from avatarsim.world.skeleton import Skeleton

Index = NDArray[np.int64]


def within(numbers: Index, least: int, below: int) -> bool:
    """Whether all numbers are at least `least` and below `below`."""
    return bool(((numbers >= least) & (numbers < below)).all())


def names_pieces(geo: Geometry, skel: Skeleton, pairs: Index) -> bool:
    """Whether every pair (k, 2) is a driven piece and a piece."""
    first, pieces = int(geo.first_shape[skel.first]), len(geo.body)
    return within(pairs[:, 0], first, pieces) and within(pairs[:, 1], 0, pieces)


def memory_is_sound(geo: Geometry, skel: Skeleton, memory: Memory) -> bool:
    """Whether all that the memory names is there: listed and failed pairs, near bodies, pieces or degrees of rows."""
    pairs, rows = memory.pairs, memory.rows
    marks, many = pairs.marks.tolist(), rows.size.item(COUNT)
    used = (marks[LISTED], len(pairs.listed)), (marks[FAILED], len(pairs.failed)), (marks[NEARBY], len(pairs.near))
    if not all(0 <= count <= room for count, room in (*used, *((size, len(rows.pair)) for size in rows.size.tolist()))):
        return False
    named, degrees = rows.pair[:many], int(skel.first_dof[-1])
    of_pieces = named[:, 0] >= 0
    return (
        names_pieces(geo, skel, pairs.listed[: marks[LISTED]]) and names_pieces(geo, skel, pairs.failed[: marks[FAILED]])
        and within(pairs.near[: marks[NEARBY]], 0, skel.first) and names_pieces(geo, skel, named[of_pieces])
        and within(named[~of_pieces, 1], 0, degrees)
    )


def way_is_sound(geo: Geometry, skel: Skeleton, way: Way) -> bool:
    """Whether the tree is one and has room for what is left of the walk under way, the path lies in it, and what was last in
    the way is there."""
    s, room = way.state.tolist(), len(way.before)
    used, node, walked, cut = s[NODES_USED], s[NODE], s[WALKED], s[CUT_TO] - s[CUT_FROM]
    if not (0 <= used <= room and 0 <= s[LEAVES_USED] <= len(way.leaves) and -1 <= node < max(used, 1)):
        return False
    # each node comes after the one that it was reached from: whoever goes back from any comes to the root
    if not (way.before[:used] < np.arange(used)).all() or not 0 <= s[AT] <= s[LAST] < room:
        return False
    if s[BLOCKING] != s[BLOCKED] and not names_pieces(geo, skel, np.array([[s[BLOCKING], s[BLOCKED]]])):
        return False
    if not 0 <= s[BLOCKING] < len(geo.body):
        return False
    if s[MODE] != SEARCHING or node < 0:
        return memory_is_sound(geo, skel, way.memory)
    if s[PHASE] == TO_NODE:
        walks = SHORT <= cut and 0 <= s[CUT_FROM] and s[CUT_TO] <= s[LAST] and 0 <= 2 * walked < cut
        left = cut - walked
    else:
        away = s[PHASE] == TO_WAYPOINT
        walks = 0 <= walked < (AWAY_STEPS if away else HOME_STEPS)
        left = (AWAY_STEPS + HOME_STEPS if away else HOME_STEPS) - walked
    return walks and used + left <= room and memory_is_sound(geo, skel, way.memory)
