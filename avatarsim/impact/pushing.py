"""Application of an impulse at a contact to its two bodies: velocities change by M^-1 J^T times the impulse."""

import numpy as np
from numpy.typing import NDArray

from avatarsim.impact.contacts import Contacts
from avatarsim.impact.masses import Masses
from avatarsim.jit.kernel import kernel
from avatarsim.spatial.tangent import columns, turned
from avatarsim.spatial.vec3 import Vec3, along, cross, put_row, row, sub

Array = NDArray[np.float64]


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
    """`push_along` all three axes of contact k at once."""
    a, b = contacts.body[k, 0], contacts.body[k, 1]
    f, p, q = contacts.frame, contacts.turn_a, contacts.turn_b
    of_a, of_b = masses.inverse_mass[a], masses.inverse_mass[b]
    for x in range(3):
        j = d[0] * f[k, 0, x] + d[1] * f[k, 1, x] + d[2] * f[k, 2, x]
        linear[a, x] += of_a * j
        linear[b, x] -= of_b * j
        angular[a, x] += d[0] * p[k, 0, x] + d[1] * p[k, 1, x] + d[2] * p[k, 2, x]
        angular[b, x] -= d[0] * q[k, 0, x] + d[1] * q[k, 1, x] + d[2] * q[k, 2, x]
