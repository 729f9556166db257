"""The upper loop of the paper's Figure 3: simulated bodies move for one frame, from collision to collision.

Touching points -> impacts of this instant (eqs 7 to 10) -> forces constant until the next event -> forward to the next time of impact.
"""

import numpy as np
from numpy.typing import NDArray

from avatarsim.impact.contacts import weigh
from avatarsim.impact.energy import held_energy, take_back
from avatarsim.impact.events import APPROACH, IMPACT, Events, record
from avatarsim.impact.impact_queue import REST_SPEED, collect, fastest_approach, resolve_impact, settle
from avatarsim.impact.masses import to_world
from avatarsim.impact.resting import SOLVED, SWEEPS, curvature, hold
from avatarsim.kernel import kernel
from avatarsim.motion.near import keeps_promise, near_pairs, stands, wake_beside
from avatarsim.motion.path import FREE, HELD, STILL, move_along
from avatarsim.motion.time_of_impact import BROKEN as PATH_BROKEN
from avatarsim.motion.time_of_impact import CLEAR, time_of_impact
from avatarsim.spatial.tangent import columns, put_columns
from avatarsim.spatial.vec3 import norm, put_row, row, scale, sub
from avatarsim.touching import BROKEN, NO_ROOM, SIMULATED, find_contacts, recall_forces, remember_forces
from avatarsim.unsqueeze import unsqueeze
from avatarsim.upper_loop_memory import (
    AUDITED, CONTACTS, GUARDED, IMPACTS, SEARCHES, SEGMENTS, SOLVES, UNSOLVED, UNSQUEEZED, Memory, Switches,
)
from avatarsim.upper_loop_memory import SWEEPS as SWEPT
from avatarsim.world.dynamics import Dynamics, Velocities
from avatarsim.world.geometry import Geometry, Poses, place

Array = NDArray[np.float64]

DONE, OUT_OF_SEGMENTS, OUT_OF_IMPACTS, OUT_OF_ROOM, SQUEEZED, NOT_FINITE = range(6)
"""Status of a frame: all of dt passed; the budget of segments is spent and bodies wait for the next frame where they were last proved
free; the budget of impacts is; more contacts or pairs than fit; overlap is left that no position of simulated bodies removes; a pose
or velocity is nan or infinite. Nothing overlaps and no energy is added in the first three."""

STATUS_NAMES = ("done", "out of segments", "out of impacts", "out of room", "squeezed", "not finite")

SEGMENTS_CAP = 100
"""Segments of one frame. A bouncing ball needs 2, a landing box 5 to 20; each costs a contact solve."""

IMPACTS_CAP = 2000
"""Impacts resolved at one instant."""

GENTLE_TURN = 0.1
"""Largest turn [rad] of a touching body that is no ball in one segment; its contact points move on arcs, not on lines."""

SETTLED = 1e-10
"""Approach [m/s] that needs no impulse."""

STILLNESS = 1e-7
"""A held body slower than this [m/s, rad/s] at both ends of a segment rests: its velocities become exactly zero."""

DEEPEST = -3.5e-7
"""Gap [m] below which positions are corrected. Must be below the dip of resting pairs (see `time_of_impact`): to lift a body that
rocks feeds it with potential energy, and it never comes to rest."""


@kernel
def begin(geometry: Geometry, dynamics: Dynamics, poses: Poses, velocities: Velocities, memory: Memory, sleeping: bool) -> int:
    """Look for what the caller changed, wake whom it concerns, and return how many bodies will move."""
    moving, asleep, trial = memory.moving, memory.asleep, memory.trial
    memory.counts[:] = 0
    memory.received[:, :] = 0.0
    bodies = moving.shape[0]
    for b in range(bodies):
        if dynamics.role[b] == SIMULATED and not (sleeping and asleep[b] == 1 and stands(velocities.linear, velocities.angular, b)):
            asleep[b], moving[b] = 0, 1
        else:
            moving[b] = 0
        memory.paths.kind[b] = STILL
    for b in range(bodies):
        same = dynamics.role[b] == SIMULATED or stands(velocities.linear, velocities.angular, b)
        for i in range(3):
            same = same and poses.position[b, i] == trial.position[b, i]
            for k in range(3):
                same = same and poses.rotation[b, i, k] == trial.rotation[b, i, k]
        if not same:
            wake_beside(trial.hulls, poses.hulls, b, memory.allowed, asleep, moving)
            if dynamics.role[b] == SIMULATED:
                asleep[b], moving[b] = 0, 1
            put_row(trial.position, b, row(poses.position, b))
            put_columns(trial.rotation, b, columns(poses.rotation, b))
            place(geometry, trial, b)
    awake = 0
    for b in range(bodies):
        awake += moving[b]
    return awake


@kernel
def weigh_bodies(dynamics: Dynamics, poses: Poses, memory: Memory) -> None:
    """Inertia in world axes of all moving bodies."""
    for b in range(memory.moving.shape[0]):
        if memory.moving[b] == 1:
            to_world(dynamics.inertia, poses.rotation, b, memory.inertia)
            to_world(dynamics.inverse_inertia, poses.rotation, b, memory.hold.inverse_inertia)


@kernel
def impacts(poses: Poses, velocities: Velocities, memory: Memory, events: Events, time: float, switches: Switches) -> int:
    """Resolve all impacts of this instant; returns DONE or OUT_OF_IMPACTS."""
    contacts, v, w = memory.contacts, velocities.linear, velocities.angular
    status, resolved = DONE, 0
    head, fastest = fastest_approach(contacts, v, w)
    if head < 0 or fastest >= -SETTLED:
        return status
    weigh(contacts, memory.strike)
    while head >= 0 and fastest < -REST_SPEED:
        if resolved == IMPACTS_CAP:
            status = OUT_OF_IMPACTS
            break
        a, b = contacts.body[head, 0], contacts.body[head, 1]
        if switches.record:
            record(events, APPROACH, time, a, b, poses.position, poses.rotation, v, w)
        guarded = resolve_impact(
            contacts, memory.strike, head, fastest, switches.paper, v, w, memory.linear_end, memory.angular_end, memory.before,
            memory.direction, memory.received,
        )
        if switches.record:
            record(events, IMPACT, time, a, b, poses.position, poses.rotation, v, w)
        memory.counts[GUARDED] += 1 if guarded else 0
        resolved += 1
        head, fastest = fastest_approach(contacts, v, w)
    memory.counts[IMPACTS] += resolved
    if fastest < -SETTLED:
        weigh(contacts, memory.hold)
        settle(contacts, memory.hold, 1e-12, SWEEPS, v, w, memory.before, memory.direction, memory.received)
    return status


@kernel
def segment(dynamics: Dynamics, velocities: Velocities, memory: Memory, left: float) -> float:
    """Forces and paths for at most ``left`` seconds; returns for how long they hold."""
    contacts, moving, paths, held, h = memory.contacts, memory.moving, memory.paths, memory.held, left
    count = contacts.count[0]
    held[:] = 0
    if count > 0:
        for k in range(count):
            for i in range(2):
                b = contacts.body[k, i]
                spin = norm(row(velocities.angular, b))
                if moving[b] == 1 and memory.ball[b] == 0 and spin * h > GENTLE_TURN:
                    h = GENTLE_TURN / spin
        recall_forces(contacts, memory.last_key, memory.last_force, memory.last_count[0])
        weigh(contacts, memory.hold)
        curvature(contacts, memory.ball, velocities.linear, velocities.angular)
        h, residual = hold(
            contacts, memory.hold, moving, memory.round, dynamics.gravity, memory.inertia, h, velocities.linear, velocities.angular,
            memory.linear_end, memory.angular_end, memory.before, memory.direction,
        )
        remember_forces(contacts, h, memory.last_key, memory.last_force, memory.last_count)
        memory.counts[SOLVES] += 1
        memory.counts[UNSOLVED] += 1 if not (residual <= 10.0 * SOLVED) else 0
        memory.counts[CONTACTS] = max(memory.counts[CONTACTS], count)
        for k in range(count):
            if contacts.impulse[k, 0] > 0.0:
                held[contacts.body[k, 0]], held[contacts.body[k, 1]] = 1, 1
    for b in range(moving.shape[0]):
        held[b] *= moving[b]
        paths.time[b] = -1.0
        paths.kind[b] = (HELD if held[b] == 1 else FREE) if moving[b] == 1 else STILL
        acceleration, twist = (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)
        if held[b] == 1:
            v, w = row(velocities.linear, b), row(velocities.angular, b)
            v_end, w_end = row(memory.linear_end, b), row(memory.angular_end, b)
            if max(norm(v), norm(w), norm(v_end), norm(w_end)) < STILLNESS:
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


@kernel
def first_event(geometry: Geometry, poses: Poses, velocities: Velocities, memory: Memory, pair_count: int, h: float) -> float:
    """Time of the first event of any near pair, at most h [s]; -1 if a pose is not finite."""
    for p in range(pair_count):
        a, b = memory.pairs[p, 0], memory.pairs[p, 1]
        if memory.paths.kind[a] == STILL and memory.paths.kind[b] == STILL:
            continue
        for sa in range(geometry.first_shape[a], geometry.first_shape[a + 1]):
            for sb in range(geometry.first_shape[b], geometry.first_shape[b + 1]):
                memory.counts[SEARCHES] += 1
                outcome, t = time_of_impact(
                    geometry, poses, velocities.linear, velocities.angular, memory.paths, memory.series, memory.reach, sa, sb, h,
                    memory.trial, memory.a_rows, memory.b_rows, memory.scratch,
                )
                if outcome == PATH_BROKEN:
                    return -1.0
                if outcome != CLEAR:
                    h = t
    return h


@kernel
def go(geometry: Geometry, poses: Poses, velocities: Velocities, memory: Memory, t: float) -> None:
    """Take every moving body t seconds along its path."""
    for b in range(memory.moving.shape[0]):
        if memory.paths.kind[b] != STILL:
            move_along(
                geometry, poses, velocities.linear, velocities.angular, memory.paths, memory.series, b, t, memory.trial
            )
            put_row(poses.position, b, row(memory.trial.position, b))
            put_columns(poses.rotation, b, columns(memory.trial.rotation, b))
            put_row(velocities.linear, b, row(memory.paths.v, b))
            put_row(velocities.angular, b, row(memory.paths.w, b))
            place(geometry, poses, b)


@kernel
def advance(
    geometry: Geometry, dynamics: Dynamics, poses: Poses, velocities: Velocities, dt: float, memory: Memory, events: Events,
    switches: Switches,
) -> int:
    """One frame of ``dt`` seconds for all simulated bodies; fixed and driven ones do not move.

    Args:
        poses, velocities: changed in place. Driven bodies keep their poses, but have velocities: set by the caller, changed by
            impacts as those of a body of the coupled mass.
        memory: from `make_memory`; afterwards ``received`` holds the impulses on driven bodies, ``counts`` the work done.
        events: emptied, then filled if ``switches.record``; more than fit are counted but not kept.

    Returns:
        A status (see DONE); DONE is 0.
    """
    events.count[0] = 0
    if begin(geometry, dynamics, poses, velocities, memory, switches.sleeping) == 0:
        return DONE
    bodies, contacts, status = memory.moving.shape[0], memory.contacts, DONE
    elapsed, pair_count, fresh = 0.0, 0, False
    for _ in range(SEGMENTS_CAP):
        left = dt - elapsed
        if not (left > 1e-14 * dt):
            break
        memory.counts[SEGMENTS] += 1
        if not fresh:
            found, pair_count = sweep_pairs(dynamics, poses, velocities, memory, left)
            status = found if found != DONE else status
            fresh = True
        weigh_bodies(dynamics, poses, memory)
        outcome, worst = find_contacts(geometry, dynamics, poses, pair_count, memory)
        if worst < DEEPEST:
            memory.counts[UNSQUEEZED] += 1
            worst = unsqueeze(geometry, dynamics, poses, pair_count, memory)
            status = SQUEEZED if worst < 2.0 * DEEPEST else status
            found, pair_count = sweep_pairs(dynamics, poses, velocities, memory, left)
            weigh_bodies(dynamics, poses, memory)
            outcome, worst = find_contacts(geometry, dynamics, poses, pair_count, memory)
        if outcome == BROKEN:
            return NOT_FINITE
        status = OUT_OF_ROOM if outcome == NO_ROOM else status
        if contacts.count[0] > 0:
            spent = impacts(poses, velocities, memory, events, elapsed, switches)
            status = spent if spent != DONE else status
        h = segment(dynamics, velocities, memory, left)
        for b in range(bodies):
            fresh = fresh and keeps_promise(
                poses.hulls, poses.position, memory.span, b, velocities.linear, velocities.angular, memory.paths, h, memory.boxes
            )
        if not fresh:
            # contacts stay as they are: whoever touches was near before
            found, pair_count = sweep_pairs(dynamics, poses, velocities, memory, left)
            status = found if found != DONE else status
            fresh = True
        kinetic, potential = held_energy(
            memory.hold, memory.inertia, memory.held, dynamics.gravity, poses.position, velocities.linear, velocities.angular
        )
        t = first_event(geometry, poses, velocities, memory, pair_count, h) if switches.continuous else h
        if t < 0.0:
            return NOT_FINITE
        go(geometry, poses, velocities, memory, t)
        elapsed = dt if t == left else elapsed + t
        for k in range(contacts.count[0]):
            # the forces lasted only for t of the h seconds they were solved for
            for i in range(3):
                contacts.impulse[k, i] *= t / h
        collect(contacts, 0, contacts.count[0], memory.received)
        audit(dynamics, poses, velocities, memory, kinetic + potential)
    for b in range(bodies):
        if switches.sleeping and memory.moving[b] == 1 and memory.held[b] == 1 and memory.paths.kind[b] == STILL:
            memory.asleep[b] = 1
    if elapsed < dt:
        return OUT_OF_SEGMENTS
    return status


@kernel
def sweep_pairs(dynamics: Dynamics, poses: Poses, velocities: Velocities, memory: Memory, left: float) -> tuple[int, int]:
    """Near pairs for the time left: (DONE, OUT_OF_ROOM or NOT_FINITE, number of pairs)."""
    memory.counts[SWEPT] += 1
    status, count = near_pairs(
        poses.hulls, poses.position, memory.span, memory.moving, memory.asleep, velocities.linear, velocities.angular,
        dynamics.gravity, left, memory.allowed, memory.boxes, memory.order, memory.pairs,
    )
    room = memory.pairs.shape[0]
    if status == 3:
        return NOT_FINITE, 0
    return (DONE if count <= room else OUT_OF_ROOM), min(count, room)


@kernel
def audit(dynamics: Dynamics, poses: Poses, velocities: Velocities, memory: Memory, energy_before: float) -> None:
    """Take back what energy the held bodies gained in a segment beyond rounding: constant forces on turning arms are not exact."""
    touched = 0
    for b in range(memory.held.shape[0]):
        if memory.held[b] == 1 and memory.paths.kind[b] == HELD:
            to_world(dynamics.inertia, poses.rotation, b, memory.inertia)
            touched += 1
    if touched == 0:
        return
    kinetic, potential = held_energy(
        memory.hold, memory.inertia, memory.held, dynamics.gravity, poses.position, velocities.linear, velocities.angular
    )
    if take_back(kinetic + potential - energy_before, kinetic, memory.held, velocities.linear, velocities.angular):
        memory.counts[AUDITED] += 1
