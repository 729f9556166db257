"""What ends a frame when its budget is spent: one step without rebound, after which nobody looks for further impacts.

Everybody goes along its path to the end of the frame, or stops where it would meet somebody: who stops loses the rest of the
frame's time, and nobody else does. So the world goes on, nothing overlaps, and no energy is added.
"""

from math import inf

import numpy as np
from numpy.typing import NDArray

from avatarsim.kernel import kernel
from avatarsim.loops.blocked import LASTS, block
from avatarsim.loops.clocks import arrive
from avatarsim.loops.first_event import event_of_pair
from avatarsim.loops.upper_memory import BLOCKED, DONE, NOT_FINITE, STOPPED, WORK, Memory
from avatarsim.motion.path import FREE, HELD, STILL
from avatarsim.world.dynamics import Velocities
from avatarsim.world.geometry import Geometry, Poses

Index = NDArray[np.int64]


STALL = 1e-9
"""An event that comes earlier than this [s], of bodies that do not approach where they touch, means that they are blocked."""

AGAIN = -1
"""Outcome: nobody has moved, and there is more to be taken into account."""


@kernel
def clog(memory: Memory, a: int, b: int) -> bool:
    """Remember that bodies a and b are blocked; False if that was known."""
    new = block(memory.blocked, a, b, memory.frames[0])
    if new:
        memory.clogged[0] = memory.frames[0] + LASTS
        memory.counts[BLOCKED] += 1
    return new


@kernel
def stop(geometry: Geometry, poses: Poses, velocities: Velocities, memory: Memory, b: int, t: float) -> None:
    """Body b stays where it is at t, with the velocities that it has there."""
    arrive(geometry, poses, velocities, memory, b, t)
    memory.islands.stops[b] = t
    memory.paths.kind[b] = STILL
    memory.counts[STOPPED] += 1


@kernel
def go_or_stop(
    geometry: Geometry, poses: Poses, velocities: Velocities, memory: Memory, members: Index, pairs: Index, first: int, h: float
) -> int:
    """Take the members h seconds along their paths; who meets somebody stops there.

    Args:
        pairs: (count, 2) near pairs of the island, those from number ``first`` on of all.

    Returns:
        DONE, or NOT_FINITE, or AGAIN if somebody is blocked, which nobody knew: then nobody has moved.
    """
    kind, when, count, islands = memory.paths.kind, memory.when, pairs.shape[0], memory.islands
    for p in range(count):
        when[first + p] = event_of_pair(geometry, memory, pairs[p, 0], pairs[p, 1], 0.0, h)
        if when[first + p] < 0.0:
            return NOT_FINITE
    new = False
    for p in range(count):
        if when[first + p] < STALL and clog(memory, pairs[p, 0], pairs[p, 1]):
            new = True
    if new:
        return AGAIN
    next_, t = -1, h
    for p in range(count):
        if when[first + p] < t:
            next_, t = p, when[first + p]
    for _ in range(members.shape[0]):
        memory.counts[WORK] += count // 16
        if next_ < 0:
            break
        one, other, now = pairs[next_, 0], pairs[next_, 1], t
        for side in range(2):
            if kind[pairs[next_, side]] != STILL:
                stop(geometry, poses, velocities, memory, pairs[next_, side], now)
        next_, t = -1, h
        for p in range(count):
            a, b = pairs[p, 0], pairs[p, 1]
            if a == one or a == other or b == one or b == other:
                # of two that stand there is no event
                when[first + p] = event_of_pair(geometry, memory, a, b, now, h)
                if when[first + p] < 0.0:
                    return NOT_FINITE
            if when[first + p] < t:
                next_, t = p, when[first + p]
    for m in range(members.shape[0]):
        b = members[m]
        if islands.stops[b] < inf:
            kind[b] = HELD if memory.held[b] == 1 else FREE
        else:
            arrive(geometry, poses, velocities, memory, b, h)
    return DONE
