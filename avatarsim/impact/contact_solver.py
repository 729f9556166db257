"""Contact solver: projected Gauss-Seidel in alternating direction, accelerated by nonlinear conjugate gradients.

Normal impulses are not negative and reach their target velocities; friction impulses are projected onto their disc. The conjugate
gradients (Fletcher and Reeves 1964) act on whole double sweeps, forth and back over the contacts; compare Silcowitz, Niebe and
Erleben 2010.
"""

from math import inf

import numpy as np
from numpy.typing import NDArray

from avatarsim.impact.contacts import Contacts, speed_along
from avatarsim.impact.friction_impulse import in_friction_disc
from avatarsim.impact.masses import Masses
from avatarsim.impact.pushing import push_all
from avatarsim.impact.solver_rows import lay_out, take_motion
from avatarsim.impact.visit import go_on_along, visit_all
from avatarsim.jit.kernel import kernel
from avatarsim.spatial.vec3 import Vec3, row

Array = NDArray[np.float64]

FIRST_TRY = 25
"""Double sweeps before normals are solved alone. Single bodies and sliding boxes converge within them."""

PATIENCE = 150
"""Double sweeps in which the best residual must halve. Impulses of four corners of a face are not unique: rounding may shift load
between them for thousands of sweeps without a measurable change of velocities. Fewer: tall stacks are given up while they still
converge."""

POINTS_OF_FACE, PATIENCE_OF_FACE, EXACT = 4, 30, 1e-10
"""The same for as few points as a face has, which converge slowly only where load wanders between corners. Not for impacts that
are solved to below this tolerance [m/s]: two corners of a thin box, a micrometre apart, take thousands of sweeps."""

WANDERING, WANDERS = 2e-6, 10
"""Double sweeps in a row without progress, below this change [m/s], after which the load only wanders. Points of one face whose
target velocities no rigid body can have at once (one is a nanometre higher) pass it on for millions of sweeps."""


ROUGH, STALE, SHRINKS, STALE_BELOW = 1e-7, 12, 0.8, 5e-5
"""Stop rule for tolerances of at least ROUGH [m/s]: after STALE double sweeps whose change stays above SHRINKS times the least so
far, and that below STALE_BELOW [m/s], only the load wanders. Corners of one face at different heights ask bodies in motion for
velocities that no rigid body can have, at micrometres a second."""


@kernel
def wanted_normal(contacts: Contacts, k: int, linear: Array, angular: Array) -> float:
    """Normal impulse of contact k for its target velocity, with all other impulses fixed, projected to be not negative."""
    short = speed_along(contacts, k, 0, linear, angular) - contacts.target[k]
    return float(max(0.0, contacts.impulse[k, 0] - short / contacts.ease[k, 0]))


@kernel
def wanted_friction(contacts: Contacts, k: int, normal: float, linear: Array, angular: Array) -> tuple[float, float]:
    """Friction impulse of contact k that ends its slip, projected onto the friction disc of that normal impulse."""
    limit = contacts.friction[k] * normal
    if limit == 0.0:
        return 0.0, 0.0
    x = contacts.impulse[k, 1] - (speed_along(contacts, k, 1, linear, angular) - contacts.slide[k, 0]) / contacts.ease[k, 1]
    y = contacts.impulse[k, 2] - (speed_along(contacts, k, 2, linear, angular) - contacts.slide[k, 1]) / contacts.ease[k, 1]
    return in_friction_disc(x, y, limit)


@kernel
def change(contacts: Contacts, masses: Masses, k: int, d: Vec3, linear: Array, angular: Array) -> None:
    """Add d (in the frame of contact k) to its impulse, velocities included."""
    for i in range(3):
        contacts.impulse[k, i] += d[i]
    push_all(contacts, masses, k, d, linear, angular)


@kernel
def unsolved(contacts: Contacts, first: int, last: int, linear: Array, angular: Array) -> float:
    """Residual [m/s]: largest change of any contact first <= k < last in another sweep."""
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

    If the first sweeps do not converge, normals are solved first, without friction: a convex problem that converges far faster,
    and bodies that merely stand need no friction.

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
    """As `solve_contacts`, cheaper: friction as ``tries`` double sweeps leave it, then normals alone, at most ``cap`` sweeps.

    Nothing approaches by more than the tolerance when normals end in time; friction may be off, and outside its disc.
    """
    lay_out(contacts, masses, first, last, linear, angular)
    worst, ended = passes(contacts, first, last, tolerance, tries, True, before, direction)
    if not ended:
        worst, _ = passes(contacts, first, last, tolerance, cap, False, before, direction)
    take_motion(contacts, first, last, linear, angular)
    return worst
