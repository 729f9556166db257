"""Earliest event of an island: the least time of impact over its near pairs, the likeliest pair searched first."""

from math import inf

import numpy as np
from numpy.typing import NDArray

from avatarsim.jit.kernel import kernel
from avatarsim.loops.balls_meet import ahead_of, balls_meet
from avatarsim.loops.seams import depth_to_pass
from avatarsim.loops.upper_memory import SEARCHES, WORK, Memory
from avatarsim.motion.path import STILL
from avatarsim.motion.safe_step import earliest_touch
from avatarsim.motion.time_of_impact import BROKEN, CLEAR, IMPACT, TOUCH, UNKNOWN, time_of_impact
from avatarsim.world.geometry import Geometry

Index = NDArray[np.int64]

SEARCH_WORK, ROUND_WORK = 8, 25
"""Work of one search for an impact, and of each of its rounds after the first, see `upper_memory.WORK`. Most searches take five
rounds or none; of boxes that slide past each other's edges a hundred, and 300 such searches a frame take 35 ms."""


@kernel
def out_of_reach(memory: Memory, a: int, b: int, begin: float, h: float) -> bool:
    """Whether a fixed plane separates the bounding balls of two bodies from ``begin`` to h seconds."""
    gap, rate, gain = ahead_of(memory, a, b, begin)
    if not (TOUCH < gap < inf and abs(rate) + abs(gain) < inf):
        return False
    return earliest_touch(gap - TOUCH, rate, gain, h - begin) >= h - begin


@kernel
def event_of_pair(geometry: Geometry, memory: Memory, a: int, b: int, begin: float, h: float) -> float:
    """Time in begin .. h of the first event of bodies a and b on their paths; inf if there is none, -1 if not finite."""
    islands, found, pace = memory.islands, inf, memory.contacts.pace[0]
    if memory.paths.kind[a] == STILL and memory.paths.kind[b] == STILL:
        return found
    if memory.ball[a] + memory.ball[b] == 2:
        memory.counts[SEARCHES] += 1
        memory.counts[WORK] += 1
        outcome, t = balls_meet(memory, a, b, begin, h)
        return -1.0 if outcome == BROKEN else t if outcome != CLEAR else found
    if out_of_reach(memory, a, b, begin, h):
        return found
    for sa in range(geometry.first_shape[a], geometry.first_shape[a + 1]):
        for sb in range(geometry.first_shape[b], geometry.first_shape[b + 1]):
            memory.counts[SEARCHES] += 1
            memory.counts[WORK] += SEARCH_WORK
            outcome, t, rounds = time_of_impact(
                geometry, memory.began, islands.linear, islands.angular, memory.paths, memory.series, memory.reach, sa, sb, begin,
                h, UNKNOWN, pace, memory.trial, memory.a_rows, memory.b_rows, memory.edges, memory.scratch,
            )
            memory.counts[WORK] += ROUND_WORK * (rounds - 1)
            depth = depth_to_pass(geometry, memory, sa, sb, h - t) if outcome == IMPACT else 0.0
            if depth < 0.0:
                outcome, t, rounds = time_of_impact(
                    geometry, memory.began, islands.linear, islands.angular, memory.paths, memory.series, memory.reach, sa, sb, t,
                    h, depth, pace, memory.trial, memory.a_rows, memory.b_rows, memory.edges, memory.scratch,
                )
                memory.counts[WORK] += ROUND_WORK * (rounds - 1)
            if outcome == BROKEN:
                return -1.0
            if outcome != CLEAR:
                h = found = t
    return found


@kernel
def first_event(geometry: Geometry, memory: Memory, pairs: Index, h: float, likely: int) -> tuple[float, int]:
    """(time, pair) of the first event of any of these pairs (count, 2), at most h [s], with pair -1 if there is none before h.

    The time is -1 if a pose is not finite. Pair ``likely``, if there is one of that number, is searched first: an early event
    shortens the search of all other pairs.
    """
    first, count = -1, pairs.shape[0]
    ahead = likely if 0 <= likely < count else 0
    for q in range(count):
        # the likely one, then the others in their order
        p = ahead if q == 0 else q - 1 if q <= ahead else q
        t = event_of_pair(geometry, memory, pairs[p, 0], pairs[p, 1], 0.0, h)
        if t < 0.0:
            return -1.0, p
        if t < h:
            h, first = t, p
    return h, first
