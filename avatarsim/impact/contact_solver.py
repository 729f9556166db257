"""Impulses of many contacts at once: normals push only and reach their target, friction stays in its disc.

Projected Gauss-Seidel in alternating direction, accelerated by nonlinear conjugate gradients over whole double sweeps.
"""

from math import inf, sqrt

import numpy as np
from numpy.typing import NDArray

from avatarsim.impact.contacts import Contacts, speed_along
from avatarsim.impact.masses import Masses
from avatarsim.impact.pushing import push_all
from avatarsim.impact.solver_rows import lay_out, take_motion
from avatarsim.impact.visit import go_on_along, visit_all
from avatarsim.jit.kernel import kernel
from avatarsim.spatial.vec3 import Vec3, row

Array = NDArray[np.float64]

FIRST_TRY = 25
"""Double sweeps before normals are solved alone. Single bodies and sliding boxes end within them."""

PATIENCE = 150
"""Double sweeps in which the best residual must halve. Four corners of a face carry a load in many ways; when rounding alone
prefers one of them, the load would wander there for thousands of sweeps while no velocity changes that one could measure. Fewer,
and tall stacks are given up while they still converge."""

POINTS_OF_FACE, PATIENCE_OF_FACE, EXACT = 4, 30, 1e-10
"""The same for so few points as one face has: nothing makes them slow but a load that wanders between corners. Not where impacts
are solved for to below this tolerance [m/s]: two corners of a thin box, a micrometre apart, take thousands of sweeps."""

WANDERING, WANDERS = 2e-6, 10
"""Double sweeps in a row that bring the solution no nearer, below so small a change [m/s], after which the load only wanders:
points of one face that ask for velocities that no rigid body can have at once (one is a nanometre higher than the others) hand it
on from sweep to sweep, millions of times, until one of them is empty."""


ROUGH, STALE, SHRINKS, STALE_BELOW = 1e-7, 12, 0.8, 5e-5
"""Where no more than the first accuracy [m/s] is asked for: so many double sweeps in which the change does not fall below this
part of the least so far, and that is below the last velocity [m/s], mean that only the load wanders. Corners of one face at
different heights ask bodies in motion for velocities that no rigid body can have, at micrometres a second."""


@kernel
def wanted_normal(contacts: Contacts, k: int, linear: Array, angular: Array) -> float:
    """What contact k would like its normal impulse to be, everybody else's held."""
    short = speed_along(contacts, k, 0, linear, angular) - contacts.target[k]
    return float(max(0.0, contacts.impulse[k, 0] - short / contacts.ease[k, 0]))


@kernel
def wanted_friction(contacts: Contacts, k: int, normal: float, linear: Array, angular: Array) -> tuple[float, float]:
    """What contact k would like its friction to be under that normal impulse: a projected step."""
    limit = contacts.friction[k] * normal
    if limit == 0.0:
        return 0.0, 0.0
    x = contacts.impulse[k, 1] - (speed_along(contacts, k, 1, linear, angular) - contacts.slide[k, 0]) / contacts.ease[k, 1]
    y = contacts.impulse[k, 2] - (speed_along(contacts, k, 2, linear, angular) - contacts.slide[k, 1]) / contacts.ease[k, 1]
    length = sqrt(x * x + y * y)
    if length > limit:
        x, y = x * limit / length, y * limit / length
    return x, y


@kernel
def change(contacts: Contacts, masses: Masses, k: int, d: Vec3, linear: Array, angular: Array) -> None:
    """Add d (in the frame of contact k) to its impulse, velocities included."""
    for i in range(3):
        contacts.impulse[k, i] += d[i]
    push_all(contacts, masses, k, d, linear, angular)


@kernel
def unsolved(contacts: Contacts, first: int, last: int, linear: Array, angular: Array) -> float:
    """Largest change [m/s] that any contact first <= k < last still wants."""
    worst = 0.0
    for k in range(first, last):
        if contacts.target[k] != -inf:
            normal = wanted_normal(contacts, k, linear, angular)
            x, y = wanted_friction(contacts, k, normal, linear, angular)
            across = abs(x - contacts.impulse[k, 1]) + abs(y - contacts.impulse[k, 2])
            worst = max(worst, abs(normal - contacts.impulse[k, 0]) * contacts.ease[k, 0], across * contacts.ease[k, 1])
    return worst


@kernel
def sweeps(
    contacts: Contacts, masses: Masses, first: int, last: int, linear: Array, angular: Array, tolerance: float, cap: int,
    grip: bool, before: Array, direction: Array,
) -> tuple[float, bool]:
    """At most ``cap`` accelerated double sweeps, fewer if they lead nowhere. Without ``grip`` friction is left out.

    Returns the change of the last one [m/s], and whether more would be of no use: solved, or the load only wanders.
    """
    lay_out(contacts, masses, first, last, linear, angular)
    worst, ended = passes(contacts, first, last, tolerance, cap, grip, before, direction)
    take_motion(contacts, first, last, linear, angular)
    return worst, ended


@kernel
def passes(
    contacts: Contacts, first: int, last: int, tolerance: float, cap: int, grip: bool, before: Array, direction: Array,
) -> tuple[float, bool]:
    """`sweeps` of contacts that are laid out."""
    last_square, best, earlier, astray, worst, points = inf, inf, inf, 0, inf, 0
    least, stale = inf, 0
    for k in range(first, last):
        points += 1 if contacts.target[k] != -inf else 0
    of_face = points <= POINTS_OF_FACE and tolerance > EXACT
    patience = PATIENCE_OF_FACE if of_face else PATIENCE
    for sweep in range(cap):
        contacts.visits[0] += 2 * (last - first)
        worst, _ = visit_all(contacts, first, last, False, grip, before)
        best = min(best, worst)
        if not (worst > tolerance) or (astray >= WANDERS and worst < WANDERING):
            return worst, True
        if worst < SHRINKS * least:
            least, stale = worst, 0
        else:
            stale += 1
        if stale >= STALE and least < STALE_BELOW and tolerance >= ROUGH:
            return worst, True
        if sweep % patience == patience - 1:
            if not (best < 0.5 * earlier):
                return worst, of_face and worst < WANDERING
            earlier, best = best, inf
        _, square = visit_all(contacts, first, last, True, grip, before)
        # Fletcher-Reeves; a growing change means that the set of touching or slipping points changed: start again
        beta = square / last_square if sweep > 0 and square <= last_square else 0.0
        astray = astray + 1 if beta == 0.0 else 0
        last_square = square
        go_on_along(contacts, first, last, beta, before, direction)
    return worst, False


@kernel
def solve_contacts(
    contacts: Contacts, masses: Masses, first: int, last: int, linear: Array, angular: Array, tolerance: float, tries: int,
    cap: int, before: Array, direction: Array,
) -> float:
    """Solve contacts first <= k < last together, starting from the impulses they hold (velocities include them).

    If a few sweeps do not do it, normals come first, without friction: that is a convex problem which converges far faster,
    and what just stands needs no friction at all.

    Args:
        linear, angular: (nb, 3), changed.
        tolerance: largest change of the last double sweep [m/s].
        tries: double sweeps before normals are solved alone. cap: double sweeps with normals alone, and then with all.
        before, direction: (cap, 3) working memory.

    Returns:
        The change of the last double sweep [m/s]; above ``tolerance`` the cap was reached, or more sweeps led nowhere.
    """
    worst, ended = sweeps(contacts, masses, first, last, linear, angular, tolerance, tries, True, before, direction)
    if ended:
        return worst
    for k in range(first, last):
        p = row(contacts.impulse, k)
        change(contacts, masses, k, (0.0, -p[1], -p[2]), linear, angular)
    sweeps(contacts, masses, first, last, linear, angular, tolerance, cap, False, before, direction)
    worst, _ = sweeps(contacts, masses, first, last, linear, angular, tolerance, cap, True, before, direction)
    return worst


@kernel
def solve_roughly(
    contacts: Contacts, masses: Masses, first: int, last: int, linear: Array, angular: Array, tolerance: float, tries: int,
    cap: int, before: Array, direction: Array,
) -> float:
    """As `solve_contacts`, in a hurry: friction as ``tries`` double sweeps leave it, then normals alone, at most ``cap`` sweeps.

    Nothing approaches by more than the tolerance when normals end in time; friction may be off, and outside its disc.
    """
    lay_out(contacts, masses, first, last, linear, angular)
    worst, ended = passes(contacts, first, last, tolerance, tries, True, before, direction)
    if not ended:
        worst, _ = passes(contacts, first, last, tolerance, cap, False, before, direction)
    take_motion(contacts, first, last, linear, angular)
    return worst
