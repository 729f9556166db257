"""The path through the tree of the search, and short cuts in it: random detours are longer than they need be."""

from avatarsim.kernel import kernel
from avatarsim.posture.chain import draw
from avatarsim.posture.way_memory import AT, CUT_FROM, CUT_TO, CUTS, LAST, NODE, NODES_USED, REFUSED, WALKED, Way

MOST_CUTS = 6
"""Short cuts that are tried on a way that was found. Fewer: limbs wave about; more: the search takes longer than they spare."""

SHORT = 16
"""Nodes of a way, or of a part of one, that is not worth a short cut."""


@kernel
def trace(way_out: Way) -> None:
    """Write the nodes from the root of the tree to the present one into the path."""
    s = way_out
    length, k = 0, s.state[NODE]
    while k >= 0:
        length += 1
        k = s.before[k]
    s.state[LAST], s.state[AT], s.state[REFUSED], s.state[CUTS] = length - 1, 0, 0, 0
    k = s.state[NODE]
    for i in range(length):
        s.path[length - 1 - i] = k
        k = s.before[k]


@kernel
def choose_cut(way_out: Way) -> bool:
    """Choose places CUT_FROM and CUT_TO of the path between which a straight walk shall be tried; False: it stays as it is."""
    s = way_out
    last = s.state[LAST]
    if s.state[CUTS] >= MOST_CUTS or last < SHORT or s.state[NODES_USED] + last > s.before.shape[0]:
        return False
    s.state[CUTS] += 1
    s.state[CUT_FROM] = draw(s.random, last - SHORT + 1)
    s.state[CUT_TO] = s.state[CUT_FROM] + SHORT + draw(s.random, last - SHORT - s.state[CUT_FROM] + 1)
    return True


@kernel
def splice(way_out: Way) -> None:
    """Put the nodes of the present walk, which began at CUT_FROM, into the path in the place of those before CUT_TO."""
    s = way_out
    start, end, last, walked = s.state[CUT_FROM], s.state[CUT_TO], s.state[LAST], s.state[WALKED]
    for k in range(end, last + 1):
        s.spare[k] = s.path[k]
    k = s.state[NODE]
    for i in range(walked):
        s.path[start + walked - i] = k
        k = s.before[k]
    for k in range(end, last + 1):
        s.path[start + walked + 1 + k - end] = s.spare[k]
    s.state[LAST] = start + walked + 1 + last - end
