"""Inelastic fallback step: ends the frame of an island whose work budget is spent (budget fallback), without rebound.

Each body goes along its path to the end of the frame, or is stopped at its first time of impact, and then loses the rest of the
frame; the others go on. So time passes, nothing overlaps, and no energy is added.

Speculative contacts (Catto, Continuous Collision, GDC 2013) of balls in the inelastic fallback step.

A pair that would meet before the step ends is given to the contact solver with its gap: it may close the gap, and no more.
Without such contacts the step drives bodies into each other and stops them, and all bodies that touch them, where they meet.
For balls only: the corners of boxes meet at other points than predicted, and a struck stack would stop in the air more often.
"""

from math import inf

import numpy as np
from numpy.typing import NDArray

from avatarsim.collision.conservative_advancement import STAND_OFF
from avatarsim.collision.path import FREE, HELD, STILL
from avatarsim.collision.status import NOT_FINITE as QUERY_NOT_FINITE
from avatarsim.jit.kernel import kernel
from avatarsim.model.dynamics import DRIVEN, Dynamics, Velocities
from avatarsim.model.geometry import Geometry, Poses
from avatarsim.rigid.clocks import arrive
from avatarsim.rigid.contact_generation import BROKEN, FOUND, LASTS, NO_ROOM, block, find_points
from avatarsim.rigid.contacts import NOT_DRIVEN, axis, velocity_at
from avatarsim.rigid.first_event import event_of_pair, never_meet
from avatarsim.rigid.islands import NONE, build_tree, changed, next_of
from avatarsim.rigid.state import BLOCKED, DONE, NOT_FINITE, STOPPED, Memory
from avatarsim.spatial.vec3 import dot, norm, row, sub
from avatarsim.tolerances import NOTHING

Index = NDArray[np.int64]


@kernel
def look_ahead(
    geometry: Geometry, dynamics: Dynamics, poses: Poses, velocities: Velocities, pairs: Index, memory: Memory, h: float
) -> int:
    """Append to ``memory.contacts`` the points of near pairs (count, 2) of a ball that do not touch, but will within h seconds.

    Forces of the step are not known yet: one of two may fall while the other is held. Such points have no friction, since they do
    not touch yet. A pair for which there is no room is left out, and its bodies stop where they meet.

    Returns an outcome as `find_contacts` does.
    """
    contacts = memory.contacts
    touching, k = contacts.used[0], 0
    for p in range(pairs.shape[0]):
        a, b = pairs[p, 0], pairs[p, 1]
        if k < touching and contacts.body[k, 0] == a and contacts.body[k, 1] == b:
            while k < touching and contacts.body[k, 0] == a and contacts.body[k, 1] == b:
                k += 1
            continue
        if memory.ball[a] + memory.ball[b] == 0:
            continue
        if memory.moving[a] + memory.moving[b] == 0 or dynamics.role[a] == DRIVEN or dynamics.role[b] == DRIVEN:
            continue
        d = sub(row(poses.position, a), row(poses.position, b))
        pull = h * norm((dynamics.gravity[0], dynamics.gravity[1], dynamics.gravity[2]))
        v = sub(row(velocities.linear, a), row(velocities.linear, b))
        turns = spin(velocities, memory, a) + spin(velocities, memory, b)
        reach = h * (norm(v) + pull + turns)
        if memory.moving[a] == 1 and memory.moving[b] == 1:
            apart = norm(d)
            if apart - memory.span[a] - memory.span[b] > h * (turns + pull - dot(d, v) / apart):
                continue
        for sa in range(geometry.first_shape[a], geometry.first_shape[a + 1]):
            for sb in range(geometry.first_shape[b], geometry.first_shape[b + 1]):
                first = contacts.used[0]
                status, _, room = find_points(
                    geometry, dynamics, poses, velocities, memory, a, b, NOT_DRIVEN, sa, sb, reach + STAND_OFF
                )
                if status == QUERY_NOT_FINITE:
                    return BROKEN
                if not room:
                    return NO_ROOM
                if not meets(dynamics, velocities, memory, first, h):
                    contacts.used[0] = first
                for i in range(first, contacts.used[0]):
                    contacts.friction[i] = 0.0
    return FOUND


@kernel
def spin(velocities: Velocities, memory: Memory, b: int) -> float:
    """Largest velocity [m/s] of a point of body b about its centre of mass."""
    return float(norm(row(velocities.angular, b)) * memory.reach[b])


@kernel
def meets(dynamics: Dynamics, velocities: Velocities, memory: Memory, first: int, h: float) -> bool:
    """Whether the gap of any contact from ``first`` on may close within h seconds, also if only one of its bodies falls."""
    contacts = memory.contacts
    for k in range(first, contacts.used[0]):
        n, v, g = axis(contacts, k, 0), velocity_at(contacts, k, velocities.linear, velocities.angular), dynamics.gravity
        if contacts.gap[k] + h * (dot(n, v) - h * abs(dot(n, (g[0], g[1], g[2])))) < STAND_OFF:
            return True
    return False


@kernel
def of_balls(memory: Memory) -> bool:
    """Whether every contact is one of a ball, and none is one of a driven body."""
    contacts = memory.contacts
    for k in range(contacts.used[0]):
        if memory.ball[contacts.body[k, 0]] + memory.ball[contacts.body[k, 1]] == 0 or contacts.driven[k] != NOT_DRIVEN:
            return False
    return True


STALL = NOTHING
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
    build_tree(soonest, pairs, when)
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
