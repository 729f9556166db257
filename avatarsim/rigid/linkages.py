"""Avatars with joints in the solve of all contacts.

Their links are bodies of the solve, each with the mass and the pull of `driven.aim`. What joints allow is one block of
constraints, solved exactly after each sweep over the contacts: velocities of the links become the nearest ones, in the metric of
their masses, that a velocity of the joints gives (block Gauss-Seidel; the mass matrix is that of Featherstone 2008, chapter 6).

In a substep each link goes straight, and turns evenly, to where forward kinematics has it at the end.
"""

from math import sqrt

import numpy as np
from numpy.typing import NDArray

from avatarsim.jit.kernel import kernel
from avatarsim.model.dynamics import DriveState, Dynamics, Linkage
from avatarsim.model.geometry import Poses
from avatarsim.model.skeleton import FREE, HINGES, carry_links
from avatarsim.rigid.contacts import Contacts
from avatarsim.rigid.solver import LANES, put_three
from avatarsim.rigid.state import Memory
from avatarsim.spatial.tangent import columns, put_columns
from avatarsim.spatial.vec3 import Vec3, along, cross, dot, norm, put_row, row, sub

Index = NDArray[np.int64]
Array = NDArray[np.float64]


@kernel
def is_linked(drive: DriveState, b: int) -> bool:
    """Return whether the upper loop moves body b with others to which joints bind it."""
    return bool(drive.coupled[b] == 1 and drive.linked[b] == 1)


@kernel
def leads_linkage(drive: DriveState, b: int) -> bool:
    """Return whether body b is the first link of a linkage."""
    return bool(is_linked(drive, b) and drive.tied[b] == b)


@kernel
def links_of(drive: DriveState, b: int) -> tuple[int, int]:
    """First link of the avatar that body b leads, and the one after its last."""
    first = drive.linkage.skeleton.first
    end = b - first + 1
    while end < drive.linkage.skeleton.kind.shape[0] and drive.tied[first + end] == b:
        end += 1
    return b - first, end


@kernel
def has_linkage(dynamics: Dynamics, members: Index) -> bool:
    """Return whether a member leads a linkage."""
    for m in range(members.shape[0]):
        if leads_linkage(dynamics.drive, members[m]):
            return True
    return False


@kernel
def motion_of(linkage: Linkage, poses: Poses, owner: int, j: int, link: int) -> tuple[Vec3, Vec3]:
    """How the origin of a link moves, and how it turns, with degree j of an owner that carries it: a column of the Jacobian."""
    skel, axis = linkage.skeleton, row(linkage.axes, j)
    if skel.kind[owner] == FREE and j < skel.first_dof[owner] + 3:
        return axis, (0.0, 0.0, 0.0)
    arm = sub(row(poses.position, skel.first + link), row(poses.position, skel.first + owner))
    return cross(axis, arm), axis


@kernel
def weigh_linkages(dynamics: Dynamics, poses: Poses, memory: Memory, members: Index) -> None:
    """Axes and mass matrices of the linkages among the members, where they are now."""
    drive, linkage = dynamics.drive, dynamics.drive.linkage
    for m in range(members.shape[0]):
        b = members[m]
        if not leads_linkage(drive, b):
            continue
        first, end = links_of(drive, b)
        skel = linkage.skeleton
        put_row(linkage.joints.root, first, row(poses.position, b))
        put_columns(linkage.joints.turn, first, columns(poses.rotation, b))
        carry_links(skel, first, end, linkage.joints, linkage.still, linkage.ahead, linkage.axes)
        low, high = skel.first_dof[first], skel.first_dof[end]
        for i in range(low, high):
            linkage.held[i] = 0
            for j in range(low, high):
                linkage.matrix[i, j - low] = 0.0
        for link in range(first, end):
            add_link(linkage, poses, memory, link, low)
        decompose(linkage, low, high)


@kernel
def add_link(linkage: Linkage, poses: Poses, memory: Memory, link: int, low: int) -> None:
    """Add the mass and the inertia of a link to the matrix of its avatar, whose first degree is ``low``."""
    skel = linkage.skeleton
    body = skel.first + link
    mass, inertia = 1.0 / memory.hold.inverse_mass[body], memory.inertia[body, 0, 0]
    one = link
    while one >= 0:
        for i in range(skel.first_dof[one], skel.first_dof[one + 1]):
            v, w = motion_of(linkage, poses, one, i, link)
            other = one
            while other >= 0:
                for j in range(skel.first_dof[other], min(i + 1, skel.first_dof[other + 1])):
                    v_too, w_too = motion_of(linkage, poses, other, j, link)
                    value = mass * dot(v, v_too) + inertia * dot(w, w_too)
                    linkage.matrix[i, j - low] += value
                    if i != j:
                        linkage.matrix[j, i - low] += value
                other = skel.parent[other]
        one = skel.parent[one]


@kernel
def decompose(linkage: Linkage, low: int, high: int) -> None:
    """Cholesky factor of the mass matrix of degrees low .. high; those held at a limit are left out."""
    factor = linkage.factor
    for i in range(low, high):
        for j in range(low, i + 1):
            if linkage.held[i] + linkage.held[j] > 0:
                factor[i, j - low] = 1.0 if i == j else 0.0
                continue
            total = linkage.matrix[i, j - low]
            for k in range(j - low):
                total -= factor[i, k] * factor[j, k]
            if i == j:
                factor[i, i - low] = sqrt(max(total, 0.0))
            else:
                factor[i, j - low] = total / factor[j, j - low] if factor[j, j - low] > 0.0 else 0.0


@kernel
def rates_for(linkage: Linkage, low: int, high: int) -> None:
    """Rates of degrees low .. high from ``momentum``, those held at a limit keep theirs."""
    rate, factor = linkage.rate, linkage.factor
    for i in range(low, high):
        if linkage.held[i] == 1:
            continue
        total = linkage.momentum[i]
        for k in range(low, high):
            if linkage.held[k] == 1:
                total -= linkage.matrix[i, k - low] * rate[k]
        for k in range(low, i):
            if linkage.held[k] == 0:
                total -= factor[i, k - low] * rate[k]
        rate[i] = total / factor[i, i - low] if factor[i, i - low] > 0.0 else 0.0
    for i in range(high - 1, low - 1, -1):
        if linkage.held[i] == 1:
            continue
        total = rate[i]
        for k in range(i + 1, high):
            if linkage.held[k] == 0:
                total -= factor[k, i - low] * rate[k]
        rate[i] = total / factor[i, i - low] if factor[i, i - low] > 0.0 else 0.0


@kernel
def hold_at_limits(linkage: Linkage, first: int, end: int, h: float) -> bool:
    """Hold hinges of links first .. end that would leave their limits within h seconds at them, and let go those that are pulled
    back from them; returns whether any changed."""
    skel, changed = linkage.skeleton, False
    low, high = skel.first_dof[first], skel.first_dof[end]
    for link in range(first, end):
        if skel.kind[link] != HINGES:
            continue
        for j in range(skel.first_dof[link], skel.first_dof[link + 1]):
            angle = linkage.joints.angle[j]
            least, most = min(0.0, skel.limits[j, 0] - angle) / h, max(0.0, skel.limits[j, 1] - angle) / h
            if linkage.held[j] == 0:
                if linkage.rate[j] < least or linkage.rate[j] > most:
                    linkage.held[j], linkage.rate[j] = 1, least if linkage.rate[j] < least else most
                    changed = True
                continue
            pull = linkage.momentum[j]
            for k in range(low, high):
                pull -= linkage.matrix[j, k - low] * linkage.rate[k]
            if (linkage.rate[j] >= most and pull < 0.0) or (linkage.rate[j] <= least and pull > 0.0):
                linkage.held[j], changed = 0, True
    return changed


@kernel
def bind(dynamics: Dynamics, poses: Poses, memory: Memory, members: Index, h: float) -> float:
    """Give the links among the members the nearest velocities that their joints and limits allow for h seconds.

    ``linear_end`` and ``angular_end`` change. Returns the largest change of a velocity [m/s], of a turn by the size of the link.
    """
    drive, worst = dynamics.drive, 0.0
    for m in range(members.shape[0]):
        if leads_linkage(drive, members[m]):
            first, end = links_of(drive, members[m])
            worst = max(worst, bind_one(drive.linkage, poses, memory, first, end, h))
    return worst


@kernel
def bind_one(linkage: Linkage, poses: Poses, memory: Memory, first: int, end: int, h: float) -> float:
    """`bind` links first .. end of one avatar."""
    skel = linkage.skeleton
    low, high = skel.first_dof[first], skel.first_dof[end]
    for i in range(low, high):
        linkage.momentum[i] = 0.0
    for link in range(first, end):
        b, one = skel.first + link, link
        mass, inertia = 1.0 / memory.hold.inverse_mass[b], memory.inertia[b, 0, 0]
        while one >= 0:
            for i in range(skel.first_dof[one], skel.first_dof[one + 1]):
                v, w = motion_of(linkage, poses, one, i, link)
                linkage.momentum[i] += mass * dot(v, row(memory.linear_end, b)) + inertia * dot(w, row(memory.angular_end, b))
            one = skel.parent[one]
    rates_for(linkage, low, high)
    for _ in range(high - low):
        if not hold_at_limits(linkage, first, end, h):
            break
        decompose(linkage, low, high)
        rates_for(linkage, low, high)
    worst = 0.0
    for link in range(first, end):
        b = skel.first + link
        v, w, one = (0.0, 0.0, 0.0), (0.0, 0.0, 0.0), link
        while one >= 0:
            for i in range(skel.first_dof[one], skel.first_dof[one + 1]):
                x, y = motion_of(linkage, poses, one, i, link)
                v, w = along(v, linkage.rate[i], x), along(w, linkage.rate[i], y)
            one = skel.parent[one]
        moved = norm(sub(v, row(memory.linear_end, b))) + memory.span[b] * norm(sub(w, row(memory.angular_end, b)))
        worst = max(worst, moved)
        put_row(memory.linear_end, b, v)
        put_row(memory.angular_end, b, w)
    return worst


@kernel
def show_bound(drive: DriveState, contacts: Contacts, memory: Memory, members: Index) -> None:
    """Let the solver see the velocities of links that `bind` changed."""
    for m in range(members.shape[0]):
        if is_linked(drive, members[m]):
            put_three(contacts.motion, members[m], 0, row(memory.linear_end, members[m]))
            put_three(contacts.motion, members[m], LANES, row(memory.angular_end, members[m]))


@kernel
def look_ahead(drive: DriveState, memory: Memory, b: int, h: float) -> None:
    """Put `Linkage.ahead` where the linkage that body b leads is after its share of h seconds, within its limits."""
    linkage, skel = drive.linkage, drive.linkage.skeleton
    first, end = links_of(drive, b)
    share = share_of_linkage(drive, memory, b)
    for link in range(first, end):
        for j in range(skel.first_dof[link], skel.first_dof[link + 1]):
            linkage.step[j] = share * h * linkage.rate[j]
            if skel.kind[link] == HINGES:
                angle = linkage.joints.angle[j]
                low, high = min(angle, skel.limits[j, 0]) - angle, max(angle, skel.limits[j, 1]) - angle
                linkage.step[j] = min(max(linkage.step[j], low), high)
    carry_links(skel, first, end, linkage.joints, linkage.step, linkage.ahead, linkage.axes_ahead)


@kernel
def share_of_linkage(drive: DriveState, memory: Memory, b: int) -> float:
    """Least share of the links of the avatar that body b leads."""
    first, end = links_of(drive, b)
    least = 1.0
    for link in range(first, end):
        least = min(least, memory.substeps.share[drive.linkage.skeleton.first + link])
    return least


@kernel
def even_shares(dynamics: Dynamics, memory: Memory, members: Index) -> None:
    """All links of a linkage go the least share of any."""
    drive = dynamics.drive
    for m in range(members.shape[0]):
        if leads_linkage(drive, members[m]):
            first, end = links_of(drive, members[m])
            least = share_of_linkage(drive, memory, members[m])
            for link in range(first, end):
                memory.substeps.share[drive.linkage.skeleton.first + link] = least


@kernel
def bend(dynamics: Dynamics, members: Index, part: float) -> None:
    """Bend the joints of the linkages among the members by a part of the step of this substep."""
    drive, linkage = dynamics.drive, dynamics.drive.linkage
    for m in range(members.shape[0]):
        if leads_linkage(drive, members[m]):
            first, end = links_of(drive, members[m])
            for j in range(linkage.skeleton.first_dof[first], linkage.skeleton.first_dof[end]):
                linkage.angle_before[j] = linkage.joints.angle[j]
                linkage.joints.angle[j] += part * linkage.step[j]
