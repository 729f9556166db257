"""Contact solver: projected Gauss-Seidel in alternating direction, accelerated by nonlinear conjugate gradients.

Normal impulses are not negative and reach their target velocities; friction impulses are projected onto their disc. The conjugate
gradients (Fletcher and Reeves 1964) act on whole double sweeps, forth and back over the contacts; compare Silcowitz, Niebe and
Erleben 2010.

Nearly all time of bodies in motion is spent here. So a sweep (Catto 2005, Iterative Dynamics with Temporal Coherence) is one flat
kernel, and Jacobian, M^-1 J^T, bias and effective mass of a contact are in one row of memory: packed in fours, for vector
instructions, and scaled by the effective mass; those of the normal come first, since many contacts have no friction. Velocities
are packed in fours as well during a solve.
"""

from math import ceil, inf

import numpy as np
from numpy.typing import NDArray

from avatarsim.collision.conservative_advancement import LEAVING
from avatarsim.jit.kernel import kernel
from avatarsim.rigid.contact_law import in_friction_disc
from avatarsim.rigid.contacts import DRIVEN_A, NOT_DRIVEN, NOT_LINKED, Contacts, Masses, axis, push_all, speed_along
from avatarsim.rigid.responses import LANES
from avatarsim.spatial.vec3 import Vec3, add, dot, put_row, row, scale, sub
from avatarsim.tolerances import JUDGED, PROOF, ROUGH

Array = NDArray[np.float64]

RESPONSE, RESPONSE_PARTS = 0, 4
"""M^-1 J^T of the normal, in so many parts of four: added to v and w of A and taken from v and w of B per impulse."""

JACOBIAN, JACOBIAN_SIZE = RESPONSE + LANES * RESPONSE_PARTS, 9
"""Jacobian of the normal (the normal, its levers on A and on B) times the effective mass: its product with the velocities is the
impulse that would stop the point along the normal."""

BIAS = JACOBIAN + JACOBIAN_SIZE
INVERSE_MASS, FRICTION, SLIDE = BIAS + 1, BIAS + 3, BIAS + 4
"""Bias velocity times effective mass; inverse effective masses along and across the normal; coefficient of friction; slide along
the tangents times effective mass."""

JACOBIANS = LANES * ceil((SLIDE + 2) / LANES)
"""The same nine numbers for the normal and both tangents, interleaved: the first of each, then the second of each."""

TANGENT_RESPONSE = JACOBIANS + LANES * JACOBIAN_SIZE
"""M^-1 J^T of each tangent, packed as that of the normal."""

CROSS_RESPONSE = TANGENT_RESPONSE + 2 * LANES * RESPONSE_PARTS
"""Impulses along the tangents that balance the slip due to a unit impulse along the normal."""

LINKS_PER_VISIT = 8
"""Touched links that count as one visit of a contact point. With 8 a visit takes as long in `carried_mug` as in `brick_wall`, to
a third. More: frames of hands that press take longer; fewer: their solves end sooner."""


@kernel
def three(rows: Array, k: int, at: int) -> Vec3:
    """Return three numbers of row k from column ``at`` on."""
    return (rows[k, at], rows[k, at + 1], rows[k, at + 2])


@kernel
def put_three(rows: Array, k: int, at: int, x: Vec3) -> None:
    """Write three numbers of row k from column ``at`` on."""
    rows[k, at], rows[k, at + 1], rows[k, at + 2] = x


@kernel
def lay_out(contacts: Contacts, masses: Masses, first: int, last: int, linear: Array, angular: Array) -> None:
    """Fill ``contacts.rows`` of first <= k < last from the results of `weigh`, and from targets, slides and frictions; and
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
            per, n = contacts.effective_mass[k, min(i, 1)], axis(contacts, k, i)
            response = RESPONSE if i == 0 else TANGENT_RESPONSE + (i - 1) * LANES * RESPONSE_PARTS
            for side in range(2):
                # links move with all of their avatar: see `apply_to_links`
                free = 1.0 if contacts.linked[k, side] == NOT_LINKED else 0.0
                turn = row(contacts.turn_a[k], i) if side == 0 else row(contacts.turn_b[k], i)
                put_three(rows, k, response, scale(n, free * masses.inverse_mass[contacts.body[k, side]]))
                put_three(rows, k, response + LANES, scale(turn, free))
                response += 2 * LANES
            for part in range(3):
                jacobian = n if part == 0 else row(contacts.jacobian_a[k], i) if part == 1 else row(contacts.jacobian_b[k], i)
                for x in range(3):
                    rows[k, JACOBIANS + LANES * (3 * part + x) + i] = jacobian[x] * per
        for c in range(JACOBIAN_SIZE):
            rows[k, JACOBIAN + c] = rows[k, JACOBIANS + LANES * c]
        for i in range(2):
            rows[k, CROSS_RESPONSE + i] = contacts.cross_response[k, i] * contacts.effective_mass[k, 1]
            rows[k, INVERSE_MASS + i] = contacts.inverse_effective_mass[k, i]
            rows[k, SLIDE + i] = (contacts.slide[k, i] + contacts.drift[k, i]) * contacts.effective_mass[k, 1]
        rows[k, BIAS] = contacts.target[k] * contacts.effective_mass[k, 0]
        rows[k, FRICTION] = contacts.friction[k]


@kernel
def take_motion(contacts: Contacts, first: int, last: int, linear: Array, angular: Array) -> None:
    """Copy the velocities in ``contacts.motion`` of the bodies of first <= k < last back to linear, angular (nb, 3)."""
    for k in range(first, last):
        for side in range(2):
            body = contacts.body[k, side]
            put_row(linear, body, three(contacts.motion, body, 0))
            put_row(angular, body, three(contacts.motion, body, LANES))


@kernel
def stopping_impulses(rows: Array, k: int, motion: Array, a: int, b: int) -> Vec3:
    """Return impulses [N s] that would stop contact k of bodies a and b along each axis of its frame, by their ``motion``."""
    u = sub(three(motion, a, 0), three(motion, b, 0))
    w_a, w_b = three(motion, a, LANES), three(motion, b, LANES)
    along, first = stopping_impulse(rows, k, 0, u, w_a, w_b), stopping_impulse(rows, k, 1, u, w_a, w_b)
    return along, first, stopping_impulse(rows, k, 2, u, w_a, w_b)


@kernel
def stopping_impulse(rows: Array, k: int, i: int, u: Vec3, w_a: Vec3, w_b: Vec3) -> float:
    """Return the impulse along axis i, by the velocity u of A's centre relative to B's and both angular velocities."""
    at, step = JACOBIANS + i, LANES
    straight = rows[k, at] * u[0] + rows[k, at + step] * u[1] + rows[k, at + 2 * step] * u[2]
    on_a = rows[k, at + 3 * step] * w_a[0] + rows[k, at + 4 * step] * w_a[1] + rows[k, at + 5 * step] * w_a[2]
    on_b = rows[k, at + 6 * step] * w_b[0] + rows[k, at + 7 * step] * w_b[1] + rows[k, at + 8 * step] * w_b[2]
    return float(straight + (on_a - on_b))


@kernel
def apply_impulse(rows: Array, k: int, d: Vec3, motion: Array, a: int, b: int) -> None:
    """Apply the impulse d, in the frame of contact k, to bodies a and b."""
    for part in range(RESPONSE_PARTS):
        x = TANGENT_RESPONSE + LANES * part
        g, y = three(rows, k, RESPONSE + LANES * part), x + LANES * RESPONSE_PARTS
        added = add(scale(g, d[0]), add(scale(three(rows, k, x), d[1]), scale(three(rows, k, y), d[2])))
        add_velocity(motion, a if part < 2 else b, LANES * (part % 2), added, part < 2)


@kernel
def apply_normal_impulse(rows: Array, k: int, d: float, motion: Array, a: int, b: int) -> None:
    """Run `apply_impulse` for an impulse d along the normal."""
    for part in range(RESPONSE_PARTS):
        added = scale(three(rows, k, RESPONSE + LANES * part), d)
        add_velocity(motion, a if part < 2 else b, LANES * (part % 2), added, part < 2)


@kernel
def add_velocity(motion: Array, body: int, at: int, added: Vec3, is_a: bool) -> None:
    """Add a change of velocity to that of A, or subtract it from that of B."""
    now = three(motion, body, at)
    put_three(motion, body, at, add(now, added) if is_a else sub(now, added))


@kernel
def apply_to_links(contacts: Contacts, k: int, d: Vec3) -> None:
    """Apply the impulse d, in the frame of contact k, to the touched links of the avatars of its links."""
    responses, motion = contacts.responses, contacts.motion
    for side in range(2):
        block = contacts.linked[k, side]
        if block < 0:
            continue
        root = responses.root[block]
        for p in range(responses.touches[root]):
            body, v = responses.touched[root + p], responses.velocity[block, p]
            for at in range(0, 2 * LANES, LANES):
                added = add(scale(three(v, 0, at), d[0]), add(scale(three(v, 1, at), d[1]), scale(three(v, 2, at), d[2])))
                add_velocity(motion, body, at, added, True)


@kernel
def normal_stopping_impulse(rows: Array, k: int, motion: Array, a: int, b: int) -> float:
    """Return the impulse that would stop contact k of bodies a and b along its normal: the first of `stopping_impulses`."""
    u = sub(three(motion, a, 0), three(motion, b, 0))
    w_a, w_b = three(motion, a, LANES), three(motion, b, LANES)
    return dot(three(rows, k, JACOBIAN), u) + (dot(three(rows, k, JACOBIAN + 3), w_a) - dot(three(rows, k, JACOBIAN + 6), w_b))


@kernel
def normal_impulse_driven(rows: Array, k: int, motion: Array, a: int, b: int, driven: int) -> float:
    """Return that impulse where a driven body that recedes counts as standing still: see `velocity_at`."""
    on_a = dot(three(rows, k, JACOBIAN), three(motion, a, 0)) + dot(three(rows, k, JACOBIAN + 3), three(motion, a, LANES))
    on_b = dot(three(rows, k, JACOBIAN), three(motion, b, 0)) + dot(three(rows, k, JACOBIAN + 6), three(motion, b, LANES))
    return min(0.0, on_a) - on_b if driven == DRIVEN_A else on_a - max(0.0, on_b)


@kernel
def gauss_seidel_sweep(contacts: Contacts, first: int, last: int, back: bool, grip: bool, before: Array) -> tuple[float, float]:
    """Sweep over contacts first <= k < last: normal impulse, then friction if ``grip``; from the last to the first if ``back``.

    The slip after the normal impulse is computed from the slip before it (``cross_response``), without updating velocities
    in between: `wanted_normal` and `wanted_friction` in one.

    Args:
        contacts: after `lay_out`; ``motion`` changes. before: (cap, 3) gets the impulses on entry, unless ``back``.

    Returns:
        (largest change [m/s], sum of squares of impulse - before, times the inverse effective mass along the normal).
    """
    impulse, rows, motion, body, driven = contacts.impulse, contacts.rows, contacts.motion, contacts.body, contacts.driven
    standing, worst, square, has_links = contacts.standing[0], 0.0, 0.0, contacts.responses.used[0] > 0
    for turn in range(last - first):
        # an index that cannot be negative is not counted from the end: four operations less for every array
        k = max(0, last - 1 - turn if back else first + turn)
        current = row(impulse, k)
        if not back:
            put_row(before, k, current)
        if rows[k, BIAS] == -inf:
            continue
        a, b = max(0, body[k, 0]), max(0, body[k, 1])
        rough = rows[k, FRICTION] if grip else 0.0
        if rough > 0.0:
            short, short_x, short_y = stopping_impulses(rows, k, motion, a, b)
        else:
            short, short_x, short_y = normal_stopping_impulse(rows, k, motion, a, b), 0.0, 0.0
        if standing == 1 and driven[k] != NOT_DRIVEN:
            short = normal_impulse_driven(rows, k, motion, a, b, driven[k])
        normal = max(0.0, (current[0] + rows[k, BIAS]) - short)
        dn, dx, dy = normal - current[0], 0.0, 0.0
        if rough > 0.0 and (normal != 0.0 or current[1] != 0.0 or current[2] != 0.0):
            x = (current[1] + rows[k, SLIDE] - short_x) - rows[k, CROSS_RESPONSE] * dn
            y = (current[2] + rows[k, SLIDE + 1] - short_y) - rows[k, CROSS_RESPONSE + 1] * dn
            x, y = in_friction_disc(x, y, rough * normal)
            dx, dy = x - current[1], y - current[2]
        moved = max(abs(dn) * rows[k, INVERSE_MASS], (abs(dx) + abs(dy)) * rows[k, INVERSE_MASS + 1])
        worst = max(worst, moved)
        if moved > 0.0:
            current = add(current, (dn, dx, dy))
            put_row(impulse, k, current)
            if rough > 0.0:
                apply_impulse(rows, k, (dn, dx, dy), motion, a, b)
            else:
                apply_normal_impulse(rows, k, dn, motion, a, b)
            if has_links:
                apply_to_links(contacts, k, (dn, dx, dy))
        if back:
            change = sub(current, row(before, k))
            square += dot(change, change) * rows[k, INVERSE_MASS]
    return worst, square


@kernel
def conjugate_step(contacts: Contacts, first: int, last: int, beta: float, before: Array, direction: Array) -> None:
    """Take a conjugate-gradient step: impulses change by ``beta`` ``direction``, which then gains the change since ``before``."""
    impulse, rows, motion, body = contacts.impulse, contacts.rows, contacts.motion, contacts.body
    for turn in range(last - first):
        k = max(0, first + turn)
        if rows[k, BIAS] == -inf:
            continue
        current = row(impulse, k)
        change = sub(current, row(before, k))
        if beta > 0.0:
            d = scale(row(direction, k), beta)
            change = add(change, d)
            if dot(d, d) > 0.0:
                put_row(impulse, k, add(current, d))
                if d[1] != 0.0 or d[2] != 0.0:
                    apply_impulse(rows, k, d, motion, body[k, 0], body[k, 1])
                else:
                    apply_normal_impulse(rows, k, d[0], motion, body[k, 0], body[k, 1])
                if contacts.responses.used[0] > 0:
                    apply_to_links(contacts, k, d)
        put_row(direction, k, change)


FIRST_TRY = 25
"""Double sweeps before normals are solved alone. Single bodies and sliding boxes converge within them. Fewer:
they are solved for again without friction; more: stacks take longer."""

PATIENCE = 150
"""Double sweeps in which the best residual must halve. Impulses of four corners of a face are not unique: rounding may shift load
between them for thousands of sweeps without a measurable change of velocities. Fewer: tall stacks are added up while they still
converge."""

POINTS_OF_FACE, PATIENCE_OF_FACE = 4, 30
"""Patience for as few points as a face has, which converge slowly only where load wanders between corners. Not for impacts that
are solved to a tolerance of PROOF [m/s] or less: two corners of a thin box, a micrometre apart, take thousands of sweeps."""

WANDERING, WANDERS = 2.0 * JUDGED, 10
"""Double sweeps in a row without progress, below this change [m/s], after which the load only wanders. Points of one face whose
target velocities no rigid body can have at once (one is a nanometre higher) pass it on for millions of sweeps."""

STALE, SHRINKS, STALE_BELOW = 12, 0.8, 0.5 * LEAVING
"""Stop rule for tolerances of at least ROUGH [m/s]: after STALE double sweeps whose change stays above SHRINKS times the least so
far, and that below STALE_BELOW [m/s], only the load wanders. Corners of one face at different heights require velocities that no
rigid body can have, at micrometres a second. STALE_BELOW is less than the speed that sets a contact free."""


@kernel
def wanted_normal(contacts: Contacts, k: int, linear: Array, angular: Array) -> float:
    """Return the normal impulse of contact k for its target velocity, with all other impulses fixed, but not below 0."""
    short = speed_along(contacts, k, 0, linear, angular) - contacts.target[k]
    return float(max(0.0, contacts.impulse[k, 0] - short / contacts.inverse_effective_mass[k, 0]))


@kernel
def wanted_friction(contacts: Contacts, k: int, normal: float, linear: Array, angular: Array) -> tuple[float, float]:
    """Return the friction impulse of contact k that ends its slip, projected onto the friction disc of that normal impulse."""
    limit = contacts.friction[k] * normal
    if limit == 0.0:
        return 0.0, 0.0
    across = contacts.inverse_effective_mass[k, 1]
    x = contacts.impulse[k, 1] - (speed_along(contacts, k, 1, linear, angular) - contacts.slide[k, 0]) / across
    y = contacts.impulse[k, 2] - (speed_along(contacts, k, 2, linear, angular) - contacts.slide[k, 1]) / across
    return in_friction_disc(x, y, limit)


@kernel
def change(contacts: Contacts, masses: Masses, k: int, d: Vec3, linear: Array, angular: Array) -> None:
    """Add d (in the frame of contact k) to its impulse, velocities included."""
    for i in range(3):
        contacts.impulse[k, i] += d[i]
    push_all(contacts, masses, k, d, linear, angular)


@kernel
def unsolved(contacts: Contacts, first: int, last: int, linear: Array, angular: Array) -> float:
    """Return the residual [m/s]: largest change of any contact first <= k < last in another sweep."""
    worst = 0.0
    for k in range(first, last):
        if contacts.target[k] != -inf:
            normal = wanted_normal(contacts, k, linear, angular)
            x, y = wanted_friction(contacts, k, normal, linear, angular)
            across = abs(x - contacts.impulse[k, 1]) + abs(y - contacts.impulse[k, 2])
            speeds = contacts.inverse_effective_mass[k]
            worst = max(worst, abs(normal - contacts.impulse[k, 0]) * speeds[0], across * speeds[1])
    return worst


@kernel
def sweeps(
    contacts: Contacts, masses: Masses, first: int, last: int, linear: Array, angular: Array, tolerance: float, cap: int,
    grip: bool, before: Array, direction: Array,
) -> tuple[float, bool]:
    """Run at most ``cap`` accelerated double sweeps, fewer if they lead nowhere. Without ``grip`` friction is left out.

    Returns the change of the last one [m/s], and whether more would be of no use: solved, or the load only wanders.
    """
    lay_out(contacts, masses, first, last, linear, angular)
    worst, ended = passes(contacts, first, last, tolerance, cap, grip, before, direction)
    take_motion(contacts, first, last, linear, angular)
    return worst, ended


@kernel
def visits_of_sweep(contacts: Contacts, first: int, last: int) -> int:
    """Return the work of one sweep over contacts first <= k < last, in visits of contact points of bodies without joints."""
    responses, links = contacts.responses, 0
    for k in range(first, last):
        for side in range(2):
            if contacts.linked[k, side] >= 0:
                links += responses.touches[responses.root[contacts.linked[k, side]]]
    return int(last - first + links // LINKS_PER_VISIT)


@kernel
def passes(
    contacts: Contacts, first: int, last: int, tolerance: float, cap: int, grip: bool, before: Array, direction: Array,
) -> tuple[float, bool]:
    """Run `sweeps` for contacts that are laid out."""
    last_square, best, earlier, astray, worst, points = inf, inf, inf, 0, inf, 0
    least, stale = inf, 0
    for k in range(first, last):
        points += 1 if contacts.target[k] != -inf else 0
    of_face = points <= POINTS_OF_FACE and tolerance > PROOF
    patience, work = PATIENCE_OF_FACE if of_face else PATIENCE, visits_of_sweep(contacts, first, last)
    for sweep in range(cap):
        contacts.visits[0] += 2 * work
        worst, _ = gauss_seidel_sweep(contacts, first, last, False, grip, before)
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
        _, square = gauss_seidel_sweep(contacts, first, last, True, grip, before)
        # Fletcher-Reeves; a growing change means that the set of touching or slipping points changed: start again. The last
        # impulses are left as the sweep projected them
        beta = square / last_square if 0 < sweep < cap - 1 and 0.0 < square <= last_square else 0.0
        astray = astray + 1 if beta == 0.0 else 0
        last_square = square
        conjugate_step(contacts, first, last, beta, before, direction)
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
    """Solve like `solve_contacts`, cheaper: ``tries`` double sweeps with friction, then normals alone, at most ``cap`` sweeps.

    Nothing approaches by more than the tolerance when normals end in time; friction may be off, and outside its disc.
    """
    lay_out(contacts, masses, first, last, linear, angular)
    worst, ended = passes(contacts, first, last, tolerance, tries, True, before, direction)
    if not ended:
        worst, _ = passes(contacts, first, last, tolerance, cap, False, before, direction)
    take_motion(contacts, first, last, linear, angular)
    return worst
