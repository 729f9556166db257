"""Contact generation: narrow phase (GJK and EPA) and contact manifolds (Sutherland and Hodgman 1974) of near pairs.

Each point gets restitution, friction and a key for the warm start, and contacts of driven bodies the slip that counts.
"""

from math import inf

import numpy as np
from numpy.typing import NDArray

from avatarsim.collision.conservative_advancement import TOUCH
from avatarsim.collision.edge_edge import lone_edge
from avatarsim.collision.manifold import manifold
from avatarsim.collision.signed_distance import signed_distance_up_to
from avatarsim.collision.status import NOT_FINITE
from avatarsim.jit.kernel import kernel
from avatarsim.model.dynamics import DRIVEN, FIXED, Dynamics, Velocities
from avatarsim.model.geometry import Geometry, Poses, allowed_depth
from avatarsim.rigid.contact_law import point_velocity, tangential_velocity
from avatarsim.rigid.contacts import DRIVEN_A, DRIVEN_B, NOT_DRIVEN, POINTS_OF_PAIR, TWO_BALLS, add_contact, axis
from avatarsim.rigid.internal_edges import forget_faces, level_seams, note
from avatarsim.rigid.rolling import is_smooth, note_smooth
from avatarsim.rigid.state import QUERY_WORK, WORK, Memory
from avatarsim.spatial.tangent import columns, step_between, turned
from avatarsim.spatial.vec3 import dot, neg, norm, put_row, row, scale, sub

Index = NDArray[np.int64]

# Slip velocity of driven contacts: the user's, or the displayed one where a contact or a limit holds the driven body back.

SEEN = 0.005
"""[m/s] by which a driven body must be displayed slower than its user along a surface to count as held back there. The springs of
eq. 6 make smaller differences; larger: slow users drag bodies along. 0: a pushed box sticks to a hand that its spring lets slide,
and takes three times as long to solve."""


@kernel
def note_shown(poses: Poses, dt: float, memory: Memory, b: int) -> None:
    """Fill ``shown_linear``, ``shown_angular`` of driven body b: from where it was a frame of dt seconds ago to where it is."""
    before, start = memory.trial, columns(memory.trial.rotation, b)
    put_row(memory.shown_linear, b, scale(sub(row(poses.position, b), row(before.position, b)), 1.0 / dt))
    turn = turned(start, step_between(start, columns(poses.rotation, b)))
    put_row(memory.shown_angular, b, scale(turn, 1.0 / dt))


@kernel
def note_drift(velocities: Velocities, memory: Memory, k: int) -> None:
    """Fill ``drift`` of contact k of a driven body: the part of its user's tangential velocity that is not displayed.

    A free driven body strikes with the user's velocity. A hand that is held back, itself
    (`coupling.tracked_motion.project_velocities`) or by its arm or a limit, must not drag a body like a conveyor belt while its
    user moves on: there the displayed, slower velocity counts.
    """
    contacts, side = memory.contacts, 0 if memory.contacts.driven[k] == DRIVEN_A else 1
    b, n = contacts.body[k, side], axis(contacts, k, 0)
    arm = row(contacts.arm_a, k) if side == 0 else row(contacts.arm_b, k)
    user = tangential_velocity(n, point_velocity(row(velocities.linear, b), row(velocities.angular, b), arm))
    shown = tangential_velocity(n, point_velocity(row(memory.shown_linear, b), row(memory.shown_angular, b), arm))
    beyond = sub(user, shown) if norm(shown) + SEEN < norm(user) else (0.0, 0.0, 0.0)
    for i in range(2):
        along_tangent = dot(axis(contacts, k, 1 + i), beyond)
        contacts.drift[k, i] = along_tangent if side == 0 else -along_tangent


Array = NDArray[np.float64]

# Contacts of one pair, and of all pairs of an island.

FOUND, NO_ROOM, BROKEN = 0, 1, 2
"""Outcome: all contacts found; more than fit; a pose is not finite."""


@kernel
def boxes_apart(boxes: Array, i: int, k: int, margin: float) -> bool:
    """Return True if two boxes of pieces are more than ``margin`` apart."""
    for x in range(3):
        if boxes[i, x] > boxes[k, 3 + x] + margin or boxes[k, x] > boxes[i, 3 + x] + margin:
            return True
    return False


@kernel
def find_points(
    geometry: Geometry, dynamics: Dynamics, poses: Poses, velocities: Velocities, memory: Memory, a: int, b: int, driven: int,
    sa: int, sb: int, reach: float,
) -> tuple[int, float, bool]:
    """Append to ``memory.contacts`` the contact points of shapes sa of body a and sb of body b with gaps below ``reach`` [m].

    Returns (status of the query, smallest gap [m], inf if none is nearer; whether there was room for all).
    """
    contacts, found, has_room = memory.contacts, memory.manifold, True
    shapes, vertices = geometry.shapes, poses.vertices
    memory.counts[WORK] += QUERY_WORK
    status, gap, n, on_a, on_b = signed_distance_up_to(vertices, shapes, sa, sb, (0.0, 0.0, 0.0), reach, memory.scratch)
    depth = allowed_depth(geometry, sa, sb)
    gap += depth
    if status == NOT_FINITE or not (gap < reach):
        return status, inf, True
    raw, before = n, contacts.used[0]
    smooth = is_smooth(shapes, sa) or is_smooth(shapes, sb)
    # one point for both bodies keeps angular momentum to rounding; for balls, and smooth bodies on fixed ones, friction is exact
    # at each surface's own point
    own = memory.ball[a] + memory.ball[b] > 0 or (smooth and dynamics.role[a] * dynamics.role[b] == FIXED)
    count, n = manifold(vertices, shapes, sa, sb, n, on_a, on_b, gap - depth, reach - depth, found)
    for i in range(count):
        p_a, p_b = row(found.on_a, i), row(found.on_b, i)
        if not own:
            p_a = p_b = scale((p_a[0] + p_b[0], p_a[1] + p_b[1], p_a[2] + p_b[2]), 0.5)
        arm_a, arm_b = sub(p_a, row(poses.position, a)), sub(p_b, row(poses.position, b))
        k = contacts.used[0]
        if not add_contact(contacts, a, b, driven, n, arm_a, arm_b, found.gap[i] + depth):
            has_room = False
            break
        contacts.face[k] = found.face[0]
        if driven != NOT_DRIVEN:
            note_drift(velocities, memory, k)
    if memory.ball[a] + memory.ball[b] == 2:
        # heaps of balls have many contacts; their curvature is a closed form
        for k in range(before, contacts.used[0]):
            contacts.smooth[k] = TWO_BALLS
    elif smooth:
        note_smooth(vertices, shapes, contacts, poses, sa, sb, raw, before)
    elif found.face[0] == 0 and count == 1:
        of_a, _, e = lone_edge(vertices, shapes, sa, neg(raw))
        of_b, _, f = lone_edge(vertices, shapes, sb, raw)
        if of_a and of_b and contacts.used[0] > before:
            put_row(contacts.edge_a, before, e)
            put_row(contacts.edge_b, before, f)
    pieces = geometry.body.shape[0]
    for k in range(before, contacts.used[0]):
        contacts.restitution[k] = dynamics.restitution[dynamics.material[a], dynamics.material[b]]
        contacts.friction[k] = dynamics.friction[dynamics.material[a], dynamics.material[b]]
        contacts.key[k] = (sa * pieces + sb) * POINTS_OF_PAIR + k - before
    return status, gap, has_room


@kernel
def find_contacts(
    geometry: Geometry, dynamics: Dynamics, poses: Poses, velocities: Velocities, pairs: Index, memory: Memory
) -> tuple[int, float]:
    """Fill ``memory.contacts`` with all points nearer than TOUCH of near pairs (count, 2) with a moving body.

    A driven body keeps its own stand-off from everything, so its contacts begin at `memory.touch`, which is larger.

    Returns (outcome, smallest gap [m], inf without contacts).
    """
    memory.contacts.used[0] = 0
    worst, outcome = inf, FOUND
    for p in range(pairs.shape[0]):
        forget_faces(memory, pairs[p, 0], pairs[p, 1])
    for p in range(pairs.shape[0]):
        a, b = pairs[p, 0], pairs[p, 1]
        if memory.moving[a] + memory.moving[b] == 0:
            continue
        driven = DRIVEN_A if dynamics.role[a] == DRIVEN else (DRIVEN_B if dynamics.role[b] == DRIVEN else NOT_DRIVEN)
        for sa in range(geometry.first_shape[a], geometry.first_shape[a + 1]):
            for sb in range(geometry.first_shape[b], geometry.first_shape[b + 1]):
                reach = TOUCH if driven == NOT_DRIVEN else memory.touch[0]
                if boxes_apart(poses.boxes, sa, sb, reach):
                    continue
                before = memory.contacts.used[0]
                status, gap, room = find_points(geometry, dynamics, poses, velocities, memory, a, b, driven, sa, sb, reach)
                if status == NOT_FINITE:
                    return BROKEN, worst
                worst = min(worst, gap)
                outcome = outcome if room else NO_ROOM
                if memory.contacts.used[0] > before:
                    note(geometry, poses, memory, sa, sb, before)
    level_seams(geometry, poses, velocities, memory)
    return outcome, worst
