"""A driven ball is led ten centimetres into a wall, held there, slid along it, and led back: one track for all engines.

The simplest question that can be put to an engine that follows a tracker. What a spring, a weld or a servo leaves here is
known: 2 to 50 mm.

In the 180 frames of a quick comparison the raw motion is inside wall in 111 of them (up to 0.1 m deep).
"""

import numpy as np

from avatarsim.scene.avatar import rigid_avatar
from avatarsim.scene.body import solid
from avatarsim.scene.scene import Scene
from avatarsim.scene.shape import Piece, Sphere
from avatarsim.scene.tracker import TrackerSample
from avatarsim.spatial import rotation
from scenarios.building.promises import FINITE, FOLLOWS_WHEN_FREE, MOVES, NO_OVERLAP, RIGHT_SIDE
from scenarios.building.stage import HIGH, THICK, wall_ahead
from scenarios.motion.keyframes import through
from scenarios.scenario import INFINITE, Motion, Region, Scenario

FRAMES = 180
RADIUS, MASS = 0.05, 0.46
"""Radius [m] and mass [kg] of the ball: a hand's."""
FACE = 0.3
"""Where the wall begins along x [m]."""
DEEP = 0.1
"""How far the ball is led into the wall [m]."""
UP = 0.5 * HIGH


def build() -> Scene:
    """A wall and a driven ball before it."""
    pieces = (Piece(Sphere(RADIUS)),)
    hand = rigid_avatar("hand", pieces, solid(pieces, MASS))
    return Scene("driven_10cm_wall", (wall_ahead(FACE),), (hand,), start=_at(0.0, 0.0))


def motion(scene: Scene, seed: int) -> Motion:
    """In, along, and out again."""
    inside = FACE - RADIUS + DEEP
    # never straight in: to motion along the normal alone standing still is the right answer
    keys = [(0.6, _at(inside, 0.1)), (1.0, _at(inside, 0.2)), (2.0, _at(inside, 0.6)), (2.6, _at(0.0, 0.5)), (3.0, _at(0.0, 0.3))]
    return through(scene.first_sample, keys, FRAMES).motion()


def _at(x: float, y: float) -> TrackerSample:
    return TrackerSample(0.0, np.array([[x, y, UP]]), np.array([rotation.IDENTITY]), np.zeros(0))


SCENARIO = Scenario(
    name="driven_10cm_wall",
    title="A driven ball is led ten centimetres into a wall, along it, and back.",
    judged="Overlap while it is held, offset once the way is free.",
    build=build,
    motion=motion,
    frames=FRAMES,
    bounds=(NO_OVERLAP, RIGHT_SIDE, FINITE, *MOVES, FOLLOWS_WHEN_FREE),
    regions=(
        Region(
            ("hand",), (-INFINITE, -INFINITE, -INFINITE), (FACE + 0.5 * THICK, INFINITE, INFINITE),
            "nothing goes through the wall; it cannot be walked round",
        ),
    ),
)
