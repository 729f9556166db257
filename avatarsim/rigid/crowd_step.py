"""Step of an island that is a crowd: its substep within the frame, on the clock and in the boxes of its island."""

import numpy as np
from numpy.typing import NDArray

from avatarsim.collision.conservative_advancement import TOUCH
from avatarsim.collision.manifold import MANIFOLD_POINTS
from avatarsim.jit.kernel import kernel
from avatarsim.model.dynamics import DRIVEN, Dynamics, Velocities, gravity_on
from avatarsim.model.geometry import Geometry, Poses
from avatarsim.rigid.clocks import arrive, depart
from avatarsim.rigid.contact_generation import BROKEN, find_contacts
from avatarsim.rigid.contacts import Contacts, is_full, lacks_responses, remember_forces
from avatarsim.rigid.deferred_impacts import transfer_impulses
from avatarsim.rigid.driven import aim_all, bound_forces, is_kinematic, note_lag, note_load
from avatarsim.rigid.energy_audit import energy_of, kinetic_energy, take_back
from avatarsim.rigid.impacts import until_tail_ends
from avatarsim.rigid.linkages import step_joints
from avatarsim.rigid.margin_rows import work_of_surfaces
from avatarsim.rigid.near_pieces import list_pieces_of
from avatarsim.rigid.response import CAREFUL_VISITS, impacts
from avatarsim.rigid.resting import SWEEPS
from avatarsim.rigid.settling import CALM, calm_frames, frames_in, holds_from_rest, note_calm, put_to_rest, rest_is_due
from avatarsim.rigid.sleeping import all_keep, regroup
from avatarsim.rigid.state import (
    AGAIN,
    AUDITED,
    DONE,
    NOT_FINITE,
    OUT_OF_ROOM,
    SUBSTEPS,
    WORK,
    Events,
    Memory,
    Switches,
)
from avatarsim.rigid.substep import (
    CUTS,
    FRAME_VISITS,
    ROUNDS,
    find_free_motions,
    forget_motions,
    is_slow,
    leave_shares,
    length_of,
    rebound,
    relax,
    solve_motions,
    take_step,
    tolerance_of,
    visits_left,
)
from avatarsim.rigid.substep_motion import (
    certify_all,
    lower_rises,
    restore_motions,
    scale_motions,
    scale_velocities,
    store_motions,
)
from avatarsim.spatial.vec3 import dot, put_row, row
from avatarsim.tolerances import GRAIN

Index = NDArray[np.int64]

FEW = MANIFOLD_POINTS
"""Contact points up to which an island is no crowd any more: those of one pair of pieces."""

MANY = CAREFUL_VISITS // (2 * SWEEPS)
"""Contact points for which the exact path has time for all sweeps of a resting solve."""

CROWDED, UNPROVED = -2, -3
"""Outcomes: there is no room for the pairs of pieces of an island; its motions are not proved."""

REGROUPS = ROUNDS
"""Times that boxes and islands are made anew in a substep. Fewer: substeps are cut short where bodies change their velocities."""

RESTLESS = 2 * REGROUPS
"""Segments of an island in a frame after which boxes only grow. Without it a body whose motion changes at each solve can join
and leave the island at one instant without end. Fewer: islands are larger than needed; more: such frames take longer."""


@kernel
def is_crowd(dynamics: Dynamics, memory: Memory, members: Index) -> bool:
    """Return whether the island of these members advances by substeps: a crowd, or bodies that touch a coupled driven body."""
    for m in range(members.shape[0]):
        if memory.substeps.crowd[members[m]] == 1 or dynamics.drive.coupled[members[m]] == 1:
            return True
    return False


@kernel
def has_driven(dynamics: Dynamics, members: Index) -> tuple[bool, bool]:
    """Return (whether a member is driven, whether a driven member keeps its pose)."""
    any_, still = False, False
    for m in range(members.shape[0]):
        any_ = any_ or dynamics.role[members[m]] == DRIVEN
        still = still or is_kinematic(dynamics, members[m])
    return any_, still


@kernel
def use_motion_velocities(velocities: Velocities, memory: Memory, members: Index) -> None:
    """Keep the velocities of the members as those before the step, and put those of their motions in their place."""
    for m in range(members.shape[0]):
        b = members[m]
        put_row(memory.substeps.spare_linear, b, row(velocities.linear, b))
        put_row(memory.substeps.spare_angular, b, row(velocities.angular, b))
        if memory.moving[b] == 1:
            put_row(velocities.linear, b, row(memory.substeps.velocity, b))
            put_row(velocities.angular, b, row(memory.substeps.turning, b))


@kernel
def put_back(velocities: Velocities, memory: Memory, members: Index) -> None:
    """Undo `use_motion_velocities`."""
    for m in range(members.shape[0]):
        put_row(velocities.linear, members[m], row(memory.substeps.spare_linear, members[m]))
        put_row(velocities.angular, members[m], row(memory.substeps.spare_angular, members[m]))


@kernel
def try_rest(
    geometry: Geometry, dynamics: Dynamics, poses: Poses, velocities: Velocities, memory: Memory, members: Index,
    now: float, h: float, untried: bool,
) -> bool:
    """Let the members stand still for the rest of the frame if their contacts hold them, or ``untried`` in any case."""
    use_motion_velocities(velocities, memory, members)
    supported = holds_from_rest(geometry, dynamics, poses, velocities, memory, members, h) or untried
    # if in vain, the next try starts from these forces
    remember_forces(memory.contacts, h, members, memory.last)
    if not supported:
        put_back(velocities, memory, members)
        return False
    put_to_rest(memory, members)
    depart(poses, velocities, memory, members, now)
    return True


@kernel
def certify_motions(
    geometry: Geometry, dynamics: Dynamics, poses: Poses, velocities: Velocities, memory: Memory, members: Index, now: float,
    dt: float, h: float, fine: bool, at_last: bool,
) -> int:
    """Find motions of the members that stay in their promised boxes and are proved free.

    Where they leave their boxes these are made anew, and the islands. As long as no other body joins, the members continue
    together, in whichever islands they are now.

    Returns:
        DONE or NOT_FINITE; AGAIN if another body joins or near pairs have no room, CROWDED, or UNPROVED unless ``at_last``.
    """
    proved = False
    for _ in range(REGROUPS):
        use_motion_velocities(velocities, memory, members)
        kept = all_keep(poses, velocities, memory, members, h)
        if not kept:
            widens = memory.islands.spent[members[0]] > RESTLESS
            status = regroup(geometry, dynamics, poses, velocities, memory, members, now, dt, widens)
            if status == NOT_FINITE:
                return status
            if status == OUT_OF_ROOM or not none_joined(memory, members):
                put_back(velocities, memory, members)
                return AGAIN
            proved = False
        put_back(velocities, memory, members)
        if kept and proved:
            break
        if not kept and not list_pieces_of(geometry, poses, memory, members):
            return CROWDED
        if not find_free_motions(geometry, dynamics, poses, velocities, memory, members, h, fine, at_last):
            return UNPROVED
        proved = True
    return DONE


@kernel
def rises_of(dynamics: Dynamics, memory: Memory, members: Index, h: float) -> tuple[float, float]:
    """Return potential energy [J] that bodies with contacts gain in h seconds: (sum of gains, sum of losses below 0)."""
    sub_, rises, falls = memory.substeps, 0.0, 0.0
    for m in range(members.shape[0]):
        b = members[m]
        if memory.moving[b] == 1 and sub_.pushed[b] == 1:
            risen = -h * dot(gravity_on(dynamics, b), row(sub_.velocity, b)) / memory.masses.inverse_mass[b]
            rises, falls = rises + max(0.0, risen), falls + min(0.0, risen)
    return rises, falls


@kernel
def pay_for_rise(
    geometry: Geometry, dynamics: Dynamics, poses: Poses, velocities: Velocities, memory: Memory, members: Index, h: float,
    slow: bool,
) -> None:
    """Reduce upward motion so that the energy of the members does not grow.

    Errors of an unconverged solve lift bodies. `take_gain` takes that energy from the velocities of fast members. In a slow
    island, or if the kinetic energy is too small, the upward motion is reduced instead: a body that starts to tip must not stop.
    """
    kinetic, gain = 0.0, 0.0
    for m in range(members.shape[0]):
        b = members[m]
        if memory.moving[b] == 1 and memory.substeps.pushed[b] == 1:
            kinetic += kinetic_energy(memory.masses, memory.inertia, b, velocities.linear, velocities.angular)
            gain += kinetic_energy(memory.masses, memory.inertia, b, memory.linear_end, memory.angular_end)
    rises, falls = rises_of(dynamics, memory, members, h)
    gain += rises + falls - kinetic
    if not (gain > 0.0 and rises > 0.0) or not (slow or rises + falls > kinetic):
        return
    store_motions(memory, members)
    lower_rises(geometry, dynamics, poses, memory, members, h, max(0.0, 1.0 - gain / rises))
    for attempt in range(ROUNDS):
        for m in range(members.shape[0]):
            memory.substeps.near[members[m]] = 0
        refused, _ = certify_all(geometry, dynamics, poses, velocities, memory, h, 0.0, 0.0)
        if refused == 0:
            break
        restore_motions(geometry, poses, memory, members, h, attempt < ROUNDS - 1)
    rises, falls = rises_of(dynamics, memory, members, h)
    if rises + falls > kinetic:
        part = kinetic / (rises + falls)
        store_motions(memory, members)
        scale_motions(geometry, dynamics, poses, memory, members, h, part)
        refused, _ = certify_all(geometry, dynamics, poses, velocities, memory, h, 0.0, 0.0)
        if refused > 0:
            restore_motions(geometry, poses, memory, members, h, False)
        else:
            scale_velocities(dynamics, memory, members, part)


@kernel
def none_joined(memory: Memory, members: Index) -> bool:
    """Return whether the islands of the members consist of members only: then the sizes of those that a member leads add up."""
    islands, count = memory.islands, 0
    for m in range(members.shape[0]):
        i = islands.label[members[m]]
        if islands.order[islands.first[i]] == members[m]:
            count += islands.first[i + 1] - islands.first[i]
    return bool(count == members.shape[0])


@kernel
def resolve_driven_impacts(
    geometry: Geometry, dynamics: Dynamics, poses: Poses, velocities: Velocities, memory: Memory, events: Events, members: Index,
    pairs: Index, now: float, switches: Switches,
) -> bool:
    """Resolve the impacts on driven members, all together; False if a pose is not finite."""
    outcome, _ = find_contacts(geometry, dynamics, poses, velocities, pairs, memory)
    if outcome == BROKEN:
        return False
    if memory.contacts.used[0] > 0:
        impacts(geometry, dynamics, poses, velocities, memory, events, members, now, True, switches)
    return True


@kernel
def find_motions(
    geometry: Geometry, dynamics: Dynamics, poses: Poses, velocities: Velocities, memory: Memory, members: Index, now: float,
    dt: float, h: float, slow: bool,
) -> tuple[int, float, bool]:
    """Solve and prove a substep of h seconds, or of halves of it if its motions cannot be proved.

    Returns (a status, or AGAIN or CROWDED; length of the substep [s]; whether it was solved finer).
    """
    found, fine = UNPROVED, False
    for cut in range(CUTS + 1):
        for _ in range(ROUNDS):
            aim_all(dynamics, poses, velocities, memory, members, now, dt, h)
            has_room, fine = solve_motions(geometry, dynamics, poses, velocities, memory, members, h, slow)
            if not has_room:
                return CROWDED, h, fine
            if not bound_forces(dynamics, poses, memory, members, now, dt, h):
                break
        at_last = cut == CUTS or slow or visits_left(memory) < FRAME_VISITS // 2
        found = certify_motions(geometry, dynamics, poses, velocities, memory, members, now, dt, h, fine, at_last)
        if found != UNPROVED:
            break
        h *= 0.5
    return found, h, fine


@kernel
def follow_motions(
    geometry: Geometry, poses: Poses, velocities: Velocities, memory: Memory, members: Index, now: float, h: float
) -> float:
    """Take the members along their motions for h seconds, or as long as they stay in their promised boxes; return how long."""
    islands, until = memory.islands, h
    use_motion_velocities(velocities, memory, members)
    while not all_keep(poses, velocities, memory, members, until):
        until *= 0.5
    depart(poses, velocities, memory, members, now)
    for m in range(members.shape[0]):
        b = members[m]
        put_row(islands.linear_before, b, row(memory.substeps.spare_linear, b))
        put_row(islands.angular_before, b, row(memory.substeps.spare_angular, b))
        islands.at_once[b] = 1
        arrive(geometry, poses, velocities, memory, b, until)
    return until


@kernel
def crowd_step(
    geometry: Geometry, dynamics: Dynamics, poses: Poses, velocities: Velocities, dt: float, i: int, memory: Memory,
    events: Events, switches: Switches,
) -> int:
    """Take island i through one substep; return a status or AGAIN."""
    islands, contacts = memory.islands, memory.contacts
    size = islands.first[i + 1] - islands.first[i]
    members = memory.substeps.members[:size]
    for m in range(size):
        # islands may be formed anew before the substep ends
        members[m] = islands.order[islands.first[i] + m]
    pairs = islands.pairs[islands.pair_first[i] : islands.pair_first[i + 1]]
    (driven, still), now = has_driven(dynamics, members), islands.due[members[0]]
    left = dt - now
    if still and now == 0.0 and not resolve_driven_impacts(
        geometry, dynamics, poses, velocities, memory, events, members, pairs, now, switches
    ):
        return NOT_FINITE
    h = min(length_of(dt, left), until_tail_ends(memory, members, now, left))
    due, untried = rest_is_due(memory, members, dt) if now == 0.0 and not driven else (False, False)
    if due and try_rest(geometry, dynamics, poses, velocities, memory, members, now, h, untried):
        for m in range(size):
            islands.due[members[m]] = dt
        return DONE
    slow = pairs.shape[0] <= FEW or is_slow(velocities, memory, members)
    status, h, fine = find_motions(geometry, dynamics, poses, velocities, memory, members, now, dt, h, slow)
    if status in (AGAIN, NOT_FINITE, CROWDED):
        forget_motions(memory, members)
    if status == AGAIN or status == NOT_FINITE:
        return status
    if status == CROWDED:
        wait_for_room(poses, velocities, memory, members, now, dt)
        return OUT_OF_ROOM
    if is_full(contacts) or lacks_responses(contacts):
        status = OUT_OF_ROOM
    kinetic, potential = energy_of(dynamics, poses, velocities, memory, members, True)
    relax(dynamics, poses, memory, members, h, fine)
    remember_lasting(memory, h, members)
    rebound(dynamics, poses, memory, members, h, tolerance_of(memory, h, fine))
    leave_shares(dynamics, memory, members)
    pay_for_rise(geometry, dynamics, poses, velocities, memory, members, h, slow)
    until = follow_motions(geometry, poses, velocities, memory, members, now, h)
    step_joints(dynamics, members, until / h)
    take_step(velocities, memory, members)
    note_load(dynamics, memory)
    transfer_impulses(dynamics, velocities, memory, False)
    memory.counts[SUBSTEPS] += 1
    memory.counts[WORK] += contacts.visits[0]
    contacts.visits[0] = 0
    given = work_of_surfaces(dynamics, poses, contacts)
    take_gain(dynamics, poses, velocities, memory, members, kinetic + potential + given)
    note_lag(dynamics, velocities, members)
    end_substep(dynamics, velocities, memory, members, now + until, dt, fine and not driven)
    return status


@kernel
def end_substep(
    dynamics: Dynamics, velocities: Velocities, memory: Memory, members: Index, then: float, dt: float, is_calm: bool
) -> None:
    """Set the clocks of the members to ``then`` [s], or to the end of the frame, and note whether they are a crowd still; one
    that was solved finer, ``is_calm``, may leave to the exact path."""
    contacts, ends = memory.contacts, then > dt * (1.0 - GRAIN)
    for m in range(members.shape[0]):
        memory.islands.due[members[m]] = dt if ends else then
    if ends:
        note_calm(dynamics, velocities, memory, members)
    first = frames_in(CALM, dt)
    leaves = is_calm and calm_frames(memory, members, first) == first and exact_path_takes(contacts)
    for m in range(members.shape[0]):
        memory.substeps.crowd[members[m]] = 1 if contacts.used[0] > FEW and not leaves else 0


@kernel
def exact_path_takes(contacts: Contacts) -> bool:
    """Return whether the rows that carry a force are near enough and few enough for the exact path."""
    if contacts.used[0] > MANY:
        return False
    for k in range(contacts.used[0]):
        if contacts.impulse[k, 0] > 0.0 and not (contacts.gap[k] < TOUCH):
            return False
    return True


@kernel
def take_gain(
    dynamics: Dynamics, poses: Poses, velocities: Velocities, memory: Memory, members: Index, energy_before: float
) -> None:
    """Take the energy [J] that an island gained, by lifts above all, from the bodies on which contacts acted."""
    kinetic, potential = energy_of(dynamics, poses, velocities, memory, members, True)
    gain, kinetic = kinetic + potential - energy_before, 0.0
    for m in range(members.shape[0]):
        b = members[m]
        memory.supported[b] = memory.moving[b] * memory.substeps.pushed[b]
        if memory.supported[b] == 1:
            kinetic += kinetic_energy(memory.masses, memory.inertia, b, velocities.linear, velocities.angular)
    if take_back(gain, kinetic, members, memory.supported, velocities.linear, velocities.angular):
        memory.counts[AUDITED] += 1


@kernel
def wait_for_room(poses: Poses, velocities: Velocities, memory: Memory, members: Index, now: float, dt: float) -> None:
    """Let an island whose contacts have no room wait for the next frame."""
    put_to_rest(memory, members)
    depart(poses, velocities, memory, members, now)
    for m in range(members.shape[0]):
        memory.islands.due[members[m]], memory.supported[members[m]] = dt, 0


@kernel
def remember_lasting(memory: Memory, h: float, members: Index) -> None:
    """Keep the forces of the rows that have a key."""
    contacts = memory.contacts
    count = contacts.used[0]
    contacts.used[0] = memory.substeps.lasting[0]
    remember_forces(contacts, h, members, memory.last)
    contacts.used[0] = count

