"""What contacts do at one instant of the upper loop: impacts first, then forces and paths until the next event."""

from math import ceil

import numpy as np
from numpy.typing import NDArray

from avatarsim.impact.contact_solver import FIRST_TRY
from avatarsim.impact.contact_time import time_to_contact
from avatarsim.impact.contacts import SHARP, Contacts, axis, velocity_at, weigh
from avatarsim.impact.events import APPROACH, IMPACT, Events
from avatarsim.impact.impact_queue import REST_SPEED, fastest_approach, line_up, next_approach, resolve_impact, settle
from avatarsim.impact.resting import ATTEMPTS, HOP, PARTING, SOLVED, SWEEPS, Care, hold
from avatarsim.impact.rolling import curvature
from avatarsim.jit.kernel import kernel
from avatarsim.loops.clocks import witness
from avatarsim.loops.last_forces import recall_forces, remember_forces
from avatarsim.loops.upper_memory import (
    CONTACTS,
    DONE,
    GUARDED,
    IMPACTS,
    OUT_OF_IMPACTS,
    SOLVES,
    UNSOLVED,
    WORK,
    Memory,
    Switches,
)
from avatarsim.loops.zeno_tail import begin_tail
from avatarsim.motion.path import FREE, HELD, STILL
from avatarsim.spatial.tangent import columns, turned
from avatarsim.spatial.vec3 import cross, dot, norm, put_row, row, scale, sub
from avatarsim.world.dynamics import Dynamics, Velocities
from avatarsim.world.geometry import Geometry, Poses

Index = NDArray[np.int64]

IMPACTS_ALONE, IMPACTS_PER_POINT = 100, 4
"""Impacts resolved one after the other at one instant, at least and per contact point. What still approaches then is an avalanche
of ever slower rebounds between the same bodies, and ends in one impact of all together without rebound. Fewer: Newton's cradles
lose speed; more: a struck stack takes thousands."""

GENTLE_TURN = 0.1
"""Largest turn [rad] of a touching body that is no ball in one segment; its contact points move on arcs, not on lines."""

STEADY_TURN = 2.0
"""The same [rad] about any axis for what is smooth and no ball, a rolling log too: over larger ones the torque of its own spin,
taken from the start, makes a tilt of nanometres grow from segment to segment."""

RISE, FEW = 8e-7, 2
"""Spin x gravity x h^3 [m] of a segment, a body that stands on so few points: it rises by a quarter of that (h^3 / 12 times three
times spin x twist x arm), and from a micrometre on it flies, lands and loses energy."""

SETTLED, BRISKLY_SETTLED = 1e-10, 1e-8
"""Approach [m/s] that needs no impulse, and that of many bodies in motion: forces brake it within a nanometre."""

PRECISE, VISITS, LOOKS = 24, 20000, 80000
"""Impacts of one instant that are solved for to rounding; visits of contact points by the solver after which all other impacts of
this instant are taken together; points looked at to find out who is next, after which they are too."""

HASTY, HASTY_VISITS = Care(tolerance=1e-6, first=60, sweeps=60, attempts=1), 20000
"""Of a plastic step, with fewer sweeps where they would look at more contact points than that. Most heaps in motion are solved
within the first sweeps, friction included; normals alone take about as many and leave friction as it happens to be. The tolerance
[m/s] is 17 nm in a sixtieth of a second, less than the stand-off; a tenth of it takes a third more sweeps."""

SOLVE_VISITS, CAREFUL_VISITS, LATE = 24000, 60000, 100000
"""The same of any other solve, for each of its stages, of bodies in motion and at rest: what a budget of sweeps would cost grows
with the contacts without end. About one and two milliseconds; less for those at rest, and a wall of a hundred boxes that stands
does not find the forces that hold it, and creeps. Once the work of a frame is above the last, its plastic steps get a quarter."""

CAREFUL = Care(SOLVED, FIRST_TRY, SWEEPS, ATTEMPTS)
"""Where bodies rest, or are few."""

BRISK = Care(tolerance=1e-7, first=60, sweeps=40, attempts=3)
"""Of many bodies in motion: they sink by a few nanometres a frame, which is lifted again."""

MANY, MOTION = 8, 1e-2
"""More contact points than this are many; a body faster than this [m/s] moves."""

STILLNESS = 1e-7
"""A held body slower than this [m/s, rad/s] at both ends of a segment rests: its velocities become exactly zero."""

SMALL = 1e-2
"""Bodies smaller than this [m] may spin faster by as much and still rest: what the solver leaves of a point's velocity, over an
arm of a tenth of a millimetre, is a spin of 1e-5."""


@kernel
def impacts(
    geometry: Geometry, dynamics: Dynamics, poses: Poses, velocities: Velocities, memory: Memory, events: Events, members: Index,
    now: float, hasty: bool, settles: bool, switches: Switches,
) -> int:
    """Resolve all impacts of this instant, ``hasty`` all at once and without rebound; returns DONE or OUT_OF_IMPACTS.

    What approach these leave is ended if ``settles``; else the step does that, see `resting.aim_at_once`.
    Events are recorded with the time at which the surfaces meet, with the poses of the stand-off at which the bodies are held.
    """
    contacts, v, w = memory.contacts, velocities.linear, velocities.angular
    contacts.standing[0] = 0
    status, resolved, patience = DONE, 0, 0 if hasty else IMPACTS_ALONE + IMPACTS_PER_POINT * contacts.used[0]
    weigh(contacts, memory.strike)
    head, fastest = fastest_approach(contacts, v, w)
    calm = BRISKLY_SETTLED if is_brisk(memory, velocities, members) else SETTLED
    if head < 0 or fastest >= -calm:
        return status
    slow = REST_SPEED * contacts.pace[0]
    line_up(contacts, memory.strike, memory.newest, memory.older)
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
            contacts, memory.strike, members, head, fastest, switches.paper, resolved < PRECISE, v, w, memory.linear_end,
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
    if fastest < -calm and settles:
        # the coupled mass yields here too: a body of a ton that creeps would give a hand of a pound a ton's momentum
        rough = hasty or fastest < -slow or 2 * contacts.used[0] * BRISK.sweeps > CAREFUL_VISITS
        few = contacts.used[0] <= MANY and not rough
        care = care_for(memory, velocities, members, rough)
        # forces brake what is left within a nanometre
        tolerance = max(care.tolerance if care.tolerance > SOLVED else calm, -1e-6 * fastest)
        settle(
            contacts, memory.strike, members, care.attempts == 1, 1e-12 if few else tolerance, care.first, care.sweeps, v, w,
            memory.linear_end, memory.angular_end, memory.before, memory.direction, memory.received,
        )
    return status


@kernel
def care_for(memory: Memory, velocities: Velocities, members: Index, hasty: bool) -> Care:
    """How exactly the contacts of these bodies are worth solving for: the more there are, the fewer sweeps.

    Who cannot afford even the first try keeps the friction that he has so far, instead of one that begins at nothing again.
    """
    count = max(1, memory.contacts.used[0])
    care, visits = CAREFUL, CAREFUL_VISITS
    if hasty:
        late = memory.counts[WORK] + memory.contacts.visits[0] > LATE
        care, visits = HASTY, HASTY_VISITS // 4 if late else HASTY_VISITS
    elif is_brisk(memory, velocities, members):
        care, visits = BRISK, SOLVE_VISITS
    most = max(1, visits // (2 * count))
    if hasty or most < care.first:
        return Care(max(care.tolerance, HASTY.tolerance), min(HASTY.first, most), min(HASTY.sweeps, most), HASTY.attempts)
    return Care(care.tolerance, care.first, min(care.sweeps, most), care.attempts)


@kernel
def is_brisk(memory: Memory, velocities: Velocities, members: Index) -> bool:
    """Whether these are many contacts of bodies of which one moves."""
    if memory.contacts.used[0] > MANY:
        for m in range(members.shape[0]):
            if norm(row(velocities.linear, members[m])) > MOTION:
                return True
    return False


@kernel
def turns_with(contacts: Contacts, memory: Memory, velocities: Velocities, k: int, side: int) -> float:
    """How fast contact k changes as its body on this side turns [rad/s], or that body's own spin does without torque."""
    b = contacts.body[k, side]
    fastest = float(contacts.turns[k, side])
    if contacts.smooth[k] != SHARP and memory.round[b] == 0:
        w = row(velocities.angular, b)
        momentum = turned(columns(memory.inertia, b), w)
        if dot(momentum, momentum) > 0.0:
            fastest = max(fastest, norm(cross(w, momentum)) / norm(momentum))
    return fastest


@kernel
def segment(
    dynamics: Dynamics, velocities: Velocities, memory: Memory, members: Index, left: float, hasty: bool, at_once: bool
) -> float:
    """Forces and paths of the members for at most ``left`` seconds; returns for how long they hold.

    With ``at_once`` those whom forces hold go straight on, with the velocities that they have at the end: `change_at_once`.
    """
    contacts, moving, paths, held, h = memory.contacts, memory.moving, memory.paths, memory.held, left
    count = contacts.used[0]
    for m in range(members.shape[0]):
        held[members[m]] = 0
    contacts.standing[0] = 1
    if count > 0:
        pull = norm((dynamics.gravity[0], dynamics.gravity[1], dynamics.gravity[2]))
        curvature(contacts, velocities.linear, velocities.angular)
        for k in range(count):
            for i in range(2):
                b = contacts.body[k, i]
                spin = turns_with(contacts, memory, velocities, k, i)
                if moving[b] == 1 and not hasty:
                    if spin * h > GENTLE_TURN:
                        h = GENTLE_TURN / spin
                    if count <= FEW and spin * pull * h * h * h > RISE:
                        h = (RISE / (spin * pull)) ** (1.0 / 3.0)
                    rolls = norm(row(velocities.angular, b)) if contacts.smooth[k] != SHARP and memory.round[b] == 0 else 0.0
                    if rolls * h > STEADY_TURN:
                        h = STEADY_TURN / rolls
        if count <= MANY and not hasty:
            for k in range(count):
                rises = dot(axis(contacts, k, 0), velocity_at(contacts, k, velocities.linear, velocities.angular))
                if rises <= PARTING * contacts.pace[0] and rises * h > HOP:
                    h = HOP / rises
        if h < left:
            # what is left over at the end would be a stretch so short that a nanometre to come down is a speed
            h = left / ceil(left / h)
        recall_forces(contacts, memory.last)
        care = care_for(memory, velocities, members, hasty)
        if at_once:
            # impacts are in these forces too: who approached on would stop at once, and all of his neighbours
            care = Care(care.tolerance, care.first, HASTY.sweeps, care.attempts)
        h, residual = hold(
            contacts, memory.hold, members, moving, memory.round, dynamics.gravity, memory.inertia, h, velocities.linear,
            velocities.angular, memory.linear_end, memory.angular_end, memory.before, memory.direction, care,
            at_once,
        )
        remember_forces(contacts, h, members, memory.last)
        memory.counts[SOLVES] += 1
        memory.counts[UNSOLVED] += 1 if not (residual <= 10.0 * care.tolerance) else 0
        memory.counts[CONTACTS] = max(memory.counts[CONTACTS], count)
        for k in range(count):
            # at once gravity is all at the start: who touches must have it as his neighbours do
            if contacts.impulse[k, 0] > 0.0 or at_once:
                held[contacts.body[k, 0]], held[contacts.body[k, 1]] = 1, 1
    for m in range(members.shape[0]):
        b = members[m]
        held[b] *= moving[b]
        paths.time[b] = -1.0
        paths.kind[b] = (HELD if held[b] == 1 else FREE) if moving[b] == 1 else STILL
        acceleration, twist = (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)
        if held[b] == 1:
            v, w = row(velocities.linear, b), row(velocities.angular, b)
            v_end, w_end = row(memory.linear_end, b), row(memory.angular_end, b)
            size = min(1.0, memory.span[b] / SMALL)
            if max(norm(v), size * norm(w), norm(v_end), size * norm(w_end)) < STILLNESS:
                paths.kind[b] = STILL
                put_row(velocities.linear, b, acceleration)
                put_row(velocities.angular, b, acceleration)
            else:
                if not at_once:
                    acceleration, twist = scale(sub(v_end, v), 1.0 / h), scale(sub(w_end, w), 1.0 / h)
        elif moving[b] == 1:
            acceleration = (dynamics.gravity[0], dynamics.gravity[1], dynamics.gravity[2])
        put_row(paths.linear, b, acceleration)
        put_row(paths.angular, b, twist)
    return h


@kernel
def change_at_once(velocities: Velocities, memory: Memory, members: Index) -> None:
    """Swap the velocities of held members for those at the end of their segment, or back again if there is to be another one."""
    for m in range(members.shape[0]):
        b = members[m]
        if memory.paths.kind[b] == HELD:
            v, w = row(velocities.linear, b), row(velocities.angular, b)
            put_row(velocities.linear, b, row(memory.linear_end, b))
            put_row(velocities.angular, b, row(memory.angular_end, b))
            put_row(memory.linear_end, b, v)
            put_row(memory.angular_end, b, w)


@kernel
def note_change(memory: Memory, members: Index) -> None:
    """After `change_at_once`: keep the velocities that held members had before, for `clocks.go_back`."""
    for m in range(members.shape[0]):
        b = members[m]
        if memory.paths.kind[b] == HELD:
            put_row(memory.islands.linear_before, b, row(memory.linear_end, b))
            put_row(memory.islands.angular_before, b, row(memory.angular_end, b))
