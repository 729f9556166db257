"""Figure 4 of the paper: a shallow overlap that translation resolves, and the pathological case in which two normals cancel.

a: a hand is dipped a centimetre into the two halves of a table and drawn along their seam; all ways out point straight up.
b: a ball is pressed into a slot narrower than itself; with radius r and half width h it comes to rest sqrt(r^2 - h^2) above the
rims.
"""

from avatarsim.scene.checks import Vector
from avatarsim.scene.scene import Scene
from avatarsim.scene.shape import Box, Piece, Sphere
from scenarios.building.avatars.hand import rigid_hand
from scenarios.building.cases import Solid, driven, fixture
from scenarios.building.promises import HAND
from scenarios.building.reach import reach
from scenarios.building.scenes import above
from scenarios.motion.rigid_hands import hands_at, led_through
from scenarios.scenario import Bound, Motion, Scenario

DIP = 0.01
"""Depth to which the user dips the hand into the table [m]."""
RADIUS, HALF_WIDTH, DEEP = 0.1, 0.09, 0.15
"""Radius of the ball, half the width of the slot, and how far below the rims the ball's centre is driven [m]."""


def two_boxes(size: Vector, apart: float) -> Solid:
    """Return two boxes side by side along x, their upper faces at z = 0."""
    return tuple(Piece(Box(size), (side * (0.5 * size[0] + apart), 0.0, -0.5 * size[2])) for side in (-1.0, 1.0))


def dip(scene: Scene, seed: int) -> Motion:
    """Return a motion down, along over the seam, and up."""
    z = float(reach(scene.avatars, (hands_at(((0.0, 0.0, 0.0),)),), (0.0, 0.0, -1.0))[0]) - DIP
    return led_through(((0.25, (-0.08, 0.0, z)), (0.75, (0.08, 0.0, z)), (1.0, (0.1, 0.0, 0.05))), 60)(scene, seed)


SCENARIOS = (
    Scenario(
        "shallow_overlap", "A rigid hand is dipped a centimetre into a table of two pieces and drawn along their seam.",
        "Overlap; that the way out is straight up, through none of the seams inside.",
        lambda: Scene("shallow_overlap", (fixture("table", two_boxes((0.6, 0.8, 0.1), 0.0), "wood"),), (rigid_hand(),),
                      start=hands_at(((-0.1, 0.0, 0.05),))),
        dip, 60,
        bounds=(*HAND, Bound("tracker_offset_rms", DIP, "the shortest way out is straight up, as long as the hand is deep")),
        regions=(above(0.0, "hand", reason="no part of the hand is that deep"),),
    ),
    Scenario(
        "opposed_normals", "A driven ball is pressed into a slot narrower than itself, where the normals of both sides cancel.",
        "Overlap; that the ball rests on the rims and does not go through between them.",
        lambda: Scene("opposed_normals", (fixture("slot", two_boxes((1.0, 2.0, 2.0), HALF_WIDTH), "wood"),),
                      (driven("hand", Sphere(RADIUS), 0.5),), start=hands_at(((0.0, 0.0, 0.2),))),
        # straight down the middle, along the slot, off the middle to both sides, along, and up
        led_through((
            (0.3, (0.0, 0.05, -DEEP)), (0.9, (0.0, 0.3, -DEEP)), (1.3, (0.06, 0.2, -DEEP)), (1.7, (-0.06, 0.1, -DEEP)),
            (2.1, (0.0, 0.0, -0.5 * DEEP)), (2.5, (0.0, 0.1, 0.2)),
        ), 150),
        150, bounds=HAND,
        regions=(above(0.0, "hand", reason="the ball is wider than the slot: it cannot be between the plates"),),
    ),
)
