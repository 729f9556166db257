"""One pass of the contact solver: every contact in turn takes what it wants, and velocities follow at once.

Nearly all time of bodies in motion goes by here, so a pass is one kernel that calls nothing larger than a sum of three products.
"""

from math import inf, sqrt

import numpy as np
from numpy.typing import NDArray

from avatarsim.impact.contacts import DRIVEN_A, NOT_DRIVEN, Contacts
from avatarsim.impact.solver_rows import DRAG, EASE, FRICTION, GIFT, GIFT_SIZE, SLIDE, TARGET, WISH, WISH_SIZE, three
from avatarsim.kernel import kernel
from avatarsim.spatial.vec3 import Vec3, add, dot, put_row, row, scale, sub

Array = NDArray[np.float64]


@kernel
def short_of(rows: Array, k: int, i: int, u: Vec3, w_a: Vec3, w_b: Vec3) -> float:
    """Impulse that would stop contact k along axis i, where A's centre moves at u as seen from B's."""
    at = WISH + WISH_SIZE * i
    return dot(three(rows, k, at), u) + (dot(three(rows, k, at + 3), w_a) - dot(three(rows, k, at + 6), w_b))


@kernel
def given(rows: Array, k: int, part: int, d: Vec3) -> Vec3:
    """What the impulse d in the frame of contact k does to part 0, 1, 2 or 3: v of A, w of A, v of B, w of B."""
    at = GIFT + 3 * part
    along = scale(three(rows, k, at), d[0])
    return add(along, add(scale(three(rows, k, at + GIFT_SIZE), d[1]), scale(three(rows, k, at + 2 * GIFT_SIZE), d[2])))


@kernel
def visit_all(
    contacts: Contacts, first: int, last: int, back: bool, grip: bool, linear: Array, angular: Array, before: Array
) -> tuple[float, float]:
    """Contacts first <= k < last take what they want, normal first, friction if ``grip``; from the last to the first if ``back``.

    The slip after the push along the normal is the slip before it and what the push drags along, so nobody waits for the
    velocities in between: `contact_solver.wanted_normal` and `wanted_friction` in one.

    Args:
        contacts: after `lay_out`.
        linear, angular: (nb, 3), changed. before: (cap, 3) gets the impulses held on entry, unless ``back``.

    Returns:
        (largest change [m/s], sum of squares of impulse - before, times the ease along the normal).
    """
    impulse, rows, body, driven, standing = contacts.impulse, contacts.rows, contacts.body, contacts.driven, contacts.standing[0]
    worst, square = 0.0, 0.0
    for turn in range(last - first):
        k = last - 1 - turn if back else first + turn
        held = row(impulse, k)
        if not back:
            put_row(before, k, held)
        if rows[k, TARGET] == -inf:
            continue
        a, b = body[k, 0], body[k, 1]
        v_a, v_b, w_a, w_b = row(linear, a), row(linear, b), row(angular, a), row(angular, b)
        u = sub(v_a, v_b)
        short = short_of(rows, k, 0, u, w_a, w_b)
        if standing == 1 and driven[k] != NOT_DRIVEN:
            # as in `contacts.velocity_at`
            on_a = dot(three(rows, k, WISH), v_a) + dot(three(rows, k, WISH + 3), w_a)
            on_b = dot(three(rows, k, WISH), v_b) + dot(three(rows, k, WISH + 6), w_b)
            short = min(0.0, on_a) - on_b if driven[k] == DRIVEN_A else on_a - max(0.0, on_b)
        normal = max(0.0, (held[0] + rows[k, TARGET]) - short)
        dn, dx, dy, rough = normal - held[0], 0.0, 0.0, rows[k, FRICTION]
        if grip and rough > 0.0 and (normal > 0.0 or held[1] != 0.0 or held[2] != 0.0):
            x = (held[1] + rows[k, SLIDE] - short_of(rows, k, 1, u, w_a, w_b)) - rows[k, DRAG] * dn
            y = (held[2] + rows[k, SLIDE + 1] - short_of(rows, k, 2, u, w_a, w_b)) - rows[k, DRAG + 1] * dn
            limit, length = rough * normal, x * x + y * y
            if length > limit * limit:
                share = limit / sqrt(length)
                x, y = x * share, y * share
            dx, dy = x - held[1], y - held[2]
        moved = max(abs(dn) * rows[k, EASE], (abs(dx) + abs(dy)) * rows[k, EASE + 1])
        worst = max(worst, moved)
        if moved > 0.0:
            d = (dn, dx, dy)
            held = add(held, d)
            put_row(impulse, k, held)
            put_row(linear, a, add(v_a, given(rows, k, 0, d)))
            put_row(angular, a, add(w_a, given(rows, k, 1, d)))
            put_row(linear, b, sub(v_b, given(rows, k, 2, d)))
            put_row(angular, b, sub(w_b, given(rows, k, 3, d)))
        if back:
            way = sub(held, row(before, k))
            square += dot(way, way) * rows[k, EASE]
    return worst, square


@kernel
def go_on_along(
    contacts: Contacts, first: int, last: int, beta: float, linear: Array, angular: Array, before: Array, direction: Array
) -> None:
    """All go on by ``beta`` times the way of last time; ``direction`` becomes that and the way since ``before``."""
    impulse, rows, body = contacts.impulse, contacts.rows, contacts.body
    for k in range(first, last):
        if rows[k, TARGET] == -inf:
            continue
        held = row(impulse, k)
        way = sub(held, row(before, k))
        if beta > 0.0:
            d = scale(row(direction, k), beta)
            way = add(way, d)
            if dot(d, d) > 0.0:
                put_row(impulse, k, add(held, d))
                a, b = body[k, 0], body[k, 1]
                put_row(linear, a, add(row(linear, a), given(rows, k, 0, d)))
                put_row(angular, a, add(row(angular, a), given(rows, k, 1, d)))
                put_row(linear, b, sub(row(linear, b), given(rows, k, 2, d)))
                put_row(angular, b, sub(row(angular, b), given(rows, k, 3, d)))
        put_row(direction, k, way)
