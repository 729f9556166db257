"""Energy of simulated bodies for the energy audit, and the scaling of velocities that takes a gain back."""

from math import sqrt

import numpy as np
from numpy.typing import NDArray

from avatarsim.impact.masses import Masses
from avatarsim.jit.kernel import kernel
from avatarsim.spatial.tangent import columns, turned
from avatarsim.spatial.vec3 import dot, row

Array = NDArray[np.float64]
Index = NDArray[np.int64]

NO_GAIN, NO_PART = 1e-13, 1e-10
"""A gain below this [J], and below this part of the motion's energy, is rounding. The first alone lets a world of millimetres,
which has so little energy, gain more than a part in 1e9 in a frame."""


@kernel
def kinetic_energy(masses: Masses, inertia: Array, b: int, linear: Array, angular: Array) -> float:
    """m v^2 / 2 + w . I w / 2 [J] of body b; ``inertia`` (nb, 3, 3) in world axes."""
    v, w = row(linear, b), row(angular, b)
    return float(0.5 * dot(v, v) / masses.inverse_mass[b] + 0.5 * dot(w, turned(columns(inertia, b), w)))


@kernel
def potential_energy(masses: Masses, b: int, gravity: Array, position: Array) -> float:
    """-m g . x [J] of body b."""
    return float(-dot((gravity[0], gravity[1], gravity[2]), row(position, b)) / masses.inverse_mass[b])


@kernel
def held_energy(
    masses: Masses, inertia: Array, members: Index, held: Index, gravity: Array, position: Array, linear: Array, angular: Array
) -> tuple[float, float]:
    """(kinetic, potential) energy [J] of all members with ``held`` 1: those that contact forces act on."""
    kinetic, potential = 0.0, 0.0
    for m in range(members.shape[0]):
        b = members[m]
        if held[b] == 1:
            kinetic += kinetic_energy(masses, inertia, b, linear, angular)
            potential += potential_energy(masses, b, gravity, position)
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
