"""The upper loop of the paper's Figure 3: simulated bodies move for one frame, from collision to collision.

Touching points -> impacts of this instant (eqs 7 to 10) -> forces constant until the next event -> forward to the next time of
impact.
"""


from avatarsim.impact.energy import held_energy, take_back
from avatarsim.impact.events import Events
from avatarsim.impact.masses import to_world
from avatarsim.kernel import kernel
from avatarsim.loops.responding import impacts, segment
from avatarsim.loops.touching import BROKEN, NO_ROOM, find_contacts
from avatarsim.loops.unsqueeze import unsqueeze
from avatarsim.loops.upper_memory import (
    AUDITED,
    DONE,
    NOT_FINITE,
    OUT_OF_ROOM,
    OUT_OF_SEGMENTS,
    SEARCHES,
    SEGMENTS,
    SQUEEZED,
    STATUS_NAMES,
    UNSQUEEZED,
    Memory,
    Switches,
)
from avatarsim.loops.waiting import go_on, hand_over, wait
from avatarsim.loops.waking import begin, sweep_pairs
from avatarsim.motion.near import keeps_promise
from avatarsim.motion.path import HELD, STILL, move_along
from avatarsim.motion.time_of_impact import BROKEN as PATH_BROKEN
from avatarsim.motion.time_of_impact import CLEAR, time_of_impact
from avatarsim.spatial.tangent import columns, put_columns
from avatarsim.spatial.vec3 import put_row, row
from avatarsim.world.dynamics import Dynamics, Velocities
from avatarsim.world.geometry import Geometry, Poses, place

__all__ = ["DONE", "STATUS_NAMES", "advance"]

SEGMENTS_CAP = 100
"""Segments of one frame. A bouncing ball needs 2, a landing box 5 to 20; each costs a contact solve."""

DEEPEST = -3.5e-7
"""Gap [m] below which positions are corrected. Must be below the dip of resting pairs (see `time_of_impact`): to lift a body that
rocks feeds it with potential energy, and it never comes to rest."""


@kernel
def weigh_bodies(dynamics: Dynamics, poses: Poses, memory: Memory) -> None:
    """Inertia in world axes of all moving bodies."""
    for b in range(memory.moving.shape[0]):
        if memory.moving[b] == 1:
            to_world(dynamics.inertia, poses.rotation, b, memory.inertia)
            to_world(dynamics.inverse_inertia, poses.rotation, b, memory.hold.inverse_inertia)


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
    events.kept[0] = 0
    if begin(geometry, dynamics, poses, velocities, memory, switches.sleeping) == 0:
        return DONE
    bodies, contacts, status = memory.moving.shape[0], memory.contacts, DONE
    elapsed, pair_count, fresh = 0.0, 0, False
    for _ in range(SEGMENTS_CAP):
        left = dt - elapsed
        if not (left > 1e-14 * dt):
            break
        memory.counts[SEGMENTS] += 1
        go_on(velocities, memory)
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
        if contacts.used[0] > 0:
            spent = impacts(poses, velocities, memory, events, elapsed, switches)
            status = spent if spent != DONE else status
            wait(velocities, memory, left)
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
        for k in range(contacts.used[0]):
            # the forces lasted only for t of the h seconds they were solved for
            for i in range(3):
                contacts.impulse[k, i] *= t / h
        hand_over(dynamics, velocities, memory)
        audit(dynamics, poses, velocities, memory, kinetic + potential)
    go_on(velocities, memory)
    for b in range(bodies):
        if switches.sleeping and memory.moving[b] == 1 and memory.held[b] == 1 and memory.paths.kind[b] == STILL:
            memory.asleep[b] = 1
    if elapsed < dt:
        return OUT_OF_SEGMENTS
    return status


@kernel
def audit(dynamics: Dynamics, poses: Poses, velocities: Velocities, memory: Memory, energy_before: float) -> None:
    """Take back what energy the held bodies gained in a segment beyond rounding: constant forces on turning arms are not
    exact."""
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
