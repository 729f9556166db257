"""When the paths of an island first lead to an event."""

from math import inf, sqrt

import numpy as np
from numpy.typing import NDArray

from avatarsim.kernel import kernel
from avatarsim.loops.seams import depth_to_pass
from avatarsim.loops.upper_memory import SEARCHES, WORK, Memory
from avatarsim.motion.path import STILL
from avatarsim.motion.time_of_impact import BROKEN, CLEAR, IMPACT, TOUCH, UNKNOWN, time_of_impact
from avatarsim.spatial.vec3 import norm, row
from avatarsim.world.geometry import Geometry

Index = NDArray[np.int64]

SEARCH_WORK = 8
"""Work of one search for an impact, see `upper_memory.WORK`."""


@kernel
def out_of_reach(memory: Memory, a: int, b: int, h: float) -> bool:
    """Whether the balls around two bodies stay apart for h seconds, however far each goes on its path before it stops."""
    islands, apart = memory.islands, 0.0
    for i in range(3):
        d = memory.began.position[a, i] - memory.began.position[b, i]
        apart += d * d
    way = 0.0
    for body in (a, b):
        if memory.moving[body] == 1:
            way += h * (norm(row(islands.linear, body)) + 0.5 * h * norm(row(memory.paths.linear, body)))
    return bool(sqrt(apart) > memory.span[a] + memory.span[b] + way + TOUCH)


@kernel
def event_of_pair(geometry: Geometry, memory: Memory, a: int, b: int, begin: float, h: float) -> float:
    """Time in begin .. h of the first event of bodies a and b on their paths; inf if there is none, -1 if not finite."""
    islands, found, pace = memory.islands, inf, memory.contacts.pace[0]
    if memory.paths.kind[a] == STILL and memory.paths.kind[b] == STILL:
        return found
    if out_of_reach(memory, a, b, h):
        return found
    for sa in range(geometry.first_shape[a], geometry.first_shape[a + 1]):
        for sb in range(geometry.first_shape[b], geometry.first_shape[b + 1]):
            memory.counts[SEARCHES] += 1
            memory.counts[WORK] += SEARCH_WORK
            outcome, t = time_of_impact(
                geometry, memory.began, islands.linear, islands.angular, memory.paths, memory.series, memory.reach, sa, sb, begin,
                h, UNKNOWN, pace, memory.trial, memory.a_rows, memory.b_rows, memory.edges, memory.scratch,
            )
            depth = depth_to_pass(geometry, memory, sa, sb, h - t) if outcome == IMPACT else 0.0
            if depth < 0.0:
                outcome, t = time_of_impact(
                    geometry, memory.began, islands.linear, islands.angular, memory.paths, memory.series, memory.reach, sa, sb, t,
                    h, depth, pace, memory.trial, memory.a_rows, memory.b_rows, memory.edges, memory.scratch,
                )
            if outcome == BROKEN:
                return -1.0
            if outcome != CLEAR:
                h = found = t
    return found


@kernel
def first_event(geometry: Geometry, memory: Memory, pairs: Index, h: float) -> tuple[float, int]:
    """(time, pair) of the first event of any of these pairs (count, 2), at most h [s], with pair -1 if there is none before h.

    The time is -1 if a pose is not finite.
    """
    first = -1
    for p in range(pairs.shape[0]):
        t = event_of_pair(geometry, memory, pairs[p, 0], pairs[p, 1], 0.0, h)
        if t < 0.0:
            return -1.0, p
        if t < h:
            h, first = t, p
    return h, first
