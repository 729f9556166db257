"""The points where bodies touch at one instant, and what an impulse at each of them does."""

from math import sqrt
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from avatarsim.impact.masses import Masses, yielding
from avatarsim.impact.relative_velocity import point_velocity, relative_velocity
from avatarsim.kernel import kernel
from avatarsim.spatial.tangent import columns, turned
from avatarsim.spatial.vec3 import Vec3, along, cross, dot, perpendicular, put_row, row, sub

Array = NDArray[np.float64]
Index = NDArray[np.int64]

ROOM = 2048
"""Contact points held at once. A wall of 100 boxes has about 1000; more is reported as a status, never dropped."""

NOT_DRIVEN, DRIVEN_A, DRIVEN_B = 0, 1, 2
"""Which body of a contact follows the user: its path is given, and it does not move while simulated bodies do."""


class Contacts(NamedTuple):
    """Contact points k < used[0]; those of one pair of bodies stand together.

    body (cap, 2) A and B; key (cap) names the point from one segment to the next; driven (cap) one of the above;
    face (cap) 1 or 2 if the normal belongs to a face of A or of B and turns with it, else 0;
    frame (cap, 3, 3) rows: normal out of B into A, two tangents; arm_a, arm_b (cap, 3) from the centres of mass [m];
    gap (cap) [m]; restitution, friction (cap); bend (cap, 3) acceleration of A's point seen from B's that needs no force [m/s^2];
    ease (cap, 2) velocity per impulse along the normal, and largest across it [1/kg];
    target (cap) least normal velocity asked for [m/s], -inf where a point takes no part;
    slide (cap, 2) velocity along the tangents at which friction has nothing to do [m/s];
    impulse (cap, 3) along the rows of frame [N s];
    standing (1) 1 while a driven body that recedes counts as standing still along the normal: see `velocity_at`.
    """

    used: Index
    body: Index
    key: Index
    driven: Index
    face: Index
    frame: Array
    arm_a: Array
    arm_b: Array
    gap: Array
    restitution: Array
    friction: Array
    bend: Array
    ease: Array
    target: Array
    slide: Array
    impulse: Array
    standing: Index


def make_contacts(cap: int = ROOM) -> Contacts:
    """Allocate room for ``cap`` contact points."""
    return Contacts(
        used=np.zeros(1, np.int64), body=np.zeros((cap, 2), np.int64), key=np.zeros(cap, np.int64),
        driven=np.zeros(cap, np.int64), face=np.zeros(cap, np.int64),
        frame=np.zeros((cap, 3, 3)), arm_a=np.zeros((cap, 3)), arm_b=np.zeros((cap, 3)),
        gap=np.zeros(cap), restitution=np.zeros(cap), friction=np.zeros(cap), bend=np.zeros((cap, 3)), ease=np.zeros((cap, 2)),
        target=np.zeros(cap), slide=np.zeros((cap, 2)), impulse=np.zeros((cap, 3)), standing=np.zeros(1, np.int64),
    )


@kernel
def axis(contacts: Contacts, k: int, i: int) -> Vec3:
    """Normal (i = 0) or tangent (1, 2) of contact k."""
    return (contacts.frame[k, i, 0], contacts.frame[k, i, 1], contacts.frame[k, i, 2])


@kernel
def add_contact(contacts: Contacts, a: int, b: int, driven: int, n: Vec3, arm_a: Vec3, arm_b: Vec3, gap: float) -> bool:
    """Append a point with given normal and arms, all else zero; False if there is no room."""
    k = contacts.used[0]
    if k >= contacts.gap.shape[0]:
        return False
    contacts.used[0] = k + 1
    contacts.body[k, 0] = a
    contacts.body[k, 1] = b
    contacts.driven[k] = driven
    contacts.face[k] = 0
    t = perpendicular(n)
    put_row(contacts.frame[k], 0, n)
    put_row(contacts.frame[k], 1, t)
    put_row(contacts.frame[k], 2, cross(n, t))
    put_row(contacts.arm_a, k, arm_a)
    put_row(contacts.arm_b, k, arm_b)
    contacts.gap[k] = gap
    put_row(contacts.bend, k, (0.0, 0.0, 0.0))
    contacts.target[k] = 0.0
    contacts.slide[k, 0] = 0.0
    contacts.slide[k, 1] = 0.0
    put_row(contacts.impulse, k, (0.0, 0.0, 0.0))
    return True


@kernel
def weigh(contacts: Contacts, masses: Masses) -> None:
    """Fill ``ease`` of all contacts: 1/m_b + 1/m_a + A + B of eq. 9, and the same across the normal."""
    for k in range(contacts.used[0]):
        n, s, t = axis(contacts, k, 0), axis(contacts, k, 1), axis(contacts, k, 2)
        contacts.ease[k, 0] = dot(n, response(contacts, masses, k, n))
        u, w = response(contacts, masses, k, s), response(contacts, masses, k, t)
        half, mean = 0.5 * (dot(s, u) - dot(t, w)), 0.5 * (dot(s, u) + dot(t, w))
        # the larger eigenvalue of the 2 x 2 block: a step by its inverse never overshoots
        contacts.ease[k, 1] = mean + sqrt(half * half + dot(s, w) * dot(s, w))


@kernel
def response(contacts: Contacts, masses: Masses, k: int, j: Vec3) -> Vec3:
    """Change of v_ab [m/s] at contact k under the impulse j [N s] on A and -j on B."""
    a, b = contacts.body[k, 0], contacts.body[k, 1]
    return relative_velocity(
        yielding(masses, a, row(contacts.arm_a, k), j), yielding(masses, b, row(contacts.arm_b, k), (-j[0], -j[1], -j[2]))
    )


@kernel
def velocity_at(contacts: Contacts, k: int, linear: Array, angular: Array) -> Vec3:
    """v_ab [m/s] at contact k.

    For equations 7 to 10 it is the true one. For paths (``standing``) a driven body that recedes counts as standing still along
    the normal: its pose does not change before the next frame, and whoever followed it would end up inside it.
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
    return relative_velocity(on_a, on_b)


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
def impulse_of(contacts: Contacts, k: int) -> Vec3:
    """The impulse held by contact k, on A, world axes [N s]."""
    p = row(contacts.impulse, k)
    j = (0.0, 0.0, 0.0)
    for i in range(3):
        j = along(j, p[i], axis(contacts, k, i))
    return j
