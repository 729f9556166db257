"""Inverse masses and inverse inertia tensors of all bodies in world axes, at the present instant."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from avatarsim.jit.kernel import kernel
from avatarsim.jit.layout import Line, Matrices
from avatarsim.spatial.tangent import Columns, columns, turned
from avatarsim.spatial.vec3 import Vec3, cross

Array = NDArray[np.float64]


class Masses(NamedTuple):
    """inverse_mass (nb) [1/kg] and inverse_inertia (nb, 3, 3) in world axes; zero for bodies that do not yield."""

    inverse_mass: Line
    inverse_inertia: Matrices


@kernel
def is_diagonal(tensors: Array, b: int) -> bool:
    """Whether tensor b of (nb, 3, 3) is given along its principal axes: those of balls and boxes are."""
    upper = (tensors[b, 0, 1] == 0.0) & (tensors[b, 0, 2] == 0.0) & (tensors[b, 1, 2] == 0.0)
    return bool(upper & (tensors[b, 1, 0] == 0.0) & (tensors[b, 2, 0] == 0.0) & (tensors[b, 2, 1] == 0.0))


@kernel
def to_world(body_axes: Array, rotation: Array, b: int, world_out: Array) -> None:
    """world[b] = R M R^T for the tensor M of body b in its own axes; all arrays (nb, 3, 3)."""
    diagonal = is_diagonal(body_axes, b)
    for i in range(3):
        for k in range(i, 3):
            total = 0.0
            for x in range(3):
                if diagonal:
                    total += rotation[b, i, x] * body_axes[b, x, x] * rotation[b, k, x]
                else:
                    for y in range(3):
                        total += rotation[b, i, x] * body_axes[b, x, y] * rotation[b, k, y]
            world_out[b, i, k] = total
            world_out[b, k, i] = total


@kernel
def yielding(masses: Masses, b: int, arm: Vec3, j: Vec3) -> Vec3:
    """Change of velocity [m/s] of the point at ``arm`` of body b under the impulse j [N s] at that point."""
    m = masses.inverse_mass[b]
    inertia: Columns = columns(masses.inverse_inertia, b)
    w = cross(turned(inertia, cross(arm, j)), arm)
    return (m * j[0] + w[0], m * j[1] + w[1], m * j[2] + w[2])
