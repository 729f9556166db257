"""Position projection (drift correction; post-stabilization: Cline and Pai 2003): overlapping simulated bodies are moved apart.

Nonlinear Gauss-Seidel on positions; velocities stay, so no kinetic energy is added. The first passes weigh by mass. They do not
converge for a light body on the floor under a heavy one, so from WEIGHED on all bodies yield as if they had the same mass.
"""

import numpy as np
from numpy.typing import NDArray

from avatarsim.impact.contacts import Contacts, axis, velocity_at, weigh
from avatarsim.impact.masses import Masses, to_world
from avatarsim.impact.resting import STAND_OFF
from avatarsim.jit.kernel import kernel
from avatarsim.loops.touching import find_contacts
from avatarsim.loops.upper_memory import Memory
from avatarsim.motion.free_rotation import spun
from avatarsim.spatial.tangent import columns, put_columns
from avatarsim.spatial.vec3 import add, dot, norm, put_row, row
from avatarsim.world.dynamics import Dynamics, Velocities
from avatarsim.world.geometry import Geometry, Poses, place

Array = NDArray[np.float64]
Index = NDArray[np.int64]

PASSES, WEIGHED = 10, 4
"""Passes, each of which finds the contacts anew, and those weighted by mass. Normals of deep overlaps turn as bodies part."""

ROUNDS = 30
"""Gauss-Seidel rounds over the contacts of one pass."""

GOOD = -1e-7
"""A gap above this [m] is left as it is."""


@kernel
def share_of(masses: Masses, b: int, evenly: bool) -> float:
    """Factor on displacements of body b: with ``evenly`` its mass, so that bodies of one shape yield alike; else 1."""
    return 1.0 / masses.inverse_mass[b] if evenly and masses.inverse_mass[b] > 0.0 else 1.0


@kernel
def displace(contacts: Contacts, masses: Masses, evenly: bool, linear: Array, angular: Array) -> None:
    """Displacements [m], [rad], of all bodies that bring the gaps of all contacts to the stand-off, to first order."""
    linear[:, :] = 0.0
    angular[:, :] = 0.0
    for _ in range(ROUNDS):
        done = True
        for k in range(contacts.used[0]):
            n = axis(contacts, k, 0)
            gap = contacts.gap[k] + dot(n, velocity_at(contacts, k, linear, angular))
            if gap < GOOD and contacts.ease[k, 0] > 0.0:
                a, b = contacts.body[k, 0], contacts.body[k, 1]
                of_a, of_b = share_of(masses, a, evenly), share_of(masses, b, evenly)
                ease_a = masses.inverse_mass[a] + dot(row(contacts.lever_a[k], 0), row(contacts.turn_a[k], 0))
                ease_b = masses.inverse_mass[b] + dot(row(contacts.lever_b[k], 0), row(contacts.turn_b[k], 0))
                d = (STAND_OFF - gap) / (of_a * ease_a + of_b * ease_b)
                for x in range(3):
                    linear[a, x] += d * of_a * masses.inverse_mass[a] * n[x]
                    linear[b, x] -= d * of_b * masses.inverse_mass[b] * n[x]
                    angular[a, x] += d * of_a * contacts.turn_a[k, 0, x]
                    angular[b, x] -= d * of_b * contacts.turn_b[k, 0, x]
                done = False
        if done:
            break


@kernel
def unsqueeze(
    geometry: Geometry, dynamics: Dynamics, poses: Poses, velocities: Velocities, pairs: Index, memory: Memory
) -> float:
    """Push overlapping simulated bodies out of each other and of the others; returns the smallest gap left [m]."""
    linear, angular = memory.linear_end, memory.angular_end
    worst = 0.0
    for k in range(PASSES + 1):
        _, worst = find_contacts(geometry, dynamics, poses, velocities, pairs, memory)
        if not (worst < GOOD) or k == PASSES:
            break
        weigh(memory.contacts, memory.hold)
        displace(memory.contacts, memory.hold, k >= WEIGHED, linear, angular)
        for b in range(memory.moving.shape[0]):
            d, turn = row(linear, b), row(angular, b)
            if memory.moving[b] == 1 and dot(d, d) + dot(turn, turn) > 0.0:
                put_row(poses.position, b, add(row(poses.position, b), d))
                # a step of a radian is no first-order step
                small = min(1.0, 0.1 / max(norm(turn), 1e-300))
                put_columns(poses.rotation, b, spun(columns(poses.rotation, b), turn, small))
                place(geometry, poses, b)
                to_world(dynamics.inverse_inertia, poses.rotation, b, memory.hold.inverse_inertia)
                put_row(memory.trial.position, b, row(poses.position, b))
                put_columns(memory.trial.rotation, b, columns(poses.rotation, b))
                place(geometry, memory.trial, b)
    for b in range(memory.moving.shape[0]):
        # for bodies at rest these rows hold their velocities again, which contacts read
        put_row(linear, b, row(velocities.linear, b))
        put_row(angular, b, row(velocities.angular, b))
    return worst
