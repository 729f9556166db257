"""Step of one island to its next event: contacts, impacts, contact forces, time of impact.

Once the work budget of the frame is spent, or an island has had too many segments, it advances by certified substeps instead.
"""

import numpy as np
from numpy.typing import NDArray

from avatarsim.collision.conservative_advancement import DIP
from avatarsim.jit.kernel import kernel
from avatarsim.model.dynamics import SIMULATED, Dynamics, Velocities
from avatarsim.model.geometry import Geometry, Poses
from avatarsim.rigid.clocks import arrive, depart
from avatarsim.rigid.contact_generation import BROKEN, NO_ROOM, find_contacts
from avatarsim.rigid.contacts import scale_impulses, to_world
from avatarsim.rigid.crowd_step import crowd_step, is_crowd
from avatarsim.rigid.deferred_impacts import defer_impacts, restore_deferred, transfer_impulses
from avatarsim.rigid.driven import note_load
from avatarsim.rigid.energy_audit import audit, energy_of, revert_segment, take_back
from avatarsim.rigid.first_event import first_event
from avatarsim.rigid.impacts import end_tails, until_tail_ends
from avatarsim.rigid.internal_edges import FLUSH
from avatarsim.rigid.response import impacts, project_positions, segment
from avatarsim.rigid.sleeping import all_keep, charged_last, regroup
from avatarsim.rigid.state import (
    AGAIN,
    DONE,
    EVENTS_CAP,
    NOT_FINITE,
    OUT_OF_ROOM,
    SEGMENTS,
    SQUEEZED,
    UNSQUEEZED,
    WORK,
    WORK_CAP,
    Events,
    Memory,
    Switches,
)
from avatarsim.tolerances import GRAIN, JUDGED, NOTHING

Index = NDArray[np.int64]

STALL, STALL_COSTS = NOTHING, 5
"""[s] below which the event of a segment comes at once (stalled advancement), and the segments that it then costs. Fewer: frames
that stall take longer; more: their islands advance by substeps sooner."""

DEEPEST = -0.7 * JUDGED
"""Gap [m] below which positions are projected apart. Must be well below the dip of resting pairs (see `time_of_impact`): lifting
a body that hardly moves adds energy. Must be above -JUDGED, the deepest that may be shown."""

assert -JUDGED < DEEPEST < FLUSH < DIP


@kernel
def weigh_bodies(dynamics: Dynamics, poses: Poses, memory: Memory, members: Index) -> None:
    """Compute inertia in world axes of the members that move."""
    for m in range(members.shape[0]):
        b = members[m]
        if memory.moving[b] == 1 and dynamics.role[b] == SIMULATED:
            to_world(dynamics.inertia, poses.rotation, b, memory.inertia)
            to_world(dynamics.inverse_inertia, poses.rotation, b, memory.masses.inverse_inertia)


@kernel
def step(
    geometry: Geometry, dynamics: Dynamics, poses: Poses, velocities: Velocities, dt: float, i: int, memory: Memory,
    events: Events, switches: Switches,
) -> int:
    """Take island i to its next event, or to the end of the frame once the budget is spent; return a status or AGAIN."""
    islands, contacts, status = memory.islands, memory.contacts, DONE
    size = islands.first[i + 1] - islands.first[i]
    members = islands.order[islands.first[i] : islands.first[i + 1]]
    pairs = islands.pairs[islands.pair_first[i] : islands.pair_first[i + 1]]
    lead = members[0]
    now = islands.due[lead]
    left = dt - now
    memory.counts[SEGMENTS] += 1
    # solver visits of an island that was given up count as work of the frame, not of this island
    memory.counts[WORK] += contacts.visits[0]
    contacts.visits[0] = 0
    spend(memory, members, 1)
    restore_deferred(velocities, memory, members)
    end_tails(geometry, poses, velocities, memory, events, members, now, switches.record)
    weigh_bodies(dynamics, poses, memory, members)
    if is_crowd(dynamics, memory, members):
        return crowd_step(geometry, dynamics, poses, velocities, dt, i, memory, events, switches)
    outcome, worst = find_contacts(geometry, dynamics, poses, velocities, pairs, memory)
    if worst < DEEPEST and memory.corrected[lead] != now:
        memory.counts[UNSQUEEZED] += 1
        kinetic, potential = energy_of(dynamics, poses, velocities, memory, members, True)
        worst = project_positions(geometry, dynamics, poses, velocities, pairs, memory)
        after, lifted = energy_of(dynamics, poses, velocities, memory, members, True)
        take_back(after + lifted - kinetic - potential, after, members, memory.supported, velocities.linear, velocities.angular)
        for m in range(size):
            memory.corrected[members[m]] = now
        found = regroup(geometry, dynamics, poses, velocities, memory, members, now, dt, False)
        return found if found != DONE else SQUEEZED if worst < DEEPEST else AGAIN
    if outcome == BROKEN:
        return NOT_FINITE
    status = OUT_OF_ROOM if outcome == NO_ROOM else status
    # a body without contacts flies on at no cost
    spent_all = islands.spent[lead] >= EVENTS_CAP or (memory.counts[WORK] > WORK_CAP and contacts.used[0] > 0)
    if spent_all:
        return crowd_step(geometry, dynamics, poses, velocities, dt, i, memory, events, switches)
    if contacts.used[0] > 0:
        spent = impacts(geometry, dynamics, poses, velocities, memory, events, members, now, False, switches)
        status = spent if spent != DONE else status
        defer_impacts(velocities, memory, members, left)
    return fly_or_slide(geometry, dynamics, poses, velocities, dt, i, members, pairs, memory, status, switches)


@kernel
def fly_or_slide(
    geometry: Geometry, dynamics: Dynamics, poses: Poses, velocities: Velocities, dt: float, i: int, members: Index,
    pairs: Index, memory: Memory, status: int, switches: Switches,
) -> int:
    """Take island i, whose impacts are resolved, along its paths to its next event; return the worse status, or AGAIN."""
    islands, size, lead = memory.islands, members.shape[0], members[0]
    now = islands.due[lead]
    left = dt - now
    h = segment(dynamics, velocities, memory, members, until_tail_ends(memory, members, now, left))
    until = h
    if not all_keep(poses, velocities, memory, members, h):
        found = regroup(geometry, dynamics, poses, velocities, memory, members, now, dt, False)
        if found != DONE:
            return found
        i = islands.label[lead]
        # with the same members the contacts stay valid, since touching pairs were near before; else the island starts anew
        if islands.first[i + 1] - islands.first[i] != size or not charged_last(memory, i):
            return AGAIN if status == DONE else status
        members = islands.order[islands.first[i] : islands.first[i + 1]]
        pairs = islands.pairs[islands.pair_first[i] : islands.pair_first[i + 1]]
        while not all_keep(poses, velocities, memory, members, until):
            until *= 0.5
    depart(poses, velocities, memory, members, now)
    kinetic, potential = energy_of(dynamics, poses, velocities, memory, members, False)
    t, pair = until, -1
    if switches.continuous:
        t, pair = first_event(geometry, memory, pairs, until, islands.earliest[lead])
    if t < 0.0:
        return NOT_FINITE
    islands.earliest[lead] = pair
    for m in range(size):
        arrive(geometry, poses, velocities, memory, members[m], t)
    for m in range(size):
        islands.due[members[m]] = dt if t == left or now + t > dt * (1.0 - GRAIN) else now + t
    if t < STALL:
        spend(memory, members, STALL_COSTS)
    memory.counts[WORK] += memory.contacts.visits[0]
    memory.contacts.visits[0] = 0
    note_load(dynamics, memory)
    scale_impulses(memory.contacts, t / h)
    transfer_impulses(dynamics, velocities, memory, True)
    if not audit(dynamics, poses, velocities, memory, members, kinetic + potential, t):
        revert_segment(geometry, poses, velocities, memory, members)
    return status


@kernel
def spend(memory: Memory, members: Index, segments: int) -> None:
    """Charge so many segments to the budget of the island."""
    most = 0
    for m in range(members.shape[0]):
        most = max(most, memory.islands.spent[members[m]])
    for m in range(members.shape[0]):
        memory.islands.spent[members[m]] = most + segments
        memory.islands.charged[members[m]] = memory.counts[SEGMENTS]
