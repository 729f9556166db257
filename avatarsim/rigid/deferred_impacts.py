"""Deferred impacts: a body that approaches a yielding driven body stops there for this frame and gets its velocity back after it.

Poses of driven bodies change in the lower loop only. A heavy body that strikes a hand may be faster than the hand's pose, which
stays until the next frame: it is stopped at the hand, and the velocity taken from it is owed to it. Momentum stays as eqs 7 to 10
made it, and the driven body receives no more than its coupled mass can take.
"""

import numpy as np
from numpy.typing import NDArray

from avatarsim.collision.conservative_advancement import STAND_OFF
from avatarsim.jit.kernel import kernel
from avatarsim.model.dynamics import Dynamics, Velocities
from avatarsim.rigid.contacts import DRIVEN_A, NOT_DRIVEN, axis, impulse_of, push, velocity_at, weigh
from avatarsim.rigid.impacts import same_pair
from avatarsim.rigid.resting import SWEEPS
from avatarsim.rigid.solver import sweeps
from avatarsim.rigid.state import Memory
from avatarsim.spatial.vec3 import add, along, dot, put_row, row, scale, sub
from avatarsim.tolerances import SLIGHT

Index = NDArray[np.int64]

ENOUGH = SLIGHT
"""Accuracy [m/s] to which bodies are stopped: in a frame they come nearer by a tenth of a nanometre, much below the stand-off."""

MOST_ELASTIC = 2.0
"""1 + e of eq. 9 at e = 1: a mass m that is met at v by the heaviest body receives 2 m v, and never more."""


@kernel
def defer_impacts(velocities: Velocities, memory: Memory, members: Index, left: float) -> None:
    """Take from simulated bodies the velocity with which they would enter driven ones in ``left`` seconds; it is owed to them.

    Half of the gap to the driven body may be closed: slower bodies continue.
    """
    contacts, v, w = memory.contacts, velocities.linear, velocities.angular
    contacts.standing[0] = 1
    count, enters = contacts.used[0], False
    for k in range(count):
        contacts.target[k] = 0.0
        put_row(contacts.impulse, k, (0.0, 0.0, 0.0))
        if contacts.driven[k] != NOT_DRIVEN:
            contacts.target[k] = -max(0.0, 0.5 * contacts.gap[k] - STAND_OFF) / left
            enters = enters or dot(axis(contacts, k, 0), velocity_at(contacts, k, v, w)) < contacts.target[k]
    if not enters:
        return
    for m in range(members.shape[0]):
        b = members[m]
        put_row(memory.linear_end, b, row(v, b))
        put_row(memory.angular_end, b, row(w, b))
    weigh(contacts, memory.masses)
    sweeps(contacts, memory.masses, 0, count, v, w, ENOUGH, SWEEPS, False, memory.before, memory.direction)
    for m in range(members.shape[0]):
        b = members[m]
        put_row(memory.owed_linear, b, sub(row(memory.linear_end, b), row(v, b)))
        put_row(memory.owed_angular, b, sub(row(memory.angular_end, b), row(w, b)))
    memory.owing[0] = 1


@kernel
def restore_deferred(velocities: Velocities, memory: Memory, members: Index) -> None:
    """Give back the velocities that are owed to members."""
    if memory.owing[0] == 0:
        return
    for m in range(members.shape[0]):
        b = members[m]
        put_row(velocities.linear, b, add(row(velocities.linear, b), row(memory.owed_linear, b)))
        put_row(velocities.angular, b, add(row(velocities.angular, b), row(memory.owed_angular, b)))
        put_row(memory.owed_linear, b, (0.0, 0.0, 0.0))
        put_row(memory.owed_angular, b, (0.0, 0.0, 0.0))


@kernel
def share_received(dynamics: Dynamics, velocities: Velocities, memory: Memory, first: int, last: int) -> float:
    """Return the share in 0 .. 1 of the contact forces of one pair that its driven body can take over the segment.

    Without the forces the simulated body would approach it by v = p / M, less what the driven one recedes. A mass m that is met
    at v takes 2 m v at most (eq. 9).
    """
    contacts, driven = memory.contacts, 0 if memory.contacts.driven[first] == DRIVEN_A else 1
    pressed, receding = 0.0, 0.0
    link, body = contacts.body[first, driven], contacts.body[first, 1 - driven]
    for k in range(first, last):
        n = axis(contacts, k, 0)
        pressed += contacts.impulse[k, 0]
        # the path's velocity differs from the true one by the owed velocity
        apart = dot(n, velocity_at(contacts, k, velocities.linear, velocities.angular))
        sign = -1.0 if driven == 0 else 1.0
        apart += sign * dot(n, row(memory.owed_linear, body))
        receding = max(receding, apart)
    if pressed <= 0.0 or dynamics.inverse_mass[link] == 0.0:
        return 1.0
    met = pressed * dynamics.inverse_mass[body] - receding
    return float(min(1.0, MOST_ELASTIC * max(0.0, met) / (dynamics.inverse_mass[link] * pressed)))


@kernel
def transfer_impulses(dynamics: Dynamics, velocities: Velocities, memory: Memory, owes: bool) -> None:
    """Add the contact forces of a segment to the impulses of driven bodies; the excess is owed to the other bodies.

    Unless ``owes`` it is lost: in a crowd it may be the force of another driven body, which continues.
    """
    contacts = memory.contacts
    count, first = contacts.used[0], 0
    contacts.standing[0] = 0
    while first < count:
        last = first + 1
        while last < count and same_pair(contacts, first, last):
            last += 1
        if contacts.driven[first] != NOT_DRIVEN:
            share = share_received(dynamics, velocities, memory, first, last)
            for k in range(first, last):
                j = impulse_of(contacts, k)
                side = 0 if contacts.driven[k] == DRIVEN_A else 1
                b, sign = contacts.body[k, side], 1.0 if side == 0 else -1.0
                put_row(memory.received, b, along(row(memory.received, b), sign * share, j))
                if owes and share < 1.0:
                    push(contacts, memory.masses, k, scale(j, share - 1.0), memory.owed_linear, memory.owed_angular)
                    memory.owing[0] = 1
        first = last
