"""Earliest event of an island: the least time of impact over its near pairs, the likeliest pair searched first.

Pairs of balls have a closed form of their own, and pairs whose bounding balls stay apart no event.
"""

from math import inf

import numpy as np
from numpy.typing import NDArray

from avatarsim.collision.conservative_advancement import (
    BROKEN,
    CLEAR,
    CREEP,
    DIP,
    DIPPED,
    FAR_OUT,
    IMPACT,
    LEAVING,
    RESTING,
    ROUNDS,
    SPENT,
    STALLED,
    STAND_OFF,
    TOLERANCE,
    TOUCH,
    UNKNOWN,
    farthest,
    time_of_impact,
)
from avatarsim.collision.motion_bounds import earliest_touch
from avatarsim.collision.path import STILL
from avatarsim.jit.kernel import kernel
from avatarsim.model.geometry import Geometry
from avatarsim.rigid.internal_edges import depth_to_pass
from avatarsim.rigid.state import QUERY_WORK, SEARCHES, WORK, Memory
from avatarsim.spatial.vec3 import Vec3, along, dot, norm, row, sub


@kernel
def motion_of(memory: Memory, b: int, t: float) -> tuple[Vec3, Vec3, Vec3]:
    """Return the position, velocity and acceleration of the centre of body b, t seconds along its path."""
    if memory.paths.kind[b] == STILL:
        # a body at rest or stopped is at the pose of the last trial
        return row(memory.trial.position, b), (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)
    x, v, a = row(memory.began.position, b), row(memory.islands.linear, b), row(memory.paths.linear, b)
    return along(along(x, t, v), 0.5 * t * t, a), along(v, t, a), a


@kernel
def ahead_of(memory: Memory, a: int, b: int, t: float) -> tuple[float, float, float]:
    """Return the gap [m] of the bounding balls of bodies a and b at t, its rate [m/s] and acceleration [m/s^2] along the line of
    centres; nan or inf if any number is."""
    (x_a, v_a, a_a), (x_b, v_b, a_b) = motion_of(memory, a, t), motion_of(memory, b, t)
    d = sub(x_a, x_b)
    apart = norm(d)
    rate, gain = dot(d, sub(v_a, v_b)) / apart, dot(d, sub(a_a, a_b)) / apart
    return apart - memory.span[a] - memory.span[b], rate, gain


# Time of impact of two balls: conservative advancement (Mirtich 1996) on centres alone, since their rotation moves no surface.
# Also an early out for any two bodies: they cannot meet if their bounding balls do not.

@kernel
def balls_meet(memory: Memory, a: int, b: int, begin: float, h: float) -> tuple[int, float]:
    """Return the first event of two balls on their paths from ``begin`` to h seconds: (outcome, time) as of `time_of_impact`.

    The separating plane is fixed over a round, so the gap along its normal bounds the true one from below: each round advances to
    the zero of that bound, and two or three find the impact.
    """
    t, target, event = begin, max(STAND_OFF, FAR_OUT * farthest(memory.began, a, b)), IMPACT
    spin = norm(row(memory.islands.angular, a)) + norm(row(memory.islands.angular, b))
    for rounds in range(ROUNDS):
        gap, rate, gain = ahead_of(memory, a, b, t)
        if not (abs(gap) + abs(rate) + abs(gain) + spin < inf):
            return BROKEN, 0.0
        if rounds > 0 and gap <= target + TOLERANCE:
            return event, t
        if rounds == 0 and gap < TOUCH:
            if rate > LEAVING * memory.contacts.pace[0]:
                target = min(target, gap)
            elif rate > RESTING * memory.contacts.pace[0]:
                target, event = min(DIP, gap - CREEP), DIPPED
        step = earliest_touch(gap - target, rate, gain, h - t)
        if t + step >= h:
            return CLEAR, h
        if step < STALLED and rounds > 0:
            return event, t
        t += step
    return SPENT, t


Index = NDArray[np.int64]

SEARCH_WORK, ROUND_WORK = QUERY_WORK, 25
"""Work of one search for an impact, a query, and of each of its rounds after the first, see `state.WORK`. Most searches take five
rounds or none; of boxes that slide past each other's edges a hundred, and 300 such searches a frame take 35 ms. Less: frames of
such boxes take longer than the budget allows; more: they lose time."""


@kernel
def out_of_reach(memory: Memory, a: int, b: int, begin: float, h: float) -> bool:
    """Return True if a fixed plane separates the bounding balls of two bodies from ``begin`` to h seconds."""
    gap, rate, gain = ahead_of(memory, a, b, begin)
    if not (TOUCH < gap < inf and abs(rate) + abs(gain) < inf):
        return False
    return earliest_touch(gap - TOUCH, rate, gain, h - begin) >= h - begin


@kernel
def event_of_pair(geometry: Geometry, memory: Memory, a: int, b: int, begin: float, h: float) -> float:
    """Return the time in begin .. h of the first event of bodies a and b on their paths; inf without one, -1 if not finite."""
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
    """Return (time, pair) of the first event of these pairs (count, 2), at most h [s], with pair -1 if there is none before.

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
