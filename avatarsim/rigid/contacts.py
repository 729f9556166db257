"""Contact points of one instant: frames, lever arms, inverse effective masses and relative velocities (contact Jacobian).

With the masses of the bodies that they are of, the impulses that act there, and their forces in the last segment, from which the
solver starts (contact caching: Catto 2005).
"""

from math import sqrt
from typing import Annotated, NamedTuple

import numpy as np
from numpy.typing import NDArray

from avatarsim.collision.manifold import MANIFOLD_POINTS
from avatarsim.jit.kept import BODY, COUNT, COUNT_OR_NONE, KEPT, NOT_KEPT
from avatarsim.jit.kernel import kernel
from avatarsim.jit.layout import Grid, IndexGrid, IndexLine, Line, Matrices, Vectors
from avatarsim.rigid.contact_law import point_velocity, relative_velocity
from avatarsim.rigid.responses import LANES, Responses, make_responses
from avatarsim.spatial.tangent import Columns, columns, turned
from avatarsim.spatial.vec3 import Vec3, along, cross, dot, perpendicular, put_row, row, scale, sub

Array = NDArray[np.float64]


# Inverse masses and inverse inertia tensors of all bodies in world axes, at the present instant.


class Masses(NamedTuple):
    """inverse_mass (nb) [1/kg] and inverse_inertia (nb, 3, 3) in world axes; zero for bodies that do not yield."""

    inverse_mass: Annotated[Line, NOT_KEPT]
    inverse_inertia: Matrices


@kernel
def is_diagonal(tensors: Array, b: int) -> bool:
    """Return True if tensor b of (nb, 3, 3) is given along its principal axes: those of balls and boxes are."""
    upper = (tensors[b, 0, 1] == 0.0) & (tensors[b, 0, 2] == 0.0) & (tensors[b, 1, 2] == 0.0)
    return bool(upper & (tensors[b, 1, 0] == 0.0) & (tensors[b, 2, 0] == 0.0) & (tensors[b, 2, 1] == 0.0))


@kernel
def to_world(body_axes: Array, rotation: Array, b: int, world_out: Array) -> None:
    """Compute world[b] = R M R^T for the tensor M of body b in its own axes; all arrays (nb, 3, 3)."""
    diagonal = is_diagonal(body_axes, b)
    for i in range(3):
        for k in range(i, 3):
            total = 0.0
            for x in range(3):
                if diagonal:
                    total += rotation[b, i, x] * body_axes[b, x, x] * rotation[b, k, x]
                else:
                    for y in range(3):
                        total += rotation[b, i, x] * body_axes[b, x, y] * rotation[b, k, y]
            world_out[b, i, k] = total
            world_out[b, k, i] = total


@kernel
def yielding(masses: Masses, b: int, arm: Vec3, j: Vec3) -> Vec3:
    """Return the change of velocity [m/s] of the point at ``arm`` of body b under the impulse j [N s] at that point."""
    m = masses.inverse_mass[b]
    inertia: Columns = columns(masses.inverse_inertia, b)
    w = cross(turned(inertia, cross(arm, j)), arm)
    return (m * j[0] + w[0], m * j[1] + w[1], m * j[2] + w[2])


Index = NDArray[np.int64]

# The points, and velocities there.

ROOM = 2048
"""Least room for contact points. A wall of 100 boxes has about 1000; a status reports too many, none is dropped silently."""

ROOM_PER_BODY = 24
"""Room for contact points per simulated body, if that is more: a box in the middle of a wall touches others with 24 corners, each
of which belongs to two bodies; one among others on a pallet with 16, and as many edges that nearly touch."""

POINTS_OF_PAIR = MANIFOLD_POINTS
"""Contact points of two shapes, at most: numbers of one pair of shapes follow each other in `Contacts.key`."""

ROW, MOTION = 104, 2 * LANES
"""Numbers that a pass of the solver reads: of a contact, thirteen lines of the cache, and of a body."""

EARTH = 9.8
"""Gravity [m/s^2] that slow speeds are stated for. A little below that on Earth, so that there they are exactly as stated."""

NOT_DRIVEN, DRIVEN_A, DRIVEN_B = 0, 1, 2
"""Driven body of a contact: its path is given, and it does not move while simulated bodies do."""

NOT_LINKED, AS_A = -1, -2
"""Instead of a block of responses: the body has no joints; it is a link of the avatar of A, whose block has both."""

SHARP, ROUND_A, ROUND_B, NORMAL_OF_ANOTHER, TWO_BALLS = 0, 1, 2, 4, 8
"""Flags of smoothness at a contact: neither surface, A's, B's, and that the normal is that of a third body's face, which does not
turn. Or, alone, that both bodies are balls."""


class Contacts(NamedTuple):
    """Contact points k < used[0]; those of one pair of bodies are contiguous.

    body (cap, 2) A and B; key (cap) names the point from one segment to the next; driven (cap) one of the above;
    face (cap) 1 or 2 if the normal belongs to a face of A or of B and turns with it, else 0;
    frame (cap, 3, 3) rows: normal out of B into A, two tangents; arm_a, arm_b (cap, 3) from the centres of mass [m];
    gap (cap) [m]; restitution, friction (cap); bias_acceleration (cap, 3) of the points at zero force, relative [m/s^2];
    inverse_effective_mass (cap, 2) along the normal, and the largest across it [1/kg]; effective_mass (cap, 2) [kg];
    cross_response (cap, 2) velocity along the tangents per impulse along the normal [1/kg];
    jacobian_a, jacobian_b (cap, 3, 3) angular rows of the contact Jacobian: arm x axis for each axis of the frame; turn_a, turn_b
    (cap, 3, 3) angular rows of M^-1 J^T: angular velocity [rad/s] per impulse [N s] along each axis;
    target (cap) least normal velocity required (bias velocity) [m/s], -inf where a point takes no part;
    slide (cap, 2) velocity along the tangents at which friction is zero [m/s];
    drift (cap, 2) part of the user's velocity along the tangents that is not displayed [m/s]: see `rigid.contact_generation`;
    impulse (cap, 3) along the rows of frame [N s];
    standing (1) 1 while a driven body that recedes counts as standing still along the normal: see `velocity_at`;
    visits (1) points visited by the solver since the count was last set to 0, a measure of its work;
    edge_a, edge_b (cap, 3) directions of the edges where two edges cross or one touches a smooth surface, of any length, or zero;
    sway_a, sway_b (cap, 3) rates of the lever arms [m/s], zero where a body is driven;
    smooth (cap) see above; radii_a, radii_b (cap, 3, 3) radii of curvature [m]: how far the point of a smooth surface moves per
    turn of its normal; zero for corners, without meaning along an edge;
    turns (cap, 2) how fast the contact changes as either body turns [rad/s];
    pace (1): factor on speeds that count as slow, see `pace_of`;
    approach (cap) velocity along the normal [m/s] when the queue of impacts last looked;
    rows (cap, ROW), motion (bodies, MOTION): data of a pass of the solver, see `rigid.solver`;
    linked (cap, 2) block of ``responses`` of A and of B, or one of the above.
    """

    used: IndexLine
    body: IndexGrid
    key: IndexLine
    driven: IndexLine
    face: IndexLine
    frame: Matrices
    arm_a: Vectors
    arm_b: Vectors
    gap: Line
    restitution: Line
    friction: Line
    bias_acceleration: Vectors
    inverse_effective_mass: Grid
    jacobian_a: Matrices
    jacobian_b: Matrices
    turn_a: Matrices
    turn_b: Matrices
    target: Line
    slide: Grid
    drift: Grid
    impulse: Vectors
    standing: IndexLine
    visits: Annotated[IndexLine, KEPT, COUNT]
    edge_a: Vectors
    edge_b: Vectors
    sway_a: Vectors
    sway_b: Vectors
    smooth: IndexLine
    radii_a: Matrices
    radii_b: Matrices
    turns: Grid
    effective_mass: Grid
    cross_response: Grid
    pace: Line
    approach: Line
    rows: Grid
    motion: Grid
    linked: IndexGrid
    responses: Responses


def pace_of(gravity: Array) -> float:
    """Return the factor on the slow speeds of this engine under a gravity (3) [m/s^2], at most 1: with it a body that leaves a
    floor rises as high as on Earth. 1 without gravity, and under a stronger one."""
    strength = float(np.linalg.norm(gravity))
    return 1.0 if strength == 0.0 else min(1.0, sqrt(strength / EARTH))


def make_contacts(cap: int = ROOM, pace: float = 1.0, bodies: int = ROOM, links: int = 0, most: int = 0) -> Contacts:
    """Allocate room for ``cap`` contact points of so many ``bodies`` and ``links`` with joints, at most so many of one avatar."""
    return Contacts(
        used=np.zeros(1, np.int64), body=np.zeros((cap, 2), np.int64), key=np.zeros(cap, np.int64),
        driven=np.zeros(cap, np.int64), face=np.zeros(cap, np.int64),
        frame=np.zeros((cap, 3, 3)), arm_a=np.zeros((cap, 3)), arm_b=np.zeros((cap, 3)),
        gap=np.zeros(cap), restitution=np.zeros(cap), friction=np.zeros(cap), bias_acceleration=np.zeros((cap, 3)),
        inverse_effective_mass=np.zeros((cap, 2)), jacobian_a=np.zeros((cap, 3, 3)), jacobian_b=np.zeros((cap, 3, 3)),
        turn_a=np.zeros((cap, 3, 3)), turn_b=np.zeros((cap, 3, 3)),
        target=np.zeros(cap), slide=np.zeros((cap, 2)), drift=np.zeros((cap, 2)),
        impulse=np.zeros((cap, 3)), standing=np.zeros(1, np.int64),
        visits=np.zeros(1, np.int64), edge_a=np.zeros((cap, 3)), edge_b=np.zeros((cap, 3)),
        sway_a=np.zeros((cap, 3)), sway_b=np.zeros((cap, 3)), smooth=np.zeros(cap, np.int64),
        radii_a=np.zeros((cap, 3, 3)), radii_b=np.zeros((cap, 3, 3)), turns=np.zeros((cap, 2)),
        effective_mass=np.zeros((cap, 2)), cross_response=np.zeros((cap, 2)),
        pace=np.full(1, pace), approach=np.zeros(cap), rows=np.zeros((cap, ROW)), motion=np.zeros((bodies, MOTION)),
        linked=np.full((cap, 2), NOT_LINKED), responses=make_responses(bodies, links, most),
    )


@kernel
def is_full(contacts: Contacts) -> bool:
    """Return whether there is no room for another contact."""
    return bool(contacts.used[0] >= contacts.gap.shape[0])


@kernel
def lacks_responses(contacts: Contacts) -> bool:
    """Return whether there is no room for the response of another avatar with joints."""
    used = contacts.responses.used[0]
    return bool(used > 0 and used >= contacts.responses.root.shape[0])


@kernel
def axis(contacts: Contacts, k: int, i: int) -> Vec3:
    """Return the normal (i = 0) or tangent (1, 2) of contact k."""
    return (contacts.frame[k, i, 0], contacts.frame[k, i, 1], contacts.frame[k, i, 2])


@kernel
def add_contact(contacts: Contacts, a: int, b: int, driven: int, n: Vec3, arm_a: Vec3, arm_b: Vec3, gap: float) -> bool:
    """Append a point with given normal and arms, all else zero; False if there is no room."""
    k = contacts.used[0]
    if is_full(contacts):
        return False
    contacts.used[0] = k + 1
    contacts.body[k, 0] = a
    contacts.body[k, 1] = b
    contacts.driven[k] = driven
    contacts.face[k] = 0
    contacts.smooth[k] = SHARP
    t = perpendicular(n)
    put_row(contacts.frame[k], 0, n)
    put_row(contacts.frame[k], 1, t)
    put_row(contacts.frame[k], 2, cross(n, t))
    put_row(contacts.arm_a, k, arm_a)
    put_row(contacts.arm_b, k, arm_b)
    contacts.gap[k] = gap
    put_row(contacts.bias_acceleration, k, (0.0, 0.0, 0.0))
    put_row(contacts.sway_a, k, (0.0, 0.0, 0.0))
    put_row(contacts.sway_b, k, (0.0, 0.0, 0.0))
    put_row(contacts.edge_a, k, (0.0, 0.0, 0.0))
    put_row(contacts.edge_b, k, (0.0, 0.0, 0.0))
    contacts.target[k] = 0.0
    for i in range(2):
        contacts.slide[k, i], contacts.drift[k, i], contacts.linked[k, i] = 0.0, 0.0, NOT_LINKED
    put_row(contacts.impulse, k, (0.0, 0.0, 0.0))
    return True


@kernel
def weigh(contacts: Contacts, masses: Masses) -> None:
    """Fill ``inverse_effective_mass``: 1/m_b + 1/m_a + A + B of eq. 9, and likewise across the normal; also levers and turns."""
    weigh_after(contacts, masses, 0.0)


@kernel
def weigh_after(contacts: Contacts, masses: Masses, t: float) -> None:
    """Do `weigh` with the arms as they are t seconds later, to first order."""
    weigh_from(contacts, masses, t, 0)


@kernel
def weigh_from(contacts: Contacts, masses: Masses, t: float, first: int) -> None:
    """Do `weigh_after` for the contacts from ``first`` on."""
    for k in range(first, contacts.used[0]):
        a, b = contacts.body[k, 0], contacts.body[k, 1]
        inertia_a, inertia_b = columns(masses.inverse_inertia, a), columns(masses.inverse_inertia, b)
        for i in range(3):
            along_axis = axis(contacts, k, i)
            jacobian_a = cross(along(row(contacts.arm_a, k), t, row(contacts.sway_a, k)), along_axis)
            jacobian_b = cross(along(row(contacts.arm_b, k), t, row(contacts.sway_b, k)), along_axis)
            put_row(contacts.jacobian_a[k], i, jacobian_a)
            put_row(contacts.jacobian_b[k], i, jacobian_b)
            put_row(contacts.turn_a[k], i, turned(inertia_a, jacobian_a))
            put_row(contacts.turn_b[k], i, turned(inertia_b, jacobian_b))
        straight = masses.inverse_mass[a] + masses.inverse_mass[b]
        contacts.inverse_effective_mass[k, 0] = straight + turning(contacts, k, 0, 0)
        one, other = straight + turning(contacts, k, 1, 1), straight + turning(contacts, k, 2, 2)
        contacts.inverse_effective_mass[k, 1] = largest_across(one, other, turning(contacts, k, 1, 2))
        for i in range(2):
            contacts.effective_mass[k, i] = 1.0 / contacts.inverse_effective_mass[k, i]
            contacts.cross_response[k, i] = turning(contacts, k, i + 1, 0)


@kernel
def largest_across(one: float, other: float, both: float) -> float:
    """Return larger eigenvalue of the symmetric 2 x 2 response across a normal [1/kg]: a step by its inverse never overshoots."""
    half, mean = 0.5 * (one - other), 0.5 * (one + other)
    return mean + sqrt(half * half + both * both)


@kernel
def turning(contacts: Contacts, k: int, i: int, j: int) -> float:
    """Return the turning part of the velocity along axis i of contact k per impulse along j [1/kg]: for normals A + B (eq. 9)."""
    on_a = dot(row(contacts.jacobian_a[k], i), row(contacts.turn_a[k], j))
    return float(on_a + dot(row(contacts.jacobian_b[k], i), row(contacts.turn_b[k], j)))


@kernel
def velocity_at(contacts: Contacts, k: int, linear: Array, angular: Array) -> Vec3:
    """Return v_ab [m/s] at contact k.

    For equations 7 to 10 it is the true one, less the drift. For paths (``standing``) a driven body that recedes counts as
    standing still along the normal: its pose does not change before the next frame, and a body that followed it would overlap it.
    """
    a, b = contacts.body[k, 0], contacts.body[k, 1]
    on_a = point_velocity(row(linear, a), row(angular, a), row(contacts.arm_a, k))
    on_b = point_velocity(row(linear, b), row(angular, b), row(contacts.arm_b, k))
    driven = contacts.driven[k]
    if driven != NOT_DRIVEN and contacts.standing[0] == 1:
        n = axis(contacts, k, 0)
        if driven == DRIVEN_A:
            on_a = along(on_a, -max(0.0, dot(n, on_a)), n)
        else:
            on_b = along(on_b, -min(0.0, dot(n, on_b)), n)
    v = relative_velocity(on_a, on_b)
    if driven != NOT_DRIVEN:
        v = along(along(v, -contacts.drift[k, 0], axis(contacts, k, 1)), -contacts.drift[k, 1], axis(contacts, k, 2))
    return v


@kernel
def impulse_of(contacts: Contacts, k: int) -> Vec3:
    """Return the impulse of contact k, on A, world axes [N s]."""
    p = row(contacts.impulse, k)
    j = (0.0, 0.0, 0.0)
    for i in range(3):
        j = along(j, p[i], axis(contacts, k, i))
    return j


@kernel
def speed_along(contacts: Contacts, k: int, i: int, linear: Array, angular: Array) -> float:
    """Return the part of `velocity_at` along axis i of contact k [m/s], from the levers that `weigh` left."""
    a, b = contacts.body[k, 0], contacts.body[k, 1]
    f, p, q = contacts.frame, contacts.jacobian_a, contacts.jacobian_b
    on_a = f[k, i, 0] * linear[a, 0] + f[k, i, 1] * linear[a, 1] + f[k, i, 2] * linear[a, 2]
    on_a += p[k, i, 0] * angular[a, 0] + p[k, i, 1] * angular[a, 1] + p[k, i, 2] * angular[a, 2]
    on_b = f[k, i, 0] * linear[b, 0] + f[k, i, 1] * linear[b, 1] + f[k, i, 2] * linear[b, 2]
    on_b += q[k, i, 0] * angular[b, 0] + q[k, i, 1] * angular[b, 1] + q[k, i, 2] * angular[b, 2]
    if i == 0 and contacts.driven[k] != NOT_DRIVEN and contacts.standing[0] == 1:
        if contacts.driven[k] == DRIVEN_A:
            on_a = min(0.0, on_a)
        else:
            on_b = max(0.0, on_b)
    drift = contacts.drift[k, i - 1] if i > 0 else 0.0
    return float(on_a - on_b - drift)


# An impulse at a contact, applied to its two bodies: velocities change by M^-1 J^T times the impulse.


@kernel
def push(contacts: Contacts, masses: Masses, k: int, j: Vec3, linear: Array, angular: Array) -> None:
    """Apply the impulse j [N s] (world axes) to A and -j to B at contact k."""
    a, b = contacts.body[k, 0], contacts.body[k, 1]
    put_row(linear, a, along(row(linear, a), masses.inverse_mass[a], j))
    put_row(linear, b, along(row(linear, b), -masses.inverse_mass[b], j))
    turn_a = turned(columns(masses.inverse_inertia, a), cross(row(contacts.arm_a, k), j))
    turn_b = turned(columns(masses.inverse_inertia, b), cross(row(contacts.arm_b, k), j))
    put_row(angular, a, along(row(angular, a), 1.0, turn_a))
    put_row(angular, b, sub(row(angular, b), turn_b))


@kernel
def push_along(contacts: Contacts, masses: Masses, k: int, i: int, d: float, linear: Array, angular: Array) -> None:
    """Apply the impulse d [N s] along axis i of contact k to A and -d to B, by the rows of M^-1 J^T from `weigh`."""
    a, b = contacts.body[k, 0], contacts.body[k, 1]
    f, p, q = contacts.frame, contacts.turn_a, contacts.turn_b
    on_a, on_b = d * masses.inverse_mass[a], d * masses.inverse_mass[b]
    for x in range(3):
        linear[a, x] += on_a * f[k, i, x]
        linear[b, x] -= on_b * f[k, i, x]
        angular[a, x] += d * p[k, i, x]
        angular[b, x] -= d * q[k, i, x]


@kernel
def push_all(contacts: Contacts, masses: Masses, k: int, d: Vec3, linear: Array, angular: Array) -> None:
    """Apply `push_along` for all three axes of contact k at once."""
    a, b = contacts.body[k, 0], contacts.body[k, 1]
    f, p, q = contacts.frame, contacts.turn_a, contacts.turn_b
    of_a, of_b = masses.inverse_mass[a], masses.inverse_mass[b]
    for x in range(3):
        j = d[0] * f[k, 0, x] + d[1] * f[k, 1, x] + d[2] * f[k, 2, x]
        linear[a, x] += of_a * j
        linear[b, x] -= of_b * j
        angular[a, x] += d[0] * p[k, 0, x] + d[1] * p[k, 1, x] + d[2] * p[k, 2, x]
        angular[b, x] -= d[0] * q[k, 0, x] + d[1] * q[k, 1, x] + d[2] * q[k, 2, x]


@kernel
def scale_impulses(contacts: Contacts, factor: float) -> None:
    """Scale the impulses of all contacts: forces to impulses, or to those of a shorter time."""
    for k in range(contacts.used[0]):
        for i in range(3):
            contacts.impulse[k, i] *= factor


# Warm start: a hash table of the last segment's forces by contact key. An entry is valid as long as its body has had no other
# segment since; a contact without one starts from zero.

SLOTS_PER_POINT = 4
"""Slots of the table per contact point that there may be at once; fewer: more forces are lost and solved for from zero."""

TRIES = 12
"""Slots probed for a key (linear probing)."""

SPREAD, SHIFT = 40503, 7
"""Multiplier and shift that spread neighbouring keys over the table; the product of any key stays far below 2^63."""


class LastForces(NamedTuple):
    """key, body, turn (slots): name of the point, a body that it belongs to, and the segment of that; force (slots, 3) [N];
    latest (nb): last segment of each body; turns (1): segments so far."""

    key: Annotated[IndexLine, COUNT_OR_NONE]
    body: Annotated[IndexLine, BODY]
    turn: Annotated[IndexLine, COUNT_OR_NONE]
    force: Vectors
    latest: Annotated[IndexLine, COUNT_OR_NONE]
    turns: Annotated[IndexLine, COUNT_OR_NONE]


def make_last_forces(bodies: int, points: int) -> LastForces:
    """Allocate an empty table for so many bodies and contact points; its size is a power of two."""
    slots = 1 << (SLOTS_PER_POINT * points - 1).bit_length()
    return LastForces(
        np.full(slots, -1, np.int64), np.zeros(slots, np.int64), np.zeros(slots, np.int64), np.zeros((slots, 3)),
        np.zeros(bodies, np.int64), np.zeros(1, np.int64),
    )


@kernel
def slot_of(table: LastForces, key: int, tried: int) -> int:
    """Return the slot number ``tried`` of the probe sequence of ``key``."""
    return int(((key * SPREAD >> SHIFT) + tried) & (table.key.shape[0] - 1))


@kernel
def recall_forces(contacts: Contacts, table: LastForces) -> None:
    """Give every point the force [N] that the point of the same key had in the last segment; zero if there was none.

    A point without friction gets the normal force only, since no sweep would remove the rest.
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
