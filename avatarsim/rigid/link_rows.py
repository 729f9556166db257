"""Response of avatars with joints to impulses at their contacts: M^-1 J^T in joint coordinates (Featherstone 2008, section 11.3).

An impulse on one link moves all links of its avatar, within joints and limits. The velocities that a unit impulse along each axis
of a contact gives them are stored per contact, so that a sweep of the solver never opens a joint. They are put together from the
velocities per unit wrench on each link that contacts touch, the inverse inertia in operational space (Khatib 1987), and are those
of such links alone: no contact reads the others during a solve.
"""

import math

from avatarsim.jit.kernel import kernel
from avatarsim.model.couplings import fold, follow_leaders
from avatarsim.model.dynamics import DriveState, Dynamics, Linkage
from avatarsim.model.geometry import Poses
from avatarsim.rigid.contacts import (
    AS_A,
    NOT_LINKED,
    Contacts,
    axis,
    lacks_responses,
    largest_across,
)
from avatarsim.rigid.linkages import add_force, is_linked, links_of, velocities_of
from avatarsim.rigid.responses import LANES, UNTOUCHED, WRENCH, Responses
from avatarsim.rigid.solver import put_three, three
from avatarsim.rigid.state import Memory
from avatarsim.spatial.vec3 import Vec3, along, cross, dot, row, scale
from avatarsim.tolerances import GRAIN

IMMOVABLE = math.sqrt(GRAIN)
"""Response of a contact, as a share of that of its bodies without joints, below which joints let nothing move along it: half of
its digits are rounding. Such a row takes no impulse."""


@kernel
def weigh_links(dynamics: Dynamics, poses: Poses, memory: Memory, first: int) -> None:
    """Store the responses of links for the contacts from ``first`` on, and correct their effective masses.

    A contact without room, see `lacks_responses`, takes no impulse: the certificate stops the motion that it would stop.
    """
    contacts, drive = memory.contacts, dynamics.drive
    if first == 0:
        forget_touched(drive.linkage, contacts.responses)
    # responses cover the touched links alone: with another one all are put together anew
    more = note_touched(drive, poses, contacts, first)
    for k in range(0 if more else first, contacts.used[0]):
        has_room = k < first or take_blocks(drive, contacts, k)
        for side in range(2):
            if contacts.linked[k, side] >= 0:
                respond(drive.linkage.skeleton.first, contacts, k, side)
        if k < first:
            continue
        if contacts.linked[k, 0] != NOT_LINKED or contacts.linked[k, 1] != NOT_LINKED:
            weigh_linked(contacts, memory, k)
        if not has_room:
            for i in range(2):
                contacts.inverse_effective_mass[k, i], contacts.effective_mass[k, i] = 0.0, 0.0


@kernel
def forget_touched(linkage: Linkage, responses: Responses) -> None:
    """Forget all responses, and the links that contacts touch."""
    responses.used[0] = 0
    for link in range(linkage.skeleton.kind.shape[0]):
        b = linkage.skeleton.first + link
        responses.touches[b], responses.place[b] = 0, UNTOUCHED


@kernel
def note_touched(drive: DriveState, poses: Poses, contacts: Contacts, first: int) -> bool:
    """List the links that the contacts from ``first`` on touch, and compute the responses to wrenches on those that are new.

    Returns whether any is new."""
    linkage, responses, more = drive.linkage, contacts.responses, False
    for k in range(first, contacts.used[0]):
        for side in range(2):
            b = contacts.body[k, side]
            if is_linked(drive, b) and responses.place[b] == UNTOUCHED:
                root = drive.tied[b]
                responses.place[b] = responses.touches[root]
                responses.touched[root + responses.touches[root]] = b
                responses.touches[root] += 1
                low, high = links_of(drive, root)
                respond_to_wrenches(linkage, poses, responses, b - linkage.skeleton.first, low, high)
                more = True
    return more


@kernel
def take_blocks(drive: DriveState, contacts: Contacts, k: int) -> bool:
    """Assign blocks of responses to contact k; return whether there was room for them."""
    responses, has_room = contacts.responses, True
    for side in range(2):
        contacts.linked[k, side] = NOT_LINKED
    for side in range(2):
        b, other = contacts.body[k, side], contacts.body[k, 1 - side]
        if not is_linked(drive, b) or contacts.linked[k, side] == AS_A:
            continue
        if lacks_responses(contacts):
            has_room = False
            continue
        contacts.linked[k, side] = responses.used[0]
        responses.root[responses.used[0]] = drive.tied[b]
        responses.used[0] += 1
        if is_linked(drive, other) and drive.tied[other] == drive.tied[b]:
            contacts.linked[k, 1] = AS_A
    return has_room


@kernel
def respond_to_wrenches(linkage: Linkage, poses: Poses, responses: Responses, link: int, first: int, end: int) -> None:
    """Compute velocities of links first .. end per unit force along each world axis at the joint of ``link``, and unit torque."""
    skel = linkage.skeleton
    low, high = skel.first_dof[first], skel.first_dof[end]
    for c in range(WRENCH):
        for j in range(low, high):
            linkage.pushed[j] = 0.0
        unit = (1.0 if c % 3 == 0 else 0.0, 1.0 if c % 3 == 1 else 0.0, 1.0 if c % 3 == 2 else 0.0)
        none = (0.0, 0.0, 0.0)
        add_force(linkage, poses, link, unit if c < 3 else none, none if c < 3 else unit, linkage.pushed)
        fold(skel, low, high, linkage.pushed)
        for j in range(low, high):
            linkage.gained[j, c + c // 3] = linkage.pushed[j]
    rates_per_wrench(linkage, low, high)
    for c in range(WRENCH):
        for j in range(low, high):
            linkage.pushed[j] = linkage.gained[j, c + c // 3]
        follow_leaders(skel, low, high, linkage.pushed)
        velocities_of(linkage, poses, first, end, linkage.pushed, linkage.force, linkage.torque)
        for other in range(first, end):
            put_three(responses.by_wrench[link, c], other - first, 0, row(linkage.force, other))
            put_three(responses.by_wrench[link, c], other - first, LANES, row(linkage.torque, other))


@kernel
def rates_per_wrench(linkage: Linkage, low: int, high: int) -> None:
    """Run `rates_for` for all of a wrench at once, in place in ``gained``; degrees at a limit stand still."""
    factor, above, at_limit, x = linkage.factor, linkage.above, linkage.at_limit, linkage.gained
    for i in range(high - 1, low - 1, -1):
        size = factor[i, i - low] if at_limit[i] == 0 else 0.0
        inverse = 1.0 / size if size > 0.0 else 0.0
        p, q = scale(three(x, i, 0), inverse), scale(three(x, i, LANES), inverse)
        put_three(x, i, 0, p)
        put_three(x, i, LANES, q)
        if dot(p, p) + dot(q, q) == 0.0:
            continue
        j = above[i]
        while j >= 0:
            put_three(x, j, 0, along(three(x, j, 0), -factor[i, j - low], p))
            put_three(x, j, LANES, along(three(x, j, LANES), -factor[i, j - low], q))
            j = above[j]
    for i in range(low, high):
        if at_limit[i] == 1:
            continue
        p, q, j = three(x, i, 0), three(x, i, LANES), above[i]
        while j >= 0:
            if at_limit[j] == 0:
                p = along(p, -factor[i, j - low], three(x, j, 0))
                q = along(q, -factor[i, j - low], three(x, j, LANES))
            j = above[j]
        inverse = 1.0 / factor[i, i - low] if factor[i, i - low] > 0.0 else 0.0
        put_three(x, i, 0, scale(p, inverse))
        put_three(x, i, LANES, scale(q, inverse))


@kernel
def respond(first_body: int, contacts: Contacts, k: int, side: int) -> None:
    """Compute velocities of the touched links per unit impulse along each axis of contact k, on one side or, within one avatar,
    on both."""
    responses, block = contacts.responses, contacts.linked[k, side]
    root = responses.root[block]
    for i in range(3):
        n = axis(contacts, k, i)
        for one in range(2):
            if one != side and contacts.linked[k, one] != AS_A:
                continue
            arm = row(contacts.arm_a, k) if one == 0 else row(contacts.arm_b, k)
            force = n if one == 0 else scale(n, -1.0)
            torque, link = cross(arm, force), contacts.body[k, one] - first_body
            for p in range(responses.touches[root]):
                other = responses.touched[root + p] - root
                for at in range(0, 2 * LANES, LANES):
                    v = (0.0, 0.0, 0.0) if one == side else three(responses.velocity[block, p], i, at)
                    for c in range(3):
                        v = along(v, force[c], three(responses.by_wrench[link, c], other, at))
                        v = along(v, torque[c], three(responses.by_wrench[link, 3 + c], other, at))
                    put_three(responses.velocity[block, p], i, at, v)


@kernel
def response_of(contacts: Contacts, memory: Memory, k: int, side: int, i: int) -> tuple[Vec3, Vec3]:
    """Return the change of the velocities of a body of contact k per impulse along axis i."""
    b, sign = contacts.body[k, side], 1.0 if side == 0 else -1.0
    block = contacts.linked[k, side]
    if block == NOT_LINKED:
        turn = row(contacts.turn_a[k], i) if side == 0 else row(contacts.turn_b[k], i)
        return scale(axis(contacts, k, i), sign * memory.masses.inverse_mass[b]), scale(turn, sign)
    if block == AS_A:
        block = contacts.linked[k, 0]
    velocity = contacts.responses.velocity[block, contacts.responses.place[b]]
    return three(velocity, i, 0), three(velocity, i, LANES)


@kernel
def speed_per_impulse(contacts: Contacts, memory: Memory, k: int, i: int, j: int) -> float:
    """Return the velocity along axis i of contact k per impulse along axis j [1/kg]."""
    v_a, w_a = response_of(contacts, memory, k, 0, j)
    v_b, w_b = response_of(contacts, memory, k, 1, j)
    n = axis(contacts, k, i)
    on_a = dot(n, v_a) + dot(row(contacts.jacobian_a[k], i), w_a)
    return float(on_a - dot(n, v_b) - dot(row(contacts.jacobian_b[k], i), w_b))


@kernel
def weigh_linked(contacts: Contacts, memory: Memory, k: int) -> None:
    """Compute effective masses of contact k with links, as `weigh_from` has them for free bodies."""
    contacts.inverse_effective_mass[k, 0] = speed_per_impulse(contacts, memory, k, 0, 0)
    one, other = speed_per_impulse(contacts, memory, k, 1, 1), speed_per_impulse(contacts, memory, k, 2, 2)
    contacts.inverse_effective_mass[k, 1] = largest_across(one, other, speed_per_impulse(contacts, memory, k, 1, 2))
    least = IMMOVABLE * (memory.masses.inverse_mass[contacts.body[k, 0]] + memory.masses.inverse_mass[contacts.body[k, 1]])
    for i in range(2):
        contacts.cross_response[k, i] = speed_per_impulse(contacts, memory, k, i + 1, 0)
        if not (contacts.inverse_effective_mass[k, i] > least):
            contacts.inverse_effective_mass[k, i], contacts.effective_mass[k, i] = 0.0, 0.0
        else:
            contacts.effective_mass[k, i] = 1.0 / contacts.inverse_effective_mass[k, i]
