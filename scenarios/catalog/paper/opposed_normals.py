"""Figure 4 b of the paper: the pathological case, in which the two normals cancel each other out.

A driven ball is pressed into a slot between two plates that is narrower than the ball, from above and in the middle, then
off it to either side. Penetration depths of the plates are equal and opposite there, so their weighted sum is nothing.
The ball must come to rest on the rims: with radius r and half width h, at a height of sqrt(r^2 - h^2) over them.

In the 150 frames of a quick comparison the raw motion is inside slot in 129 of them (up to 0.07 m deep).
"""

import numpy as np

from avatarsim.scene.avatar import rigid_avatar
from avatarsim.scene.body import fixed, solid
from avatarsim.scene.scene import Scene
from avatarsim.scene.shape import Box, Piece, Sphere
from avatarsim.scene.tracker import TrackerSample
from avatarsim.spatial import rotation
from scenarios.building.promises import FINITE, FOLLOWS_WHEN_FREE, MOVES, NO_OVERLAP, RIGHT_SIDE
from scenarios.motion.keyframes import through
from scenarios.scenario import INFINITE, Motion, Region, Scenario

FRAMES = 150
RADIUS, HALF_WIDTH = 0.1, 0.09
"""Radius of the ball and half the width of the slot [m]."""
PLATE = (1.0, 2.0, 2.0)
"""Edges of a plate [m]; their tops are at z = 0."""
DEEP = 0.15
"""How far below the rims the ball's centre is driven [m]."""


def build() -> Scene:
    """Two plates, one body, and a ball over the slot between them."""
    plates = tuple(
        Piece(Box(PLATE), (side * (0.5 * PLATE[0] + HALF_WIDTH), 0.0, -0.5 * PLATE[2])) for side in (-1.0, 1.0)
    )
    pieces = (Piece(Sphere(RADIUS)),)
    hand = rigid_avatar("hand", pieces, solid(pieces, 0.5))
    return Scene("opposed_normals", (fixed("slot", plates, "wood"),), (hand,), start=_at(0.0, 0.0, 0.2))


def motion(scene: Scene, seed: int) -> Motion:
    """Straight down the middle, along the slot, off the middle to both sides, along, and up."""
    keys = [
        (0.3, _at(0.0, 0.05, -DEEP)), (0.9, _at(0.0, 0.3, -DEEP)), (1.3, _at(0.06, 0.2, -DEEP)),
        (1.7, _at(-0.06, 0.1, -DEEP)), (2.1, _at(0.0, 0.0, -0.5 * DEEP)), (2.5, _at(0.0, 0.1, 0.2)),
    ]
    return through(scene.first_sample, keys, FRAMES).motion()


def _at(x: float, y: float, z: float) -> TrackerSample:
    return TrackerSample(0.0, np.array([[x, y, z]]), np.array([rotation.IDENTITY]), np.zeros(0))


SCENARIO = Scenario(
    name="opposed_normals",
    title="A driven ball is pressed into a slot narrower than itself, where the normals of both sides cancel.",
    judged="Overlap; that the ball rests on the rims and does not go through between them.",
    build=build,
    motion=motion,
    frames=FRAMES,
    bounds=(NO_OVERLAP, RIGHT_SIDE, FINITE, *MOVES, FOLLOWS_WHEN_FREE),
    regions=(
        Region(
            ("hand",), (-INFINITE, -INFINITE, 0.0), (INFINITE, INFINITE, INFINITE),
            "the ball is wider than the slot: it cannot be between the plates",
        ),
    ),
)
