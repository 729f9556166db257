"""Contact rows of a substep: speculative contacts (Catto, Continuous Collision, GDC 2013) with a stand-off, and refused pairs.

Each near pair of pieces gives the points of its manifold that may close within the substep. A row requires that its gap closes no
further than to the stand-off. A pair whose certificate fails gets rows where it comes nearest, the deepest point in any
case, which require the least gap that can be proved and no more: bodies wedged between two others have no room for a stand-off.
"""

from math import inf

import numpy as np
from numpy.typing import NDArray

from avatarsim.collision.manifold import manifold
from avatarsim.collision.path import acceleration
from avatarsim.jit.kernel import kernel
from avatarsim.model.dynamics import SIMULATED, Dynamics, Velocities
from avatarsim.model.geometry import Geometry, Poses, allowed_depth
from avatarsim.rigid.attached import move_together, on_links
from avatarsim.rigid.contact_generation import boxes_apart, note_drift
from avatarsim.rigid.contact_law import point_velocity
from avatarsim.rigid.contacts import (
    DRIVEN_A,
    DRIVEN_B,
    NOT_DRIVEN,
    POINTS_OF_PAIR,
    Contacts,
    Masses,
    add_contact,
    axis,
    speed_along,
    weigh_from,
)
from avatarsim.rigid.driven import is_kinematic
from avatarsim.rigid.internal_edges import forget_faces, level_seams, note
from avatarsim.rigid.linkages import is_linked
from avatarsim.rigid.state import Memory
from avatarsim.rigid.substep_state import KNOWN
from avatarsim.rigid.swept_certificate import Refusal, least_of, query
from avatarsim.spatial.tangent import columns, turned
from avatarsim.spatial.vec3 import Vec3, dot, norm, put_row, row, scale, sub
from avatarsim.tolerances import FINE

Index = NDArray[np.int64]
Array = NDArray[np.float64]

LOWER = 0.5
UPPER = 2.0 - LOWER
"""[stand-offs] between which a gap is left as it is: corners of one face, a micrometre apart in height, would otherwise require
velocities that no rigid body can have."""

LIFT = 0.05
"""Share per substep of a gap's shortfall below LOWER that is opened. Larger: energy of the lift, which is taken from speeds;
smaller: bodies come as near as can be proved, and more pairs are refused."""

REACH = 4.0
"""[stand-offs] gap below which a pair gets rows at any speed."""

BAND = 10.0
"""[stand-offs] by which points of a manifold may be farther apart than its closest. Larger: false normals; smaller: a face that
falls on another gets its rows one corner after the other."""

@kernel
def stand_off_of(memory: Memory) -> float:
    """Return the gap [m] that bodies of a moving crowd keep: a tenth of the broad phase's margin, 50 um unless all are small."""
    return float(FINE * memory.margin[0])


@kernel
def driven_side(dynamics: Dynamics, a: int, b: int) -> int:
    """Return the kinematic body of a pair as a code of `Contacts.driven`."""
    return DRIVEN_A if is_kinematic(dynamics, a) else DRIVEN_B if is_kinematic(dynamics, b) else NOT_DRIVEN


@kernel
def friction_of(dynamics: Dynamics, a: int, b: int) -> float:
    """Return the friction of a pair: none between driven bodies and fixed ones, along which they slide."""
    if dynamics.role[a] != SIMULATED and dynamics.role[b] != SIMULATED:
        return 0.0
    return float(dynamics.friction[dynamics.material[a], dynamics.material[b]])


@kernel
def closing_bound(memory: Memory, a: int, b: int) -> float:
    """Return the largest speed [m/s] at which points of bodies a and b may approach by their velocities without contact."""
    v, w, span = memory.linear_end, memory.angular_end, memory.span
    return float(norm(sub(row(v, a), row(v, b))) + norm(row(w, a)) * span[a] + norm(row(w, b)) * span[b])


@kernel
def find_rows(geometry: Geometry, dynamics: Dynamics, poses: Poses, velocities: Velocities, memory: Memory, h: float) -> None:
    """Fill ``memory.contacts`` with the rows of all listed pairs of pieces for a substep of h seconds, as far as there is room.

    Pairs whose rows have no room are refused by their certificate, if they come too near.

    ``memory.linear_end``, ``angular_end``: velocities without contact.
    """
    sub_, contacts = memory.substeps, memory.contacts
    contacts.used[0], d = 0, stand_off_of(memory)
    for q in range(sub_.found[0]):
        forget_faces(memory, geometry.body[sub_.pieces[q, 0]], geometry.body[sub_.pieces[q, 1]])
    gravity = norm((dynamics.gravity[0], dynamics.gravity[1], dynamics.gravity[2]))
    for q in range(sub_.found[0]):
        sa, sb = sub_.pieces[q, 0], sub_.pieces[q, 1]
        a, b = geometry.body[sa], geometry.body[sb]
        if move_together(dynamics.drive, a, b):
            continue
        reach = REACH * d + h * (closing_bound(memory, a, b) + 2.0 * h * gravity)
        driven = driven_side(dynamics, a, b)
        if driven != NOT_DRIVEN:
            reach = max(reach, memory.touch[0])
        if boxes_apart(poses.boxes, sa, sb, reach):
            continue
        gap, n, on_a, on_b = query(geometry, poses, memory, sa, sb, reach)
        put_row(sub_.normal, q, n)
        sub_.gap[q], sub_.state[q] = gap, KNOWN
        if not (gap < reach):
            continue
        first = contacts.used[0]
        band = min(reach, max(gap, 0.0) + BAND * d)
        add_manifold(geometry, dynamics, poses, velocities, memory, sa, sb, driven, gap, n, on_a, on_b, band)
        for k in range(first, contacts.used[0]):
            contacts.key[k] = (sa * geometry.body.shape[0] + sb) * POINTS_OF_PAIR + k - first
        if contacts.used[0] > first:
            note(geometry, poses, memory, sa, sb, first)
    level_seams(geometry, poses, Velocities(memory.linear_end, memory.angular_end), memory)
    on_links(dynamics.drive, poses, contacts, 0)
    sub_.lasting[0] = contacts.used[0]


@kernel
def add_manifold(
    geometry: Geometry, dynamics: Dynamics, poses: Poses, velocities: Velocities, memory: Memory, sa: int, sb: int, driven: int,
    gap: float, n: Vec3, on_a: Vec3, on_b: Vec3, band: float,
) -> bool:
    """Append a row for every point of the manifold of two pieces whose gap is below ``band`` [m]; False without room."""
    found, contacts = memory.manifold, memory.contacts
    a, b, depth = geometry.body[sa], geometry.body[sb], allowed_depth(geometry, sa, sb)
    count, n = manifold(poses.vertices, geometry.shapes, sa, sb, n, on_a, on_b, gap - depth, band - depth, found)
    friction = friction_of(dynamics, a, b)
    for i in range(count):
        k = contacts.used[0]
        p, q = row(found.on_a, i), row(found.on_b, i)
        if not add_point(dynamics, poses, memory, a, b, driven, n, p, q, found.gap[i] + depth, friction):
            return False
        if driven != NOT_DRIVEN:
            note_drift(velocities, memory, k)
            slide_with_driven(velocities, contacts, k)
        for side in range(2):
            slide_with_surface(dynamics, poses, contacts, k, side)
    return True


@kernel
def slide_with_surface(dynamics: Dynamics, poses: Poses, contacts: Contacts, k: int, side: int) -> None:
    """Let friction of row k go by the surface velocity of its body on one side."""
    b = contacts.body[k, side]
    s = row(dynamics.surface, b)
    if dot(s, s) > 0.0:
        s = turned(columns(poses.rotation, b), s)
        for i in range(2):
            along_tangent = dot(axis(contacts, k, 1 + i), s)
            contacts.slide[k, i] += -along_tangent if side == 0 else along_tangent


@kernel
def slide_with_driven(velocities: Velocities, contacts: Contacts, k: int) -> None:
    """Let friction of row k go by the velocity along the tangents of its driven body, which does not move in the solve."""
    side = 0 if contacts.driven[k] == DRIVEN_A else 1
    b, arm = contacts.body[k, side], row(contacts.arm_a, k) if side == 0 else row(contacts.arm_b, k)
    u = point_velocity(row(velocities.linear, b), row(velocities.angular, b), arm)
    for i in range(2):
        along_tangent = dot(axis(contacts, k, 1 + i), u)
        contacts.slide[k, i] = -along_tangent if side == 0 else along_tangent


@kernel
def work_of_surfaces(dynamics: Dynamics, poses: Poses, contacts: Contacts) -> float:
    """Return the work [J] that surfaces with a velocity of their own can do on bodies on them, by the impulses of friction."""
    total = 0.0
    for k in range(contacts.used[0]):
        for side in range(2):
            b = contacts.body[k, side]
            s = row(dynamics.surface, b)
            if dot(s, s) > 0.0:
                s = turned(columns(poses.rotation, b), s)
                for i in range(1, 3):
                    done = contacts.impulse[k, i] * dot(axis(contacts, k, i), s)
                    total += -done if side == 0 else done
    return float(max(0.0, total))


@kernel
def add_point(
    dynamics: Dynamics, poses: Poses, memory: Memory, a: int, b: int, driven: int, n: Vec3, on_a: Vec3, on_b: Vec3, gap: float,
    friction: float,
) -> bool:
    """Append one row of bodies a and b; False without room."""
    contacts, k = memory.contacts, memory.contacts.used[0]
    if memory.ball[a] + memory.ball[b] == 0:
        # one point for both bodies keeps angular momentum; on a ball friction is exact at each surface's own
        on_a = on_b = scale((on_a[0] + on_b[0], on_a[1] + on_b[1], on_a[2] + on_b[2]), 0.5)
    arm_a, arm_b = sub(on_a, row(poses.position, a)), sub(on_b, row(poses.position, b))
    if not add_contact(contacts, a, b, driven, n, arm_a, arm_b, gap):
        return False
    if dynamics.role[a] == SIMULATED or dynamics.role[b] == SIMULATED:
        contacts.restitution[k] = dynamics.restitution[dynamics.material[a], dynamics.material[b]]
    else:
        # links do not bounce off each other or off walls
        contacts.restitution[k] = 0.0
    contacts.friction[k] = friction
    return True


@kernel
def aim_rows(contacts: Contacts, count: int, d: float, h: float, lifts: bool) -> None:
    """Set target velocities of rows k < count: gaps close to UPPER stand-offs d, and with ``lifts`` open slowly below LOWER."""
    for k in range(count):
        gap = contacts.gap[k]
        contacts.target[k] = 0.0
        if gap > UPPER * d:
            contacts.target[k] = -(gap - UPPER * d) / h
        elif gap < LOWER * d and lifts:
            contacts.target[k] = LIFT * (LOWER * d - gap) / h


@kernel
def add_refused(
    geometry: Geometry, dynamics: Dynamics, velocities: Velocities, memory: Memory, masses: Masses, q: int, refusal: Refusal,
    h: float, d: float, error: float,
) -> bool:
    """Append rows of refused pair q where it is nearest on its motion, for a stand-off d [m]; False without room.

    They require the gap that is to be proved and ``error`` [m], the solver's tolerance. No more: bodies wedged between two others
    have no room, and to lift costs energy.

    Rows of bodies without joints use the velocities of their motions. Rows of links use the rates of the joints, which the solve
    changes; the difference between the two is assumed to stay as it is. A corner of a face that is farther away requires its
    share of the stand-off, as a row of the start does.
    """
    sub_, contacts = memory.substeps, memory.contacts
    sa, sb = sub_.pieces[q, 0], sub_.pieces[q, 1]
    a, b, wanted = geometry.body[sa], geometry.body[sb], least_of(sub_.gap[q]) + error
    driven, first, at_end = driven_side(dynamics, a, b), contacts.used[0], refusal.at >= 1.0
    poses = memory.trial if at_end else sub_.high
    has_room = True
    if at_end:
        has_room = add_manifold(
            geometry, dynamics, poses, velocities, memory, sa, sb, driven, refusal.gap, refusal.normal, refusal.on_a,
            refusal.on_b, REACH * stand_off_of(memory),
        )
    has_room = add_point(
        dynamics, poses, memory, a, b, driven, refusal.normal, refusal.on_a, refusal.on_b, refusal.gap, 0.0
    ) and has_room
    after = h * refusal.at
    on_links(dynamics.drive, poses, contacts, first)
    weigh_from(contacts, masses, 0.0, first)
    for k in range(first, contacts.used[0]):
        contacts.friction[k], contacts.key[k] = 0.0, -1
        gravity = dot(axis(contacts, k, 0), sub(acceleration(memory.paths, a), acceleration(memory.paths, b)))
        speed = speed_along(contacts, k, 0, sub_.velocity, sub_.turning) + curvature_speed(dynamics, memory, k)
        gap = contacts.gap[k] - after * (speed + 0.5 * after * gravity)
        contacts.gap[k] = gap
        if gap > LOWER * d:
            contacts.target[k] = -(gap - LOWER * d) / after
        else:
            contacts.target[k] = 0.0 if gap > wanted else (wanted - gap) / after
    return has_room


@kernel
def curvature_speed(dynamics: Dynamics, memory: Memory, k: int) -> float:
    """Return how much faster [m/s] links of row k part by the rates of their joints than along the chord of their motion."""
    sub_, contacts, n, found = memory.substeps, memory.contacts, axis(memory.contacts, k, 0), 0.0
    for side in range(2):
        b = contacts.body[k, side]
        if is_linked(dynamics.drive, b):
            jacobian = row(contacts.jacobian_a[k], 0) if side == 0 else row(contacts.jacobian_b[k], 0)
            straight = sub(row(memory.linear_end, b), row(sub_.velocity, b))
            turning = sub(row(memory.angular_end, b), row(sub_.turning, b))
            speed = dot(n, straight) + dot(jacobian, turning)
            found += speed if side == 0 else -speed
    return float(found)


@kernel
def correct_curvature(dynamics: Dynamics, memory: Memory, tolerance: float) -> bool:
    """Correct the targets of rows for the curvature of the motions of links: how much less these part along their chords than by
    the rates of their joints (second-order correction: Nocedal and Wright 2006, section 15.6).

    Returns whether a chord misses the target of its row by more than ``tolerance`` [m/s], so that another solve is needed.
    """
    contacts, sub_, misses = memory.contacts, memory.substeps, False
    for k in range(sub_.lasting[0]):
        if contacts.target[k] == -inf:
            continue
        misses = misses or speed_along(contacts, k, 0, sub_.velocity, sub_.turning) < contacts.target[k] - tolerance
        if contacts.impulse[k, 0] > 0.0:
            # what is lifted stays so
            contacts.target[k] = max(contacts.target[k], speed_along(contacts, k, 0, memory.linear_end, memory.angular_end))
        contacts.target[k] += curvature_speed(dynamics, memory, k)
    return misses
