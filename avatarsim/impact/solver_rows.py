"""Packed rows of the contact solver: Jacobian, M^-1 J^T, bias velocity and effective mass of a contact in one row of memory.

Numbers are packed in fours, for vector instructions, and scaled by the effective mass; those of the normal come first, since many
contacts have no friction. Velocities are packed in fours as well during a solve.
"""

import numpy as np
from numpy.typing import NDArray

from avatarsim.impact.contacts import Contacts, axis
from avatarsim.impact.masses import Masses
from avatarsim.jit.kernel import kernel
from avatarsim.spatial.vec3 import Vec3, put_row, row, scale

Array = NDArray[np.float64]

LANES = 4
"""Numbers taken at a time; the last one of each four is zero."""

GIFT, PARTS = 0, 4
"""M^-1 J^T of the normal, in so many parts of four: added to v and w of A and taken from v and w of B per impulse."""

WISH, WISH_SIZE = 16, 9
"""Jacobian of the normal (the normal, its levers on A and on B) times the effective mass: its product with the velocities is the
impulse that would stop the point along the normal."""

TARGET, EASE, FRICTION, SLIDE = 25, 26, 28, 29
"""Bias velocity times effective mass; inverse effective masses along and across the normal; coefficient of friction; slide along
the tangents times effective mass."""

ALL_WISHES = 32
"""The same nine numbers for the normal and both tangents, interleaved: the first of each, then the second of each."""

SIDE_GIFT = 68
"""M^-1 J^T of each tangent, packed as that of the normal."""

DRAG = 100
"""Impulses along the tangents that balance the slip due to a unit impulse along the normal."""


@kernel
def three(rows: Array, k: int, at: int) -> Vec3:
    """Three numbers of row k from column ``at`` on."""
    return (rows[k, at], rows[k, at + 1], rows[k, at + 2])


@kernel
def put_three(rows: Array, k: int, at: int, x: Vec3) -> None:
    """Write three numbers of row k from column ``at`` on."""
    rows[k, at], rows[k, at + 1], rows[k, at + 2] = x


@kernel
def lay_out(contacts: Contacts, masses: Masses, first: int, last: int, linear: Array, angular: Array) -> None:
    """Fill ``contacts.rows`` of first <= k < last from what `weigh` left, and from targets, slides and frictions; and
    ``contacts.motion`` of their bodies from linear, angular (nb, 3).

    The tangential part of a contact without friction and without tangential impulse is neither written nor read.
    """
    rows, motion = contacts.rows, contacts.motion
    for k in range(first, last):
        a, b = contacts.body[k, 0], contacts.body[k, 1]
        for body in (a, b):
            put_three(motion, body, 0, row(linear, body))
            put_three(motion, body, LANES, row(angular, body))
        flat = contacts.friction[k] == 0.0 and contacts.impulse[k, 1] == 0.0 and contacts.impulse[k, 2] == 0.0
        for i in range(1 if flat else 3):
            per, n = contacts.unease[k, min(i, 1)], axis(contacts, k, i)
            gift = GIFT if i == 0 else SIDE_GIFT + (i - 1) * LANES * PARTS
            put_three(rows, k, gift, scale(n, masses.inverse_mass[a]))
            put_three(rows, k, gift + LANES, row(contacts.turn_a[k], i))
            put_three(rows, k, gift + 2 * LANES, scale(n, masses.inverse_mass[b]))
            put_three(rows, k, gift + 3 * LANES, row(contacts.turn_b[k], i))
            for part in range(3):
                lever = n if part == 0 else row(contacts.lever_a[k], i) if part == 1 else row(contacts.lever_b[k], i)
                for x in range(3):
                    rows[k, ALL_WISHES + LANES * (3 * part + x) + i] = lever[x] * per
        for c in range(WISH_SIZE):
            rows[k, WISH + c] = rows[k, ALL_WISHES + LANES * c]
        for i in range(2):
            rows[k, DRAG + i] = contacts.drag[k, i] * contacts.unease[k, 1]
            rows[k, EASE + i] = contacts.ease[k, i]
            rows[k, SLIDE + i] = (contacts.slide[k, i] + contacts.drift[k, i]) * contacts.unease[k, 1]
        rows[k, TARGET] = contacts.target[k] * contacts.unease[k, 0]
        rows[k, FRICTION] = contacts.friction[k]


@kernel
def take_motion(contacts: Contacts, first: int, last: int, linear: Array, angular: Array) -> None:
    """Copy the velocities in ``contacts.motion`` of the bodies of first <= k < last back to linear, angular (nb, 3)."""
    for k in range(first, last):
        for side in range(2):
            body = contacts.body[k, side]
            put_row(linear, body, three(contacts.motion, body, 0))
            put_row(angular, body, three(contacts.motion, body, LANES))
