"""The unit that an engine counts lengths in, from the size of the moving bodies of a scene."""

import math

import numpy as np

from avatarsim.scene.avatar import Link
from avatarsim.scene.body import Body, Role
from avatarsim.scene.scene import Scene
from avatarsim.scene.shape import Box, Capsule, Ellipsoid, Shape, Sphere

THOUSAND = 1e3
"""Ratio of one unit to the next: kilometres, metres, millimetres."""


def length_unit(scene: Scene) -> float:
    """Return the power of a thousand nearest to the largest piece of the moving bodies [m]; 1 where nothing moves."""
    owners: tuple[Body | Link, ...] = (*scene.bodies, *scene.links)
    moving = [owner for owner, role in zip(owners, scene.roles, strict=True) if role is not Role.FIXED]
    sizes = [_size(piece.shape) for owner in moving for piece in owner.pieces]
    return THOUSAND ** round(math.log(max(sizes), THOUSAND)) if sizes else 1.0


def _size(shape: Shape) -> float:
    if isinstance(shape, Sphere):
        return 2.0 * shape.radius
    if isinstance(shape, Capsule):
        return 2.0 * shape.radius + shape.length
    if isinstance(shape, Box):
        return max(shape.size)
    return 2.0 * max(shape.radii) if isinstance(shape, Ellipsoid) else float(np.ptp(shape.vertices, axis=0).max())
