"""Energy audit: the energy of an island before and after a segment; a gain beyond rounding is taken back.

Energy of simulated bodies for the energy audit, and the scaling of velocities that takes a gain back.
"""

from math import sqrt

import numpy as np
from numpy.typing import NDArray

from avatarsim.collision.path import STILL
from avatarsim.jit.kernel import kernel
from avatarsim.model.dynamics import DRIVEN, Dynamics, Velocities, pull_on
from avatarsim.model.geometry import Geometry, Poses
from avatarsim.rigid.clocks import arrive
from avatarsim.rigid.contacts import Masses, to_world
from avatarsim.rigid.state import AUDITED, Memory
from avatarsim.spatial.tangent import columns, turned
from avatarsim.spatial.vec3 import Vec3, dot, put_row, row
from avatarsim.tolerances import GRAINS, PROOF

Array = NDArray[np.float64]
Index = NDArray[np.int64]

NO_GAIN, NO_PART = GRAINS, PROOF
"""A gain below this [J], and below this part of the motion's energy, is rounding. The first alone lets a world of millimetres,
which has so little energy, gain more than a part in 1e9 in a frame."""


@kernel
def kinetic_energy(masses: Masses, inertia: Array, b: int, linear: Array, angular: Array) -> float:
    """m v^2 / 2 + w . I w / 2 [J] of body b; ``inertia`` (nb, 3, 3) in world axes."""
    v, w = row(linear, b), row(angular, b)
    return float(0.5 * dot(v, v) / masses.inverse_mass[b] + 0.5 * dot(w, turned(columns(inertia, b), w)))


@kernel
def potential_energy(masses: Masses, b: int, pull: Vec3, position: Array) -> float:
    """-m g . x [J] of body b."""
    return float(-dot(pull, row(position, b)) / masses.inverse_mass[b])


@kernel
def held_energy(
    masses: Masses, inertia: Array, members: Index, held: Index, dynamics: Dynamics, position: Array, linear: Array,
    angular: Array,
) -> tuple[float, float]:
    """(kinetic, potential) energy [J] of all members with ``held`` 1: those that contact forces act on."""
    kinetic, potential = 0.0, 0.0
    for m in range(members.shape[0]):
        b = members[m]
        if held[b] == 1:
            kinetic += kinetic_energy(masses, inertia, b, linear, angular)
            potential += potential_energy(masses, b, pull_on(dynamics, b), position)
    return kinetic, potential


@kernel
def take_back(gain: float, kinetic: float, members: Index, held: Index, linear: Array, angular: Array) -> bool:
    """Scale the velocities of held members so that a ``gain`` [J] above rounding is gone; True if that was needed.

    A common factor keeps separating contacts separating and friction in its disc.
    """
    if not (gain > min(NO_GAIN, NO_PART * kinetic)) or not (kinetic > 0.0):
        return False
    kept = sqrt(max(0.0, 1.0 - gain / kinetic))
    for m in range(members.shape[0]):
        b = members[m]
        if held[b] == 1:
            for i in range(3):
                linear[b, i] *= kept
                angular[b, i] *= kept
    return True


@kernel
def energy_of(
    dynamics: Dynamics, poses: Poses, velocities: Velocities, memory: Memory, members: Index, of_all: bool
) -> tuple[float, float]:
    """(kinetic, potential) energy [J] of the members held by contact forces, or of all that move, which then count as held."""
    for m in range(members.shape[0]):
        b = members[m]
        if of_all:
            memory.held[b] = memory.moving[b]
        # coupled driven bodies have theirs from `driven.aim`
        if memory.held[b] == 1 and dynamics.role[b] != DRIVEN:
            to_world(dynamics.inertia, poses.rotation, b, memory.inertia)
    return held_energy(
        memory.hold, memory.inertia, members, memory.held, dynamics, poses.position, velocities.linear, velocities.angular
    )


@kernel
def audit(
    dynamics: Dynamics, poses: Poses, velocities: Velocities, memory: Memory, members: Index, of_all: bool,
    energy_before: float,
) -> bool:
    """Take back the energy that held members gained beyond rounding: constant forces on turning lever arms are not exact.

    False if they gained more than their whole kinetic energy.
    """
    kinetic, potential = energy_of(dynamics, poses, velocities, memory, members, of_all)
    if take_back(kinetic + potential - energy_before, kinetic, members, memory.held, velocities.linear, velocities.angular):
        memory.counts[AUDITED] += 1
    return kinetic + potential - energy_before <= max(kinetic, NO_GAIN)


@kernel
def stay(geometry: Geometry, poses: Poses, velocities: Velocities, memory: Memory, members: Index) -> None:
    """Put an island back to where its segment began, at rest: it gained more energy than its motion holds.

    A force that is constant over a segment brakes a body that leaves a contact slowly, and so lifts it. An island with a body in
    free flight is left as it is: flight is exact, and was checked against the paths of the others.
    """
    for m in range(members.shape[0]):
        if memory.moving[members[m]] > memory.held[members[m]]:
            return
    for m in range(members.shape[0]):
        b = members[m]
        if memory.moving[b] == 1:
            arrive(geometry, poses, velocities, memory, b, 0.0)
            memory.paths.kind[b] = STILL
            put_row(velocities.linear, b, (0.0, 0.0, 0.0))
            put_row(velocities.angular, b, (0.0, 0.0, 0.0))
