"""Sequential impacts at one instant (eqs 7 to 10): the fastest approach first, one block of impulses per pair of bodies.

Before them the time at which an impact is recorded; after them the rest where the budget ends, and the closed-form tail of a
ball's Zeno sequence of bounces.
"""

from math import inf, sqrt

import numpy as np
from numpy.typing import NDArray

from avatarsim.collision.conservative_advancement import RESTING
from avatarsim.collision.manifold import MANIFOLD_POINTS
from avatarsim.jit.kernel import kernel
from avatarsim.model.dynamics import Dynamics, Velocities
from avatarsim.model.geometry import Geometry, Poses
from avatarsim.rigid.clocks import witness
from avatarsim.rigid.contact_law import (
    collision_impulse,
    friction_impulse,
    limited_friction_impulse,
    normal_velocity,
    tangential_velocity,
    turning_term,
    velocity_after,
)
from avatarsim.rigid.contacts import DRIVEN_A, NOT_DRIVEN, Contacts, Masses, axis, impulse_of, speed_along, velocity_at
from avatarsim.rigid.solver import FIRST_TRY, PATIENCE, change, solve_contacts, solve_roughly
from avatarsim.rigid.state import APPROACH, IMPACT, Events, Memory
from avatarsim.spatial.tangent import columns
from avatarsim.spatial.vec3 import Vec3, add, along, cross, dot, norm, put_row, row, scale, sub
from avatarsim.tolerances import GRAINS, LAST_PLACES, ROUGH
from avatarsim.tolerances import NOTHING as NEGLIGIBLE

Array = NDArray[np.float64]


# Recorded time of an impact: when the surfaces meet, extrapolated over the stand-off at which the bodies were stopped.


@kernel
def time_to_close(gap: float, v: float, a: float) -> float:
    """Return the first t with gap + v t + a t^2 / 2 = 0 for v < 0; the instant of least gap if that stays above 0."""
    return 2.0 * gap / (sqrt(max(0.0, v * v - 2.0 * a * gap)) - v)


@kernel
def time_to_contact(contacts: Contacts, head: int, linear: Array, angular: Array, acceleration: Array, twist: Array) -> float:
    """Return seconds from now until the pair of contact ``head`` would touch, moving as it does.

    Args:
        contacts: ``bias_acceleration`` filled by `curvature`.
        linear, angular: (nb, 3) velocities before the impact. acceleration, twist: (nb, 3) accelerations.

    Returns:
        Least time over the pair's approaching points, to third order in the stand-off: below 1e-11 s from 2 m/s on. 0 if they
        touch already, and for a driven body, whose surface is its own, larger stand-off.
    """
    a, b = contacts.body[head, 0], contacts.body[head, 1]
    soonest = inf
    for k in range(contacts.used[0]):
        if contacts.body[k, 0] != a or contacts.body[k, 1] != b or contacts.driven[k] != NOT_DRIVEN:
            continue
        n = axis(contacts, k, 0)
        v = normal_velocity(n, velocity_at(contacts, k, linear, angular))
        if v < 0.0:
            turning = sub(cross(row(twist, a), row(contacts.arm_a, k)), cross(row(twist, b), row(contacts.arm_b, k)))
            free = sub(row(acceleration, a), row(acceleration, b))
            closing = dot(n, add(add(free, turning), row(contacts.bias_acceleration, k)))
            soonest = min(soonest, time_to_close(max(0.0, contacts.gap[k]), v, closing))
    return soonest if soonest < inf else 0.0


Index = NDArray[np.int64]

# Impacts of a queue, one after the other.

REST_SPEED = -RESTING
"""No rebound is slower than this [m/s], times the pace of the scene (`pace_of` of `rigid.contacts`): it would rise 1.1e-7 m, and
is rest. So no approach slower than that over the restitution bounces. Larger: visible bounces end early; smaller: a bouncing ball
takes more impacts to come to rest, without limit as it goes to 0."""

TIE = NEGLIGIBLE
"""Pairs whose approach speeds differ by less than this part are solved together, so that a corner is hit symmetrically."""

BLOCK_TOLERANCE = 10.0 * LAST_PLACES
"""Block impulses are solved to this part of the approach speed; it bounds the error of restitution."""

BLOCK_VISITS = 48000
"""Most contact points that each stage of the solve of one block visits; where a wall lands at once that is few sweeps. Fewer:
walls land with friction or restitution that is not solved for."""

BLOCK_SWEEPS = BLOCK_VISITS // (2 * MANIFOLD_POINTS)
"""Double sweeps per block: those of the points of one pair of shapes. A box face needs about 25."""

ROUGH_TOLERANCE, ROUGH_SWEEPS = ROUGH, PATIENCE
"""Block tolerance and sweeps where many blocks follow each other at one instant: a later block resolves the rest."""

NOTHING = -1
"""No contact."""

CENTRAL = NEGLIGIBLE
"""An arm whose part across the normal is smaller than this part of it counts as parallel: then normal and friction impulse do
not influence each other and eqs 9 and 10 are the exact answer."""


@kernel
def fastest_approach(contacts: Contacts, linear: Array, angular: Array) -> tuple[int, float]:
    """Return the head of the queue: the contact with the most negative v_n of eq. 7 and that v_n; (-1, 0) if none approaches.

    ``contacts.approach`` holds v_n of all of them afterwards.
    """
    for k in range(contacts.used[0]):
        contacts.approach[k] = speed_along(contacts, k, 0, linear, angular)
    return head_of_queue(contacts)


@kernel
def head_of_queue(contacts: Contacts) -> tuple[int, float]:
    """Return `fastest_approach` by the velocities in ``contacts.approach``."""
    v, count = contacts.approach, contacts.used[0]
    a, b, c, d = 0.0, 0.0, 0.0, 0.0
    # four minima side by side, so that no comparison depends on the one before
    for k in range(0, count - count % 4, 4):
        a = v[k] if v[k] < a else a
        b = v[k + 1] if v[k + 1] < b else b
        c = v[k + 2] if v[k + 2] < c else c
        d = v[k + 3] if v[k + 3] < d else d
    for k in range(count - count % 4, count):
        a = v[k] if v[k] < a else a
    fastest, head = min(min(a, b), min(c, d)), 0
    if not (fastest < 0.0):
        return -1, 0.0
    while v[head] != fastest:
        head += 1
    return head, fastest


@kernel
def chain_by_body(contacts: Contacts, masses: Masses, newest: Index, older: Index) -> None:
    """List the contacts of each body that moves, for `next_approach`.

    Args:
        newest: (nb) gets the last contact of a body, NOTHING if it has none; bodies without contacts are left as they are.
        older: (cap, 2) gets, for either body of a contact, the one before.
    """
    for k in range(contacts.used[0]):
        newest[contacts.body[k, 0]], newest[contacts.body[k, 1]] = NOTHING, NOTHING
    for k in range(contacts.used[0]):
        for side in range(2):
            b = contacts.body[k, side]
            # fixed bodies carry many contacts and never move
            if masses.inverse_mass[b] > 0.0:
                older[k, side], newest[b] = newest[b], k


@kernel
def next_approach(
    contacts: Contacts, first: int, last: int, linear: Array, angular: Array, newest: Index, older: Index
) -> tuple[int, float]:
    """Return `fastest_approach` after the block first <= k < last was resolved; updates the contacts of bodies in the block only.

    ``newest``, ``older``: of `chain_by_body`.
    """
    for i in range(first, last):
        if contacts.target[i] == -inf or (i > first and contacts.target[i - 1] != -inf and same_pair(contacts, i - 1, i)):
            continue
        for side in range(2):
            b = contacts.body[i, side]
            k = newest[b]
            while k != NOTHING:
                contacts.approach[k] = speed_along(contacts, k, 0, linear, angular)
                k = older[k, 0] if contacts.body[k, 0] == b else older[k, 1]
    return head_of_queue(contacts)


@kernel
def same_pair(contacts: Contacts, i: int, k: int) -> bool:
    """Return True if two contacts belong to the same pair of bodies."""
    return bool(contacts.body[i, 0] == contacts.body[k, 0] and contacts.body[i, 1] == contacts.body[k, 1])


@kernel
def choose_block(contacts: Contacts, fastest: float) -> tuple[int, int, int]:
    """Set targets (eq. 8) for all points of all pairs that tie with the fastest by the velocities in ``contacts.approach``.

    Returns (first, last, number of points): the block lies within first <= k < last, where the target of all others is -inf.
    """
    first, last, points, count, k = -1, 0, 0, contacts.used[0], 0
    limit, tied = fastest * (1.0 - TIE), 0
    for i in range(count):
        tied += 1 if contacts.approach[i] <= limit else 0
    while tied > 0:
        if not (contacts.approach[k] <= limit):
            k += 1
            continue
        start = k
        while start > 0 and same_pair(contacts, start - 1, k):
            start -= 1
        k += 1
        while k < count and same_pair(contacts, start, k):
            k += 1
        first = start if first < 0 else first
        for i in range(last if last > 0 else start, start):
            contacts.target[i] = -inf
        for i in range(start, k):
            v = contacts.approach[i]
            tied -= 1 if v <= limit else 0
            target = velocity_after(contacts.restitution[i], v) if v < 0.0 else 0.0
            contacts.target[i] = target if target > REST_SPEED * contacts.pace[0] else 0.0
        last = k
        points += k - start
    for k in range(first, last):
        put_row(contacts.impulse, k, (0.0, 0.0, 0.0))
    return first, last, points


@kernel
def central(contacts: Contacts, k: int) -> bool:
    """Return True if both arms of contact k are parallel to its normal, as they are between spheres."""
    n = axis(contacts, k, 0)
    ra, rb = row(contacts.arm_a, k), row(contacts.arm_b, k)
    return norm(cross(ra, n)) <= CENTRAL * norm(ra) and norm(cross(rb, n)) <= CENTRAL * norm(rb)


@kernel
def lone_impact(contacts: Contacts, masses: Masses, k: int, literal: bool, linear: Array, angular: Array) -> None:
    """Apply eqs 7, 9 and 10 in turn to one point, as printed if ``literal``, else with friction limited to sticking."""
    n, v_ab = axis(contacts, k, 0), velocity_at(contacts, k, linear, angular)
    before, v_t = normal_velocity(n, v_ab), tangential_velocity(n, v_ab)
    a, b = contacts.body[k, 0], contacts.body[k, 1]
    restitution = contacts.restitution[k] if contacts.target[k] > 0.0 else 0.0
    # a body of infinite mass has inverse mass 0 and does not turn, central arms or not: its terms vanish
    j = collision_impulse(
        restitution, before, masses.inverse_mass[a], masses.inverse_mass[b],
        turning_term(columns(masses.inverse_inertia, a), row(contacts.arm_a, k), n),
        turning_term(columns(masses.inverse_inertia, b), row(contacts.arm_b, k), n),
    )
    if literal:
        j_t = friction_impulse(contacts.friction[k], j, v_t)
    else:
        j_t = limited_friction_impulse(contacts.friction[k], j, v_t, norm(v_t) / contacts.inverse_effective_mass[k, 1])
    change(contacts, masses, k, in_frame(contacts, k, along(j_t, j, n)), linear, angular)


@kernel
def in_frame(contacts: Contacts, k: int, j: Vec3) -> Vec3:
    """Return a world vector in the axes of contact k: along the normal, and the two tangents."""
    return (dot(axis(contacts, k, 0), j), dot(axis(contacts, k, 1), j), dot(axis(contacts, k, 2), j))


@kernel
def resolve_impact(
    contacts: Contacts, masses: Masses, members: Index, head: int, fastest: float, literal: bool, precise: bool,
    linear: Array, angular: Array, linear_before: Array, angular_before: Array, before: Array, direction: Array, received: Array,
) -> tuple[bool, int, int]:
    """Resolve the head of the queue, to rounding if ``precise``; ``received`` (nb, 3) gains the impulses [N s] on driven bodies.

    Returns:
        (whether the energy guard had to shorten the impulses: Newton's law (eq. 8) with friction can otherwise create energy,
        first, last: those that took part have a target and first <= k < last).
    """
    guarded = False
    if literal:
        first, last = head, head + 1
        put_row(contacts.impulse, head, (0.0, 0.0, 0.0))
        target = velocity_after(contacts.restitution[head], fastest)
        contacts.target[head] = target if target > REST_SPEED * contacts.pace[0] else 0.0
        lone_impact(contacts, masses, head, True, linear, angular)
    else:
        first, last, points = choose_block(contacts, fastest)
        if points == 1 and (contacts.friction[first] == 0.0 or central(contacts, first)):
            lone_impact(contacts, masses, first, False, linear, angular)
        else:
            for m in range(members.shape[0]):
                b = members[m]
                put_row(linear_before, b, row(linear, b))
                put_row(angular_before, b, row(angular, b))
            tolerance = BLOCK_TOLERANCE * max(1.0, -fastest) if precise else -ROUGH_TOLERANCE * fastest
            solve_contacts(
                contacts, masses, first, last, linear, angular, tolerance, FIRST_TRY,
                min(BLOCK_SWEEPS if precise else ROUGH_SWEEPS, max(1, BLOCK_VISITS // (2 * (last - first)))), before, direction,
            )
            guarded = guard_energy(contacts, members, first, last, linear, angular, linear_before, angular_before)
    collect(contacts, first, last, received)
    return guarded, first, last


@kernel
def guard_energy(
    contacts: Contacts, members: Index, first: int, last: int, linear: Array, angular: Array, linear_before: Array,
    angular_before: Array,
) -> bool:
    """Shorten the block's impulses so that the energy they add, sum p . (u- + u+) / 2, is not above zero."""
    work, gained = 0.0, 0.0
    for k in range(first, last):
        if contacts.target[k] != -inf:
            j = impulse_of(contacts, k)
            u0 = velocity_at(contacts, k, linear_before, angular_before)
            u1 = velocity_at(contacts, k, linear, angular)
            work += dot(j, u0)
            gained += 0.5 * (dot(j, u0) + dot(j, u1))
    # rounding of an elastic impact is no gain
    if not (gained > GRAINS * abs(work)):
        return False
    kept = min(1.0, max(0.0, -work / (gained - work)))
    for m in range(members.shape[0]):
        b = members[m]
        for i in range(3):
            linear[b, i] = linear_before[b, i] + kept * (linear[b, i] - linear_before[b, i])
            angular[b, i] = angular_before[b, i] + kept * (angular[b, i] - angular_before[b, i])
    for k in range(first, last):
        for i in range(3):
            contacts.impulse[k, i] *= kept
    return True


@kernel
def collect(contacts: Contacts, first: int, last: int, received: Array) -> None:
    """Add the impulses of these contacts to those that each driven body received, for eq. 6."""
    for k in range(first, last):
        if contacts.driven[k] != NOT_DRIVEN and contacts.target[k] != -inf:
            j = impulse_of(contacts, k)
            if contacts.driven[k] == DRIVEN_A:
                b, sign = contacts.body[k, 0], 1.0
            else:
                b, sign = contacts.body[k, 1], -1.0
            put_row(received, b, along(row(received, b), sign, j))


@kernel
def settle(
    contacts: Contacts, masses: Masses, members: Index, hasty: bool, tolerance: float, tries: int, sweeps_cap: int, linear: Array,
    angular: Array,
    linear_before: Array, angular_before: Array, before: Array, direction: Array, received: Array,
) -> float:
    """End the approach that is left, all contacts together and without rebound; return the residual [m/s].

    No energy is added, even if the solver stops half way.
    """
    count = contacts.used[0]
    for m in range(members.shape[0]):
        b = members[m]
        put_row(linear_before, b, row(linear, b))
        put_row(angular_before, b, row(angular, b))
    for k in range(count):
        contacts.target[k] = 0.0
        put_row(contacts.impulse, k, (0.0, 0.0, 0.0))
    if hasty:
        left = solve_roughly(contacts, masses, 0, count, linear, angular, tolerance, tries, sweeps_cap, before, direction)
    else:
        left = solve_contacts(contacts, masses, 0, count, linear, angular, tolerance, tries, sweeps_cap, before, direction)
    guard_energy(contacts, members, 0, count, linear, angular, linear_before, angular_before)
    collect(contacts, 0, count, received)
    return left


# Closed-form tail of a Zeno sequence: the infinitely many last bounces of a ball, too low to be distinguished from rest. After an
# impact from which it rebounds with v, too slowly to leave its stand-off, all flights to come take 2 v / (g (1 - e)) together.
# For that long it lies where it is, with the speed v of its last rebound; then it is at rest.

NONE = -1.0
"""End of the tail [s] of a body that has none."""


@kernel
def tail_lasts(restitution: float, rebound: float, towards: float) -> float:
    """Return the sum of all flights [s] that begin with ``rebound`` [m/s] at the acceleration ``towards`` the surface [m/s^2]."""
    return 2.0 * rebound / (towards * (1.0 - restitution))


@kernel
def begin_tail(contacts: Contacts, dynamics: Dynamics, memory: Memory, k: int, before: float, now: float) -> None:
    """Begin the tail of a ball if the impact of contact k with velocity ``before`` < 0 at ``now`` [s] was its last.

    All flights begin and end at the stand-off, so it does not matter when the surfaces would meet.
    """
    a, b = contacts.body[k, 0], contacts.body[k, 1]
    memory.tail_end[a], memory.tail_end[b] = NONE, NONE
    e = contacts.restitution[k]
    rebound = velocity_after(e, before)
    if memory.moving[a] + memory.moving[b] != 1 or not (0.0 < rebound <= REST_SPEED * contacts.pace[0]) or e >= 1.0:
        return
    ball, sign = (a, 1.0) if memory.moving[a] == 1 else (b, -1.0)
    n, g = axis(contacts, k, 0), dynamics.gravity
    towards = -sign * dot(n, (g[0], g[1], g[2]))
    if memory.ball[ball] == 1 and contacts.used[0] == 1 and towards > 0.0:
        memory.tail_end[ball] = now + tail_lasts(e, rebound, towards)
        put_row(memory.tail_speed, ball, scale(n, sign * rebound))


@kernel
def end_tails(
    geometry: Geometry, poses: Poses, velocities: Velocities, memory: Memory, events: Events, members: Index, now: float,
    keep: bool,
) -> None:
    """End the tails of members that end now; with ``keep`` that is recorded, as an event of the ball alone."""
    for m in range(members.shape[0]):
        b = members[m]
        if NONE < memory.tail_end[b] <= now:
            if keep:
                witness(geometry, events, APPROACH, now, now, b, b, poses, velocities, memory)
            memory.tail_end[b] = NONE
            if keep:
                witness(geometry, events, IMPACT, now, now, b, b, poses, velocities, memory)


@kernel
def until_tail_ends(memory: Memory, members: Index, now: float, left: float) -> float:
    """Return the time from ``now`` to the first end of a tail of the members, at most ``left`` [s]."""
    for m in range(members.shape[0]):
        if memory.tail_end[members[m]] > now:
            left = min(left, memory.tail_end[members[m]] - now)
    return left


@kernel
def show_zeno(velocities: Velocities, memory: Memory, dt: float) -> None:
    """Show a ball within its tail with its rebound speed, at the end of a frame of dt seconds."""
    for b in range(memory.moving.shape[0]):
        if memory.tail_end[b] > dt:
            memory.tail_end[b] -= dt
            put_row(velocities.linear, b, add(row(velocities.linear, b), row(memory.tail_speed, b)))
        else:
            memory.tail_end[b] = NONE


@kernel
def resume_zeno(velocities: Velocities, memory: Memory) -> None:
    """Let a ball within its tail rest, at the start of a frame, unless its velocity was set to another one meanwhile."""
    for b in range(memory.moving.shape[0]):
        if memory.tail_end[b] > NONE:
            same = True
            for i in range(3):
                same = same and velocities.linear[b, i] == memory.tail_speed[b, i]
            if same:
                put_row(velocities.linear, b, (0.0, 0.0, 0.0))
            else:
                memory.tail_end[b] = NONE
