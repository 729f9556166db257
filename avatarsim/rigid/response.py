"""Contact response of an island at one instant: impacts (eqs 7 to 10), then constant contact forces until the next event.

Before these, overlaps that are left of earlier frames are projected out of positions alone.
"""

from math import ceil

import numpy as np
from numpy.typing import NDArray

from avatarsim.collision.conservative_advancement import STAND_OFF, TOUCH
from avatarsim.collision.manifold import MANIFOLD_POINTS
from avatarsim.collision.path import FREE, HELD, STILL, spun
from avatarsim.jit.kernel import kernel
from avatarsim.model.dynamics import Dynamics, Velocities
from avatarsim.model.geometry import Geometry, Poses, place
from avatarsim.rigid.clocks import witness
from avatarsim.rigid.contact_generation import find_contacts
from avatarsim.rigid.contacts import SHARP, Contacts, Masses, axis, recall_forces, remember_forces, to_world, velocity_at, weigh
from avatarsim.rigid.impacts import (
    REST_SPEED,
    begin_tail,
    chain_by_body,
    fastest_approach,
    next_approach,
    resolve_impact,
    settle,
    time_to_contact,
)
from avatarsim.rigid.resting import ATTEMPTS, DETERMINED, HOP, ONCE, PARTING, SOLVED, SWEEPS, Care, hold
from avatarsim.rigid.rolling import curvature
from avatarsim.rigid.solver import FIRST_TRY
from avatarsim.rigid.state import (
    APPROACH,
    CONTACTS,
    DONE,
    EVENTS_CAP,
    GUARDED,
    IMPACT,
    IMPACTS,
    OUT_OF_IMPACTS,
    SOLVES,
    UNSOLVED,
    WORK,
    WORK_CAP,
    Events,
    Memory,
    Switches,
)
from avatarsim.spatial.tangent import columns, put_columns, turned
from avatarsim.spatial.vec3 import add, cross, dot, norm, put_row, row, scale, sub
from avatarsim.tolerances import JUDGED, PROOF, ROUGH, ROUNDING, SLIGHT, SMALL

Array = NDArray[np.float64]
Index = NDArray[np.int64]

PASSES, WEIGHED = 10, 4
"""Passes, each of which finds the contacts anew, and those weighted by mass. Normals of deep overlaps turn as bodies part.
Fewer: overlap is left (SQUEEZED), or a light body under a heavy one stays in it; more: frames that overlap take longer."""

ROUNDS = 30
"""Gauss-Seidel rounds over the contacts of one pass. Fewer: more passes; more: rounds for normals that turn."""

GOOD = -ROUGH
"""A gap above this [m] is left as it is."""


# Position projection (drift correction; post-stabilization: Cline and Pai 2003): overlapping simulated bodies are moved apart.
#
# Nonlinear Gauss-Seidel on positions; velocities stay, so no kinetic energy is added. The first passes weigh by mass. They do not
# converge for a light body on the floor under a heavy one, so from WEIGHED on all bodies yield as if they had the same mass.

@kernel
def share_of(masses: Masses, b: int, evenly: bool) -> float:
    """Return the factor on displacements of body b: with ``evenly`` its mass, so that bodies of one shape yield alike; else 1."""
    return 1.0 / masses.inverse_mass[b] if evenly and masses.inverse_mass[b] > 0.0 else 1.0


@kernel
def displace(contacts: Contacts, masses: Masses, evenly: bool, linear: Array, angular: Array) -> None:
    """Compute displacements [m], [rad], of all bodies that bring the gaps of all contacts to the stand-off, to first order."""
    linear[:, :] = 0.0
    angular[:, :] = 0.0
    for _ in range(ROUNDS):
        done = True
        for k in range(contacts.used[0]):
            n = axis(contacts, k, 0)
            gap = contacts.gap[k] + dot(n, velocity_at(contacts, k, linear, angular))
            if gap < GOOD and contacts.inverse_effective_mass[k, 0] > 0.0:
                a, b = contacts.body[k, 0], contacts.body[k, 1]
                of_a, of_b = share_of(masses, a, evenly), share_of(masses, b, evenly)
                ease_a = masses.inverse_mass[a] + dot(row(contacts.jacobian_a[k], 0), row(contacts.turn_a[k], 0))
                ease_b = masses.inverse_mass[b] + dot(row(contacts.jacobian_b[k], 0), row(contacts.turn_b[k], 0))
                d = (STAND_OFF - gap) / (of_a * ease_a + of_b * ease_b)
                for x in range(3):
                    linear[a, x] += d * of_a * masses.inverse_mass[a] * n[x]
                    linear[b, x] -= d * of_b * masses.inverse_mass[b] * n[x]
                    angular[a, x] += d * of_a * contacts.turn_a[k, 0, x]
                    angular[b, x] -= d * of_b * contacts.turn_b[k, 0, x]
                done = False
        if done:
            break


@kernel
def project_positions(
    geometry: Geometry, dynamics: Dynamics, poses: Poses, velocities: Velocities, pairs: Index, memory: Memory
) -> float:
    """Push overlapping simulated bodies out of each other and of the others; return the smallest gap left [m]."""
    linear, angular = memory.linear_end, memory.angular_end
    worst = 0.0
    for k in range(PASSES + 1):
        _, worst = find_contacts(geometry, dynamics, poses, velocities, pairs, memory)
        if not (worst < GOOD) or k == PASSES:
            break
        weigh(memory.contacts, memory.masses)
        displace(memory.contacts, memory.masses, k >= WEIGHED, linear, angular)
        for b in range(memory.moving.shape[0]):
            d, turn = row(linear, b), row(angular, b)
            if memory.moving[b] == 1 and dot(d, d) + dot(turn, turn) > 0.0:
                put_row(poses.position, b, add(row(poses.position, b), d))
                # a step of a radian is no first-order step
                small = min(1.0, GENTLE_TURN / max(norm(turn), 1e-300))
                put_columns(poses.rotation, b, spun(columns(poses.rotation, b), turn, small))
                place(geometry, poses, b)
                to_world(dynamics.inverse_inertia, poses.rotation, b, memory.masses.inverse_inertia)
                put_row(memory.trial.position, b, row(poses.position, b))
                put_columns(memory.trial.rotation, b, columns(poses.rotation, b))
                place(geometry, memory.trial, b)
    for b in range(memory.moving.shape[0]):
        # for bodies at rest these rows hold their velocities again, which contacts read
        put_row(linear, b, row(velocities.linear, b))
        put_row(angular, b, row(velocities.angular, b))
    return worst


IMPACTS_PER_POINT = 4
"""Most impacts per contact point, in addition to EVENTS_CAP, resolved one after the other at one instant. Contacts that still
approach then are resolved together without rebound: they pass ever slower rebounds between the same bodies."""

GENTLE_TURN = 0.1
"""Largest turn [rad] of a touching body that is no ball in one segment; its contact points move on arcs, not on lines.
Larger: it dips or gains energy, which is taken back; smaller: more segments."""

STEADY_TURN = 2.0
"""Largest turn [rad] about any axis for smooth bodies that are no balls, such as a rolling log: over larger turns the gyroscopic
torque, taken from the start of the segment, makes a tilt of nanometres grow from segment to segment."""

RISE = 0.8 * TOUCH
"""Largest spin x gravity x h^3 [m] of a segment for a body on fewer points than determine its motion: it rises by a quarter of
that (h^3 / 12 times three times spin x twist x arm), and from TOUCH on it would leave its contacts, land and lose energy."""

SETTLED, BRISKLY_SETTLED = PROOF, SLIGHT
"""Approach [m/s] that needs no impulse, and that of many bodies in motion: forces brake it within a nanometre."""

PRECISE, VISITS, LOOKS = 24, 20000, 80000
"""Impacts of one instant that are solved to rounding; solver visits of contact points after which the remaining impacts of this
instant are resolved together, and that the sweeps of a fallback step may make; the same for points searched for the fastest
approach. Fewer: restitution is less exact, or lost in the rest; more: instants with many impacts take longer."""

FIRST_SWEEPS = 60
"""Double sweeps of bodies in motion, friction included, before normals are solved alone. Fewer: friction is left where it is;
more: heaps cost more, most of which converge within them."""

HASTY = Care(JUDGED, FIRST_SWEEPS, FIRST_SWEEPS, ONCE)
"""Accuracy of a fallback step. Normals alone take about as many sweeps as the first and leave friction where it is. The tolerance
[m/s] is 17 nm in a sixtieth of a second, less than the stand-off; a tenth of it takes a third more sweeps."""

SOLVE_VISITS, CAREFUL_VISITS, LATE = WORK_CAP, 60000, 100000
"""Most contact points that each stage of any other solve may visit, of bodies in motion and at rest; sweeps alone are no bound on
work. About one and two milliseconds; less at rest, and a standing wall of a hundred boxes does not find the forces that hold it,
and creeps. LATE: work of a frame above which its fallback steps get a quarter of VISITS."""

CAREFUL = Care(SOLVED, FIRST_TRY, SWEEPS, ATTEMPTS)
"""Accuracy where bodies rest, or are few."""

BRISK = Care(tolerance=ROUGH, first=FIRST_SWEEPS, sweeps=40, attempts=3)
"""Accuracy for many bodies in motion: they sink by a few nanometres a frame, which is corrected later.
Fewer sweeps or attempts: they sink more, and slips end late; more: heaps take longer."""

MANY, MOTION = MANIFOLD_POINTS, 1e-2
"""More contact points than this, those of one pair of shapes, are many; a body faster than this [m/s] moves."""

STILLNESS = ROUGH
"""A supported body slower than this [m/s, rad/s] at both ends of a segment rests: its velocities become exactly zero."""


@kernel
def impacts(
    geometry: Geometry, dynamics: Dynamics, poses: Poses, velocities: Velocities, memory: Memory, events: Events, members: Index,
    now: float, hasty: bool, switches: Switches,
) -> int:
    """Resolve all impacts of this instant, ``hasty``: all together and without rebound; return DONE or OUT_OF_IMPACTS.

    The approach that is left is ended too, without rebound. Events are recorded with the time at which the surfaces meet, and the
    poses at the stand-off.
    """
    contacts, v, w = memory.contacts, velocities.linear, velocities.angular
    contacts.standing[0] = 0
    status, resolved, patience = DONE, 0, 0 if hasty else EVENTS_CAP + IMPACTS_PER_POINT * contacts.used[0]
    weigh(contacts, memory.impact_masses)
    head, fastest = fastest_approach(contacts, v, w)
    calm = BRISKLY_SETTLED if is_brisk(memory, velocities, members) else SETTLED
    if head < 0 or fastest >= -calm:
        return status
    slow = REST_SPEED * contacts.pace[0]
    chain_by_body(contacts, memory.impact_masses, memory.newest, memory.older)
    while head >= 0 and fastest < -slow:
        if resolved >= patience or contacts.visits[0] > VISITS or resolved * contacts.used[0] > LOOKS:
            status = OUT_OF_IMPACTS
            break
        a, b = contacts.body[head, 0], contacts.body[head, 1]
        met = now
        if switches.record:
            curvature(contacts, v, w)
            met += time_to_contact(contacts, head, v, w, memory.paths.linear, memory.paths.angular)
            witness(geometry, events, APPROACH, met, now, a, b, poses, velocities, memory)
        guarded, first, last = resolve_impact(
            contacts, memory.impact_masses, members, head, fastest, switches.paper, resolved < PRECISE, v, w, memory.linear_end,
            memory.angular_end, memory.before, memory.direction, memory.received,
        )
        begin_tail(contacts, dynamics, memory, head, fastest, now)
        if switches.record:
            witness(geometry, events, IMPACT, met, now, a, b, poses, velocities, memory)
        memory.counts[GUARDED] += 1 if guarded else 0
        resolved += 1
        head, fastest = next_approach(contacts, first, last, v, w, memory.newest, memory.older)
    memory.counts[IMPACTS] += resolved
    memory.counts[WORK] += resolved * contacts.used[0] // 2
    if fastest < -calm:
        # driven bodies yield with their coupled mass here too: else a creeping body of a ton would give a hand its whole momentum
        rough = hasty or fastest < -slow or 2 * contacts.used[0] * BRISK.sweeps > CAREFUL_VISITS
        few = contacts.used[0] <= MANY and not rough
        care = care_for(memory, velocities, members, rough)
        # forces brake the rest within a nanometre
        tolerance = max(care.tolerance if care.tolerance > SOLVED else calm, -JUDGED * fastest)
        settle(
            contacts, memory.impact_masses, members, care.attempts == ONCE, ROUNDING if few else tolerance, care.first,
            care.sweeps, v, w, memory.linear_end, memory.angular_end, memory.before, memory.direction, memory.received,
        )
    return status


@kernel
def care_for(memory: Memory, velocities: Velocities, members: Index, hasty: bool) -> Care:
    """Return the accuracy and sweeps for the contacts of these bodies: the more contacts, the fewer sweeps.

    Where the bound of visits does not cover the first sweeps, friction stays as these leave it, and is not solved anew from zero.
    """
    count = max(1, memory.contacts.used[0])
    care, visits = CAREFUL, CAREFUL_VISITS
    if hasty:
        late = memory.counts[WORK] + memory.contacts.visits[0] > LATE
        care, visits = HASTY, VISITS // 4 if late else VISITS
    elif is_brisk(memory, velocities, members):
        care, visits = BRISK, SOLVE_VISITS
    most = max(1, visits // (2 * count))
    if hasty or most < care.first:
        return Care(max(care.tolerance, HASTY.tolerance), min(HASTY.first, most), min(HASTY.sweeps, most), HASTY.attempts)
    return Care(care.tolerance, care.first, min(care.sweeps, most), care.attempts)


@kernel
def is_brisk(memory: Memory, velocities: Velocities, members: Index) -> bool:
    """Return True if there are more than MANY contacts and a member faster than MOTION."""
    if memory.contacts.used[0] > MANY:
        for m in range(members.shape[0]):
            if norm(row(velocities.linear, members[m])) > MOTION:
                return True
    return False


@kernel
def turns_with(contacts: Contacts, memory: Memory, velocities: Velocities, k: int, side: int) -> float:
    """Return how fast contact k changes as its body on this side turns, or as its spin precesses freely if faster [rad/s]."""
    b = contacts.body[k, side]
    fastest = float(contacts.turns[k, side])
    if contacts.smooth[k] != SHARP and memory.round[b] == 0:
        w = row(velocities.angular, b)
        momentum = turned(columns(memory.inertia, b), w)
        if dot(momentum, momentum) > 0.0:
            fastest = max(fastest, norm(cross(w, momentum)) / norm(momentum))
    return fastest


@kernel
def longest_segment(dynamics: Dynamics, velocities: Velocities, memory: Memory, left: float) -> float:
    """Return the time [s] up to ``left`` for which constant contact forces are accurate; mark rolling members ``supported``."""
    contacts, moving, supported, h, count = memory.contacts, memory.moving, memory.supported, left, memory.contacts.used[0]
    gravity = norm((dynamics.gravity[0], dynamics.gravity[1], dynamics.gravity[2]))
    curvature(contacts, velocities.linear, velocities.angular)
    for k in range(count):
        for i in range(2):
            b = contacts.body[k, i]
            # for `hold`: it rolls
            supported[b] = moving[b] if contacts.smooth[k] != SHARP else supported[b]
            spin = turns_with(contacts, memory, velocities, k, i)
            if moving[b] == 1:
                if spin * h > GENTLE_TURN:
                    h = GENTLE_TURN / spin
                if count < DETERMINED and spin * gravity * h * h * h > RISE:
                    h = (RISE / (spin * gravity)) ** (1.0 / 3.0)
                rolls = norm(row(velocities.angular, b)) if contacts.smooth[k] != SHARP and memory.round[b] == 0 else 0.0
                if rolls * h > STEADY_TURN:
                    h = STEADY_TURN / rolls
    if count <= MANY:
        for k in range(count):
            rises = dot(axis(contacts, k, 0), velocity_at(contacts, k, velocities.linear, velocities.angular))
            if rises <= PARTING * contacts.pace[0] and rises * h > HOP:
                h = HOP / rises
    return h


@kernel
def segment(dynamics: Dynamics, velocities: Velocities, memory: Memory, members: Index, left: float) -> float:
    """Solve contact forces and set the paths of the members for at most ``left`` seconds; return for how long they hold."""
    contacts, moving, paths, supported, h = memory.contacts, memory.moving, memory.paths, memory.supported, left
    count = contacts.used[0]
    for m in range(members.shape[0]):
        supported[members[m]] = 0
    contacts.standing[0] = 1
    if count > 0:
        h = longest_segment(dynamics, velocities, memory, left)
        if h < left:
            # equal parts: over a very short remainder a gap of a nanometre to close would be a high velocity
            h = left / ceil(left / h)
        recall_forces(contacts, memory.last)
        care = care_for(memory, velocities, members, False)
        h, residual = hold(
            contacts, memory.masses, members, moving, memory.round, dynamics.gravity, memory.inertia, h, velocities.linear,
            velocities.angular, memory.linear_end, memory.angular_end, memory.before, memory.direction, care,
            supported, memory.series,
        )
        for m in range(members.shape[0]):
            supported[members[m]] = 0
        remember_forces(contacts, h, members, memory.last)
        memory.counts[SOLVES] += 1
        memory.counts[UNSOLVED] += 1 if not (residual <= 10.0 * care.tolerance) else 0
        memory.counts[CONTACTS] = max(memory.counts[CONTACTS], count)
        for k in range(count):
            if contacts.impulse[k, 0] > 0.0:
                supported[contacts.body[k, 0]], supported[contacts.body[k, 1]] = 1, 1
    for m in range(members.shape[0]):
        b = members[m]
        supported[b] *= moving[b]
        paths.time[b] = -1.0
        paths.kind[b] = (HELD if supported[b] == 1 else FREE) if moving[b] == 1 else STILL
        acceleration, twist = (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)
        if supported[b] == 1:
            v, w = row(velocities.linear, b), row(velocities.angular, b)
            v_end, w_end = row(memory.linear_end, b), row(memory.angular_end, b)
            # small bodies may spin faster in proportion and still count as resting: the solver's residual at a contact, over a
            # lever arm of a tenth of a millimetre, is a spin of 1e-5
            size = min(1.0, memory.span[b] / SMALL)
            if max(norm(v), size * norm(w), norm(v_end), size * norm(w_end)) < STILLNESS:
                paths.kind[b] = STILL
                put_row(velocities.linear, b, acceleration)
                put_row(velocities.angular, b, acceleration)
            else:
                acceleration, twist = scale(sub(v_end, v), 1.0 / h), scale(sub(w_end, w), 1.0 / h)
        elif moving[b] == 1:
            acceleration = (dynamics.gravity[0], dynamics.gravity[1], dynamics.gravity[2])
        put_row(paths.linear, b, acceleration)
        put_row(paths.angular, b, twist)
    return h
