"""Convex bodies and contact laws drawn at random, and places at which the bodies do not overlap."""

from collections.abc import Sequence
from itertools import combinations_with_replacement

import numpy as np
from numpy.typing import NDArray

from avatarsim.scene.body import ContactLaw, Mass, PairTable, solid, volume
from avatarsim.scene.checks import Vector
from avatarsim.scene.shape import Capsule, Piece, Sphere
from scenarios.building.things import drawn_box, drawn_hull

Array = NDArray[np.float64]

SMALLEST, LARGEST = 0.02, 0.12
"""Sizes of bodies [m]: diameters of balls, edges of boxes, thickness and length of capsules, twice the reach of hulls."""
THICKEST = 0.08
"""Largest thickness of a capsule [m]."""
DENSITIES = (300.0, 3000.0)
"""Light wood to stone [kg/m^3]: the heaviest body of a scene weighs up to 1000 times as much as the lightest."""
FRICTIONS, RESTITUTIONS = (0.1, 0.9), (0.0, 0.5)
"""Ranges of the contact laws."""
THINGS = ("thing_a", "thing_b", "thing_c")
"""Materials of the bodies, one of which each is made of."""
FLOOR, HAND = "floor", "hand"
"""Material of everything fixed, and of hands."""
JITTER, LOW = 0.01, 0.02
"""Largest shift of a body from its place in the lattice along each axis, and height of the lowest layer above the floor [m]."""


def drawn_piece(random: np.random.Generator) -> Piece:
    """Return a hull, a box, a capsule or a ball."""
    kind, size = int(random.integers(4)), float(random.uniform(SMALLEST, LARGEST))
    if kind == 0:
        return drawn_hull(random, 0.5 * size)
    if kind == 1:
        return drawn_box(random, SMALLEST, LARGEST)
    if kind == 2:
        thick = float(random.uniform(SMALLEST, THICKEST))
        return Piece(Capsule(0.5 * thick, float(random.uniform(0.1, 1.0)) * (LARGEST - thick)))
    return Piece(Sphere(0.5 * size))


def of_density(piece: Piece, density: float) -> Mass:
    """Return the mass of a solid piece of `density` [kg/m^3]."""
    return solid((piece,), density * volume(piece.shape))


def drawn_table(random: np.random.Generator) -> PairTable:
    """Return a contact law for every pair of materials."""
    return PairTable({
        pair: ContactLaw(float(random.uniform(*RESTITUTIONS)), float(random.uniform(*FRICTIONS)))
        for pair in combinations_with_replacement((*THINGS, FLOOR, HAND), 2)
    })


def spacing(radii: Sequence[float]) -> float:
    """Return the distance [m] of neighbours in a layer of the lattice, such that balls of `radii` never touch."""
    return 2.0 * (max(radii) + JITTER)


def lattice(random: np.random.Generator, radii: Sequence[float], a_layer: int, hole: float = 0.0) -> list[Vector]:
    """Return places of balls of `radii` [m] about the z axis, `a_layer` of them at a height, each shifted at random.

    No ball comes nearer to another, or below LOW; with a `hole` [m] none comes that near to the z axis.
    """
    distance = spacing(radii)
    nearest = hole + 0.5 * distance * np.sqrt(2.0)
    side = int(np.ceil(np.sqrt(a_layer) + 2.0 * nearest / distance)) + 2
    grid = distance * (np.stack(np.meshgrid(np.arange(side), np.arange(side)), axis=-1).reshape(-1, 2) - 0.5 * (side - 1))
    away = np.linalg.norm(grid, axis=1)
    cells = grid[np.argsort(np.where(away < (nearest if hole else 0.0), np.inf, away), kind="stable")[:a_layer]]
    places: list[Vector] = []
    top = LOW
    for first in range(0, len(radii), a_layer):
        layer = radii[first : first + a_layer]
        half = max(layer) + JITTER
        middles = np.insert(random.permutation(cells)[: len(layer)], 2, top + half, axis=1)
        places += [(x, y, z) for x, y, z in (middles + random.uniform(-JITTER, JITTER, size=middles.shape)).tolist()]
        top += 2.0 * half
    return places
