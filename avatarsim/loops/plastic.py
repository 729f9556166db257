"""Inelastic fallback step: ends the frame of an island whose work budget is spent (budget fallback), without rebound.

Each body goes along its path to the end of the frame, or is stopped at its first time of impact, and then loses the rest of the
frame; the others go on. So time passes, nothing overlaps, and no energy is added.
"""

from math import inf

import numpy as np
from numpy.typing import NDArray

from avatarsim.jit.kernel import kernel
from avatarsim.loops.balls_meet import never_meet
from avatarsim.loops.blocked import LASTS, block
from avatarsim.loops.clocks import arrive
from avatarsim.loops.first_event import event_of_pair
from avatarsim.loops.soonest import NONE, changed, line_up, next_of
from avatarsim.loops.upper_memory import BLOCKED, DONE, NOT_FINITE, STOPPED, Memory
from avatarsim.motion.path import FREE, HELD, STILL
from avatarsim.world.dynamics import Velocities
from avatarsim.world.geometry import Geometry, Poses

Index = NDArray[np.int64]


STALL = 1e-9
"""A pair is blocked if its event comes earlier than this [s] although its bodies do not approach at their contacts."""

AGAIN = -1
"""Outcome: no body was moved; the step is to be repeated, with the contacts of pairs found blocked."""


@kernel
def clog(memory: Memory, a: int, b: int) -> bool:
    """Record the pair of bodies a and b as blocked; False if it was already."""
    new = block(memory.blocked, a, b, memory.frames[0])
    if new:
        memory.clogged[0] = memory.frames[0] + LASTS
        memory.counts[BLOCKED] += 1
    return new


@kernel
def stop(geometry: Geometry, poses: Poses, velocities: Velocities, memory: Memory, b: int, t: float) -> None:
    """Stop body b at t on its path; it keeps the velocities that it has there."""
    arrive(geometry, poses, velocities, memory, b, t)
    memory.islands.stops[b] = t
    memory.paths.kind[b] = STILL
    memory.counts[STOPPED] += 1


@kernel
def go_or_stop(
    geometry: Geometry, poses: Poses, velocities: Velocities, memory: Memory, members: Index, pairs: Index, first: int, h: float
) -> int:
    """Take the members h seconds along their paths; both bodies of a pair that meets stop there.

    Args:
        pairs: (count, 2) near pairs of the island, those from number ``first`` on of all. Pairs that cannot meet wherever a body
            stops, which are most of them, get no event and are not searched again.

    Returns:
        DONE, or NOT_FINITE, or AGAIN if a pair is newly found blocked: then no body was moved.
    """
    kind, count, islands, soonest = memory.paths.kind, pairs.shape[0], memory.islands, memory.soonest
    when = memory.when[first : first + count]
    for p in range(count):
        when[p] = inf
        if not never_meet(memory, pairs[p, 0], pairs[p, 1], h):
            when[p] = min(h, event_of_pair(geometry, memory, pairs[p, 0], pairs[p, 1], 0.0, h))
        if when[p] < 0.0:
            return NOT_FINITE
    new = False
    for p in range(count):
        # balls have no corners that could block
        balls = memory.ball[pairs[p, 0]] + memory.ball[pairs[p, 1]] == 2
        if when[p] < STALL and not balls and clog(memory, pairs[p, 0], pairs[p, 1]):
            new = True
    if new:
        return AGAIN
    line_up(soonest, pairs, when)
    for _ in range(members.shape[0] if count > 0 else 0):
        next_ = soonest.tree[1]
        now = when[next_]
        if not (now < h):
            break
        one, other = pairs[next_, 0], pairs[next_, 1]
        one_moves, other_moves = kind[one] != STILL, kind[other] != STILL
        if one_moves:
            stop(geometry, poses, velocities, memory, one, now)
        if other_moves:
            stop(geometry, poses, velocities, memory, other, now)
        for side in range(2):
            b = one if side == 0 else other
            p = soonest.head[b] if (one_moves if side == 0 else other_moves) else NONE
            while p != NONE:
                # a pair of stopped bodies has no event
                when[p] = min(h, event_of_pair(geometry, memory, pairs[p, 0], pairs[p, 1], now, h))
                if when[p] < 0.0:
                    return NOT_FINITE
                changed(soonest, when, p, count)
                p = next_of(soonest, pairs, p, b)
    for m in range(members.shape[0]):
        b = members[m]
        if islands.stops[b] < inf:
            kind[b] = HELD if memory.held[b] == 1 else FREE
        else:
            arrive(geometry, poses, velocities, memory, b, h)
    return DONE
