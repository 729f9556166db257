"""Response of avatars with joints to impulses at their contacts: M^-1 J^T in joint coordinates (Featherstone 2008, section 11.3).

An impulse on one link moves all links of its avatar, within joints and limits. The velocities that a unit impulse along each axis
of a contact gives them are stored per contact, so that a sweep of the solver never opens a joint.
"""

import math

from avatarsim.jit.kernel import kernel
from avatarsim.model.couplings import fold, follow_leaders
from avatarsim.model.dynamics import Dynamics, Linkage
from avatarsim.model.geometry import Poses
from avatarsim.rigid.contacts import AS_A, NOT_LINKED, Contacts, axis, lacks_responses, largest_across
from avatarsim.rigid.linkages import add_force, is_linked, links_of, rates_for, velocities_of
from avatarsim.rigid.state import Memory
from avatarsim.spatial.vec3 import Vec3, cross, dot, put_row, row, scale
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
    responses = contacts.responses
    if first == 0:
        responses.used[0] = 0
    for k in range(first, contacts.used[0]):
        lacking = False
        for side in range(2):
            contacts.linked[k, side] = NOT_LINKED
        for side in range(2):
            b, other = contacts.body[k, side], contacts.body[k, 1 - side]
            if not is_linked(drive, b) or contacts.linked[k, side] == AS_A:
                continue
            if lacks_responses(contacts):
                lacking = True
                continue
            contacts.linked[k, side] = responses.used[0]
            responses.used[0] += 1
            same = is_linked(drive, other) and drive.tied[other] == drive.tied[b]
            if same:
                contacts.linked[k, 1] = AS_A
            root = drive.tied[b]
            first_link, end = links_of(drive, root)
            responses.first[contacts.linked[k, side]], responses.links[contacts.linked[k, side]] = root, end - first_link
            respond(drive.linkage, poses, contacts, k, side, same, first_link, end)
        if contacts.linked[k, 0] != NOT_LINKED or contacts.linked[k, 1] != NOT_LINKED:
            weigh_linked(contacts, memory, k)
        if lacking:
            for i in range(2):
                contacts.inverse_effective_mass[k, i], contacts.effective_mass[k, i] = 0.0, 0.0


@kernel
def respond(
    linkage: Linkage, poses: Poses, contacts: Contacts, k: int, side: int, same: bool, first: int, end: int
) -> None:
    """Compute velocities of links first .. end per unit impulse along each axis of contact k, on a side or, if ``same``, both."""
    skel, block = linkage.skeleton, contacts.linked[k, side]
    low, high = skel.first_dof[first], skel.first_dof[end]
    for i in range(3):
        n = axis(contacts, k, i)
        for j in range(low, high):
            linkage.pushed[j], linkage.gained[j] = 0.0, 0.0
        for one in range(2):
            if one == side or same:
                arm = row(contacts.arm_a, k) if one == 0 else row(contacts.arm_b, k)
                force = n if one == 0 else scale(n, -1.0)
                add_force(linkage, poses, contacts.body[k, one] - skel.first, force, cross(arm, force), linkage.pushed)
        fold(skel, low, high, linkage.pushed)
        rates_for(linkage, low, high, linkage.pushed, linkage.gained)
        follow_leaders(skel, low, high, linkage.gained)
        velocities_of(linkage, poses, first, end, linkage.gained, linkage.force, linkage.torque)
        for link in range(first, end):
            put_row(contacts.responses.linear[block, link - first], i, row(linkage.force, link))
            put_row(contacts.responses.angular[block, link - first], i, row(linkage.torque, link))


@kernel
def response_of(contacts: Contacts, memory: Memory, k: int, side: int, i: int) -> tuple[Vec3, Vec3]:
    """Return the change of the velocities of a body of contact k per impulse along axis i."""
    b, sign = contacts.body[k, side], 1.0 if side == 0 else -1.0
    block = contacts.linked[k, side]
    if block == NOT_LINKED:
        turn = row(contacts.turn_a[k], i) if side == 0 else row(contacts.turn_b[k], i)
        return scale(axis(contacts, k, i), sign * memory.hold.inverse_mass[b]), scale(turn, sign)
    if block == AS_A:
        block = contacts.linked[k, 0]
    link = b - contacts.responses.first[block]
    return row(contacts.responses.linear[block, link], i), row(contacts.responses.angular[block, link], i)


@kernel
def speed_per_impulse(contacts: Contacts, memory: Memory, k: int, i: int, j: int) -> float:
    """Return the velocity along axis i of contact k per impulse along axis j [1/kg]."""
    v_a, w_a = response_of(contacts, memory, k, 0, j)
    v_b, w_b = response_of(contacts, memory, k, 1, j)
    n = axis(contacts, k, i)
    on_a = dot(n, v_a) + dot(row(contacts.lever_a[k], i), w_a)
    return float(on_a - dot(n, v_b) - dot(row(contacts.lever_b[k], i), w_b))


@kernel
def weigh_linked(contacts: Contacts, memory: Memory, k: int) -> None:
    """Compute effective masses of contact k with links, as `weigh_from` has them for free bodies."""
    contacts.inverse_effective_mass[k, 0] = speed_per_impulse(contacts, memory, k, 0, 0)
    one, other = speed_per_impulse(contacts, memory, k, 1, 1), speed_per_impulse(contacts, memory, k, 2, 2)
    contacts.inverse_effective_mass[k, 1] = largest_across(one, other, speed_per_impulse(contacts, memory, k, 1, 2))
    least = IMMOVABLE * (memory.hold.inverse_mass[contacts.body[k, 0]] + memory.hold.inverse_mass[contacts.body[k, 1]])
    for i in range(2):
        contacts.cross_response[k, i] = speed_per_impulse(contacts, memory, k, i + 1, 0)
        if not (contacts.inverse_effective_mass[k, i] > least):
            contacts.inverse_effective_mass[k, i], contacts.effective_mass[k, i] = 0.0, 0.0
        else:
            contacts.effective_mass[k, i] = 1.0 / contacts.inverse_effective_mass[k, i]
