"""From poses to contacts: who touches whom at this instant, with which coefficients and which forces last time."""

from math import inf

import numpy as np
from numpy.typing import NDArray

from avatarsim.collide.signed_distance import signed_distance_up_to
from avatarsim.collide.status import NOT_FINITE
from avatarsim.impact.contacts import DRIVEN_A, DRIVEN_B, NOT_DRIVEN, Contacts, add_contact
from avatarsim.kernel import kernel
from avatarsim.loops.upper_memory import Memory
from avatarsim.motion.manifold import manifold
from avatarsim.motion.time_of_impact import TOUCH
from avatarsim.settings import PostureSettings
from avatarsim.spatial.vec3 import put_row, row, scale, sub
from avatarsim.world.dynamics import Dynamics
from avatarsim.world.geometry import Geometry, Poses

Array = NDArray[np.float64]
Index = NDArray[np.int64]

FOUND, NO_ROOM, BROKEN = 0, 1, 2
"""Outcome: all contacts found; more than fit; a pose is not finite."""

DRIVEN_TOUCH = 2.0 * PostureSettings().stand_off
"""Gap [m] below which a driven body touches: twice the stand-off that it keeps. Below the stand-off it could push nothing."""

SIMULATED, DRIVEN = 1, 2
"""Values of `Role` that matter here."""


@kernel
def boxes_apart(boxes: Array, i: int, k: int, margin: float) -> bool:
    """Whether two boxes of pieces are more than ``margin`` apart."""
    for x in range(3):
        if boxes[i, x] > boxes[k, 3 + x] + margin or boxes[k, x] > boxes[i, 3 + x] + margin:
            return True
    return False


@kernel
def find_contacts(geometry: Geometry, dynamics: Dynamics, poses: Poses, pair_count: int, memory: Memory) -> tuple[int, float]:
    """Fill ``memory.contacts`` with all points nearer than TOUCH of near pairs that somebody moves in.

    A driven body keeps a stand-off from everything, so it touches from DRIVEN_TOUCH on: what it cannot come nearer to, it hits.

    Returns (outcome, smallest gap [m], inf without contacts).
    """
    contacts, found = memory.contacts, memory.manifold
    contacts.used[0] = 0
    worst, outcome = inf, FOUND
    shapes, vertices = geometry.shapes, poses.vertices
    pieces = geometry.body.shape[0]
    for p in range(pair_count):
        a, b = memory.pairs[p, 0], memory.pairs[p, 1]
        if memory.moving[a] + memory.moving[b] == 0:
            continue
        driven = DRIVEN_A if dynamics.role[a] == DRIVEN else (DRIVEN_B if dynamics.role[b] == DRIVEN else NOT_DRIVEN)
        for sa in range(geometry.first_shape[a], geometry.first_shape[a + 1]):
            for sb in range(geometry.first_shape[b], geometry.first_shape[b + 1]):
                reach = TOUCH if driven == NOT_DRIVEN else DRIVEN_TOUCH
                if boxes_apart(poses.boxes, sa, sb, reach):
                    continue
                status, gap, n, on_a, on_b = signed_distance_up_to(
                    vertices, shapes, sa, sb, (0.0, 0.0, 0.0), reach, memory.scratch
                )
                if status == NOT_FINITE:
                    return BROKEN, worst
                if not (gap < reach):
                    continue
                count, n = manifold(vertices, shapes, sa, sb, n, on_a, on_b, gap, reach, found)
                worst = min(worst, gap)
                for i in range(count):
                    p_a, p_b = row(found.on_a, i), row(found.on_b, i)
                    if memory.ball[a] + memory.ball[b] == 0:
                        # one point for both keeps angular momentum to rounding; balls keep their exact friction laws
                        p_a = p_b = scale((p_a[0] + p_b[0], p_a[1] + p_b[1], p_a[2] + p_b[2]), 0.5)
                    arm_a, arm_b = sub(p_a, row(poses.position, a)), sub(p_b, row(poses.position, b))
                    k = contacts.used[0]
                    if not add_contact(contacts, a, b, driven, n, arm_a, arm_b, found.gap[i]):
                        outcome = NO_ROOM
                        break
                    contacts.face[k] = found.face[0]
                    contacts.restitution[k] = dynamics.restitution[dynamics.material[a], dynamics.material[b]]
                    contacts.friction[k] = dynamics.friction[dynamics.material[a], dynamics.material[b]]
                    contacts.key[k] = (sa * pieces + sb) * 8 + i
    return outcome, worst


@kernel
def recall_forces(contacts: Contacts, last_key: Index, last_force: Array, last_count: int) -> None:
    """Give every point the force [N] that the point of the same key had; zero if there was none."""
    at = 0
    for k in range(contacts.used[0]):
        put_row(contacts.impulse, k, (0.0, 0.0, 0.0))
        for tried in range(last_count):
            i = at + tried if at + tried < last_count else at + tried - last_count
            if last_key[i] == contacts.key[k]:
                put_row(contacts.impulse, k, row(last_force, i))
                at = i + 1 if i + 1 < last_count else 0
                break


@kernel
def remember_forces(contacts: Contacts, h: float, last_key: Index, last_force: Array, last_count: Index) -> None:
    """Keep impulse / h [N] of every point for the next segment."""
    last_count[0] = contacts.used[0]
    for k in range(contacts.used[0]):
        last_key[k] = contacts.key[k]
        put_row(last_force, k, scale(row(contacts.impulse, k), 1.0 / h))
