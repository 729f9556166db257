"""One pass of the contact solver: every contact in turn takes what it wants, and velocities follow at once.

Nearly all time of bodies in motion goes by here, so a pass is one kernel, which calls nobody.
"""

from math import inf, sqrt

import numpy as np
from numpy.typing import NDArray

from avatarsim.impact.contacts import DRIVEN_A, NOT_DRIVEN, Contacts
from avatarsim.impact.four_at_once import give, give_along_normal, wishes
from avatarsim.impact.solver_rows import DRAG, EASE, FRICTION, LANES, SLIDE, TARGET, WISH, three
from avatarsim.kernel import kernel
from avatarsim.seldom import seldom
from avatarsim.spatial.vec3 import add, dot, put_row, row, scale, sub

Array = NDArray[np.float64]


@kernel
def wish_along_normal(rows: Array, k: int, motion: Array, a: int, b: int) -> float:
    """Impulse that would stop contact k of bodies a and b along its normal: the first of `wishes`."""
    u = sub(three(motion, a, 0), three(motion, b, 0))
    w_a, w_b = three(motion, a, LANES), three(motion, b, LANES)
    return dot(three(rows, k, WISH), u) + (dot(three(rows, k, WISH + 3), w_a) - dot(three(rows, k, WISH + 6), w_b))


@kernel
def wish_beside_driven(rows: Array, k: int, motion: Array, a: int, b: int, driven: int) -> float:
    """The same where a driven body that recedes counts as standing still: see `contacts.velocity_at`."""
    on_a = dot(three(rows, k, WISH), three(motion, a, 0)) + dot(three(rows, k, WISH + 3), three(motion, a, LANES))
    on_b = dot(three(rows, k, WISH), three(motion, b, 0)) + dot(three(rows, k, WISH + 6), three(motion, b, LANES))
    return min(0.0, on_a) - on_b if driven == DRIVEN_A else on_a - max(0.0, on_b)


@kernel
def visit_all(contacts: Contacts, first: int, last: int, back: bool, grip: bool, before: Array) -> tuple[float, float]:
    """Contacts first <= k < last take what they want, normal first, friction if ``grip``; from the last to the first if ``back``.

    The slip after the push along the normal is the slip before it and what the push drags along, so nobody waits for the
    velocities in between: `contact_solver.wanted_normal` and `wanted_friction` in one.

    Args:
        contacts: after `lay_out`; ``motion`` changes. before: (cap, 3) gets the impulses held on entry, unless ``back``.

    Returns:
        (largest change [m/s], sum of squares of impulse - before, times the ease along the normal).
    """
    impulse, rows, motion, body, driven = contacts.impulse, contacts.rows, contacts.motion, contacts.body, contacts.driven
    standing, worst, square = contacts.standing[0], 0.0, 0.0
    for turn in range(last - first):
        # an index that cannot be negative is not counted from the end: four operations less for every array
        k = max(0, last - 1 - turn if back else first + turn)
        held = row(impulse, k)
        if not back:
            put_row(before, k, held)
        if rows[k, TARGET] == -inf:
            continue
        a, b = max(0, body[k, 0]), max(0, body[k, 1])
        rough = rows[k, FRICTION] if grip else 0.0
        if rough > 0.0:
            short, short_x, short_y = wishes(rows, k, motion, a, b)
        else:
            short, short_x, short_y = wish_along_normal(rows, k, motion, a, b), 0.0, 0.0
        if standing == 1 and driven[k] != NOT_DRIVEN:
            short = wish_beside_driven(rows, k, motion, a, b, driven[k])
        normal = max(0.0, (held[0] + rows[k, TARGET]) - short)
        dn, dx, dy = normal - held[0], 0.0, 0.0
        if rough > 0.0 and (normal > 0.0 or held[1] != 0.0 or held[2] != 0.0):
            x = (held[1] + rows[k, SLIDE] - short_x) - rows[k, DRAG] * dn
            y = (held[2] + rows[k, SLIDE + 1] - short_y) - rows[k, DRAG + 1] * dn
            limit, length = rough * normal, x * x + y * y
            if seldom(length > limit * limit):
                share = limit / sqrt(length)
                x, y = x * share, y * share
            dx, dy = x - held[1], y - held[2]
        moved = max(abs(dn) * rows[k, EASE], (abs(dx) + abs(dy)) * rows[k, EASE + 1])
        worst = max(worst, moved)
        if moved > 0.0:
            held = add(held, (dn, dx, dy))
            put_row(impulse, k, held)
            if rough > 0.0:
                give(rows, k, (dn, dx, dy), motion, a, b)
            else:
                give_along_normal(rows, k, dn, motion, a, b)
        if back:
            way = sub(held, row(before, k))
            square += dot(way, way) * rows[k, EASE]
    return worst, square


@kernel
def go_on_along(contacts: Contacts, first: int, last: int, beta: float, before: Array, direction: Array) -> None:
    """All go on by ``beta`` times the way of last time; ``direction`` becomes that and the way since ``before``."""
    impulse, rows, motion, body = contacts.impulse, contacts.rows, contacts.motion, contacts.body
    for turn in range(last - first):
        k = max(0, first + turn)
        if rows[k, TARGET] == -inf:
            continue
        held = row(impulse, k)
        way = sub(held, row(before, k))
        if beta > 0.0:
            d = scale(row(direction, k), beta)
            way = add(way, d)
            if dot(d, d) > 0.0:
                put_row(impulse, k, add(held, d))
                if d[1] != 0.0 or d[2] != 0.0:
                    give(rows, k, d, motion, body[k, 0], body[k, 1])
                else:
                    give_along_normal(rows, k, d[0], motion, body[k, 0], body[k, 1])
        put_row(direction, k, way)
