"""Warm start of the contact solver (contact caching: Catto 2005): a hash table of the last segment's forces by contact key.

An entry is valid as long as its body has had no other segment since; a contact without one starts from zero.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from avatarsim.impact.contacts import Contacts
from avatarsim.jit.kernel import kernel
from avatarsim.jit.layout import IndexLine, Vectors
from avatarsim.spatial.vec3 import put_row, row, scale

Array = NDArray[np.float64]
Index = NDArray[np.int64]

SLOTS_PER_POINT = 4
"""Slots of the table per contact point that there may be at once; fewer: more forces are lost and solved for from zero."""

TRIES = 12
"""Slots probed for a key (linear probing)."""

SPREAD, SHIFT = 40503, 7
"""Multiplier and shift that spread neighbouring keys over the table; the product of any key stays far below 2^63."""


class LastForces(NamedTuple):
    """key, body, turn (slots): name of the point, a body that it belongs to, and the segment of that; force (slots, 3) [N];
    latest (nb): last segment of each body; turns (1): segments so far."""

    key: IndexLine
    body: IndexLine
    turn: IndexLine
    force: Vectors
    latest: IndexLine
    turns: IndexLine


def make_last_forces(bodies: int, points: int) -> LastForces:
    """Allocate an empty table for so many bodies and contact points; its size is a power of two."""
    slots = 1 << (SLOTS_PER_POINT * points - 1).bit_length()
    return LastForces(
        np.full(slots, -1, np.int64), np.zeros(slots, np.int64), np.zeros(slots, np.int64), np.zeros((slots, 3)),
        np.zeros(bodies, np.int64), np.zeros(1, np.int64),
    )


@kernel
def slot_of(table: LastForces, key: int, tried: int) -> int:
    """Slot number ``tried`` of the probe sequence of ``key``."""
    return int(((key * SPREAD >> SHIFT) + tried) & (table.key.shape[0] - 1))


@kernel
def recall_forces(contacts: Contacts, table: LastForces) -> None:
    """Give every point the force [N] that the point of the same key had in the last segment; zero if there was none.

    A point without friction gets the normal force only, since no sweep would remove the rest: a speculative contact
    (`loops.ahead`) has none, and may have touched in the last segment.
    """
    for k in range(contacts.used[0]):
        put_row(contacts.impulse, k, (0.0, 0.0, 0.0))
        for tried in range(TRIES):
            s = slot_of(table, contacts.key[k], tried)
            if table.key[s] == -1:
                break
            if table.key[s] == contacts.key[k]:
                if table.turn[s] == table.latest[table.body[s]]:
                    force = row(table.force, s)
                    put_row(contacts.impulse, k, force if contacts.friction[k] > 0.0 else (force[0], 0.0, 0.0))
                break


@kernel
def remember_forces(contacts: Contacts, h: float, members: Index, table: LastForces) -> None:
    """Keep impulse / h [N] of every point for the next segment of these bodies."""
    table.turns[0] += 1
    turn = table.turns[0]
    for m in range(members.shape[0]):
        table.latest[members[m]] = turn
    for k in range(contacts.used[0]):
        key, free = contacts.key[k], -1
        for tried in range(TRIES):
            s = slot_of(table, key, tried)
            if table.key[s] == key or table.key[s] == -1:
                free = s if free < 0 or table.key[s] == key else free
                break
            if free < 0 and table.turn[s] != table.latest[table.body[s]]:
                free = s
        if free >= 0:
            a, b = contacts.body[k, 0], contacts.body[k, 1]
            table.key[free], table.turn[free] = key, turn
            table.body[free] = a if table.latest[a] == turn else b
            put_row(table.force, free, scale(row(contacts.impulse, k), 1.0 / h))
