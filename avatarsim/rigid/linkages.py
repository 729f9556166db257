"""Avatars with joints in the solve of all contacts.

Each link is a body of the solve with the mass and the free velocity of `driven.aim`. All joints of an avatar are one block of
constraints, solved exactly after each sweep over the contacts: the velocities of its links are projected onto those that rates of
its joints give, in the metric of their masses (block Gauss-Seidel; mass matrix: Featherstone 2008, chapter 6).

In a substep each link moves at constant velocities to its pose by forward kinematics at the end.
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
    """Return whether body b is a link with joints that the upper loop moves."""
    return bool(drive.coupled[b] == 1 and drive.linked[b] == 1)


@kernel
def leads_linkage(drive: DriveState, b: int) -> bool:
    """Return whether body b is the root link of such an avatar."""
    return bool(is_linked(drive, b) and drive.tied[b] == b)


@kernel
def links_of(drive: DriveState, b: int) -> tuple[int, int]:
    """First link of the avatar with root body b, and the end of its range of links."""
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
def motion_of(linkage: Linkage, poses: Poses, owner: int, j: int, link: int) -> tuple[Vec3, Vec3]:
    """Column of the Jacobian: linear and angular velocity of a link per rate of degree j of its ancestor ``owner``."""
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
    """Cholesky factor of the mass matrix of degrees low .. high without the degrees at a limit."""
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
    """Solve for the rates of degrees low .. high from ``momentum``; the rates of degrees at a limit are fixed."""
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
    """Update the active set of joint limits of links first .. end for a step of h seconds; return whether it changed."""
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
    """Project the velocities of links onto those that joints and limits allow for h seconds, in the metric of their masses.

    Updates ``linear_end`` and ``angular_end``.

    Returns:
        Largest change of a velocity [m/s]; of an angular velocity, times the size of the link.
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
    """Copy the velocities of links into the solver's array."""
    for m in range(members.shape[0]):
        if is_linked(drive, members[m]):
            put_three(contacts.motion, members[m], 0, row(memory.linear_end, members[m]))
            put_three(contacts.motion, members[m], LANES, row(memory.angular_end, members[m]))


@kernel
def look_ahead(drive: DriveState, memory: Memory, b: int, h: float) -> None:
    """Compute `Linkage.ahead` by forward kinematics: the avatar with root body b after its share of h seconds, within limits."""
    linkage, skel = drive.linkage, drive.linkage.skeleton
    first, end = links_of(drive, b)
    share = memory.substeps.share[b]
    for link in range(first, end):
        for j in range(skel.first_dof[link], skel.first_dof[link + 1]):
            linkage.step[j] = share * h * linkage.rate[j]
            if skel.kind[link] == HINGES:
                angle = linkage.joints.angle[j]
                low, high = min(angle, skel.limits[j, 0]) - angle, max(angle, skel.limits[j, 1]) - angle
                linkage.step[j] = min(max(linkage.step[j], low), high)
    carry_links(skel, first, end, linkage.joints, linkage.step, linkage.ahead, linkage.axes_ahead)


@kernel
def even_shares(dynamics: Dynamics, memory: Memory, members: Index) -> None:
    """Set the share of all links of an avatar to the smallest of them."""
    share = memory.substeps.share
    for m in range(members.shape[0]):
        if leads_linkage(dynamics.drive, members[m]):
            first, end = links_of(dynamics.drive, members[m])
            body, smallest = dynamics.drive.linkage.skeleton.first, 1.0
            for link in range(first, end):
                smallest = min(smallest, share[body + link])
            for link in range(first, end):
                share[body + link] = smallest


@kernel
def bend(dynamics: Dynamics, members: Index, part: float) -> None:
    """Add a part of this substep's step to the joint angles of the linkages among the members."""
    drive, linkage = dynamics.drive, dynamics.drive.linkage
    for m in range(members.shape[0]):
        if leads_linkage(drive, members[m]):
            first, end = links_of(drive, members[m])
            for j in range(linkage.skeleton.first_dof[first], linkage.skeleton.first_dof[end]):
                linkage.angle_before[j] = linkage.joints.angle[j]
                linkage.joints.angle[j] += part * linkage.step[j]
