"""Energy audit: the energy of an island before and after a segment; a gain beyond rounding is taken back."""

import numpy as np
from numpy.typing import NDArray

from avatarsim.impact.energy import NO_GAIN, held_energy, take_back
from avatarsim.impact.masses import to_world
from avatarsim.jit.kernel import kernel
from avatarsim.loops.clocks import arrive
from avatarsim.loops.upper_memory import AUDITED, Memory
from avatarsim.motion.path import STILL
from avatarsim.spatial.vec3 import put_row
from avatarsim.world.dynamics import Dynamics, Velocities
from avatarsim.world.geometry import Geometry, Poses

Index = NDArray[np.int64]


@kernel
def energy_of(
    dynamics: Dynamics, poses: Poses, velocities: Velocities, memory: Memory, members: Index, of_all: bool
) -> tuple[float, float]:
    """(kinetic, potential) energy [J] of the members held by contact forces, or of all that move, which then count as held."""
    for m in range(members.shape[0]):
        b = members[m]
        if of_all:
            memory.held[b] = memory.moving[b]
        if memory.held[b] == 1:
            to_world(dynamics.inertia, poses.rotation, b, memory.inertia)
    return held_energy(
        memory.hold, memory.inertia, members, memory.held, dynamics.gravity, poses.position, velocities.linear, velocities.angular
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
