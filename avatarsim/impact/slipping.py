"""Sliding contacts within a segment of constant forces: which of them slip, when the first slip ends, their kinetic friction."""

from math import hypot

import numpy as np
from numpy.typing import NDArray

from avatarsim.impact.contact_solver import change
from avatarsim.impact.contacts import NOT_DRIVEN, POINTS_OF_PAIR, SHARP, Contacts, axis, velocity_at
from avatarsim.impact.friction_impulse import kinetic_friction
from avatarsim.impact.masses import Masses
from avatarsim.impact.relative_velocity import tangential_velocity
from avatarsim.jit.kernel import kernel
from avatarsim.spatial.vec3 import Vec3, along, dot, norm, row, sub

Array = NDArray[np.float64]

SLIPPED = 1e-8
"""The end of a slip is looked for if it would go farther than this [m] in the segment, and is faster than `remainder`."""

PARALLEL = 1e-9
"""Normals nearer to each other than this are of one face."""


@kernel
def one_face(contacts: Contacts, masses: Masses, i: int, k: int) -> bool:
    """Whether contacts i and k are of the same shapes, or of one body and one immovable face, which may be of several pieces."""
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
    """Speed [m/s] at which contact k may slip after a segment of h seconds that was to hold it.

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
    """(slip velocity of contact k at the start of a segment of h seconds, its norm [m/s]); zero where its end is not searched."""
    u = tangential_velocity(axis(contacts, k, 0), velocity_at(contacts, k, linear, angular))
    slip = norm(u)
    if slip * h > SLIPPED and slip > remainder(contacts, k, h, angular, angular_end):
        return u, slip
    return (0.0, 0.0, 0.0), 0.0


@kernel
def end_of_slip(
    contacts: Contacts, masses: Masses, h: float, linear: Array, angular: Array, linear_end: Array, angular_end: Array
) -> float:
    """Time <= h at which the first slip ends.

    Summed over the points of a face that slip at the start, since their shares of the friction are not unique. Less friction than
    sliding gives means that the slip ended at that part of h; a slip that reversed went through zero meanwhile. Whether it ended
    follows from the sizes of the friction impulses: under a spinning box they cancel as vectors although no point sticks. When it
    ended follows from their power: impulses of points that only strain against each other have none together.
    """
    soonest = h
    count, start = contacts.used[0], 0
    while start < count:
        end, limit, pull, touching, power, most = start, 0.0, 0.0, -1, 0.0, 0.0
        while end < count and one_face(contacts, masses, start, end):
            if contacts.impulse[end, 0] > 0.0:
                u0, slip = slip_that_ends(contacts, end, h, linear, angular, angular_end)
                if slip > 0.0:
                    limit += contacts.friction[end] * contacts.impulse[end, 0]
                    pull += hypot(contacts.impulse[end, 1], contacts.impulse[end, 2])
                    most += contacts.friction[end] * contacts.impulse[end, 0] * slip
                    for i in range(1, 3):
                        power -= contacts.impulse[end, i] * dot(axis(contacts, end, i), u0)
                    touching = end
            end += 1
        if limit > 0.0:
            n = axis(contacts, touching, 0)
            u0 = tangential_velocity(n, velocity_at(contacts, touching, linear, angular))
            slip, share = norm(u0), pull / limit
            u1 = along(velocity_at(contacts, touching, linear_end, angular_end), h, row(contacts.bend, touching))
            u1 = tangential_velocity(n, u1)
            if share < 1.0 - 1e-7:
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
