"""Things to fill a scene with: prisms, drawn hulls, boxes and capsules, and an open box of walls that holds them."""

import numpy as np
from numpy.typing import NDArray

from avatarsim.scene.body import Body, solid
from avatarsim.scene.checks import Quaternion, Vector
from avatarsim.scene.shape import Box, Capsule, ConvexHull, Piece
from avatarsim.spatial import rotation
from scenarios.building.cases import fixture

Array = NDArray[np.float64]

CORNERS = 12
"""Directions in which a drawn hull has a corner: some four of them lie inside the others."""
def prism(sides: int, radius: float, height: float) -> Piece:
    """Return an upright prism of so many `sides` with its corners at `radius` [m]; the origin is its centre of mass."""
    angles = 2.0 * np.pi * np.arange(sides) / sides
    ring = radius * np.stack([np.cos(angles), np.sin(angles)], axis=1)
    return Piece(ConvexHull(np.vstack([np.insert(ring, 2, z, axis=1) for z in (-0.5 * height, 0.5 * height)])))


COIN_THICK, COIN_MASS = 0.002, 0.007
COIN = prism(20, 0.012, COIN_THICK)
"""A coin, a prism of 20 sides [m, kg]."""


def disc(sides: int, radius: float, height: float) -> Piece:
    """Return a `prism` whose corners come one above another."""
    around = np.linspace(0.0, 2.0 * np.pi, sides, endpoint=False)
    rim = [(radius * np.cos(a), radius * np.sin(a), z) for a in around for z in (-0.5 * height, 0.5 * height)]
    return Piece(ConvexHull(np.array(rim)))


def drawn_hull(random: np.random.Generator, radius: float) -> Piece:
    """Return a hull of random corners at most `radius` [m] from the middle, along its principal axes about its centre of mass.

    Engines that know no other axes so have the body that is meant.
    """
    directions = random.normal(size=(CORNERS, 3))
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    corners = radius * random.uniform(0.6, 1.0, size=3) * directions
    mass = solid((Piece(ConvexHull(corners)),), 1.0)
    _, axes = np.linalg.eigh(mass.inertia)
    # a reflection would leave a mirror image: just as good a hull, and no turn
    return Piece(ConvexHull((corners - np.array(mass.centre)) @ axes))


def drawn_turn(random: np.random.Generator) -> Quaternion:
    """Return a random orientation, all equally likely."""
    w, x, y, z = rotation.normalised(random.normal(size=4)).tolist()
    return w, x, y, z


def drawn_box(random: np.random.Generator, least: float, most: float) -> Piece:
    """Return a box of three random edges [m]."""
    x, y, z = random.uniform(least, most, size=3).tolist()
    return Piece(Box((x, y, z)))


def mixed(random: np.random.Generator, count: int) -> list[Piece]:
    """Return as many hulls as capsules and boxes, 3 to 9 cm across."""
    makers = (
        lambda: drawn_hull(random, 0.045), lambda: Piece(Capsule(0.018, 0.05)), lambda: drawn_box(random, 0.03, 0.07),
    )
    return [makers[k % len(makers)]() for k in range(count)]


def open_box(width: float, height: float, thick: float, material: str) -> tuple[Body, ...]:
    """Return a floor, with its origin in its top at z = 0, and four walls about a square of `width` [m], from "wall_0" on."""
    out = width + 2.0 * thick
    at = 0.5 * (width + thick)
    walls: tuple[tuple[Vector, Vector], ...] = (
        ((thick, out, height), (at, 0.0, 0.5 * height)), ((thick, out, height), (-at, 0.0, 0.5 * height)),
        ((width, thick, height), (0.0, at, 0.5 * height)), ((width, thick, height), (0.0, -at, 0.5 * height)),
    )
    floor = fixture("floor", Piece(Box((out, out, 0.1)), (0.0, 0.0, -0.05)), material)
    return (floor, *(fixture(f"wall_{k}", Box(size), material, place) for k, (size, place) in enumerate(walls)))
