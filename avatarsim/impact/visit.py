"""One pass of the contact solver: every contact in turn takes what it wants, and velocities follow at once.

Nearly all time of bodies in motion goes by here, so a pass is one kernel that calls nothing larger than a sum of three products.
"""

from math import inf, sqrt

import numpy as np
from numpy.typing import NDArray

from avatarsim.impact.contacts import DRIVEN_A, NOT_DRIVEN, Contacts
from avatarsim.impact.masses import Masses
from avatarsim.kernel import kernel
from avatarsim.spatial.vec3 import Vec3, add, dot, put_row, row, scale, sub

Array = NDArray[np.float64]
Stack = NDArray[np.float64]


@kernel
def line(m: Stack, k: int, i: int) -> Vec3:
    """Row i of matrix k of (n, 3, 3)."""
    return (m[k, i, 0], m[k, i, 1], m[k, i, 2])


@kernel
def mixed(m: Stack, k: int, d: Vec3) -> Vec3:
    """Sum of the rows of matrix k of (n, 3, 3), weighed by d."""
    return add(add(scale(line(m, k, 0), d[0]), scale(line(m, k, 1), d[1])), scale(line(m, k, 2), d[2]))


@kernel
def visit_all(
    contacts: Contacts, masses: Masses, first: int, last: int, back: bool, grip: bool, linear: Array, angular: Array,
    before: Array,
) -> tuple[float, float]:
    """Contacts first <= k < last take what they want, normal first, friction if ``grip``; from the last to the first if ``back``.

    The slip after the push along the normal is the slip before it and what the push drags along, so nobody waits for the
    velocities in between: `contact_solver.wanted_normal` and `wanted_friction` in one.

    Args:
        linear, angular: (nb, 3), changed. before: (cap, 3) gets the impulses held on entry, unless ``back``.

    Returns:
        (largest change [m/s], sum of squares of impulse - before, times the ease along the normal).
    """
    impulse, target, ease, unease = contacts.impulse, contacts.target, contacts.ease, contacts.unease
    frame, lever_a, lever_b, turn_a, turn_b = contacts.frame, contacts.lever_a, contacts.lever_b, contacts.turn_a, contacts.turn_b
    body, driven, rough, drag, slide = contacts.body, contacts.driven, contacts.friction, contacts.drag, contacts.slide
    inverse_mass, standing = masses.inverse_mass, contacts.standing[0] == 1
    worst, square = 0.0, 0.0
    for turn in range(last - first):
        k = last - 1 - turn if back else first + turn
        held = row(impulse, k)
        if not back:
            put_row(before, k, held)
        if target[k] == -inf:
            continue
        a, b = body[k, 0], body[k, 1]
        v_a, v_b, w_a, w_b = row(linear, a), row(linear, b), row(angular, a), row(angular, b)
        n = line(frame, k, 0)
        on_a, on_b = dot(n, v_a) + dot(line(lever_a, k, 0), w_a), dot(n, v_b) + dot(line(lever_b, k, 0), w_b)
        if standing and driven[k] != NOT_DRIVEN:
            # as in `contacts.velocity_at`
            if driven[k] == DRIVEN_A:
                on_a = min(0.0, on_a)
            else:
                on_b = max(0.0, on_b)
        normal = max(0.0, held[0] - (on_a - on_b - target[k]) * unease[k, 0])
        dn, dx, dy = normal - held[0], 0.0, 0.0
        if grip and rough[k] > 0.0 and (normal > 0.0 or held[1] != 0.0 or held[2] != 0.0):
            u = sub(v_a, v_b)
            slip = dot(line(frame, k, 1), u) + (dot(line(lever_a, k, 1), w_a) - dot(line(lever_b, k, 1), w_b))
            skid = dot(line(frame, k, 2), u) + (dot(line(lever_a, k, 2), w_a) - dot(line(lever_b, k, 2), w_b))
            x = held[1] - (slip + drag[k, 0] * dn - slide[k, 0]) * unease[k, 1]
            y = held[2] - (skid + drag[k, 1] * dn - slide[k, 1]) * unease[k, 1]
            limit, length = rough[k] * normal, x * x + y * y
            if length > limit * limit:
                share = limit / sqrt(length)
                x, y = x * share, y * share
            dx, dy = x - held[1], y - held[2]
        moved = max(abs(dn) * ease[k, 0], (abs(dx) + abs(dy)) * ease[k, 1])
        worst = max(worst, moved)
        if moved > 0.0:
            held = add(held, (dn, dx, dy))
            put_row(impulse, k, held)
            j, of_a, of_b = mixed(frame, k, (dn, dx, dy)), inverse_mass[a], inverse_mass[b]
            put_row(linear, a, add(v_a, scale(j, of_a)))
            put_row(linear, b, sub(v_b, scale(j, of_b)))
            put_row(angular, a, add(w_a, mixed(turn_a, k, (dn, dx, dy))))
            put_row(angular, b, sub(w_b, mixed(turn_b, k, (dn, dx, dy))))
        if back:
            way = sub(held, row(before, k))
            square += dot(way, way) * ease[k, 0]
    return worst, square


@kernel
def go_on_along(
    contacts: Contacts, masses: Masses, first: int, last: int, beta: float, linear: Array, angular: Array, before: Array,
    direction: Array,
) -> None:
    """All go on by ``beta`` times the way of last time; ``direction`` becomes that and the way since ``before``."""
    impulse, target, body, inverse_mass = contacts.impulse, contacts.target, contacts.body, masses.inverse_mass
    frame, turn_a, turn_b = contacts.frame, contacts.turn_a, contacts.turn_b
    for k in range(first, last):
        if target[k] == -inf:
            continue
        held = row(impulse, k)
        way = sub(held, row(before, k))
        if beta > 0.0:
            d = scale(row(direction, k), beta)
            way = add(way, d)
            if dot(d, d) > 0.0:
                put_row(impulse, k, add(held, d))
                a, b = body[k, 0], body[k, 1]
                j, of_a, of_b = mixed(frame, k, d), inverse_mass[a], inverse_mass[b]
                put_row(linear, a, add(row(linear, a), scale(j, of_a)))
                put_row(linear, b, sub(row(linear, b), scale(j, of_b)))
                put_row(angular, a, add(row(angular, a), mixed(turn_a, k, d)))
                put_row(angular, b, sub(row(angular, b), mixed(turn_b, k, d)))
        put_row(direction, k, way)
