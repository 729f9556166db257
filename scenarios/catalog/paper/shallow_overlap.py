"""Figure 4 a of the paper: a "reasonable" overlap with a body of several pieces, not too deep, resolved by translation.

The rigid hand is dipped a centimetre into the two halves of a table, over their seam, and drawn along it. All ways out
point straight up, so eq. 1 must say up as well, and the hand may be no further from its user than it is deep inside.

In the 60 frames of a quick comparison the raw motion is inside table in 41 of them (up to 0.01 m deep).
"""

import numpy as np

from avatarsim.scene.body import fixed
from avatarsim.scene.scene import Scene
from avatarsim.scene.shape import Box, Piece
from avatarsim.scene.tracker import TrackerSample
from avatarsim.spatial import rotation
from scenarios.building.avatars.hand import rigid_hand
from scenarios.building.promises import FINITE, FOLLOWS_WHEN_FREE, MOVES, NO_OVERLAP, RIGHT_SIDE
from scenarios.building.reach import reach
from scenarios.motion.keyframes import through
from scenarios.scenario import INFINITE, Bound, Motion, Region, Scenario

FRAMES = 60
DEEP = 0.01
"""How far the user dips the hand into the table [m]."""
HALF = (0.6, 0.8, 0.1)
"""Edges of one half of the table [m]; they meet at x = 0, their tops at z = 0."""


def build() -> Scene:
    """A table of two pieces and a hand over it."""
    halves = tuple(Piece(Box(HALF), (side * 0.5 * HALF[0], 0.0, -0.5 * HALF[2])) for side in (-1.0, 1.0))
    return Scene("shallow_overlap", (fixed("table", halves, "wood"),), (rigid_hand(),), start=_at(-0.1, 0.05))


def motion(scene: Scene, seed: int) -> Motion:
    """Down, along over the seam, and up."""
    rests = float(reach(scene.avatars, (_at(0.0, 0.0),), (0.0, 0.0, -1.0))[0])
    keys = [(0.25, _at(-0.08, rests - DEEP)), (0.75, _at(0.08, rests - DEEP)), (1.0, _at(0.1, 0.05))]
    return through(scene.first_sample, keys, FRAMES).motion()


def _at(x: float, z: float) -> TrackerSample:
    return TrackerSample(0.0, np.array([[x, 0.0, z]]), np.array([rotation.IDENTITY]), np.zeros(0))


SCENARIO = Scenario(
    name="shallow_overlap",
    title="A rigid hand is dipped a centimetre into a table of two pieces and drawn along their seam.",
    judged="Overlap; that the way out is straight up, through none of the seams inside.",
    build=build,
    motion=motion,
    frames=FRAMES,
    bounds=(
        NO_OVERLAP, RIGHT_SIDE, FINITE, *MOVES, FOLLOWS_WHEN_FREE,
        Bound("tracker_offset_rms", DEEP, "straight up is the shortest way out, and it is at most as long as the hand is deep"),
    ),
    regions=(
        Region(("hand",), (-INFINITE, -INFINITE, 0.0), (INFINITE, INFINITE, INFINITE), "no part of the hand is that deep"),
    ),
)
