"""Bodies that are attached to links: welds in the solve of all contacts.

A weld is three contact points about the centre of mass of the body whose impulses have no bounds, neither along the normal nor
across it (as a fixed joint in Catto, Modeling and Solving Constraints, GDC 2009). They ask for the velocities that bring the body
to its place on the link within the substep. A weld that is open by the size of its body breaks.
"""

import numpy as np
from numpy.typing import NDArray

from avatarsim.jit.kernel import kernel
from avatarsim.model.dynamics import Dynamics
from avatarsim.model.geometry import Poses
from avatarsim.rigid.contacts import NOT_DRIVEN, POINTS_OF_PAIR, WELDED, Contacts, add_contact, axis
from avatarsim.rigid.state import WELDS_BROKEN, Memory
from avatarsim.spatial.tangent import columns, turned
from avatarsim.spatial.vec3 import add, dot, norm, row, scale, sub

Index = NDArray[np.int64]

POINTS = 3
"""Points of a weld: as few as hold a body."""

@kernel
def acts(contacts: Contacts, k: int) -> bool:
    """Return whether contact k has an impulse."""
    return bool(contacts.impulse[k, 0] > 0.0 or contacts.friction[k] == WELDED)


@kernel
def holds(dynamics: Dynamics, a: int, b: int) -> bool:
    """Return whether one of two bodies is attached to the other."""
    carrier = dynamics.drive.carrier
    return bool(carrier[a] == b or carrier[b] == a)


@kernel
def add_welds(dynamics: Dynamics, poses: Poses, memory: Memory, members: Index, pieces: int, h: float) -> bool:
    """Append the rows of the members that are attached, for a substep of h seconds; False without room.

    Args:
        pieces: number of pieces of the scene, for keys that no pair of them has.
    """
    drive, contacts = dynamics.drive, memory.contacts
    for m in range(members.shape[0]):
        b = members[m]
        link = drive.carrier[b]
        if link < 0 or memory.moving[b] == 0:
            continue
        frame, x = columns(poses.rotation, link), row(poses.position, b)
        place = add(row(poses.position, link), turned(frame, row(drive.held_place, b)))
        if not (norm(sub(x, place)) <= memory.span[b]):
            # the solve did not keep it: it breaks before what it lacks becomes speed
            drive.carrier[b], drive.tied[b] = -1, b
            memory.counts[WELDS_BROKEN] += 1
            continue
        for i in range(POINTS):
            # on the body, and where it belongs
            arm = scale((1.0 if i == 0 else 0.0, 1.0 if i == 1 else 0.0, 1.0 if i == 2 else 0.0), memory.span[b])
            there = add(place, turned(frame, turned(columns(drive.held_turn, b), arm)))
            arm = turned(columns(poses.rotation, b), arm)
            here, k = add(x, arm), contacts.used[0]
            n = scale(arm, 1.0 / memory.span[b])
            if not add_contact(contacts, b, link, NOT_DRIVEN, n, arm, sub(here, row(poses.position, link)), 0.0):
                return False
            off = sub(here, there)
            contacts.gap[k], contacts.friction[k], contacts.restitution[k] = dot(off, n), WELDED, 0.0
            for t in range(2):
                contacts.slide[k, t] = -dot(axis(contacts, k, 1 + t), off) / h
            contacts.key[k] = (pieces * pieces + b) * POINTS_OF_PAIR + i
    return True
