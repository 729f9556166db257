"""What contacts do at one instant of the upper loop: impacts first, then forces and paths until the next event."""

from avatarsim.impact.contact_time import time_to_contact
from avatarsim.impact.contacts import weigh
from avatarsim.impact.events import APPROACH, IMPACT, Events, record
from avatarsim.impact.impact_queue import REST_SPEED, fastest_approach, resolve_impact, settle
from avatarsim.impact.resting import SOLVED, SWEEPS, curvature, hold
from avatarsim.kernel import kernel
from avatarsim.loops.touching import recall_forces, remember_forces
from avatarsim.loops.upper_memory import CONTACTS, DONE, GUARDED, IMPACTS, OUT_OF_IMPACTS, SOLVES, UNSOLVED, Memory, Switches
from avatarsim.motion.path import FREE, HELD, STILL
from avatarsim.spatial.vec3 import norm, put_row, row, scale, sub
from avatarsim.world.dynamics import Dynamics, Velocities
from avatarsim.world.geometry import Poses

IMPACTS_CAP = 2000
"""Impacts resolved at one instant."""

GENTLE_TURN = 0.1
"""Largest turn [rad] of a touching body that is no ball in one segment; its contact points move on arcs, not on lines."""

SETTLED = 1e-10
"""Approach [m/s] that needs no impulse."""

STILLNESS = 1e-7
"""A held body slower than this [m/s, rad/s] at both ends of a segment rests: its velocities become exactly zero."""


@kernel
def impacts(poses: Poses, velocities: Velocities, memory: Memory, events: Events, time: float, switches: Switches) -> int:
    """Resolve all impacts of this instant; returns DONE or OUT_OF_IMPACTS.

    Events are recorded with the time at which the surfaces meet, with the poses of the stand-off at which the bodies are held.
    """
    contacts, v, w = memory.contacts, velocities.linear, velocities.angular
    contacts.standing[0] = 0
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
        met = time
        if switches.record:
            curvature(contacts, memory.ball, v, w)
            met += time_to_contact(contacts, head, v, w, memory.paths.linear, memory.paths.angular)
            record(events, APPROACH, met, a, b, poses.position, poses.rotation, v, w)
        guarded = resolve_impact(
            contacts, memory.strike, head, fastest, switches.paper, v, w, memory.linear_end, memory.angular_end, memory.before,
            memory.direction, memory.received,
        )
        if switches.record:
            record(events, IMPACT, met, a, b, poses.position, poses.rotation, v, w)
        memory.counts[GUARDED] += 1 if guarded else 0
        resolved += 1
        head, fastest = fastest_approach(contacts, v, w)
    memory.counts[IMPACTS] += resolved
    if fastest < -SETTLED:
        # the coupled mass yields here too: a body of a ton that creeps would give a hand of a pound a ton's momentum
        settle(contacts, memory.strike, 1e-12, SWEEPS, v, w, memory.before, memory.direction, memory.received)
    return status


@kernel
def segment(dynamics: Dynamics, velocities: Velocities, memory: Memory, left: float) -> float:
    """Forces and paths for at most ``left`` seconds; returns for how long they hold."""
    contacts, moving, paths, held, h = memory.contacts, memory.moving, memory.paths, memory.held, left
    count = contacts.used[0]
    held[:] = 0
    contacts.standing[0] = 1
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
            contacts, memory.hold, moving, memory.round, dynamics.gravity, memory.inertia, h, velocities.linear,
            velocities.angular, memory.linear_end, memory.angular_end, memory.before, memory.direction,
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
