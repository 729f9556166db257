"""Certified substep of a crowd: an island whose events are too many to be taken one after the other.

Velocities without contact -> contact rows with a stand-off -> one solve for all, and another where links turn so far that their
chords part less than their rates -> motions of the bodies, each pair of which is proved free over the substep; pairs that are
not become rows, and the solve is repeated -> pairs still refused go less of their motion -> velocities without the push, with
restitution -> next poses.
"""

from math import ceil, inf, sqrt

import numpy as np
from numpy.typing import NDArray

from avatarsim.jit.kernel import kernel
from avatarsim.model.dynamics import Dynamics, Velocities, gravity_on
from avatarsim.model.geometry import Geometry, Poses
from avatarsim.rigid.contacts import Contacts, push_all, recall_forces, scale_impulses, speed_along, weigh_from
from avatarsim.rigid.driven import approach_velocities, follow_arcs
from avatarsim.rigid.energy_audit import kinetic_energy
from avatarsim.rigid.link_rows import weigh_links
from avatarsim.rigid.linkages import has_linkage, is_linked, move_linkages, show_linkages, weigh_linkages
from avatarsim.rigid.margin_rows import aim_rows, correct_curvature, find_rows, stand_off_of
from avatarsim.rigid.near_pieces import list_pieces_of, may_go
from avatarsim.rigid.solver import BIAS, lay_out, passes, solve_contacts, take_motion, visits_of_sweep
from avatarsim.rigid.state import CONTACTS, GUARDED, SOLVES, WORK, Memory
from avatarsim.rigid.substep_motion import certify_all, set_motions, shared, shorten_motions, weigh_groups
from avatarsim.rigid.swept_certificate import LEAST, least_of
from avatarsim.spatial.tangent import columns, turned, turned_back
from avatarsim.spatial.vec3 import Vec3, add, along, cross, dot, norm, put_row, row, scale, solved, sub
from avatarsim.tolerances import FINE, ROUNDING

Array = NDArray[np.float64]
Index = NDArray[np.int64]

SUBSTEP = 1.0 / 240.0
"""Longest substep [s]. Longer: a solve has farther to look, and gravity alone is a larger part of a stand-off; shorter: a frame
takes more of them, each of which costs as much."""

TOLERANCE, SWEEPS = 0.02, 20
"""Accuracy of the solve of a longest substep, in stand-offs, and its most double sweeps."""

SLOW, FINER = 0.1, FINE * FINE
"""[m/s] speed below which an island without joints is solved finer, by this factor: errors of a solve make a tower sway. A hand
yields by more than they are."""

VISITS, SWEEPS_OF_FINE = 48000, 15 * SWEEPS
"""Most contact points that one solve visits, if that allows more than SWEEPS: few contacts, as of a heavy body on light ones,
need many sweeps. Double sweeps that it must allow for an island to be solved finer. Fewer: light bodies sink, towers sway; more:
frames of large slow heaps take longer."""

SHARE_OF_SOLVE = 8
FRAME_VISITS, LEAST_SWEEPS = SHARE_OF_SOLVE * VISITS, SWEEPS // 4
"""Visits of contact points of a frame, about twenty milliseconds, of whose rest a solve takes at most one part in SHARE_OF_SOLVE;
the least double sweeps of a solve, and those for restitution. Fewer: bodies of large heaps lose time; more: frames in which a
heap lands take longer."""

CUTS = 1
"""Times that a substep of an island that can be solved finer is halved and solved anew where its motions cannot be proved, before
motions are shortened instead. Fewer: struck bodies lose momentum; more: frames in which that happens take longer."""

ROUNDS = 6
"""Solves of a substep, each with rows of the pairs refused in the last; and of one solve while joints come to their limits or
leave them. Fewer: more bodies lose a part of the substep, and hands at a limit of their arms press unevenly."""

HOPS = ROUNDS // 2
"""Contacts from a refused pair over which velocities are solved again; twice as many from the fourth round on."""


@kernel
def length_of(dt: float, left: float) -> float:
    """Return the length [s] of the next substep of a frame of dt seconds of which ``left`` are left."""
    longest = dt / ceil(dt / SUBSTEP - ROUNDING)
    return left / max(1, ceil(left / longest - ROUNDING))


@kernel
def tolerance_of(memory: Memory, h: float, fine: bool) -> float:
    """Return the accuracy [m/s] of a solve for h seconds: a fixed part of the speed that gravity adds in h, however short.

    Finer where bodies of the exact path are nearer than the gap to be proved, and no lift parts them: half of their room to dip.
    """
    least = TOLERANCE * FINER * stand_off_of(memory)
    error = least if fine else TOLERANCE * stand_off_of(memory)
    error *= (h / SUBSTEP) ** 2
    for k in range(memory.substeps.lasting[0]):
        gap = memory.contacts.gap[k]
        if gap < 2.0 * LEAST and not (memory.contacts.target[k] > 0.0):
            error = min(error, max(0.5 * (gap - least_of(gap)), least))
    return error / h


@kernel
def sweeps_for(count: int) -> int:
    """Return most double sweeps of a solve of so many rows in a slow island, or of one that is repeated."""
    return int(max(SWEEPS, VISITS // (2 * max(1, count))))


@kernel
def fall_free(dynamics: Dynamics, poses: Poses, velocities: Velocities, memory: Memory, members: Index, h: float) -> None:
    """Compute velocities of the members after h seconds without contact, into ``linear_end``, ``angular_end``.

    Driven bodies have what `driven.aim` gave them, or stand.
    """
    for m in range(members.shape[0]):
        b = members[m]
        if memory.moving[b] == 0:
            put_row(memory.linear_end, b, (0.0, 0.0, 0.0))
            put_row(memory.angular_end, b, (0.0, 0.0, 0.0))
            continue
        put_row(memory.linear_end, b, along(row(velocities.linear, b), h, gravity_on(dynamics, b)))
        put_row(memory.angular_end, b, row(velocities.angular, b))
        if memory.round[b] == 0:
            put_row(memory.angular_end, b, spin_after(dynamics, poses, b, row(velocities.angular, b), h))


@kernel
def spin_after(dynamics: Dynamics, poses: Poses, b: int, w: Vec3, h: float) -> Vec3:
    """Return the angular velocity [rad/s] of body b after h seconds of its gyroscopic torque.

    One Newton step of implicit Euler in body axes, which is stable for any spin (Catto, Numerical Methods, GDC 2015).
    """
    frame, inertia = columns(poses.rotation, b), columns(dynamics.inertia, b)
    x = turned_back(frame, w)
    momentum = turned(inertia, x)
    left = scale(cross(x, momentum), h)
    # columns of I + h (skew(x) I - skew(I x))
    c0 = add(inertia[0], scale(sub(cross(x, inertia[0]), cross(momentum, (1.0, 0.0, 0.0))), h))
    c1 = add(inertia[1], scale(sub(cross(x, inertia[1]), cross(momentum, (0.0, 1.0, 0.0))), h))
    c2 = add(inertia[2], scale(sub(cross(x, inertia[2]), cross(momentum, (0.0, 0.0, 1.0))), h))
    return turned(frame, sub(x, solved(c0, c1, c2, left)))


@kernel
def is_slow(velocities: Velocities, memory: Memory, members: Index) -> bool:
    """Return whether no point of a member moves faster than SLOW."""
    for m in range(members.shape[0]):
        b = members[m]
        if memory.moving[b] == 1:
            spin = norm(row(velocities.angular, b)) * memory.span[b]
            if not (norm(row(velocities.linear, b)) + spin < SLOW):
                return False
    return True


@kernel
def note_pushed(memory: Memory) -> None:
    """Mark the bodies on which a contact acts."""
    contacts, pushed = memory.contacts, memory.substeps.pushed
    for k in range(contacts.used[0]):
        if contacts.impulse[k, 0] > 0.0:
            pushed[contacts.body[k, 0]], pushed[contacts.body[k, 1]] = 1, 1


@kernel
def visits_left(memory: Memory) -> int:
    """Return visits that the solves of this frame may still make; below 0 when they are spent."""
    return int(FRAME_VISITS - memory.counts[WORK] - memory.contacts.visits[0])


@kernel
def solve(dynamics: Dynamics, poses: Poses, memory: Memory, members: Index, h: float, tolerance: float, sweeps: int) -> None:
    """Solve all rows that are laid out and have a target; ``linear_end`` and ``angular_end`` change."""
    contacts, count, active = memory.contacts, memory.contacts.used[0], 0
    for k in range(count):
        active += 1 if contacts.rows[k, BIAS] != -inf else 0
    visited, work = contacts.visits[0], visits_of_sweep(contacts, 0, count) * active // max(1, count)
    sweeps = min(sweeps, max(LEAST_SWEEPS, visits_left(memory) // (2 * SHARE_OF_SOLVE * max(1, work))))
    for _ in range(ROUNDS):
        passes(contacts, 0, count, tolerance, sweeps, True, memory.before, memory.direction)
        take_motion(contacts, 0, count, memory.linear_end, memory.angular_end)
        if not has_linkage(dynamics, members):
            break
        changed = move_linkages(dynamics, poses, memory, members)
        if changed:
            weigh_again(dynamics, poses, memory)
        show_linkages(dynamics.drive, contacts, memory, members)
        if not changed:
            break
    # rows that take no part cost next to nothing
    contacts.visits[0] = visited + (contacts.visits[0] - visited) * active // max(1, count)
    memory.counts[SOLVES] += 1


@kernel
def weigh_again(dynamics: Dynamics, poses: Poses, memory: Memory) -> None:
    """Compute responses of links anew after degrees came to a limit or left it; rows that take no part still take none."""
    contacts = memory.contacts
    count, idle = contacts.used[0], memory.substeps.idle
    for k in range(count):
        idle[k] = 1 if contacts.rows[k, BIAS] == -inf else 0
    weigh_links(dynamics, poses, memory, 0)
    lay_out(contacts, memory.masses, 0, count, memory.linear_end, memory.angular_end)
    for k in range(count):
        if idle[k] == 1:
            contacts.rows[k, BIAS] = -inf


@kernel
def put_targets(contacts: Contacts, first: int, count: int) -> None:
    """Set bias velocities of rows first <= k < count as `lay_out` has them, after their targets changed."""
    for k in range(first, count):
        contacts.rows[k, BIAS] = contacts.target[k] * contacts.effective_mass[k, 0]


@kernel
def apply_impulses(memory: Memory, count: int) -> None:
    """Add the impulses that rows hold to the velocities; rows along which nothing moves hold none."""
    contacts = memory.contacts
    for k in range(count):
        if contacts.inverse_effective_mass[k, 0] == 0.0:
            put_row(contacts.impulse, k, (0.0, 0.0, 0.0))
        elif contacts.impulse[k, 0] != 0.0:
            p = row(contacts.impulse, k)
            push_all(contacts, memory.masses, k, p, memory.linear_end, memory.angular_end)


@kernel
def spread_from_refused(memory: Memory, hops: int) -> None:
    """Mark as ``near`` the bodies within so many contacts of a refused pair, whose own are marked 1; rows of no marked body take
    no part in the next solve."""
    contacts, near = memory.contacts, memory.substeps.near
    for hop in range(1, hops + 1):
        for k in range(contacts.used[0]):
            a, b = contacts.body[k, 0], contacts.body[k, 1]
            if memory.moving[a] == 1 and memory.moving[b] == 1:
                if 0 < near[a] <= hop and near[b] == 0:
                    near[b] = hop + 1
                elif 0 < near[b] <= hop and near[a] == 0:
                    near[a] = hop + 1
    for k in range(contacts.used[0]):
        a, b = contacts.body[k, 0], contacts.body[k, 1]
        takes_part = near[a] * memory.moving[a] + near[b] * memory.moving[b] > 0
        contacts.rows[k, BIAS] = contacts.target[k] * contacts.effective_mass[k, 0] if takes_part else -inf
        if takes_part:
            memory.substeps.changed[a], memory.substeps.changed[b] = 1, 1


@kernel
def find_free_motions(
    geometry: Geometry, dynamics: Dynamics, poses: Poses, velocities: Velocities, memory: Memory, members: Index, h: float,
    fine: bool, at_last: bool,
) -> bool:
    """Find motions of the members that are proved free: rows for refused pairs and another solve; ``at_last`` shorter motions.

    Returns whether they are found.
    """
    sub_, refused, tolerance = memory.substeps, 0, tolerance_of(memory, h, fine)
    d = stand_off_of(memory)
    error = 2.0 * tolerance * h
    for m in range(members.shape[0]):
        sub_.changed[members[m]] = 1
    for turn in range(ROUNDS):
        for m in range(members.shape[0]):
            sub_.near[members[m]] = 0
        refused, _ = certify_all(geometry, dynamics, poses, velocities, memory, h, d, error if turn < ROUNDS - 1 else 0.0)
        if refused == 0 and sub_.lacking[0] == 0:
            return True
        if turn == ROUNDS - 1 or sub_.lacking[0] == 1 or (at_last and visits_left(memory) < 0):
            break
        for m in range(members.shape[0]):
            # joints transmit the effect of a contact on one link
            sub_.changed[members[m]] = 1 if is_linked(dynamics.drive, members[m]) else 0
        spread_from_refused(memory, HOPS if turn < ROUNDS // 2 else 2 * HOPS)
        count = memory.contacts.used[0]
        sweeps = sweeps_for(count) if fine else SWEEPS * (1 + turn)
        solve(dynamics, poses, memory, members, h, 0.25 * tolerance, sweeps)
        note_pushed(memory)
        set_motions(geometry, dynamics, poses, velocities, memory, members, h)
    if at_last:
        shorten_motions(geometry, dynamics, poses, velocities, memory, members, h)
    return at_last


@kernel
def relax(dynamics: Dynamics, poses: Poses, memory: Memory, members: Index, h: float, fine: bool) -> None:
    """Solve again without lifts and without the gaps required of refused pairs: velocities lose the push that motions had."""
    contacts, count = memory.contacts, memory.contacts.used[0]
    aim_rows(contacts, count, stand_off_of(memory), h, False)
    put_targets(contacts, 0, count)
    solve(dynamics, poses, memory, members, h, tolerance_of(memory, h, fine), sweeps_for(count) if fine else SWEEPS)


@kernel
def rebound(dynamics: Dynamics, poses: Poses, memory: Memory, members: Index, h: float, tolerance: float) -> None:
    """Apply Newton's restitution (eq. 8) at all points that were hit, together; its impulses are scaled by one factor so that the
    kinetic energy of the members is at most that before all contacts acted.

    Between velocities that approach nowhere lie only such, so the scaled ones are sound too. A point counts as hit above the
    speed that gravity adds in two substeps.
    """
    contacts, sub_, any_hit = memory.contacts, memory.substeps, False
    slow = 2.0 * h * norm((dynamics.gravity[0], dynamics.gravity[1], dynamics.gravity[2]))
    for k in range(sub_.lasting[0]):
        if contacts.restitution[k] > 0.0 and sub_.approach[k] < -slow and contacts.impulse[k, 0] > 0.0:
            contacts.target[k] = -contacts.restitution[k] * sub_.approach[k]
            any_hit = True
    if not any_hit:
        return
    keep_spare(memory, members)
    put_targets(contacts, 0, contacts.used[0])
    solve(dynamics, poses, memory, members, h, tolerance, LEAST_SWEEPS)
    for m in range(members.shape[0]):
        b = members[m]
        put_row(sub_.change_linear, b, sub(row(memory.linear_end, b), row(sub_.spare_linear, b)))
        put_row(sub_.change_angular, b, sub(row(memory.angular_end, b), row(sub_.spare_angular, b)))
    allowed, before = sub_.kinetic[0], kinetic_of(memory, members, sub_.spare_linear, sub_.spare_angular)
    after = kinetic_of(memory, members, memory.linear_end, memory.angular_end)
    change = kinetic_of(memory, members, sub_.change_linear, sub_.change_angular)
    if after <= allowed or not (change > 0.0):
        return
    # energy along the line between both: before + mixed s + change s^2
    mixed, room = after - before - change, max(0.0, allowed - before)
    kept = (sqrt(mixed * mixed + 4.0 * change * room) - mixed) / (2.0 * change)
    kept = min(1.0, max(0.0, kept))
    memory.counts[GUARDED] += 1
    for m in range(members.shape[0]):
        b = members[m]
        put_row(memory.linear_end, b, along(row(sub_.spare_linear, b), kept, row(sub_.change_linear, b)))
        put_row(memory.angular_end, b, along(row(sub_.spare_angular, b), kept, row(sub_.change_angular, b)))


@kernel
def kinetic_of(memory: Memory, members: Index, linear: Array, angular: Array) -> float:
    """Return the kinetic energy [J] of the members that move; ``memory.inertia`` is in world axes."""
    total = 0.0
    for m in range(members.shape[0]):
        if memory.moving[members[m]] == 1:
            total += kinetic_energy(memory.masses, memory.inertia, members[m], linear, angular)
    return total


@kernel
def leave_shares(dynamics: Dynamics, memory: Memory, members: Index) -> None:
    """Reduce the relaxed velocities as far as the motions were shortened."""
    weigh_groups(memory, members)
    for m in range(members.shape[0]):
        b = members[m]
        v, w = shared(dynamics, memory, b)
        put_row(memory.linear_end, b, v)
        put_row(memory.angular_end, b, w)


@kernel
def take_step(velocities: Velocities, memory: Memory, members: Index) -> None:
    """Set velocities of the members at the end of the substep."""
    for m in range(members.shape[0]):
        b = members[m]
        if memory.moving[b] == 1:
            put_row(velocities.linear, b, row(memory.linear_end, b))
            put_row(velocities.angular, b, row(memory.angular_end, b))
    forget_motions(memory, members)


@kernel
def forget_motions(memory: Memory, members: Index) -> None:
    """Let the members stand still until they have other motions."""
    sub_ = memory.substeps
    for m in range(members.shape[0]):
        b = members[m]
        put_row(sub_.velocity, b, (0.0, 0.0, 0.0))
        put_row(sub_.turning, b, (0.0, 0.0, 0.0))
        sub_.turn[b], sub_.bulge[b] = 0.0, 0.0


@kernel
def gained(dynamics: Dynamics, velocities: Velocities, memory: Memory, members: Index, h: float) -> float:
    """Return the energy [J] that the members gain in h seconds at the solved velocities."""
    found = kinetic_of(memory, members, memory.linear_end, memory.angular_end)
    found -= kinetic_of(memory, members, velocities.linear, velocities.angular)
    for m in range(members.shape[0]):
        b = members[m]
        if memory.moving[b] == 1:
            found -= h * dot(gravity_on(dynamics, b), row(memory.linear_end, b)) / memory.masses.inverse_mass[b]
    return found


@kernel
def lift_within_energy(
    dynamics: Dynamics, poses: Poses, velocities: Velocities, memory: Memory, members: Index, h: float, d: float,
    tolerance: float, sweeps: int,
) -> None:
    """Solve without lifts if gaps open at the cost of more energy than contacts dissipate, and lift by the share that is paid.

    Between velocities with lifts and without lie those of smaller ones.
    """
    sub_, contacts, count = memory.substeps, memory.contacts, memory.contacts.used[0]
    with_lifts = gained(dynamics, velocities, memory, members, h)
    if not (with_lifts > 0.0):
        return
    keep_spare(memory, members)
    for k in range(count):
        put_row(sub_.spare_impulse, k, row(contacts.impulse, k))
    aim_rows(contacts, count, d, h, False)
    put_targets(contacts, 0, count)
    solve(dynamics, poses, memory, members, h, tolerance, sweeps)
    without = gained(dynamics, velocities, memory, members, h)
    if without > 0.0 and not has_linkage(dynamics, members):
        # not converged
        solve_contacts(
            contacts, memory.masses, 0, count, memory.linear_end, memory.angular_end, tolerance, SWEEPS, sweeps, memory.before,
            memory.direction,
        )
        without = gained(dynamics, velocities, memory, members, h)
    share = -without / (with_lifts - without) if without < 0.0 else 0.0
    for m in range(members.shape[0]):
        b = members[m]
        v, w = row(memory.linear_end, b), row(memory.angular_end, b)
        put_row(memory.linear_end, b, along(v, share, sub(row(sub_.spare_linear, b), v)))
        put_row(memory.angular_end, b, along(w, share, sub(row(sub_.spare_angular, b), w)))
    for k in range(count):
        p = row(contacts.impulse, k)
        put_row(contacts.impulse, k, along(p, share, sub(row(sub_.spare_impulse, k), p)))
    lay_out(contacts, memory.masses, 0, count, memory.linear_end, memory.angular_end)


@kernel
def keep_spare(memory: Memory, members: Index) -> None:
    """Keep the solved velocities of the members."""
    for m in range(members.shape[0]):
        b = members[m]
        put_row(memory.substeps.spare_linear, b, row(memory.linear_end, b))
        put_row(memory.substeps.spare_angular, b, row(memory.angular_end, b))


@kernel
def solve_motions(
    geometry: Geometry, dynamics: Dynamics, poses: Poses, velocities: Velocities, memory: Memory, members: Index,
    h: float, slow: bool,
) -> tuple[bool, bool]:
    """Run the first solve of a substep of h seconds, and the motions that follow; return whether there was room for all contacts,
    and whether it was solved finer."""
    sub_, contacts = memory.substeps, memory.contacts
    fall_free(dynamics, poses, velocities, memory, members, h)
    contacts.used[0] = 0
    weigh_linkages(dynamics, poses, memory, members, h)
    move_linkages(dynamics, poses, memory, members)
    sub_.kinetic[0] = kinetic_of(memory, members, memory.linear_end, memory.angular_end)
    contacts.standing[0], sub_.lacking[0] = 1, 0
    may_go(dynamics, memory, members, h)
    if not list_pieces_of(geometry, poses, memory, members):
        return False, False
    find_rows(geometry, dynamics, poses, velocities, memory, h)
    sub_.lasting[0] = contacts.used[0]
    count, d = contacts.used[0], stand_off_of(memory)
    fine = slow and sweeps_for(count) >= SWEEPS_OF_FINE and not has_linkage(dynamics, members)
    sweeps = sweeps_for(count) if fine else SWEEPS
    weigh_from(contacts, memory.masses, 0.0, 0)
    weigh_links(dynamics, poses, memory, 0)
    approach_velocities(dynamics, memory, members)
    for k in range(count):
        sub_.approach[k] = speed_along(contacts, k, 0, sub_.spare_linear, sub_.spare_angular)
    follow_arcs(dynamics, memory, h)
    aim_rows(contacts, count, d, h, True)
    tolerance = tolerance_of(memory, h, fine)
    recall_forces(contacts, memory.last)
    scale_impulses(contacts, h)
    apply_impulses(memory, count)
    if has_linkage(dynamics, members) and move_linkages(dynamics, poses, memory, members):
        weigh_links(dynamics, poses, memory, 0)
    lay_out(contacts, memory.masses, 0, count, memory.linear_end, memory.angular_end)
    solve(dynamics, poses, memory, members, h, tolerance, sweeps)
    lift_within_energy(dynamics, poses, velocities, memory, members, h, d, tolerance, sweeps)
    memory.counts[CONTACTS] = max(memory.counts[CONTACTS], count)
    for m in range(members.shape[0]):
        b = members[m]
        sub_.share[b], sub_.group[b], sub_.pushed[b] = 1.0, b, 0
        put_row(sub_.wall, b, (0.0, 0.0, 0.0))
    note_pushed(memory)
    set_motions(geometry, dynamics, poses, velocities, memory, members, h)
    if has_linkage(dynamics, members) and correct_curvature(dynamics, memory, tolerance):
        put_targets(contacts, 0, count)
        solve(dynamics, poses, memory, members, h, tolerance, sweeps)
        note_pushed(memory)
        set_motions(geometry, dynamics, poses, velocities, memory, members, h)
    return True, fine
