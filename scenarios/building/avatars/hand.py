"""The paper's rigid hand: fifteen elliptical parts of a hundred triangles each, moved as one body.

Lengths are those of an adult hand of 0.19 m: flat, palm down, fingers along x, thumb of the left hand towards -y, z up.
"""

from dataclasses import dataclass

import numpy as np

from avatarsim.scene.avatar import Avatar
from avatarsim.scene.checks import Vector
from avatarsim.scene.shape import Piece, ellipsoid_hull
from scenarios.building.cases import driven, turned_by

MASS = 0.46
"""Mass of the hand [kg]: 0.61 per cent of a body of 75 kg (de Leva 1996)."""
PALM: Vector = (0.052, 0.044, 0.016)
"""Semi-axes of the palm [m], its centre at the origin of the hand."""
OVERREACH = 1.15
"""Length of a part over that of its bone, so that neighbours run into each other and no gap stays between."""


@dataclass(frozen=True)
class Digit:
    """Where a finger begins [m], where it points, its half thickness [m] and the lengths of its bones [m], root first."""

    base: Vector
    bearing: float
    half_thickness: float
    bones: tuple[float, ...]


DIGITS = (
    Digit((0.010, -0.036, 0.0), -50.0, 0.0105, (0.038, 0.030)),
    Digit((0.038, -0.026, 0.0), -6.0, 0.0090, (0.042, 0.025, 0.020)),
    Digit((0.049, -0.009, 0.0), 0.0, 0.0092, (0.046, 0.029, 0.021)),
    Digit((0.046, 0.010, 0.0), 4.0, 0.0088, (0.042, 0.027, 0.021)),
    Digit((0.040, 0.027, 0.0), 10.0, 0.0078, (0.034, 0.020, 0.018)),
)
"""Thumb, index, middle, ring and little finger; bearings in degrees from x, in the plane of the palm."""


def hand_pieces() -> tuple[Piece, ...]:
    """Return the fifteen hulls, palm first, then thumb to little finger, each from its root outwards."""
    pieces = [Piece(ellipsoid_hull(PALM))]
    for digit in DIGITS:
        angle = float(np.radians(digit.bearing))
        along, turn = np.array([np.cos(angle), np.sin(angle), 0.0]), turned_by((0.0, 0.0, 1.0), angle)
        reached = 0.0
        for bone in digit.bones:
            x, y, z = (np.array(digit.base) + (reached + 0.5 * bone) * along).tolist()
            radii = (0.5 * bone * OVERREACH, digit.half_thickness, digit.half_thickness)
            pieces.append(Piece(ellipsoid_hull(radii), (x, y, z), turn))
            reached += bone
    return tuple(pieces)


def rigid_hand(name: str = "hand") -> Avatar:
    """Return a driven hand without joints: it is kept out of things by translation alone, as in the paper."""
    return driven(name, hand_pieces(), MASS)
