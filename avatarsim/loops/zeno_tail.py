"""Closed-form tail of a Zeno sequence: the infinitely many last bounces of a ball, too low to be told apart from rest.

After an impact from which a ball rebounds with v, too slowly to leave its stand-off, all flights to come take 2 v / (g (1 - e))
together. For that long it lies where it is, with the speed v of its last rebound; then it is at rest.
"""

import numpy as np
from numpy.typing import NDArray

from avatarsim.impact.contacts import Contacts, axis
from avatarsim.impact.events import APPROACH, IMPACT, Events
from avatarsim.impact.impact_queue import REST_SPEED
from avatarsim.impact.relative_velocity import velocity_after
from avatarsim.jit.kernel import kernel
from avatarsim.loops.clocks import witness
from avatarsim.loops.upper_memory import Memory
from avatarsim.spatial.vec3 import add, dot, put_row, row, scale
from avatarsim.world.dynamics import Dynamics, Velocities
from avatarsim.world.geometry import Geometry, Poses

Array = NDArray[np.float64]
Index = NDArray[np.int64]

NONE = -1.0
"""End of the tail [s] of a body that has none."""


@kernel
def tail_lasts(restitution: float, rebound: float, pull: float) -> float:
    """Sum of all flights [s] that begin with ``rebound`` [m/s] under the acceleration ``pull`` [m/s^2] towards the surface."""
    return 2.0 * rebound / (pull * (1.0 - restitution))


@kernel
def begin_tail(contacts: Contacts, dynamics: Dynamics, memory: Memory, k: int, before: float, now: float) -> None:
    """After an impact of contact k with the velocity ``before`` < 0 at ``now`` [s]: if it was a ball's last, its tail begins.

    All flights begin and end at the stand-off, so it does not matter when the surfaces would meet.
    """
    a, b = contacts.body[k, 0], contacts.body[k, 1]
    memory.tail_end[a], memory.tail_end[b] = NONE, NONE
    e = contacts.restitution[k]
    rebound = velocity_after(e, before)
    if memory.moving[a] + memory.moving[b] != 1 or not (0.0 < rebound <= REST_SPEED * contacts.pace[0]) or e >= 1.0:
        return
    ball, sign = (a, 1.0) if memory.moving[a] == 1 else (b, -1.0)
    n, g = axis(contacts, k, 0), dynamics.gravity
    pull = -sign * dot(n, (g[0], g[1], g[2]))
    if memory.ball[ball] == 1 and contacts.used[0] == 1 and pull > 0.0:
        memory.tail_end[ball] = now + tail_lasts(e, rebound, pull)
        put_row(memory.tail_speed, ball, scale(n, sign * rebound))


@kernel
def end_tails(
    geometry: Geometry, poses: Poses, velocities: Velocities, memory: Memory, events: Events, members: Index, now: float,
    keep: bool,
) -> None:
    """End the tails of members that end now; with ``keep`` that is recorded, as an event of the ball alone."""
    for m in range(members.shape[0]):
        b = members[m]
        if NONE < memory.tail_end[b] <= now:
            if keep:
                witness(geometry, events, APPROACH, now, now, b, b, poses, velocities, memory)
            memory.tail_end[b] = NONE
            if keep:
                witness(geometry, events, IMPACT, now, now, b, b, poses, velocities, memory)


@kernel
def until_tail_ends(memory: Memory, members: Index, now: float, left: float) -> float:
    """Time from ``now`` to the first end of a tail of the members, at most ``left`` [s]."""
    for m in range(members.shape[0]):
        if memory.tail_end[members[m]] > now:
            left = min(left, memory.tail_end[members[m]] - now)
    return left


@kernel
def show_tails(velocities: Velocities, memory: Memory, dt: float) -> None:
    """At the end of a frame of dt seconds: a ball within its tail is shown with its rebound speed."""
    for b in range(memory.moving.shape[0]):
        if memory.tail_end[b] > dt:
            memory.tail_end[b] -= dt
            put_row(velocities.linear, b, add(row(velocities.linear, b), row(memory.tail_speed, b)))
        else:
            memory.tail_end[b] = NONE


@kernel
def take_up_tails(velocities: Velocities, memory: Memory) -> None:
    """At the start of a frame: a ball within its tail is at rest, unless its velocity was set to another one meanwhile."""
    for b in range(memory.moving.shape[0]):
        if memory.tail_end[b] > NONE:
            same = True
            for i in range(3):
                same = same and velocities.linear[b, i] == memory.tail_speed[b, i]
            if same:
                put_row(velocities.linear, b, (0.0, 0.0, 0.0))
            else:
                memory.tail_end[b] = NONE
