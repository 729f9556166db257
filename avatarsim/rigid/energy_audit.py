"""Energy audit: the energy of an island before and after a segment; a gain beyond rounding is taken back.

Energy of simulated bodies for the energy audit, and the scaling of velocities that takes a gain back.
"""

from math import sqrt

import numpy as np
from numpy.typing import NDArray

from avatarsim.collision.path import STILL
from avatarsim.jit.kernel import kernel
from avatarsim.model.dynamics import DRIVEN, Dynamics, Velocities, gravity_on
from avatarsim.model.geometry import Geometry, Poses
from avatarsim.rigid.clocks import arrive
from avatarsim.rigid.contacts import SHARP, Contacts, Masses, push_along, to_world
from avatarsim.rigid.state import AUDITED, Memory
from avatarsim.spatial.tangent import columns, turned
from avatarsim.spatial.vec3 import Vec3, along, dot, put_row, row, scale
from avatarsim.tolerances import GRAINS, PROOF

Array = NDArray[np.float64]
Index = NDArray[np.int64]

NO_GAIN, NO_PART = GRAINS, PROOF
"""A gain below this [J], and below this part of the motion's energy, is rounding. The first alone lets a world of millimetres,
which has so little energy, gain more than a part in 1e9 in a frame."""


@kernel
def kinetic_energy(masses: Masses, inertia: Array, b: int, linear: Array, angular: Array) -> float:
    """Return m v^2 / 2 + w . I w / 2 [J] of body b; ``inertia`` (nb, 3, 3) in world axes."""
    v, w = row(linear, b), row(angular, b)
    return float(0.5 * dot(v, v) / masses.inverse_mass[b] + 0.5 * dot(w, turned(columns(inertia, b), w)))


@kernel
def potential_energy(masses: Masses, b: int, gravity: Vec3, position: Array) -> float:
    """Return -m g . x [J] of body b."""
    return float(-dot(gravity, row(position, b)) / masses.inverse_mass[b])


@kernel
def supported_energy(
    masses: Masses, inertia: Array, members: Index, supported: Index, dynamics: Dynamics, position: Array, linear: Array,
    angular: Array,
) -> tuple[float, float]:
    """Return (kinetic, potential) energy [J] of all members with ``supported`` 1: those that contact forces act on."""
    kinetic, potential = 0.0, 0.0
    for m in range(members.shape[0]):
        b = members[m]
        if supported[b] == 1:
            kinetic += kinetic_energy(masses, inertia, b, linear, angular)
            potential += potential_energy(masses, b, gravity_on(dynamics, b), position)
    return kinetic, potential


@kernel
def take_back(gain: float, kinetic: float, members: Index, supported: Index, linear: Array, angular: Array) -> bool:
    """Scale the velocities of supported members so that a ``gain`` [J] above rounding is gone; True if that was needed.

    A common factor keeps separating contacts separating and friction in its disc.
    """
    if not (gain > min(NO_GAIN, NO_PART * kinetic)) or not (kinetic > 0.0):
        return False
    factor = sqrt(max(0.0, 1.0 - gain / kinetic))
    for m in range(members.shape[0]):
        b = members[m]
        if supported[b] == 1:
            for i in range(3):
                linear[b, i] *= factor
                angular[b, i] *= factor
    return True


@kernel
def energy_of(
    dynamics: Dynamics, poses: Poses, velocities: Velocities, memory: Memory, members: Index, of_all: bool
) -> tuple[float, float]:
    """Return (kinetic, potential) energy [J] of members with contact forces, or of all that move, then supported too."""
    for m in range(members.shape[0]):
        b = members[m]
        if of_all:
            memory.supported[b] = memory.moving[b]
        # coupled driven bodies have theirs from `driven.aim`
        if memory.supported[b] == 1 and dynamics.role[b] != DRIVEN:
            to_world(dynamics.inertia, poses.rotation, b, memory.inertia)
    return supported_energy(
        memory.masses, memory.inertia, members, memory.supported, dynamics, poses.position, velocities.linear, velocities.angular
    )


@kernel
def work_on(memory: Memory, members: Index, linear: Array, angular: Array) -> float:
    """Return the work [J] of the impulses of ``linear_end``, ``angular_end`` on supported members that move so [m/s], [rad/s]."""
    total, dv, dw = 0.0, memory.linear_end, memory.angular_end
    for m in range(members.shape[0]):
        b = members[m]
        if memory.supported[b] == 1:
            total += dot(row(dv, b), row(linear, b)) / memory.masses.inverse_mass[b]
            total += dot(turned(columns(memory.inertia, b), row(dw, b)), row(angular, b))
    return total


@kernel
def any_rolls(contacts: Contacts) -> bool:
    """Return whether a smooth surface touches: then errors come of gyroscopic torques as well, which no contact force bounds."""
    for k in range(contacts.used[0]):
        if contacts.smooth[k] != SHARP:
            return True
    return False


@kernel
def put_forces(dynamics: Dynamics, memory: Memory, members: Index, t: float) -> None:
    """Write changes of velocity by contacts and gravity in a segment of t seconds, into ``linear_end`` and ``angular_end``."""
    dv, dw = memory.linear_end, memory.angular_end
    for m in range(members.shape[0]):
        b = members[m]
        put_row(dv, b, scale(gravity_on(dynamics, b), t))
        put_row(dw, b, (0.0, 0.0, 0.0))
    for k in range(memory.contacts.used[0]):
        for i in range(3):
            push_along(memory.contacts, memory.masses, k, i, memory.contacts.impulse[k, i], dv, dw)
    for m in range(members.shape[0]):
        b = members[m]
        if memory.paths.kind[b] == STILL:
            put_row(dv, b, (0.0, 0.0, 0.0))
            put_row(dw, b, (0.0, 0.0, 0.0))


@kernel
def take_along_forces(gain: float, velocities: Velocities, memory: Memory, members: Index) -> float:
    """Take a ``gain`` [J] by the motion along the forces of the last segment; return how much.

    Spin about an axis without torque stays. At most the forces count as none, or twice.
    """
    dv, dw, v, w = memory.linear_end, memory.angular_end, velocities.linear, velocities.angular
    size, power = work_on(memory, members, dv, dw), work_on(memory, members, v, w)
    if not (size > 0.0) or power == 0.0:
        return 0.0
    energy = 0.5 * power * power / size
    less = power / size * (1.0 - sqrt(1.0 - min(gain, energy) / energy))
    less = max(-1.0, min(less, 1.0))
    for m in range(members.shape[0]):
        b = members[m]
        if memory.supported[b] == 1:
            put_row(v, b, along(row(v, b), -less, row(dv, b)))
            put_row(w, b, along(row(w, b), -less, row(dw, b)))
    return less * (power - 0.5 * less * size)


@kernel
def audit(
    dynamics: Dynamics, poses: Poses, velocities: Velocities, memory: Memory, members: Index, energy_before: float, t: float
) -> bool:
    """Take the energy that supported members gained in a segment of t seconds: constant forces on turning arms are not exact.

    Passivity control (Hannaford and Ryu 2002): along the forces first, and the rest, or all where a body rolls, by a common
    factor. False if they gained more than their whole kinetic energy.
    """
    kinetic, potential = energy_of(dynamics, poses, velocities, memory, members, False)
    gain, part = kinetic + potential - energy_before, 0.0
    if gain > min(NO_GAIN, NO_PART * kinetic):
        memory.counts[AUDITED] += 1
        if not any_rolls(memory.contacts):
            put_forces(dynamics, memory, members, t)
            part = take_along_forces(gain, velocities, memory, members)
        take_back(gain - part, kinetic - part, members, memory.supported, velocities.linear, velocities.angular)
    return gain <= max(kinetic, NO_GAIN)


@kernel
def revert_segment(geometry: Geometry, poses: Poses, velocities: Velocities, memory: Memory, members: Index) -> None:
    """Put an island back to where its segment began, at rest: it gained more energy than its motion holds.

    A force that is constant over a segment brakes a body that leaves a contact slowly, and so lifts it. An island with a body in
    free flight is left as it is: flight is exact, and was checked against the paths of the others.
    """
    for m in range(members.shape[0]):
        if memory.moving[members[m]] > memory.supported[members[m]]:
            return
    for m in range(members.shape[0]):
        b = members[m]
        if memory.moving[b] == 1:
            arrive(geometry, poses, velocities, memory, b, 0.0)
            memory.paths.kind[b] = STILL
            put_row(velocities.linear, b, (0.0, 0.0, 0.0))
            put_row(velocities.angular, b, (0.0, 0.0, 0.0))
