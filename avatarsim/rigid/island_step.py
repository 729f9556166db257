"""Step of one island to its next event: contacts, impacts, contact forces, time of impact.

Once the work budget of the frame is spent, or an island has had too many segments, it takes the inelastic fallback step instead.
"""

from math import inf

import numpy as np
from numpy.typing import NDArray

from avatarsim.collision.conservative_advancement import DIP
from avatarsim.jit.kernel import kernel
from avatarsim.model.dynamics import Dynamics, Velocities
from avatarsim.model.geometry import Geometry, Poses
from avatarsim.rigid.budget_fallback import AGAIN, STALL, clog, go_or_stop, look_ahead, of_balls
from avatarsim.rigid.clocks import arrive, depart
from avatarsim.rigid.contact_generation import BROKEN, NO_ROOM, find_contacts
from avatarsim.rigid.contacts import Contacts, to_world
from avatarsim.rigid.deferred_impacts import go_on, hand_over, wait
from avatarsim.rigid.energy_audit import audit, energy_of, stay
from avatarsim.rigid.first_event import first_event
from avatarsim.rigid.impacts import end_tails, until_tail_ends
from avatarsim.rigid.internal_edges import FLUSH
from avatarsim.rigid.near_pairs import keeps_promise
from avatarsim.rigid.response import FIRST_SWEEPS, change_at_once, impacts, is_brisk, note_change, segment, unsqueeze
from avatarsim.rigid.sleeping import regroup
from avatarsim.rigid.state import (
    DONE,
    EVENTS_CAP,
    NOT_FINITE,
    OUT_OF_ROOM,
    OUT_OF_SEGMENTS,
    PLASTIC,
    SEGMENTS,
    SQUEEZED,
    UNSQUEEZED,
    WORK,
    WORK_CAP,
    Events,
    Memory,
    Switches,
)
from avatarsim.tolerances import GRAIN, JUDGED

Index = NDArray[np.int64]

STALL_COSTS = 5
"""Segments of the budget that a segment costs whose event comes at once (stalled advancement). Fewer: frames that stall take
longer; more: their bodies lose time."""

UNDONE_COSTS = EVENTS_CAP // 2
"""The same of a fallback step undone because its island changed; after four of them, islands follow from the old velocities."""

PIECES, PLASTIC_WORK, SWEEPS_OF_STEP, WORK_OF_PAIR = 8, WORK_CAP // 2, 250, 40
"""Most fallback steps of a frame, and their work together; solver visits per contact point, and work per near pair. Fewer steps,
or more work of each: stopped bodies lose more of the frame; more steps: frames of small heaps take longer."""

CROWD = PLASTIC_WORK // (2 * FIRST_SWEEPS)
"""Contact points for which the first sweeps of one solve take the work of all fallback steps of a frame."""

DEEPEST = -0.7 * JUDGED
"""Gap [m] below which positions are projected apart. Must be well below the dip of resting pairs (see `time_of_impact`): lifting
a body that hardly moves adds energy. Must be above -JUDGED, the deepest that may be shown."""

assert -JUDGED < DEEPEST < FLUSH < DIP


@kernel
def weigh_bodies(dynamics: Dynamics, poses: Poses, memory: Memory, members: Index) -> None:
    """Inertia in world axes of the members that move."""
    for m in range(members.shape[0]):
        b = members[m]
        if memory.moving[b] == 1:
            to_world(dynamics.inertia, poses.rotation, b, memory.inertia)
            to_world(dynamics.inverse_inertia, poses.rotation, b, memory.hold.inverse_inertia)


@kernel
def all_keep(poses: Poses, velocities: Velocities, memory: Memory, members: Index, h: float) -> bool:
    """Whether the members stay in their promised boxes for h seconds."""
    for m in range(members.shape[0]):
        if not keeps_promise(
            poses.hulls, poses.position, memory.span, members[m], velocities.linear, velocities.angular, memory.paths, h,
            memory.margin[0], memory.boxes,
        ):
            return False
    return True


@kernel
def step(
    geometry: Geometry, dynamics: Dynamics, poses: Poses, velocities: Velocities, dt: float, i: int, memory: Memory,
    events: Events, switches: Switches,
) -> int:
    """Take island i to its next event, or to the end of the frame once the budget is spent; returns a status or AGAIN."""
    islands, contacts, status = memory.islands, memory.contacts, DONE
    size, first = islands.first[i + 1] - islands.first[i], islands.pair_first[i]
    members = islands.order[islands.first[i] : islands.first[i + 1]]
    pairs = islands.pairs[first : islands.pair_first[i + 1]]
    lead = members[0]
    now = islands.due[lead]
    left = dt - now
    memory.counts[SEGMENTS] += 1
    # solver visits of an island that was given up count as work of the frame, not of this island
    memory.counts[WORK] += contacts.visits[0]
    contacts.visits[0] = 0
    spend(memory, members, 1)
    go_on(velocities, memory, members)
    end_tails(geometry, poses, velocities, memory, events, members, now, switches.record)
    weigh_bodies(dynamics, poses, memory, members)
    outcome, worst = find_contacts(geometry, dynamics, poses, velocities, pairs, memory)
    if worst < DEEPEST and memory.corrected[lead] != now:
        memory.counts[UNSQUEEZED] += 1
        kinetic, potential = energy_of(dynamics, poses, velocities, memory, members, True)
        worst = unsqueeze(geometry, dynamics, poses, velocities, pairs, memory)
        audit(dynamics, poses, velocities, memory, members, True, kinetic + potential)
        for m in range(size):
            memory.corrected[members[m]] = now
        found = regroup(geometry, dynamics, poses, velocities, memory, members, now, dt)
        return found if found != DONE else SQUEEZED if worst < DEEPEST else AGAIN
    if outcome == BROKEN:
        return NOT_FINITE
    status = OUT_OF_ROOM if outcome == NO_ROOM else status
    # a body without contacts flies on at no cost
    hasty = islands.spent[lead] >= EVENTS_CAP or (memory.counts[WORK] > WORK_CAP and contacts.used[0] > 0)
    ends = hasty or is_late(memory, velocities, members)
    at_once = ends and of_balls(memory)
    kinetic, potential = energy_of(dynamics, poses, velocities, memory, members, ends)
    if contacts.used[0] > 0:
        spent = impacts(geometry, dynamics, poses, velocities, memory, events, members, now, hasty, not at_once, switches)
        status = spent if spent != DONE else status
        wait(velocities, memory, members, left)
    longest = until_tail_ends(memory, members, now, left)
    if ends:
        longest = min(longest, dt / pieces_of(contacts, pairs))
    touching = contacts.used[0]
    if at_once:
        # pairs without room are stopped where they meet
        if look_ahead(geometry, dynamics, poses, velocities, pairs, memory, longest) == BROKEN:
            return NOT_FINITE
    h = segment(dynamics, velocities, memory, members, longest, ends, at_once)
    if at_once:
        change_at_once(velocities, memory, members)
    until = h
    if not all_keep(poses, velocities, memory, members, h):
        # velocities follow from the members of the island, and members from velocities: without a cap that may alternate for ever
        old = at_once and islands.spent[lead] >= 2 * EVENTS_CAP
        if old:
            change_at_once(velocities, memory, members)
        found = regroup(geometry, dynamics, poses, velocities, memory, members, now, dt)
        if found == NOT_FINITE:
            return found
        status = found if found != DONE else status
        i = islands.label[lead]
        # with the same members the contacts stay valid, since touching pairs were near before; else the island starts anew
        if islands.first[i + 1] - islands.first[i] != size or not still_those(memory, i):
            if at_once and not old:
                change_back(velocities, memory)
            return AGAIN if status == DONE else status
        first = islands.pair_first[i]
        members = islands.order[islands.first[i] : islands.first[i + 1]]
        pairs = islands.pairs[first : islands.pair_first[i + 1]]
        if old:
            change_at_once(velocities, memory, members)
        while not all_keep(poses, velocities, memory, members, until):
            until *= 0.5
    depart(poses, velocities, memory, members, now)
    if at_once:
        note_change(memory, members)
    t = until
    if ends:
        memory.counts[PLASTIC] += 1
        status = OUT_OF_SEGMENTS
        outcome = go_or_stop(geometry, poses, velocities, memory, members, pairs, first, until)
        if outcome != DONE:
            if at_once:
                change_at_once(velocities, memory, members)
            return outcome
        note_lateness(memory, members, touching)
    else:
        kinetic, potential = energy_of(dynamics, poses, velocities, memory, members, False)
        t, pair = until, -1
        if switches.continuous:
            t, pair = first_event(geometry, memory, pairs, until, islands.earliest[lead])
        if t < 0.0:
            return NOT_FINITE
        islands.earliest[lead] = pair
        if t < STALL and pair >= 0:
            clog(memory, pairs[pair, 0], pairs[pair, 1])
        for m in range(size):
            islands.late[members[m]] = 0
            arrive(geometry, poses, velocities, memory, members[m], t)
    for m in range(size):
        islands.due[members[m]] = dt if t == left or now + t > dt * (1.0 - GRAIN) else now + t
    if t < STALL:
        spend(memory, members, STALL_COSTS)
    memory.counts[WORK] += contacts.visits[0]
    contacts.visits[0] = 0
    last_for(memory, t / h, h)
    hand_over(dynamics, velocities, memory)
    if not audit(dynamics, poses, velocities, memory, members, ends, kinetic + potential):
        stay(geometry, poses, velocities, memory, members)
    return status


@kernel
def is_late(memory: Memory, velocities: Velocities, members: Index) -> bool:
    """Whether this island, of many contacts and in motion, ran out of budget in the last frame, and so will again.

    Its impacts are resolved as ever, then it takes the fallback step at once. A segment before it would cost as much work, and
    only reach the earliest event, which is near.
    """
    if memory.contacts.used[0] > CROWD and is_brisk(memory, velocities, members):
        for m in range(members.shape[0]):
            if memory.islands.late[members[m]] == 1:
                return True
    return False


@kernel
def note_lateness(memory: Memory, members: Index, touching: int) -> None:
    """After a fallback step: the members are late if it stopped a body, or if a speculative contact carried an impulse."""
    late = 0
    for k in range(touching, memory.contacts.used[0]):
        if memory.contacts.impulse[k, 0] > 0.0:
            late = 1
    for m in range(members.shape[0]):
        if memory.islands.stops[members[m]] < inf:
            late = 1
    for m in range(members.shape[0]):
        memory.islands.late[members[m]] = late


@kernel
def pieces_of(contacts: Contacts, pairs: Index) -> int:
    """Number of fallback steps to the end of the frame: small islands take several, so that stopped bodies lose less of it."""
    work = SWEEPS_OF_STEP * contacts.used[0] + WORK_OF_PAIR * pairs.shape[0]
    return int(max(1, min(PIECES, PLASTIC_WORK // max(1, work))))


@kernel
def spend(memory: Memory, members: Index, segments: int) -> None:
    """Charge so many segments to the budget of the island."""
    most = 0
    for m in range(members.shape[0]):
        most = max(most, memory.islands.spent[members[m]])
    for m in range(members.shape[0]):
        memory.islands.spent[members[m]] = most + segments
        memory.islands.charged[members[m]] = memory.counts[SEGMENTS]


@kernel
def still_those(memory: Memory, i: int) -> bool:
    """Whether island i consists only of bodies charged last: those whose contacts are in ``memory.contacts``."""
    islands = memory.islands
    for m in range(islands.first[i], islands.first[i + 1]):
        if islands.charged[islands.order[m]] != memory.counts[SEGMENTS]:
            return False
    return True


@kernel
def change_back(velocities: Velocities, memory: Memory) -> None:
    """Undo `change_at_once` for the bodies charged last: islands were formed anew, and ``members`` is of another one."""
    for b in range(memory.moving.shape[0]):
        if memory.islands.charged[b] == memory.counts[SEGMENTS]:
            memory.islands.spent[b] += UNDONE_COSTS
            change_at_once(velocities, memory, memory.all_bodies[b : b + 1])


@kernel
def last_for(memory: Memory, share: float, h: float) -> None:
    """The forces lasted only for this share of the h seconds that they were solved for, or until a body stopped."""
    contacts, stops = memory.contacts, memory.islands.stops
    for k in range(contacts.used[0]):
        a, b = contacts.body[k, 0], contacts.body[k, 1]
        part = share
        for body in (a, b):
            if memory.moving[body] == 1:
                part = min(part, stops[body] / h)
        for i in range(3):
            contacts.impulse[k, i] *= part
