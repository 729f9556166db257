"""Speculative contacts (Catto, Continuous Collision, GDC 2013) of balls in the inelastic fallback step.

A pair that would meet before the step ends is given to the contact solver with its gap: it may close the gap, and no more.
Without such contacts the step drives bodies into each other and stops them, and all bodies that touch them, where they meet.
For balls only: the corners of boxes meet at other points than predicted, and a struck stack would stop in the air more often.
"""

import numpy as np
from numpy.typing import NDArray

from avatarsim.collide.status import NOT_FINITE as QUERY_NOT_FINITE
from avatarsim.impact.contacts import NOT_DRIVEN, axis, velocity_at
from avatarsim.jit.kernel import kernel
from avatarsim.loops.touching import BROKEN, FOUND, NO_ROOM, find_points
from avatarsim.loops.upper_memory import Memory
from avatarsim.motion.time_of_impact import STAND_OFF
from avatarsim.spatial.vec3 import dot, norm, row, sub
from avatarsim.world.dynamics import DRIVEN, Dynamics, Velocities
from avatarsim.world.geometry import Geometry, Poses

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
