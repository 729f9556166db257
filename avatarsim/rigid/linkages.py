"""Avatars with joints in the solve of all contacts.

Each link is a body of the solve with the mass and the free velocity of `driven.aim`. Momenta of the links and impulses at their
contacts give rates of the joints by the mass matrix in joint coordinates (Featherstone 2008, chapter 6), and the rates give the
velocities of all links. Degrees at a limit are an active set. A body that is attached to a link is part of its composite body:
see `attached`.

In a substep each link moves at constant velocities to its pose by forward kinematics at the end.
"""

from math import inf, sqrt

import numpy as np
from numpy.typing import NDArray

from avatarsim.jit.kernel import kernel
from avatarsim.model.couplings import fold, follow_leaders
from avatarsim.model.dynamics import DriveState, Dynamics, Linkage, holder_of
from avatarsim.model.geometry import Poses
from avatarsim.model.joint_limits import LEFT_ALONE, has_cone, inside_cone, room_of_ball, room_of_twist, surely_inside
from avatarsim.model.skeleton import BALL, FREE, Skeleton, carry_links, has_angles, translations
from avatarsim.rigid.attached import add_attached, carried_by, carry_attached
from avatarsim.rigid.contacts import Contacts, impulse_of
from avatarsim.rigid.linkage_couplings import fold_limits, fold_matrix
from avatarsim.rigid.responses import LANES
from avatarsim.rigid.solver import put_three
from avatarsim.rigid.state import Memory
from avatarsim.spatial.tangent import columns, put_columns, step_between, stepped, straightened, turned, turned_back
from avatarsim.spatial.vec3 import Vec3, add, along, cross, dot, put_row, row, scale, sub

Index = NDArray[np.int64]
Array = NDArray[np.float64]


@kernel
def is_linked(drive: DriveState, b: int) -> bool:
    """Return whether the upper loop moves body b with all links of an avatar: its links, and bodies attached to them."""
    link = holder_of(drive, b)
    return bool(drive.coupled[link] == 1 and drive.linked[link] == 1)


@kernel
def leads_linkage(drive: DriveState, b: int) -> bool:
    """Return whether body b is the root link of such an avatar."""
    return bool(is_linked(drive, b) and drive.tied[b] == b)


@kernel
def links_of(drive: DriveState, b: int) -> tuple[int, int]:
    """Return the first link of the avatar with root body b, and the end of its range of links."""
    first = drive.linkage.skeleton.first
    end = b - first + 1
    while end < drive.linkage.skeleton.kind.shape[0] and drive.tied[first + end] == b:
        end += 1
    return b - first, end


@kernel
def has_linkage(dynamics: Dynamics, members: Index) -> bool:
    """Return whether a member is the root of a linkage."""
    for m in range(members.shape[0]):
        if leads_linkage(dynamics.drive, members[m]):
            return True
    return False


@kernel
def weigh_linkages(dynamics: Dynamics, poses: Poses, memory: Memory, members: Index, h: float) -> None:
    """Compute axes, limits and mass matrices of the linkages among the members, where they are now, for a step of h seconds."""
    drive, linkage = dynamics.drive, dynamics.drive.linkage
    for m in range(members.shape[0]):
        b = members[m]
        if not leads_linkage(drive, b):
            continue
        first, end = links_of(drive, b)
        skel = linkage.skeleton
        if skel.kind[first] == FREE:
            put_row(linkage.joints.root, first, row(poses.position, b))
            put_columns(linkage.joints.turn, first, columns(poses.rotation, b))
        carry_links(skel, first, end, linkage.joints, linkage.still, linkage.ahead, linkage.axes)
        bound_degrees(linkage, first, end, h)
        low, high = skel.first_dof[first], skel.first_dof[end]
        fold_limits(linkage, low, high)
        for i in range(skel.first_dof[first], skel.first_dof[end]):
            linkage.at_limit[i] = 0
        put_masses(linkage, memory, first, end)
        put_momenta(linkage, memory, first, end)
        for n in range(members.shape[0]):
            if carried_by(drive, members[n], first, end):
                add_attached(dynamics, poses, memory, members[n], h)
        sum_masses(linkage, poses, first, end)
        sum_momenta(linkage, poses, first, end)
        fill_matrix(linkage, poses, first, end)
        fold(skel, low, high, linkage.free_momentum)
        fold_matrix(linkage, low, high)
        decompose(linkage, low, high)


@kernel
def bound_degrees(linkage: Linkage, first: int, end: int, h: float) -> None:
    """Compute the least and largest rate of the degrees of links first .. end over h seconds.

    The axes of a ball with limits become dual to the gradients of its twist and of the two nearest edges for its limb, so that
    each of these limits bounds one rate.
    """
    skel, bounds = linkage.skeleton, linkage.bounds
    for link in range(first, end):
        d, stop = skel.first_dof[link], skel.first_dof[link + 1]
        for j in range(d, stop):
            bounds[j, 0], bounds[j, 1] = -inf, inf
            if has_angles(skel, link):
                angle = linkage.joints.angle[j]
                bounds[j, 0] = min(0.0, skel.limits[j, 0] - angle) / h
                bounds[j, 1] = max(0.0, skel.limits[j, 1] - angle) / h
        if skel.kind[link] != BALL or not has_cone(skel.balls, link):
            continue
        turn = columns(linkage.joints.turn, link)
        room, inward, second, across = room_of_ball(skel.balls, link, turn)
        low, high, along_twist = room_of_twist(skel.balls, link, turn)
        bounds[d, 0], bounds[d + 1, 0], bounds[d + 1, 1], bounds[d + 2, 0] = -room / h, low / h, high / h, -second / h
        if second == inf:
            across = cross(inward, along_twist)
        duals = cross(along_twist, across), cross(across, inward), cross(inward, along_twist)
        size, frame = dot(inward, duals[0]), columns(linkage.ahead.rotation, skel.first + link)
        for i in range(3):
            put_row(linkage.axes, d + i, turned(frame, turned_back(turn, scale(duals[i], 1.0 / size))))


@kernel
def put_masses(linkage: Linkage, memory: Memory, first: int, end: int) -> None:
    """Compute mass, first moment and inertia of each link about its joint."""
    skel = linkage.skeleton
    for link in range(first, end):
        body = skel.first + link
        linkage.mass[link] = 1.0 / memory.masses.inverse_mass[body]
        put_row(linkage.moment, link, (0.0, 0.0, 0.0))
        for i in range(3):
            for j in range(3):
                linkage.inertia[link, i, j] = memory.inertia[body, i, j]


@kernel
def sum_masses(linkage: Linkage, poses: Poses, first: int, end: int) -> None:
    """Add to each link all that it carries (composite bodies), leaves first."""
    skel = linkage.skeleton
    for link in range(end - 1, first, -1):
        parent = skel.parent[link]
        r = sub(row(poses.position, skel.first + link), row(poses.position, skel.first + parent))
        mass, c = linkage.mass[link], row(linkage.moment, link)
        spread = 2.0 * dot(r, c) + mass * dot(r, r)
        for i in range(3):
            for j in range(3):
                shift = (spread if i == j else 0.0) - r[i] * c[j] - c[i] * r[j] - mass * r[i] * r[j]
                linkage.inertia[parent, i, j] += linkage.inertia[link, i, j] + shift
        linkage.mass[parent] += mass
        put_row(linkage.moment, parent, add(row(linkage.moment, parent), along(c, mass, r)))


@kernel
def fill_matrix(linkage: Linkage, poses: Poses, first: int, end: int) -> None:
    """Compute the mass matrix of the avatar of links first .. end by composite bodies (Featherstone 2008, section 6.2)."""
    skel = linkage.skeleton
    low, high = skel.first_dof[first], skel.first_dof[end]
    for i in range(low, high):
        for j in range(low, high):
            linkage.matrix[i, j - low] = 0.0
    for link in range(first, end):
        for i in range(skel.first_dof[link], skel.first_dof[link + 1]):
            axis, c = row(linkage.axes, i), row(linkage.moment, link)
            if moves_straight(skel, link, i):
                force, torque = scale(axis, linkage.mass[link]), cross(c, axis)
            else:
                force, torque = cross(axis, c), turned(columns(linkage.inertia, link), axis)
            one = link
            while one >= 0:
                for j in range(skel.first_dof[one], skel.first_dof[one + 1]):
                    value = dot(row(linkage.axes, j), force if moves_straight(skel, one, j) else torque)
                    linkage.matrix[i, j - low] = value
                    linkage.matrix[j, i - low] = value
                torque, one = at_parent(skel, poses, one, force, torque), skel.parent[one]


@kernel
def moves_straight(skel: Skeleton, link: int, j: int) -> bool:
    """Return whether degree j of a link is a translation."""
    return bool(j < skel.first_dof[link] + translations(skel, link))


@kernel
def at_parent(skel: Skeleton, poses: Poses, link: int, force: Vec3, torque: Vec3) -> Vec3:
    """Return the torque about the joint of a link's parent of a force and torque at its own; unchanged for a root."""
    if skel.parent[link] < 0:
        return torque
    arm = sub(row(poses.position, skel.first + link), row(poses.position, skel.first + skel.parent[link]))
    return add(torque, cross(arm, force))


@kernel
def decompose(linkage: Linkage, low: int, high: int) -> None:
    """Factor L'L of the mass matrix of degrees low .. high without the degrees at a limit.

    L has entries for a degree and those above it alone (Featherstone 2008, section 6.5).
    """
    factor, above, at_limit = linkage.factor, linkage.above, linkage.at_limit
    for k in range(low, high):
        i = k
        while i >= 0:
            factor[k, i - low] = linkage.matrix[k, i - low]
            i = above[i]
    for k in range(high - 1, low - 1, -1):
        if at_limit[k] == 1:
            continue
        factor[k, k - low] = sqrt(max(factor[k, k - low], 0.0))
        scale_by = 1.0 / factor[k, k - low] if factor[k, k - low] > 0.0 else 0.0
        i = above[k]
        while i >= 0:
            factor[k, i - low] *= scale_by
            i = above[i]
        i = above[k]
        while i >= 0:
            j = i
            while j >= 0:
                factor[i, j - low] -= factor[k, i - low] * factor[k, j - low]
                j = above[j]
            i = above[i]


@kernel
def rates_for(linkage: Linkage, low: int, high: int, momentum: Array, rate: Array) -> None:
    """Solve for the ``rate`` of degrees low .. high that have a ``momentum``; the rates of degrees at a limit are fixed."""
    factor, above, at_limit = linkage.factor, linkage.above, linkage.at_limit
    for i in range(low, high):
        if at_limit[i] == 0:
            rate[i] = momentum[i]
    for k in range(low, high):
        if at_limit[k] == 1 and rate[k] != 0.0:
            for i in range(low, high):
                if at_limit[i] == 0:
                    rate[i] -= linkage.matrix[i, k - low] * rate[k]
    for i in range(high - 1, low - 1, -1):
        if at_limit[i] == 1 or rate[i] == 0.0:
            continue
        rate[i] = rate[i] / factor[i, i - low] if factor[i, i - low] > 0.0 else 0.0
        j = above[i]
        while j >= 0:
            if at_limit[j] == 0:
                rate[j] -= factor[i, j - low] * rate[i]
            j = above[j]
    for i in range(low, high):
        if at_limit[i] == 1:
            continue
        total, j = rate[i], above[i]
        while j >= 0:
            if at_limit[j] == 0:
                total -= factor[i, j - low] * rate[j]
            j = above[j]
        rate[i] = total / factor[i, i - low] if factor[i, i - low] > 0.0 else 0.0


@kernel
def hold_at_limits(linkage: Linkage, low: int, high: int) -> bool:
    """Update the active set of the limits of degrees low .. high; return whether it changed."""
    changed = False
    for j in range(low, high):
        least, most = linkage.bounds[j, 0], linkage.bounds[j, 1]
        if linkage.at_limit[j] == 0:
            if linkage.rate[j] < least or linkage.rate[j] > most:
                linkage.at_limit[j], linkage.rate[j] = 1, least if linkage.rate[j] < least else most
                changed = True
            continue
        residual = linkage.momentum[j]
        for k in range(low, high):
            residual -= linkage.matrix[j, k - low] * linkage.rate[k]
        if (linkage.rate[j] >= most and residual < 0.0) or (linkage.rate[j] <= least and residual > 0.0):
            linkage.at_limit[j], changed = 0, True
    return changed


@kernel
def move_linkages(dynamics: Dynamics, poses: Poses, memory: Memory, members: Index) -> bool:
    """Compute velocities of links from their momenta without contact, the impulses at contacts, joints and limits.

    Updates ``linear_end`` and ``angular_end``. Returns whether other degrees are at a limit than before.
    """
    drive, any_ = dynamics.drive, False
    for m in range(members.shape[0]):
        if leads_linkage(drive, members[m]):
            first, end = links_of(drive, members[m])
            linkage = drive.linkage
            low, high = linkage.skeleton.first_dof[first], linkage.skeleton.first_dof[end]
            changed = False
            for j in range(low, high):
                linkage.momentum[j] = linkage.free_momentum[j]
            add_impulses(linkage, poses, memory.contacts, first, end)
            fold(linkage.skeleton, low, high, linkage.momentum)
            rates_for(linkage, low, high, linkage.momentum, linkage.rate)
            for _ in range(high - low):
                if not hold_at_limits(linkage, low, high):
                    break
                changed = True
                decompose(linkage, low, high)
                rates_for(linkage, low, high, linkage.momentum, linkage.rate)
            follow_leaders(linkage.skeleton, low, high, linkage.rate)
            velocities_of(linkage, poses, first, end, linkage.rate, linkage.force, linkage.torque)
            for link in range(first, end):
                put_row(memory.linear_end, linkage.skeleton.first + link, row(linkage.force, link))
                put_row(memory.angular_end, linkage.skeleton.first + link, row(linkage.torque, link))
            for n in range(members.shape[0]):
                if carried_by(drive, members[n], first, end):
                    carry_attached(drive, poses, memory, members[n])
            any_ = any_ or changed
    return any_


@kernel
def put_momenta(linkage: Linkage, memory: Memory, first: int, end: int) -> None:
    """Compute momenta without contact of links first .. end, about their joints."""
    for link in range(first, end):
        b = linkage.skeleton.first + link
        put_row(linkage.force, link, scale(row(memory.linear_end, b), 1.0 / memory.masses.inverse_mass[b]))
        put_row(linkage.torque, link, scale(row(memory.angular_end, b), memory.inertia[b, 0, 0]))


@kernel
def sum_momenta(linkage: Linkage, poses: Poses, first: int, end: int) -> None:
    """Compute the momentum without contact of each degree of links first .. end, leaves first."""
    skel = linkage.skeleton
    for link in range(end - 1, first - 1, -1):
        force, torque, parent = row(linkage.force, link), row(linkage.torque, link), skel.parent[link]
        for j in range(skel.first_dof[link], skel.first_dof[link + 1]):
            linkage.free_momentum[j] = dot(row(linkage.axes, j), force if moves_straight(skel, link, j) else torque)
        if parent >= 0:
            torque = at_parent(skel, poses, link, force, torque)
            put_row(linkage.force, parent, add(row(linkage.force, parent), force))
            put_row(linkage.torque, parent, add(row(linkage.torque, parent), torque))


@kernel
def add_force(linkage: Linkage, poses: Poses, link: int, force: Vec3, torque: Vec3, momentum_out: Array) -> None:
    """Add J^T of a force, or impulse, and a torque about the joint of a link to the degrees that move it."""
    skel = linkage.skeleton
    while link >= 0:
        for j in range(skel.first_dof[link], skel.first_dof[link + 1]):
            momentum_out[j] += dot(row(linkage.axes, j), force if moves_straight(skel, link, j) else torque)
        torque, link = at_parent(skel, poses, link, force, torque), skel.parent[link]


@kernel
def add_impulses(linkage: Linkage, poses: Poses, contacts: Contacts, first: int, end: int) -> None:
    """Add the impulses at the contacts of links first .. end to the momenta of their degrees."""
    low, high = linkage.skeleton.first + first, linkage.skeleton.first + end
    for k in range(contacts.used[0]):
        for side in range(2):
            b = contacts.body[k, side]
            if low <= b < high and contacts.impulse[k, 0] > 0.0:
                j = impulse_of(contacts, k) if side == 0 else scale(impulse_of(contacts, k), -1.0)
                arm = row(contacts.arm_a, k) if side == 0 else row(contacts.arm_b, k)
                add_force(linkage, poses, b - linkage.skeleton.first, j, cross(arm, j), linkage.momentum)


@kernel
def velocities_of(
    linkage: Linkage, poses: Poses, first: int, end: int, rate: Array, linear_out: Array, angular_out: Array
) -> None:
    """Compute velocities of links first .. end (nl, 3) by the rates of their joints (nd), root first."""
    skel = linkage.skeleton
    for link in range(first, end):
        parent, v, w = skel.parent[link], (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)
        if parent >= 0:
            arm = sub(row(poses.position, skel.first + link), row(poses.position, skel.first + parent))
            w = row(angular_out, parent)
            v = add(row(linear_out, parent), cross(w, arm))
        for j in range(skel.first_dof[link], skel.first_dof[link + 1]):
            if moves_straight(skel, link, j):
                v = along(v, rate[j], row(linkage.axes, j))
            else:
                w = along(w, rate[j], row(linkage.axes, j))
        put_row(linear_out, link, v)
        put_row(angular_out, link, w)


@kernel
def show_linkages(drive: DriveState, contacts: Contacts, memory: Memory, members: Index) -> None:
    """Copy the velocities of links into the solver's array."""
    for m in range(members.shape[0]):
        if is_linked(drive, members[m]):
            put_three(contacts.motion, members[m], 0, row(memory.linear_end, members[m]))
            put_three(contacts.motion, members[m], LANES, row(memory.angular_end, members[m]))


@kernel
def look_ahead(drive: DriveState, poses: Poses, memory: Memory, b: int, h: float) -> None:
    """Compute `Linkage.ahead` by forward kinematics: the avatar with root body b after its share of h seconds, within limits."""
    linkage, skel = drive.linkage, drive.linkage.skeleton
    first, end = links_of(drive, b)
    share = memory.substeps.share[b]
    for link in range(first, end):
        d, kind = skel.first_dof[link], skel.kind[link]
        for j in range(d, skel.first_dof[link + 1]):
            linkage.step[j] = share * h * linkage.rate[j]
            if has_angles(skel, link):
                angle = linkage.joints.angle[j]
                low, high = min(angle, skel.limits[j, 0]) - angle, max(angle, skel.limits[j, 1]) - angle
                linkage.step[j] = min(max(linkage.step[j], low), high)
        if kind == BALL:
            turn_ball(linkage, poses, link, d)
    follow_leaders(skel, skel.first_dof[first], skel.first_dof[end], linkage.step)
    carry_links(skel, first, end, linkage.joints, linkage.step, linkage.ahead, linkage.axes_ahead)


@kernel
def turn_ball(linkage: Linkage, poses: Poses, link: int, d: int) -> None:
    """Convert the step of a ball, along its axes of this substep, to the axes of its link, and keep it within its limits."""
    skel, turn = linkage.skeleton, columns(linkage.joints.turn, link)
    whole = (0.0, 0.0, 0.0)
    for i in range(3):
        whole = along(whole, linkage.step[d + i], row(linkage.axes, d + i))
    step = turned_back(columns(poses.rotation, skel.first + link), whole)
    if has_cone(skel.balls, link):
        end = stepped(turn, step)
        if not surely_inside(skel.balls, link, end, LEFT_ALONE):
            step = step_between(turn, inside_cone(skel.balls, link, end))
    for i in range(3):
        linkage.step[d + i] = step[i]


@kernel
def even_shares(dynamics: Dynamics, memory: Memory, members: Index) -> None:
    """Set the share of all links of an avatar, and of bodies attached to them, to the smallest of them."""
    share, drive = memory.substeps.share, dynamics.drive
    for m in range(members.shape[0]):
        if is_linked(drive, members[m]):
            root = drive.tied[members[m]]
            share[root] = min(share[root], share[members[m]])
    for m in range(members.shape[0]):
        if is_linked(drive, members[m]):
            share[members[m]] = share[drive.tied[members[m]]]


@kernel
def step_joints(dynamics: Dynamics, members: Index, part: float) -> None:
    """Add a part of this substep's step to the joints of the linkages among the members."""
    drive, linkage = dynamics.drive, dynamics.drive.linkage
    for m in range(members.shape[0]):
        if leads_linkage(drive, members[m]):
            first, end = links_of(drive, members[m])
            for link in range(first, end):
                scale_step(linkage, link, part)
                turn_joint(linkage, link, 1.0)


@kernel
def scale_last_step(linkage: Linkage, link: int, share: float) -> None:
    """Keep only a share of the last step of a joint."""
    turn_joint(linkage, link, share - 1.0)
    scale_step(linkage, link, share)


@kernel
def scale_step(linkage: Linkage, link: int, share: float) -> None:
    """Scale the step of a joint."""
    for j in range(linkage.skeleton.first_dof[link], linkage.skeleton.first_dof[link + 1]):
        linkage.step[j] *= share


@kernel
def turn_joint(linkage: Linkage, link: int, times: float) -> None:
    """Add ``times`` its step to a joint."""
    skel, d = linkage.skeleton, linkage.skeleton.first_dof[link]
    if has_angles(skel, link):
        for j in range(d, skel.first_dof[link + 1]):
            linkage.joints.angle[j] += times * linkage.step[j]
    elif skel.kind[link] == BALL:
        step = scale((linkage.step[d], linkage.step[d + 1], linkage.step[d + 2]), times)
        put_columns(linkage.joints.turn, link, straightened(stepped(columns(linkage.joints.turn, link), step)))
