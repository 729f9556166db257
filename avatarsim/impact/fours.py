"""Contacts of balls, laid out so that a pass of the solver takes four of them at once.

What touches a ball along the line to its centre turns it by nothing but friction, and by the same around any axis: such a contact
is its three axes and a dozen numbers. Four that have no body in common change nothing that one of the others reads, so it is all
the same whether they go one after the other or side by side. Contacts of one colour have no moving body in common.
"""

from math import inf

import numpy as np
from numpy.typing import NDArray

from avatarsim.impact.contacts import COLOURS, MOTION, NOT_DRIVEN, ROW, Contacts, axis
from avatarsim.impact.masses import Masses
from avatarsim.impact.solver_rows import LANES, put_three, three
from avatarsim.kernel import kernel
from avatarsim.spatial.vec3 import dot, put_row, row

Array = NDArray[np.float64]

NORMAL, TANGENTS = 0, 3
"""Places in a four, of which each holds a number of every one of its contacts: the axes, three numbers each."""

ARM, MASS, TURN = 9, 11, 13
"""For A and for B: arm along the normal; inverse mass; turn per impulse along a tangent."""

PER, TARGET, EASE, FRICTION, SLIDE = 15, 17, 18, 20, 21
"""As in `solver_rows`, but PER: impulse per velocity along the normal and across it."""

HELD, BEFORE, DIRECTION, PLACES = 23, 26, 29, 32
"""Impulse along each axis, the same when a double sweep began, and the way that it took last."""

ROWS_OF_FOUR = 2
"""Rows of `Contacts.rows` in which the places of a four lie."""

CONTACT, READ, WRITTEN = 0, 1, 3
"""Columns of `Contacts.lanes`, of which four rows belong to a four: number of the contact, -1 for none; rows of
`Contacts.motion` where velocities of A and B are read, and where they are written."""

SILENT, WASTE = -2, -1
"""Rows of `Contacts.motion` for what nobody moves: it has no velocity, and what it gets is written where nobody reads it, or all
who touch it would have to wait for one another."""

LEAST = 12
"""Fewer contacts than this have hardly four to take at once."""

ROUND = 1e-9
"""Parts of an arm across the normal, and of an inertia that differs from axis to axis, below this are rounding."""


@kernel
def place(rows: Array, g: int, at: int, lane: int) -> tuple[int, int]:
    """Row and column of the number ``at`` of a contact in four g."""
    beyond = at // (ROW // LANES)
    return ROWS_OF_FOUR * g + beyond, LANES * (at - beyond * (ROW // LANES)) + lane


@kernel
def put_places(rows: Array, g: int, at: int, lane: int, x: tuple[float, float, float]) -> None:
    """Write three numbers of a contact in four g, from number ``at`` on."""
    for i in range(3):
        rows[place(rows, g, at + i, lane)] = x[i]


@kernel
def turns_evenly(masses: Masses, b: int) -> bool:
    """Whether body b turns as easily about any axis."""
    m, i = masses.inverse_inertia, masses.inverse_inertia[b, 0, 0]
    apart = max(abs(m[b, 0, 1]), abs(m[b, 0, 2]), abs(m[b, 1, 2]), abs(m[b, 1, 1] - i), abs(m[b, 2, 2] - i))
    return bool(apart <= ROUND * i)


@kernel
def arm_along(contacts: Contacts, k: int, side: int) -> float:
    """Arm of contact k along its normal, from what `weigh` left."""
    lever = row(contacts.lever_a[k] if side == 0 else contacts.lever_b[k], 1)
    return dot(lever, axis(contacts, k, 2))


@kernel
def are_of_balls(contacts: Contacts, masses: Masses, first: int, last: int, linear: Array, angular: Array) -> bool:
    """Whether of those first <= k < last that have a target all are of balls, or of a ball and what stands."""
    for k in range(first, last):
        if contacts.target[k] == -inf:
            continue
        if contacts.driven[k] != NOT_DRIVEN:
            return False
        for side in range(2):
            b = contacts.body[k, side]
            if masses.inverse_mass[b] == 0.0:
                if dot(row(linear, b), row(linear, b)) + dot(row(angular, b), row(angular, b)) != 0.0:
                    return False
                continue
            across, arm = row(contacts.lever_a[k] if side == 0 else contacts.lever_b[k], 0), arm_along(contacts, k, side)
            if not (turns_evenly(masses, b) and dot(across, across) <= ROUND * ROUND * arm * arm):
                return False
    return True


@kernel
def paint(contacts: Contacts, masses: Masses, first: int, last: int) -> int:
    """Give every contact that has a target a colour; returns how many fours that makes, 0 if there are too many of a body.

    Those with friction and those without have colours of their own. ``contacts.many`` becomes the first four of each colour.
    """
    colour, many, worn, fours = contacts.colour, contacts.many, contacts.worn, 0
    many[:] = 0
    for k in range(first, last):
        worn[contacts.body[k, 0]], worn[contacts.body[k, 1]] = 0, 0
    for k in range(first, last):
        colour[k] = -1
        if contacts.target[k] == -inf:
            continue
        a, b, c = contacts.body[k, 0], contacts.body[k, 1], 0
        taken = (worn[a] if masses.inverse_mass[a] > 0.0 else 0) | (worn[b] if masses.inverse_mass[b] > 0.0 else 0)
        while taken >> c & 1:
            c += 1
        if c >= COLOURS:
            return 0
        worn[a] |= 1 << c
        worn[b] |= 1 << c
        colour[k] = c if contacts.friction[k] > 0.0 else COLOURS + c
        many[colour[k]] += 1
    for c in range(2 * COLOURS):
        ones = (many[c] + LANES - 1) // LANES
        many[c] = fours
        fours += ones
    return fours


@kernel
def lay_out_fours(contacts: Contacts, masses: Masses, first: int, last: int, linear: Array, angular: Array) -> int:
    """`solver_rows.lay_out` in fours, if the contacts are of balls; returns how many fours, 0 if they are not laid out."""
    rows, lanes, motion = contacts.rows, contacts.lanes, contacts.motion
    if last - first < LEAST or not are_of_balls(contacts, masses, first, last, linear, angular):
        return 0
    fours = paint(contacts, masses, first, last)
    if LANES * fours > rows.shape[0]:
        return 0
    silent, waste = motion.shape[0] + SILENT, motion.shape[0] + WASTE
    for x in range(MOTION):
        motion[silent, x], motion[waste, x] = 0.0, 0.0
    for g in range(fours):
        for at in range(LANES * PLACES):
            rows[ROWS_OF_FOUR * g + at // ROW, at % ROW] = 0.0
        for i in range(LANES):
            lanes[LANES * g + i, CONTACT] = -1
            lanes[LANES * g + i, READ], lanes[LANES * g + i, READ + 1] = silent, silent
            lanes[LANES * g + i, WRITTEN], lanes[LANES * g + i, WRITTEN + 1] = waste, waste
    for k in range(first, last):
        if contacts.colour[k] < 0:
            continue
        g, i = contacts.many[contacts.colour[k]], 0
        while lanes[LANES * g + i, CONTACT] >= 0:
            i += 1
        lanes[LANES * g + i, CONTACT] = k
        contacts.many[contacts.colour[k]] += 1 if i == LANES - 1 else 0
        for x in range(3):
            put_places(rows, g, NORMAL + 3 * x, i, axis(contacts, k, x))
        for side in range(2):
            b = contacts.body[k, side]
            if masses.inverse_mass[b] > 0.0:
                put_three(motion, b, 0, row(linear, b))
                put_three(motion, b, LANES, row(angular, b))
                lanes[LANES * g + i, READ + side], lanes[LANES * g + i, WRITTEN + side] = b, b
                arm = arm_along(contacts, k, side)
                rows[place(rows, g, ARM + side, i)] = arm
                rows[place(rows, g, MASS + side, i)] = masses.inverse_mass[b]
                rows[place(rows, g, TURN + side, i)] = arm * masses.inverse_inertia[b, 0, 0]
            rows[place(rows, g, PER + side, i)] = contacts.unease[k, side]
            rows[place(rows, g, EASE + side, i)] = contacts.ease[k, side]
            rows[place(rows, g, SLIDE + side, i)] = contacts.slide[k, side] * contacts.unease[k, 1]
        rows[place(rows, g, TARGET, i)] = contacts.target[k] * contacts.unease[k, 0]
        rows[place(rows, g, FRICTION, i)] = contacts.friction[k]
        put_places(rows, g, HELD, i, row(contacts.impulse, k))
    return fours


@kernel
def take_fours(contacts: Contacts, fours: int, linear: Array, angular: Array) -> None:
    """Write what passes made of impulses and velocities of so many fours to ``contacts.impulse`` and linear, angular (nb, 3)."""
    rows, lanes, motion = contacts.rows, contacts.lanes, contacts.motion
    for g in range(fours):
        for i in range(LANES):
            k = lanes[LANES * g + i, CONTACT]
            if k < 0:
                continue
            for x in range(3):
                contacts.impulse[k, x] = rows[place(rows, g, HELD + x, i)]
            for side in range(2):
                b = lanes[LANES * g + i, WRITTEN + side]
                if b < motion.shape[0] + SILENT:
                    put_row(linear, b, three(motion, b, 0))
                    put_row(angular, b, three(motion, b, LANES))
