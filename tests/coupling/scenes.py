"""Floors, cubes and fists for the tests of bodies that hands hold, push and carry."""

import numpy as np

from avatarsim.engine import FrameRecord
from avatarsim.scene.avatar import Avatar, rigid_avatar
from avatarsim.scene.body import Body, ContactLaw, PairTable, fixed, simulated, solid
from avatarsim.scene.checks import Vector
from avatarsim.scene.scene import Scene
from avatarsim.scene.shape import Box, Piece, Sphere
from reference.judging.judge import Judge

LAW = PairTable({("m", "m"): ContactLaw(0.0, 0.6)})
FLOOR = fixed("floor", (Piece(Box((6.0, 6.0, 0.1))),), "m", (0.0, 0.0, -0.05))
FIST = (Piece(Sphere(0.05)),)


def cube(mass: float, place: Vector = (0.0, 0.0, 0.05), name: str = "cube", size: float = 0.1) -> Body:
    """Return a cube, of 10 cm by default."""
    pieces = (Piece(Box((size, size, size))),)
    return simulated(name, pieces, "m", solid(pieces, mass), place)


def fist(name: str = "fist") -> Avatar:
    """Return a rigid hand: a ball of 10 cm and 0.5 kg."""
    return rigid_avatar(name, FIST, solid(FIST, 0.5), "m")


def deepest(scene: Scene, records: list[FrameRecord]) -> float:
    """Return the largest overlap [m] by the judge."""
    positions = np.array([one.shown.positions for one in records])
    return Judge(scene).deepest(positions, np.array([one.shown.orientations for one in records]))
