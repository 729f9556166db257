"""When the paths of an island first lead to an event."""

from math import inf

import numpy as np
from numpy.typing import NDArray

from avatarsim.kernel import kernel
from avatarsim.loops.upper_memory import SEARCHES, WORK, Memory
from avatarsim.motion.path import STILL
from avatarsim.motion.safe_step import earliest_touch
from avatarsim.motion.time_of_impact import (
    BROKEN,
    CLEAR,
    CREEP,
    DIP,
    FAR_OUT,
    LEAVING,
    RESTING,
    STAND_OFF,
    TOUCH,
    farthest,
    time_of_impact,
)
from avatarsim.spatial.vec3 import Vec3, along, dot, norm, row, sub
from avatarsim.world.geometry import Geometry

Index = NDArray[np.int64]

SEARCH_WORK = 8
"""Work of one search for an impact, see `upper_memory.WORK`."""


@kernel
def motion_of(memory: Memory, b: int, t: float) -> tuple[Vec3, Vec3, Vec3]:
    """Position, velocity and acceleration of the centre of body b, t seconds along its path."""
    if memory.paths.kind[b] == STILL:
        # whoever stands or has stopped is where it was last looked at
        return row(memory.trial.position, b), (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)
    x, v, a = row(memory.began.position, b), row(memory.islands.linear, b), row(memory.paths.linear, b)
    return along(along(x, t, v), 0.5 * t * t, a), along(v, t, a), a


@kernel
def out_of_reach(memory: Memory, a: int, b: int, begin: float, h: float) -> bool:
    """Whether a plane stays between the balls around two bodies from ``begin`` to h seconds, at right angles to where they are.

    Two bodies that are balls are out of reach already if they touch and do not come nearer: then what holds for the plane is what
    `time_of_impact` would find.
    """
    (x_a, v_a, a_a), (x_b, v_b, a_b) = motion_of(memory, a, begin), motion_of(memory, b, begin)
    d, left = sub(x_a, x_b), h - begin
    apart = norm(d)
    if not (apart > 0.0):
        return False
    speed, gain = dot(d, sub(v_a, v_b)) / apart, dot(d, sub(a_a, a_b)) / apart
    gap = apart - memory.span[a] - memory.span[b]
    if not (abs(gap) + abs(speed) + abs(gain) < inf):
        return False
    target = TOUCH
    if memory.ball[a] + memory.ball[b] == 2:
        target = max(STAND_OFF, FAR_OUT * farthest(memory.began, a, b))
        if gap < TOUCH and speed > LEAVING:
            target = min(target, gap)
        elif gap < TOUCH and speed > RESTING:
            target = min(DIP, gap - CREEP)
    return earliest_touch(gap - target, speed, gain, left) >= left and gap >= target


@kernel
def event_of_pair(geometry: Geometry, memory: Memory, a: int, b: int, begin: float, h: float) -> float:
    """Time in begin .. h of the first event of bodies a and b on their paths; inf if there is none, -1 if not finite."""
    islands, found = memory.islands, inf
    if memory.paths.kind[a] == STILL and memory.paths.kind[b] == STILL:
        return found
    if out_of_reach(memory, a, b, begin, h):
        return found
    for sa in range(geometry.first_shape[a], geometry.first_shape[a + 1]):
        for sb in range(geometry.first_shape[b], geometry.first_shape[b + 1]):
            memory.counts[SEARCHES] += 1
            memory.counts[WORK] += SEARCH_WORK
            outcome, t = time_of_impact(
                geometry, memory.began, islands.linear, islands.angular, memory.paths, memory.series, memory.reach, sa, sb, begin,
                h, memory.trial, memory.a_rows, memory.b_rows, memory.edges, memory.scratch,
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
