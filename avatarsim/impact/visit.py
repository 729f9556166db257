"""One projected Gauss-Seidel sweep over contacts (Catto, Iterative Dynamics with Temporal Coherence, 2005).

Nearly all time of bodies in motion is spent here, so a sweep is one flat kernel.
"""

from math import inf

import numpy as np
from numpy.typing import NDArray

from avatarsim.impact.contacts import DRIVEN_A, NOT_DRIVEN, Contacts
from avatarsim.impact.friction_impulse import in_friction_disc
from avatarsim.impact.solver_rows import (
    ALL_WISHES,
    DRAG,
    EASE,
    FRICTION,
    GIFT,
    LANES,
    PARTS,
    SIDE_GIFT,
    SLIDE,
    TARGET,
    WISH,
    put_three,
    three,
)
from avatarsim.jit.kernel import kernel
from avatarsim.spatial.vec3 import Vec3, add, dot, put_row, row, scale, sub

Array = NDArray[np.float64]


@kernel
def wishes(rows: Array, k: int, motion: Array, a: int, b: int) -> Vec3:
    """Impulses that would stop contact k of bodies a and b along each axis of its frame, by the velocities ``motion``."""
    u = sub(three(motion, a, 0), three(motion, b, 0))
    w_a, w_b = three(motion, a, LANES), three(motion, b, LANES)
    return wish(rows, k, 0, u, w_a, w_b), wish(rows, k, 1, u, w_a, w_b), wish(rows, k, 2, u, w_a, w_b)


@kernel
def wish(rows: Array, k: int, i: int, u: Vec3, w_a: Vec3, w_b: Vec3) -> float:
    """The impulse along axis i, by the velocity u of A's centre relative to B's and both angular velocities."""
    at, step = ALL_WISHES + i, LANES
    straight = rows[k, at] * u[0] + rows[k, at + step] * u[1] + rows[k, at + 2 * step] * u[2]
    on_a = rows[k, at + 3 * step] * w_a[0] + rows[k, at + 4 * step] * w_a[1] + rows[k, at + 5 * step] * w_a[2]
    on_b = rows[k, at + 6 * step] * w_b[0] + rows[k, at + 7 * step] * w_b[1] + rows[k, at + 8 * step] * w_b[2]
    return float(straight + (on_a - on_b))


@kernel
def give(rows: Array, k: int, d: Vec3, motion: Array, a: int, b: int) -> None:
    """Apply the impulse d, in the frame of contact k, to bodies a and b."""
    for part in range(PARTS):
        g, x, y = three(rows, k, GIFT + LANES * part), SIDE_GIFT + LANES * part, SIDE_GIFT + LANES * (PARTS + part)
        given = add(scale(g, d[0]), add(scale(three(rows, k, x), d[1]), scale(three(rows, k, y), d[2])))
        take(motion, a if part < 2 else b, LANES * (part % 2), given, part < 2)


@kernel
def give_along_normal(rows: Array, k: int, d: float, motion: Array, a: int, b: int) -> None:
    """`give` of an impulse d along the normal."""
    for part in range(PARTS):
        given = scale(three(rows, k, GIFT + LANES * part), d)
        take(motion, a if part < 2 else b, LANES * (part % 2), given, part < 2)


@kernel
def take(motion: Array, body: int, at: int, given: Vec3, is_a: bool) -> None:
    """Add a change of velocity to that of A, or subtract it from that of B."""
    now = three(motion, body, at)
    put_three(motion, body, at, add(now, given) if is_a else sub(now, given))


@kernel
def wish_along_normal(rows: Array, k: int, motion: Array, a: int, b: int) -> float:
    """Impulse that would stop contact k of bodies a and b along its normal: the first that `wishes` returns."""
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
    """Sweep over contacts first <= k < last: normal impulse, then friction if ``grip``; from the last to the first if ``back``.

    The slip after the normal impulse is computed from the slip before it (``drag``), without updating velocities in between:
    `contact_solver.wanted_normal` and `wanted_friction` in one.

    Args:
        contacts: after `lay_out`; ``motion`` changes. before: (cap, 3) gets the impulses held on entry, unless ``back``.

    Returns:
        (largest change [m/s], sum of squares of impulse - before, times the inverse effective mass along the normal).
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
            x, y = in_friction_disc(x, y, rough * normal)
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
    """Conjugate-gradient step: impulses change by ``beta`` ``direction``, which becomes that plus the change since ``before``."""
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
