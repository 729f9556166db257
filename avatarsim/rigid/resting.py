"""Resting contact forces (Baraff 1994), constant over a segment of time: for bodies that stay in contact, at rest or sliding.

Unlike there the forces reach velocities at the end of the segment, and come from the contact solver (projected Gauss-Seidel).

Sliding contacts within a segment of constant forces: which of them slip, when the first slip ends, their kinetic friction.
"""

from math import hypot, inf
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from avatarsim.collision.conservative_advancement import LIFT, LIFTED, STAND_OFF, TOUCH
from avatarsim.collision.path import Series, tumbled
from avatarsim.jit.kernel import kernel
from avatarsim.rigid.contact_law import kinetic_friction, tangential_velocity
from avatarsim.rigid.contacts import (
    NOT_DRIVEN,
    POINTS_OF_PAIR,
    SHARP,
    Contacts,
    Masses,
    axis,
    push_along,
    scale_impulses,
    velocity_at,
    weigh_after,
)
from avatarsim.rigid.solver import change, solve_contacts, solve_roughly, sweeps, unsolved
from avatarsim.spatial.tangent import columns, turned
from avatarsim.spatial.vec3 import Vec3, add, along, cross, dot, norm, put_row, row, sub
from avatarsim.tolerances import JUDGED, NOTHING, PROOF, ROUGH, SLIGHT

Array = NDArray[np.float64]

SLIPPED = SLIGHT
"""The end of a slip is looked for if it would go farther than this [m] in the segment, and is faster than `remainder`."""

PARALLEL = NOTHING
"""Normals nearer to each other than this are of one face."""


@kernel
def one_face(contacts: Contacts, masses: Masses, i: int, k: int) -> bool:
    """Return True if contacts i and k are of the same shapes, or of one body and one immovable face, perhaps of several
    pieces."""
    if contacts.key[i] // POINTS_OF_PAIR == contacts.key[k] // POINTS_OF_PAIR:
        return True
    if contacts.driven[i] != contacts.driven[k]:
        return False
    for side in range(2):
        if contacts.body[i, side] != contacts.body[k, side]:
            if masses.inverse_mass[contacts.body[i, side]] > 0.0 or masses.inverse_mass[contacts.body[k, side]] > 0.0:
                return False
    return norm(sub(axis(contacts, i, 0), axis(contacts, k, 0))) < PARALLEL


@kernel
def remainder(contacts: Contacts, k: int, h: float, angular: Array, angular_end: Array) -> float:
    """Return the speed [m/s] at which contact k may slip after a segment of h seconds that was to hold it.

    Constant forces include the lever arms of the midpoint and the bias acceleration of the start; the error is h^2 / 2 (w x r'' +
    w' x r'), at most h^2 / 2 w (w^2 + 2 w') r. Ended as a slip, it would shorten the segments of a pivoting corner without end.
    """
    if contacts.smooth[k] != SHARP:
        return 0.0
    found = 0.0
    for side in range(2):
        b = contacts.body[k, side]
        arm = row(contacts.arm_a, k) if side == 0 else row(contacts.arm_b, k)
        w, gain = norm(row(angular, b)), norm(sub(row(angular_end, b), row(angular, b)))
        found += norm(arm) * w * h * (w * w * h + 2.0 * gain)
    return 0.5 * found


@kernel
def slip_that_ends(
    contacts: Contacts, k: int, h: float, linear: Array, angular: Array, angular_end: Array
) -> tuple[Vec3, float]:
    """Return (slip velocity of contact k at the start of a segment of h seconds, its norm [m/s]); zero without a search."""
    u = tangential_velocity(axis(contacts, k, 0), velocity_at(contacts, k, linear, angular))
    slip = norm(u)
    if slip * h > SLIPPED and slip > remainder(contacts, k, h, angular, angular_end):
        return u, slip
    return (0.0, 0.0, 0.0), 0.0


@kernel
def end_of_slip(
    contacts: Contacts, masses: Masses, h: float, linear: Array, angular: Array, linear_end: Array, angular_end: Array
) -> float:
    """Return the time <= h at which the first slip ends.

    Summed over the points of a face that slip at the start, since their shares of the friction are not unique. Less friction than
    sliding gives means that the slip ended at that part of h; a slip that reversed went through zero meanwhile. Whether it ended
    follows from the sizes of the friction impulses: under a spinning box they cancel as vectors although no point sticks. When it
    ended follows from their power: impulses of points that only strain against each other have none together.
    """
    soonest = h
    count, start = contacts.used[0], 0
    while start < count:
        end, limit, friction, touching, power, most = start, 0.0, 0.0, -1, 0.0, 0.0
        while end < count and one_face(contacts, masses, start, end):
            if contacts.impulse[end, 0] > 0.0:
                u0, slip = slip_that_ends(contacts, end, h, linear, angular, angular_end)
                if slip > 0.0:
                    limit += contacts.friction[end] * contacts.impulse[end, 0]
                    friction += hypot(contacts.impulse[end, 1], contacts.impulse[end, 2])
                    most += contacts.friction[end] * contacts.impulse[end, 0] * slip
                    for i in range(1, 3):
                        power -= contacts.impulse[end, i] * dot(axis(contacts, end, i), u0)
                    touching = end
            end += 1
        if limit > 0.0:
            n = axis(contacts, touching, 0)
            u0 = tangential_velocity(n, velocity_at(contacts, touching, linear, angular))
            slip, share = norm(u0), friction / limit
            u1 = along(velocity_at(contacts, touching, linear_end, angular_end), h, row(contacts.bias_acceleration, touching))
            u1 = tangential_velocity(n, u1)
            if share < 1.0 - ROUGH:
                share = power / most if 0.0 < power < share * most else share
                soonest = min(soonest, h * share)
            elif dot(u0, u1) < 0.0:
                soonest = min(soonest, h * slip / (slip + norm(u1)))
        start = end
    return soonest


@kernel
def slip_on(
    contacts: Contacts, masses: Masses, h: float, linear: Array, angular: Array, linear_end: Array, angular_end: Array
) -> None:
    """Set kinetic friction at all contacts that slip at the start of a segment of h seconds, as if they slipped throughout."""
    for k in range(contacts.used[0]):
        u, slip = slip_that_ends(contacts, k, h, linear, angular, angular_end)
        if contacts.driven[k] == NOT_DRIVEN and contacts.impulse[k, 0] > 0.0 and slip > 0.0:
            along_x, along_y = dot(axis(contacts, k, 1), u), dot(axis(contacts, k, 2), u)
            x, y = kinetic_friction(contacts.friction[k], contacts.impulse[k, 0], along_x, along_y, slip)
            change(contacts, masses, k, (0.0, x - contacts.impulse[k, 1], y - contacts.impulse[k, 2]), linear_end, angular_end)


Index = NDArray[np.int64]

LEVEL, HOVER, DETERMINED = 1.5, 5.0, 3
"""Heights in stand-offs: a held point below LEVEL stays at its height, a higher one is brought down to LEVEL. Among more than
DETERMINED points it may stay up to HOVER: a body may have more of them than it needs, and the corners of one face, a nanometre
apart in height, would require velocities that no rigid body can have at once."""

PARTING = LIFTED
"""Contacts that separate faster than this [m/s] get no force: a force constant over the segment would hold them back. Must be
below the slowest rebound (`REST_SPEED` of `rigid.impacts`)."""

HOP = TOUCH
"""Slower separations are braked over the segment if they rise less than half of this [m] meanwhile. Without it a box that settles
rocks from corner to corner by nanometres, thousands of times."""

PAYS = 400.0
"""A dip is lifted where speed^2 is above this [m/s^2] times its depth: twenty times the cost of the lift on Earth. Slower bodies
stay in their dip, since lifting them would add energy."""

SOLVED = NOTHING
"""Accuracy [m/s] of the resting solve: a resting body sinks less than 2e-11 m a frame. 1e-12 makes moving stacks ten times
slower."""

SWEEPS = 600
"""Double sweeps of one resting solve; a stack of ten boxes takes about 100 from cold, 1 when at rest. Fewer: walls sink, or
creep; more: solves that do not converge take longer."""

GUESSES = 8
"""Rounds in which normals are solved and the friction of slipping contacts is set in turn, before all are solved together.
Fewer: slips that end are solved for slowly; more: in vain."""

ALONE = 32
"""Most contact points for which that is done. Among more, some slip and some stick, and it does not converge."""

ATTEMPTS = 6
"""Times one segment may be shortened because a slip ends inside it. Fewer: friction continues after a slip has ended; more:
solves."""

ONCE = 1
"""Attempts of a solve that is done once and roughly, by `solve_roughly`."""


class Care(NamedTuple):
    """Accuracy of a solve for forces: accuracy [m/s], double sweeps of the first try and of each later one, and attempts; ONCE
    selects `solve_roughly`."""

    tolerance: float
    first: int
    sweeps: int
    attempts: int


@kernel
def can_pay(contacts: Contacts, k: int, dip: float, linear: Array) -> bool:
    """Return True if the kinetic energy of a body of contact k can pay for lifting it by ``dip`` [m]."""
    v_a, v_b = row(linear, contacts.body[k, 0]), row(linear, contacts.body[k, 1])
    return bool(max(dot(v_a, v_a), dot(v_b, v_b)) > PAYS * contacts.pace[0] * contacts.pace[0] * dip)


@kernel
def distance_to_close(contacts: Contacts, k: int, linear: Array) -> float:
    """Return the distance [m] by which contact k is to close, or, below 0, to open; 0 where no body has energy for the lift."""
    gap = contacts.gap[k]
    stays = (HOVER if contacts.used[0] > DETERMINED else LEVEL) * STAND_OFF
    distance = gap - LEVEL * STAND_OFF if gap > stays else min(0.0, gap)
    return 0.0 if distance < 0.0 and not can_pay(contacts, k, -gap, linear) else float(distance)


@kernel
def sway_acceleration(contacts: Contacts, k: int, angular: Array) -> Vec3:
    """Return the part [m/s^2] of contact k's bias acceleration by its turning lever arms; midpoint arms include half of it."""
    a, b = contacts.body[k, 0], contacts.body[k, 1]
    return sub(cross(row(angular, a), row(contacts.sway_a, k)), cross(row(angular, b), row(contacts.sway_b, k)))


@kernel
def aim(contacts: Contacts, h: float, linear: Array, angular: Array) -> None:
    """Set the bias velocities of all contacts after h seconds of constant force, from velocities at the start.

    Velocities at the end are taken with the lever arms of the midpoint, so the bias acceleration is added to the target, less the
    half of `sway_acceleration` that those arms include already.
    """
    for k in range(contacts.used[0]):
        v = dot(axis(contacts, k, 0), velocity_at(contacts, k, linear, angular))
        if v * h > HOP or v > PARTING * contacts.pace[0]:
            contacts.target[k] = -inf
            for i in range(3):
                contacts.impulse[k, i] = 0.0
        else:
            distance = distance_to_close(contacts, k, linear)
            bias = along(row(contacts.bias_acceleration, k), -0.5, sway_acceleration(contacts, k, angular))
            contacts.target[k] = -h * dot(axis(contacts, k, 0), bias) - max(-LIFT * contacts.pace[0], 2.0 * distance / h)
            contacts.slide[k, 0] = -h * dot(axis(contacts, k, 1), bias)
            contacts.slide[k, 1] = -h * dot(axis(contacts, k, 2), bias)


@kernel
def fall(
    members: Index, moving: Index, round_: Index, gravity: Array, inertia: Array, masses: Masses, h: float, linear: Array,
    angular: Array, linear_end: Array, angular_end: Array, rolls: Index, series: Series,
) -> None:
    """Add the velocities without contacts after h seconds to the changes by contacts in ``linear_end`` and ``angular_end``.

    Rotation without torque is exact: explicit Euler makes a spinning top nod ever more. The torque of the contacts, as guessed so
    far, tilts inertia and momentum of a spinning body, to second order in h. A body that ``rolls`` turns too far for that; its
    gyroscopic torque, which contacts nearly balance, is that of the start. ``inertia`` (nb, 3, 3) in world axes, gyroscopic
    unless ``round_``.
    """
    unturned = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))
    for m in range(members.shape[0]):
        b = members[m]
        w, gain = row(angular, b), row(angular_end, b)
        for i in range(3):
            linear_end[b, i] += linear[b, i] + (h * gravity[i] if moving[b] == 1 else 0.0)
        if moving[b] == 1 and round_[b] == 0:
            of, inverse = columns(inertia, b), columns(masses.inverse_inertia, b)
            momentum = turned(of, w)
            if rolls[b] == 1:
                w = along(w, h, turned(inverse, cross(momentum, w)))
            else:
                tilt = along(cross(gain, momentum), 2.0, cross(w, turned(of, gain)))
                gain = along(gain, 0.5 * h, sub(cross(w, gain), turned(inverse, tilt)))
                _, w = tumbled(of, inverse, unturned, w, h, series)
        put_row(angular_end, b, add(w, gain))


@kernel
def hold(
    contacts: Contacts, masses: Masses, members: Index, moving: Index, round_: Index, gravity: Array, inertia: Array, h: float,
    linear: Array, angular: Array, linear_end: Array, angular_end: Array, before: Array, direction: Array, care: Care,
    rolls: Index, series: Series,
) -> tuple[float, float]:
    """Solve for contact forces constant over the next h seconds, or over less if a slip ends before.

    Args:
        contacts: hold forces [N] on entry (a guess), impulses over the segment [N s] on return.
        members: the bodies that the contacts are between, but for fixed and sleeping ones.
        masses: driven bodies must not yield in them.
        rolls: (nb) 1 where a body touches with a smooth surface, or touches one.
        linear, angular: velocities at the start, unchanged; linear_end, angular_end: at the end of the segment.

    Returns:
        (length of the segment [s], residual [m/s]).
    """
    scale_impulses(contacts, h)
    residual = 0.0
    for attempt in range(care.attempts):
        count = contacts.used[0]
        # forces at the lever arms of the midpoint do the work along the curved path to second order
        weigh_after(contacts, masses, 0.5 * h)
        aim(contacts, h, linear, angular)
        for m in range(members.shape[0]):
            linear_end[members[m], :] = 0.0
            angular_end[members[m], :] = 0.0
        for k in range(count):
            for i in range(3):
                push_along(contacts, masses, k, i, contacts.impulse[k, i], linear_end, angular_end)
        fall(members, moving, round_, gravity, inertia, masses, h, linear, angular, linear_end, angular_end, rolls, series)
        residual = unsolved(contacts, 0, count, linear_end, angular_end)
        for _ in range(GUESSES if attempt > 0 and count <= ALONE else 0):
            # shortly before a slip ends the solver converges slowest in friction, which is known there
            if not (residual > 10.0 * care.tolerance):
                break
            slip_on(contacts, masses, h, linear, angular, linear_end, angular_end)
            sweeps(contacts, masses, 0, count, linear_end, angular_end, care.tolerance, care.first, False, before, direction)
            residual = unsolved(contacts, 0, count, linear_end, angular_end)
        if residual > 10.0 * care.tolerance or not (residual >= 0.0):
            if care.attempts == ONCE:
                residual = solve_roughly(
                    contacts, masses, 0, count, linear_end, angular_end, care.tolerance, care.first, care.sweeps, before,
                    direction,
                )
            else:
                residual = solve_contacts(
                    contacts, masses, 0, count, linear_end, angular_end, care.tolerance, care.first, care.sweeps, before,
                    direction,
                )
            if not (residual <= 10.0 * care.tolerance):
                # the end of a slip cannot be found from forces that have not converged
                break
        shorter = end_of_slip(contacts, masses, h, linear, angular, linear_end, angular_end)
        if shorter >= h * (1.0 - JUDGED) or shorter < PROOF or attempt == care.attempts - 1:
            break
        scale_impulses(contacts, shorter / h)
        h = shorter
    return h, residual
