"""What a pass of the contact solver reads of a contact, in one row of memory and scaled so that little is left to multiply.

The contacts of a pass wait for one another's velocities, so what counts is how few operations follow each other.
"""

import numpy as np
from numpy.typing import NDArray

from avatarsim.impact.contacts import Contacts, axis
from avatarsim.impact.masses import Masses
from avatarsim.kernel import kernel
from avatarsim.spatial.vec3 import Vec3, row, scale

Array = NDArray[np.float64]

WISH, WISH_SIZE = 0, 9
"""From here on, for each axis of the frame: the axis and its levers on A and on B, each over the ease of the axis. Their products
with the velocities are the impulse that would stop the point along the axis."""

GIFT, GIFT_SIZE = 27, 12
"""From here on, for each axis: what an impulse along it adds to v and w of A and takes from v and w of B."""

DRAG, EASE, TARGET, SLIDE, FRICTION = 63, 65, 67, 68, 70
"""Impulses along the tangents that one along the normal costs; eases along and across the normal; target and slide over the ease;
friction."""


@kernel
def three(rows: Array, k: int, at: int) -> Vec3:
    """Three numbers of row k from column ``at`` on."""
    return (rows[k, at], rows[k, at + 1], rows[k, at + 2])


@kernel
def put_three(rows: Array, k: int, at: int, x: Vec3) -> None:
    """Write three numbers of row k from column ``at`` on."""
    rows[k, at], rows[k, at + 1], rows[k, at + 2] = x


@kernel
def lay_out(contacts: Contacts, masses: Masses, first: int, last: int) -> None:
    """Fill ``contacts.rows`` of first <= k < last from what `weigh` left, and from targets, slides and frictions."""
    rows = contacts.rows
    for k in range(first, last):
        a, b = contacts.body[k, 0], contacts.body[k, 1]
        for i in range(3):
            per, n = contacts.unease[k, min(i, 1)], axis(contacts, k, i)
            wish, gift = WISH + WISH_SIZE * i, GIFT + GIFT_SIZE * i
            put_three(rows, k, wish, scale(n, per))
            put_three(rows, k, wish + 3, scale(row(contacts.lever_a[k], i), per))
            put_three(rows, k, wish + 6, scale(row(contacts.lever_b[k], i), per))
            put_three(rows, k, gift, scale(n, masses.inverse_mass[a]))
            put_three(rows, k, gift + 3, row(contacts.turn_a[k], i))
            put_three(rows, k, gift + 6, scale(n, masses.inverse_mass[b]))
            put_three(rows, k, gift + 9, row(contacts.turn_b[k], i))
        for i in range(2):
            rows[k, DRAG + i] = contacts.drag[k, i] * contacts.unease[k, 1]
            rows[k, EASE + i] = contacts.ease[k, i]
            rows[k, SLIDE + i] = contacts.slide[k, i] * contacts.unease[k, 1]
        rows[k, TARGET] = contacts.target[k] * contacts.unease[k, 0]
        rows[k, FRICTION] = contacts.friction[k]
