"""Bodies that are attached to links: parts of their composite bodies (Featherstone 2008, section 6.2).

In the solve of all contacts mass, momentum and weight of an attached body are added to those of its link, and contacts of the
body are contacts of the link. It moves to its place on the link where forward kinematics has that at the end of a substep, along
a motion of its own that is certified like all others.
"""

import numpy as np
from numpy.typing import NDArray

from avatarsim.jit.kernel import kernel
from avatarsim.model.dynamics import DriveState, Dynamics, holder_of
from avatarsim.model.geometry import Poses
from avatarsim.rigid.contacts import Contacts
from avatarsim.rigid.state import Memory
from avatarsim.spatial.tangent import columns, product, put_columns, turned
from avatarsim.spatial.vec3 import Vec3, add, along, cross, put_row, row, scale, sub

Array = NDArray[np.float64]


@kernel
def carried_by(drive: DriveState, b: int, first: int, end: int) -> bool:
    """Return whether body b is attached to one of the links first .. end."""
    link = drive.carrier[b] - drive.linkage.skeleton.first
    return bool(drive.carrier[b] >= 0 and first <= link < end)


@kernel
def move_together(drive: DriveState, a: int, b: int) -> bool:
    """Return whether two bodies are one rigid body: attached to the same link, or one to the other."""
    return holder_of(drive, a) == holder_of(drive, b)


@kernel
def arm_of(drive: DriveState, poses: Poses, b: int) -> Vec3:
    """Return the centre of attached body b from the joint of its link [m]."""
    return sub(row(poses.position, b), row(poses.position, drive.carrier[b]))


@kernel
def add_attached(dynamics: Dynamics, poses: Poses, memory: Memory, b: int, h: float) -> None:
    """Add mass, inertia, and the momentum that attached body b would have after h seconds of falling, to its link."""
    drive, linkage = dynamics.drive, dynamics.drive.linkage
    link, r, mass = drive.carrier[b] - linkage.skeleton.first, arm_of(drive, poses, b), 1.0 / memory.masses.inverse_mass[b]
    squared = r[0] * r[0] + r[1] * r[1] + r[2] * r[2]
    for i in range(3):
        for j in range(3):
            linkage.inertia[link, i, j] += memory.inertia[b, i, j] + mass * ((squared if i == j else 0.0) - r[i] * r[j])
    linkage.mass[link] += mass
    put_row(linkage.moment, link, along(row(linkage.moment, link), mass, r))
    gravity = (dynamics.gravity[0], dynamics.gravity[1], dynamics.gravity[2])
    p = scale(along(row(memory.linear_end, b), h, gravity), mass)
    turning = add(turned(columns(memory.inertia, b), row(memory.angular_end, b)), cross(r, p))
    put_row(linkage.force, link, add(row(linkage.force, link), p))
    put_row(linkage.torque, link, add(row(linkage.torque, link), turning))


@kernel
def carry_attached(drive: DriveState, poses: Poses, memory: Memory, b: int) -> None:
    """Give attached body b the velocities of its link: ``linear_end``, ``angular_end``."""
    w = row(memory.angular_end, drive.carrier[b])
    put_row(memory.linear_end, b, add(row(memory.linear_end, drive.carrier[b]), cross(w, arm_of(drive, poses, b))))
    put_row(memory.angular_end, b, w)


@kernel
def put_on_link(drive: DriveState, b: int, ahead: Poses) -> None:
    """Set the pose of attached body b in ``ahead`` by that of its link there."""
    frame = columns(ahead.rotation, drive.carrier[b])
    put_row(ahead.position, b, add(row(ahead.position, drive.carrier[b]), turned(frame, row(drive.attached_place, b))))
    put_columns(ahead.rotation, b, product(frame, columns(drive.attached_turn, b)))


@kernel
def on_links(drive: DriveState, poses: Poses, contacts: Contacts, first: int) -> None:
    """Make the contacts from ``first`` on of attached bodies contacts of their links."""
    for k in range(first, contacts.used[0]):
        for side in range(2):
            b = contacts.body[k, side]
            if drive.carrier[b] >= 0:
                arms = contacts.arm_a if side == 0 else contacts.arm_b
                put_row(arms, k, add(row(arms, k), arm_of(drive, poses, b)))
                contacts.body[k, side] = drive.carrier[b]
