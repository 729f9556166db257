"""Impulses of many contacts at once: normals push only and reach their target, friction stays in its disc.

Projected Gauss-Seidel in alternating direction, accelerated by nonlinear conjugate gradients over whole double sweeps.
"""

from math import inf, sqrt

import numpy as np
from numpy.typing import NDArray

from avatarsim.impact.contacts import Contacts, axis, push, velocity_at
from avatarsim.impact.masses import Masses
from avatarsim.kernel import kernel
from avatarsim.spatial.vec3 import Vec3, add, dot, scale

Array = NDArray[np.float64]


@kernel
def wanted_impulse(contacts: Contacts, k: int, linear: Array, angular: Array) -> Vec3:
    """What contact k would like its impulse to be, everybody else's held: a projected step, in its own frame."""
    u = velocity_at(contacts, k, linear, angular)
    normal = contacts.impulse[k, 0] - (dot(axis(contacts, k, 0), u) - contacts.target[k]) / contacts.ease[k, 0]
    normal = max(0.0, normal)
    limit = contacts.friction[k] * normal
    if limit == 0.0:
        return (normal, 0.0, 0.0)
    x = contacts.impulse[k, 1] - dot(axis(contacts, k, 1), u) / contacts.ease[k, 1]
    y = contacts.impulse[k, 2] - dot(axis(contacts, k, 2), u) / contacts.ease[k, 1]
    length = sqrt(x * x + y * y)
    if length > limit:
        x, y = x * limit / length, y * limit / length
    return (normal, x, y)


@kernel
def change(contacts: Contacts, masses: Masses, k: int, d: Vec3, linear: Array, angular: Array) -> None:
    """Add d (in the frame of contact k) to its impulse, velocities included."""
    for i in range(3):
        contacts.impulse[k, i] += d[i]
    j = add(
        add(scale(axis(contacts, k, 0), d[0]), scale(axis(contacts, k, 1), d[1])), scale(axis(contacts, k, 2), d[2])
    )
    push(contacts, masses, k, j, linear, angular)


@kernel
def relax(contacts: Contacts, masses: Masses, k: int, linear: Array, angular: Array) -> float:
    """One contact takes what it wants, normal first; returns the change, as a velocity [m/s]."""
    if contacts.target[k] == -inf:
        return 0.0
    p = contacts.impulse
    u = velocity_at(contacts, k, linear, angular)
    normal = max(0.0, p[k, 0] - (dot(axis(contacts, k, 0), u) - contacts.target[k]) / contacts.ease[k, 0])
    dn = normal - p[k, 0]
    moved = abs(dn) * contacts.ease[k, 0]
    if dn != 0.0:
        change(contacts, masses, k, (dn, 0.0, 0.0), linear, angular)
    if contacts.friction[k] > 0.0 and (normal > 0.0 or p[k, 1] != 0.0 or p[k, 2] != 0.0):
        want = wanted_impulse(contacts, k, linear, angular)
        dx, dy = want[1] - p[k, 1], want[2] - p[k, 2]
        moved = max(moved, (abs(dx) + abs(dy)) * contacts.ease[k, 1])
        change(contacts, masses, k, (0.0, dx, dy), linear, angular)
    return moved


@kernel
def unsolved(contacts: Contacts, first: int, last: int, linear: Array, angular: Array) -> float:
    """Largest change [m/s] that any contact first <= k < last still wants."""
    worst = 0.0
    for k in range(first, last):
        if contacts.target[k] != -inf:
            want = wanted_impulse(contacts, k, linear, angular)
            across = abs(want[1] - contacts.impulse[k, 1]) + abs(want[2] - contacts.impulse[k, 2])
            worst = max(worst, abs(want[0] - contacts.impulse[k, 0]) * contacts.ease[k, 0], across * contacts.ease[k, 1])
    return worst


@kernel
def solve_contacts(
    contacts: Contacts, masses: Masses, first: int, last: int, linear: Array, angular: Array, tolerance: float, sweeps_cap: int,
    before: Array, direction: Array,
) -> float:
    """Solve contacts first <= k < last together, starting from the impulses they hold (velocities include them).

    Args:
        linear, angular: (nb, 3), changed.
        tolerance: largest change of the last double sweep [m/s].
        before, direction: (cap, 3) working memory.

    Returns:
        The change of the last double sweep [m/s]; above ``tolerance`` the cap was reached.
    """
    p = contacts.impulse
    last_square = inf
    worst = inf
    for sweep in range(sweeps_cap):
        for k in range(first, last):
            for i in range(3):
                before[k, i] = p[k, i]
        worst = 0.0
        for k in range(first, last):
            worst = max(worst, relax(contacts, masses, k, linear, angular))
        if not (worst > tolerance):
            return worst
        if last - first > 1:
            for k in range(last - 1, first - 1, -1):
                relax(contacts, masses, k, linear, angular)
        square = 0.0
        for k in range(first, last):
            for i in range(3):
                square += (p[k, i] - before[k, i]) ** 2 * contacts.ease[k, 0]
        # Fletcher-Reeves; a growing change means that the set of touching or slipping points changed: start again
        beta = square / last_square if sweep > 0 and square <= last_square else 0.0
        last_square = square
        for k in range(first, last):
            if contacts.target[k] == -inf:
                continue
            kept = (beta * direction[k, 0], beta * direction[k, 1], beta * direction[k, 2])
            if beta == 0.0:
                kept = (0.0, 0.0, 0.0)
            for i in range(3):
                direction[k, i] = kept[i] + p[k, i] - before[k, i]
            if dot(kept, kept) > 0.0:
                change(contacts, masses, k, kept, linear, angular)
    return worst
