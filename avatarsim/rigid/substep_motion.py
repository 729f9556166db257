"""Motion of the bodies of a crowd within a substep: computed from velocities, certified, and reduced where it is refused."""

import numpy as np
from numpy.typing import NDArray

from avatarsim.collision.path import HELD, STILL
from avatarsim.jit.kernel import kernel
from avatarsim.model.dynamics import SIMULATED, Dynamics, Velocities, gravity_on, holder_of
from avatarsim.model.geometry import Geometry, Poses
from avatarsim.rigid.attached import move_together, put_on_link
from avatarsim.rigid.link_rows import weigh_links
from avatarsim.rigid.linkages import even_shares, is_linked, leads_linkage, look_ahead
from avatarsim.rigid.margin_rows import add_refused
from avatarsim.rigid.near_pieces import FARTHER, list_more
from avatarsim.rigid.solver import lay_out
from avatarsim.rigid.state import SHORTENED, Memory
from avatarsim.rigid.substep_state import FIXED_GROUP, Substeps
from avatarsim.rigid.swept_certificate import certify_pieces, measure_motion, pose_at
from avatarsim.spatial.tangent import columns, turn_of
from avatarsim.spatial.vec3 import Vec3, along, dot, norm, put_row, row, scale, sub

Index = NDArray[np.int64]

NONE_LEFT = 0.25
"""Least share of its motion that a body goes whose pair is refused still, after halves; below it stays where it is."""


@kernel
def set_motions(
    geometry: Geometry, dynamics: Dynamics, poses: Poses, velocities: Velocities, memory: Memory, members: Index, h: float
) -> None:
    """Set motions of the members over h seconds, by the solved velocities: trial poses, turns and bulges.

    A body with contacts moves straight at its end velocity, any other on its parabola. For a body that moves farther than
    estimated, more pairs of pieces are listed; ``lacking`` marks where there is no room for them.
    """
    sub_, paths, wider = memory.substeps, memory.paths, False
    for m in range(members.shape[0]):
        if leads_linkage(dynamics.drive, members[m]):
            look_ahead(dynamics.drive, poses, memory, members[m], h)
    for m in range(members.shape[0]):
        b = members[m]
        if memory.moving[b] == 0:
            paths.kind[b] = STILL
            put_row(sub_.velocity, b, (0.0, 0.0, 0.0))
            put_row(sub_.turning, b, (0.0, 0.0, 0.0))
            sub_.turn[b], sub_.bulge[b], sub_.wider[b] = 0.0, 0.0, 0.0
            continue
        paths.kind[b], paths.time[b] = HELD, -1.0
        put_row(paths.angular, b, (0.0, 0.0, 0.0))
        v, w = shared(dynamics, memory, b)
        if is_linked(dynamics.drive, b):
            v, w = velocities_ahead(dynamics, poses, b, h)
        flies = sub_.pushed[b] == 0 and sub_.share[b] == 1.0 and not is_linked(dynamics.drive, b)
        gravity = gravity_on(dynamics, b) if flies else (0.0, 0.0, 0.0)
        put_row(paths.linear, b, gravity)
        set_motion(geometry, poses, memory, b, h, row(velocities.linear, b) if flies else v, w)
        farthest = h * (norm(row(sub_.velocity, b)) + 0.5 * h * norm(gravity)) + sub_.turn[b] * memory.span[b]
        sub_.wider[b] = sub_.room[b]
        if farthest > sub_.room[b]:
            sub_.wider[b], wider = FARTHER * farthest, True
    if wider:
        if not list_more(geometry, poses, memory, members, sub_.room, sub_.wider):
            sub_.lacking[0] = 1
        for m in range(members.shape[0]):
            sub_.room[members[m]] = sub_.wider[members[m]]


@kernel
def velocities_ahead(dynamics: Dynamics, poses: Poses, b: int, h: float) -> tuple[Vec3, Vec3]:
    """Return constant velocities [m/s], [rad/s] from the pose of b, a link or attached, to forward kinematics h seconds later."""
    ahead = dynamics.drive.linkage.ahead
    if dynamics.drive.carrier[b] >= 0:
        put_on_link(dynamics.drive, b, ahead)
    offset = sub(row(ahead.position, b), row(poses.position, b))
    return scale(offset, 1.0 / h), scale(turn_of(columns(poses.rotation, b), columns(ahead.rotation, b)), 1.0 / h)


@kernel
def shared(dynamics: Dynamics, memory: Memory, b: int) -> tuple[Vec3, Vec3]:
    """Return velocities of body b [m/s], [rad/s]: its share of its own, and the mean of its group for the rest."""
    sub_, v, w = memory.substeps, row(memory.linear_end, b), row(memory.angular_end, b)
    if sub_.share[b] == 1.0:
        return v, w
    leader = FIXED_GROUP if is_linked(dynamics.drive, b) else leader_of(sub_, b)
    mean = (0.0, 0.0, 0.0) if leader == FIXED_GROUP else row(sub_.mean, leader)
    return along(mean, sub_.share[b], sub(v, mean)), scale(w, sub_.share[b])


@kernel
def leader_of(sub_: Substeps, b: int) -> int:
    """Return the representative of the group of body b, or FIXED_GROUP."""
    while b != FIXED_GROUP and sub_.group[b] != b:
        b = sub_.group[b]
    return b


@kernel
def certify_all(
    geometry: Geometry, dynamics: Dynamics, poses: Poses, velocities: Velocities, memory: Memory, h: float, d: float, error: float
) -> tuple[int, bool]:
    """Certify every near pair of pieces whose bodies changed, or that was refused; return (refused, room for their rows).

    Refused pairs are marked, and their bodies ``near``; with an ``error`` [m] > 0 they get rows: see `add_refused`.
    """
    sub_, refused, has_room = memory.substeps, 0, True
    first = memory.contacts.used[0]
    for q in range(sub_.found[0]):
        a, b = geometry.body[sub_.pieces[q, 0]], geometry.body[sub_.pieces[q, 1]]
        if sub_.changed[a] + sub_.changed[b] + sub_.refused[q] == 0:
            continue
        if move_together(dynamics.drive, a, b):
            sub_.refused[q] = 0
            continue
        refusal = certify_pieces(geometry, poses, memory, q, h)
        sub_.refused[q] = 0 if refusal.holds else 1
        if refusal.holds:
            continue
        refused += 1
        sub_.near[holder_of(dynamics.drive, a)], sub_.near[holder_of(dynamics.drive, b)] = 1, 1
        if error > 0.0:
            has_room = (add_refused(geometry, dynamics, velocities, memory, memory.masses, q, refusal, h, d, error) and has_room)
    if error > 0.0 and refused > 0:
        weigh_links(dynamics, poses, memory, first)
        lay_out(memory.contacts, memory.masses, first, memory.contacts.used[0], memory.linear_end, memory.angular_end)
    return refused, has_room


@kernel
def shorten_motions(
    geometry: Geometry, dynamics: Dynamics, poses: Poses, velocities: Velocities, memory: Memory, members: Index, h: float
) -> None:
    """Reduce the relative motion of refused pairs until every pair is proved free.

    The bodies of a refused pair join one group. The body with the larger share of its own motion halves it, down to zero, and
    moves with the weighted mean velocity of its group for the rest, so the momentum of a group is conserved. Against a body that
    does not move, a group slides along its surface, and stops if that is refused too.
    """
    sub_ = memory.substeps
    for _ in range(4 * members.shape[0]):
        for m in range(members.shape[0]):
            sub_.changed[members[m]] = 0
        shortened = join_refused(geometry, dynamics, memory)
        even_shares(dynamics, memory, members)
        if shortened == 0:
            break
        memory.counts[SHORTENED] += shortened
        weigh_groups(memory, members)
        for m in range(members.shape[0]):
            b = members[m]
            sub_.changed[b] = 1 if sub_.share[b] < 1.0 else 0
        set_motions(geometry, dynamics, poses, velocities, memory, members, h)
        refused, _ = certify_all(geometry, dynamics, poses, velocities, memory, h, 0.0, 0.0)
        if refused == 0 and sub_.lacking[0] == 0:
            return
    halt(geometry, dynamics, poses, velocities, memory, members, h)


@kernel
def halt(
    geometry: Geometry, dynamics: Dynamics, poses: Poses, velocities: Velocities, memory: Memory, members: Index, h: float
) -> None:
    """Set the motion of all members in this substep to zero."""
    for m in range(members.shape[0]):
        memory.substeps.share[members[m]], memory.substeps.group[members[m]] = 0.0, FIXED_GROUP
    set_motions(geometry, dynamics, poses, velocities, memory, members, h)


@kernel
def join_refused(geometry: Geometry, dynamics: Dynamics, memory: Memory) -> int:
    """Join the groups of refused pairs and halve the larger share of each; return how many bodies changed.

    ``changed`` marks the bodies whose share was halved in this turn.
    """
    sub_, changed = memory.substeps, 0
    for q in range(sub_.found[0]):
        if sub_.refused[q] == 0:
            continue
        a, b = geometry.body[sub_.pieces[q, 0]], geometry.body[sub_.pieces[q, 1]]
        share_a = sub_.share[a] if memory.moving[a] == 1 else 0.0
        share_b = sub_.share[b] if memory.moving[b] == 1 else 0.0
        bound = is_linked(dynamics.drive, a) or is_linked(dynamics.drive, b)
        if memory.moving[a] + memory.moving[b] == 2 and not bound:
            changed += join(memory, a, b)
        elif not bound:
            changed += put_wall(memory, q, a, b)
        for side in range(2):
            body, own, others = (a, share_a, share_b) if side == 0 else (b, share_b, share_a)
            if memory.moving[body] == 0 or own < others or sub_.changed[body] == 1:
                continue
            if own > 0.0:
                sub_.share[body] = 0.5 * own if 0.5 * own >= NONE_LEFT else 0.0
            elif memory.moving[a] + memory.moving[b] == 1 and join(memory, a, b) == 1:
                sub_.share[body] = 0.5
            else:
                continue
            sub_.changed[body] = 1
            changed += 1
    return changed


@kernel
def join(memory: Memory, a: int, b: int) -> int:
    """Merge the groups of bodies a and b, into the fixed group if one does not move; return 1 if they were separate."""
    sub_ = memory.substeps
    one = leader_of(sub_, a) if memory.moving[a] == 1 else FIXED_GROUP
    other = leader_of(sub_, b) if memory.moving[b] == 1 else FIXED_GROUP
    if one == other:
        return 0
    least, most = min(one, other), max(one, other)
    sub_.group[most] = least
    if least != FIXED_GROUP and not any_of(row(sub_.wall, least)):
        put_row(sub_.wall, least, row(sub_.wall, most))
    return 1


@kernel
def put_wall(memory: Memory, q: int, a: int, b: int) -> int:
    """Restrict the group of the moving body of refused pair q to slide along the other; return 0 if it has a restriction."""
    sub_ = memory.substeps
    leader = leader_of(sub_, a if memory.moving[a] == 1 else b)
    if leader == FIXED_GROUP or any_of(row(sub_.wall, leader)):
        return 0
    put_row(sub_.wall, leader, scale(row(sub_.normal, q), 1.0 if memory.moving[a] == 1 else -1.0))
    return 1


@kernel
def any_of(n: Vec3) -> bool:
    """Return whether a vector is not zero."""
    return dot(n, n) > 0.0


@kernel
def weigh_groups(memory: Memory, members: Index) -> None:
    """Compute ``mean`` and ``mass`` of each group. Bodies are weighted by the motion that they lose, which conserves momentum."""
    sub_ = memory.substeps
    for m in range(members.shape[0]):
        b = members[m]
        sub_.mass[b] = 0.0
        put_row(sub_.mean, b, (0.0, 0.0, 0.0))
    for m in range(members.shape[0]):
        b = members[m]
        i = leader_of(sub_, b)
        if i != FIXED_GROUP and memory.moving[b] == 1:
            mass = (1.0 - sub_.share[b]) / memory.masses.inverse_mass[b]
            sub_.mass[i] += mass
            put_row(sub_.mean, i, along(row(sub_.mean, i), mass, row(memory.linear_end, b)))
    for m in range(members.shape[0]):
        b = members[m]
        if sub_.mass[b] > 0.0:
            mean, wall = scale(row(sub_.mean, b), 1.0 / sub_.mass[b]), row(sub_.wall, b)
            put_row(sub_.mean, b, along(mean, -min(0.0, dot(mean, wall)), wall))


@kernel
def store_motions(memory: Memory, members: Index) -> None:
    """Store the motion of the members in ``change_linear``, ``change_angular``."""
    sub_ = memory.substeps
    for m in range(members.shape[0]):
        put_row(sub_.change_linear, members[m], row(sub_.velocity, members[m]))
        put_row(sub_.change_angular, members[m], row(sub_.turning, members[m]))


@kernel
def restore_motions(geometry: Geometry, poses: Poses, memory: Memory, members: Index, h: float, of_near: bool) -> None:
    """Restore the motion stored by `store_motions`, of all members or of those marked ``near``, and mark them as changed."""
    sub_ = memory.substeps
    for m in range(members.shape[0]):
        b = members[m]
        sub_.changed[b] = memory.moving[b] * (sub_.near[b] if of_near else 1)
        if sub_.changed[b] == 1:
            set_motion(geometry, poses, memory, b, h, row(sub_.change_linear, b), row(sub_.change_angular, b))


@kernel
def lower_rises(
    geometry: Geometry, dynamics: Dynamics, poses: Poses, memory: Memory, members: Index, h: float, part: float
) -> None:
    """Scale the motion against gravity of bodies that contacts lift, and mark them as changed."""
    sub_ = memory.substeps
    for m in range(members.shape[0]):
        b = members[m]
        v, gravity = row(sub_.velocity, b), gravity_on(dynamics, b)
        fall = dot(gravity, v)
        sub_.changed[b] = memory.moving[b] * sub_.pushed[b] if fall < 0.0 else 0
        if sub_.changed[b] == 1:
            slower = along(v, -(1.0 - part) * fall / dot(gravity, gravity), gravity)
            set_motion(geometry, poses, memory, b, h, slower, row(sub_.turning, b))


@kernel
def scale_motions(
    geometry: Geometry, dynamics: Dynamics, poses: Poses, memory: Memory, members: Index, h: float, part: float
) -> None:
    """Scale the motion of loose bodies with contacts, and mark them as changed."""
    sub_ = memory.substeps
    for m in range(members.shape[0]):
        b = members[m]
        sub_.changed[b] = memory.moving[b] * sub_.pushed[b] if dynamics.role[b] == SIMULATED else 0
        if sub_.changed[b] == 1:
            set_motion(geometry, poses, memory, b, h, scale(row(sub_.velocity, b), part), scale(row(sub_.turning, b), part))


@kernel
def set_motion(geometry: Geometry, poses: Poses, memory: Memory, b: int, h: float, v: Vec3, w: Vec3) -> None:
    """Set the velocities [m/s], [rad/s] of body b for h seconds, and compute its pose at the end."""
    put_row(memory.substeps.velocity, b, v)
    put_row(memory.substeps.turning, b, w)
    pose_at(geometry, poses, memory, b, h, memory.trial)
    measure_motion(geometry, poses, memory, b, h)


@kernel
def scale_velocities(dynamics: Dynamics, memory: Memory, members: Index, part: float) -> None:
    """Scale the solved velocities of loose bodies with contacts."""
    for m in range(members.shape[0]):
        b = members[m]
        if memory.moving[b] * memory.substeps.pushed[b] == 1 and dynamics.role[b] == SIMULATED:
            put_row(memory.linear_end, b, scale(row(memory.linear_end, b), part))
            put_row(memory.angular_end, b, scale(row(memory.angular_end, b), part))
