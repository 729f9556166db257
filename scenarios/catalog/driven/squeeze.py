"""Squeezing: a driven hand presses a simulated box against a fixed wall, further than there is room.

Fixed bodies never give way, driven ones first, simulated ones if they must. The user pushes the box along the floor until
it stands at the wall, presses on, 8 cm further within 0.3 s, moves about while pressing, lets go, and once more. In the end
the box stands at the wall and the hand in front of it: nothing is squeezed through, and nothing shoots out.

In the 150 frames of a quick comparison the raw motion is inside box in 107 of them (up to 0.12 m deep).
"""

import numpy as np

from avatarsim.scene.avatar import rigid_avatar
from avatarsim.scene.body import simulated, solid
from avatarsim.scene.scene import Scene
from avatarsim.scene.shape import Box, Piece
from avatarsim.scene.tracker import TrackerSample
from avatarsim.spatial import rotation
from scenarios.building.promises import FINITE, FOLLOWS_WHEN_FREE, MOVES, NO_OVERLAP, RIGHT_SIDE
from scenarios.building.stage import THICK, floor, wall_ahead
from scenarios.motion.keyframes import through
from scenarios.scenario import INFINITE, Bound, Motion, Region, Scenario

FRAMES, SHORT = 300, 150
EDGE, MASS = 0.2, 2.0
"""Edge [m] and mass [kg] of the box, which is of wood."""
HAND = (0.04, 0.12, 0.12)
"""Edges of the hand, a flat palm held upright [m]."""
HAND_MASS = 0.46
"""Mass of the hand [kg]."""
FACE, BOX_AT, GAP = 0.6, 0.35, 1e-4
"""Where the wall begins, where the box's middle is at first, along x, and its height over the floor [m]."""
PRESSED = 0.08
"""How far the user presses beyond where the box stands at the wall [m]."""
FIRST = 0.1
"""Where the hand begins [m]."""


def build() -> Scene:
    """Floor, wall, a box before it and a flat hand behind the box."""
    pieces, palm = (Piece(Box((EDGE, EDGE, EDGE))),), (Piece(Box(HAND)),)
    box = simulated("box", pieces, "wood", solid(pieces, MASS), (BOX_AT, 0.0, 0.5 * EDGE + GAP))
    hand = rigid_avatar("hand", palm, solid(palm, HAND_MASS))
    return Scene("squeeze", (floor(), wall_ahead(FACE), box), (hand,), start=_at(FIRST, 0.0))


def motion(scene: Scene, seed: int) -> Motion:
    """Push, press, move about, let go."""
    at_wall = FACE - EDGE - 0.5 * HAND[0]
    keys = [
        (0.8, _at(at_wall, 0.005)), (1.1, _at(at_wall + PRESSED, 0.0)), (1.5, _at(at_wall + 0.9 * PRESSED, -0.02)),
        (1.9, _at(at_wall - 0.05, 0.0)), (2.5, _at(FIRST, 0.0)), (3.2, _at(at_wall, 0.02)), (3.5, _at(at_wall + PRESSED, 0.03)),
        (3.8, _at(at_wall - 0.05, 0.0)), (5.0, _at(FIRST, 0.1)),
    ]
    return through(scene.first_sample, keys, FRAMES).motion()


def _at(x: float, y: float) -> TrackerSample:
    return TrackerSample(0.0, np.array([[x, y, 0.5 * EDGE]]), np.array([rotation.IDENTITY]), np.zeros(0))


SCENARIO = Scenario(
    name="squeeze",
    title="A driven hand presses a box against a wall, further than there is room.",
    judged="Overlap; that the box stays in the room and the hand on its side of it; where the box ends; energy.",
    build=build,
    motion=motion,
    frames=FRAMES,
    short=SHORT,
    bounds=(
        NO_OVERLAP, RIGHT_SIDE, FINITE, *MOVES, FOLLOWS_WHEN_FREE,
        Bound("travel_missing", 0.0, "the box is pushed to the wall, 15 cm; a hand that meets nothing leaves it where it is"),
    ),
    expects={"travel": {"box": FACE - 0.5 * EDGE - BOX_AT - 0.01}},
    regions=(
        Region(
            ("box",), (0.0, -0.5, 0.0), (FACE, 0.5, 2.0 * EDGE),
            "the box can be pushed to the wall, but neither through it, nor into the floor, nor thrown over the hand",
        ),
        Region(
            ("hand",), (-INFINITE, -INFINITE, -INFINITE), (FACE + 0.5 * THICK, INFINITE, INFINITE),
            "nothing goes through the wall; it cannot be walked round",
        ),
    ),
)
