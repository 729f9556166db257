"""A non-convex bowl: a rigid hand of fifteen parts stirs in a bowl of thirteen pieces, pressed against its bottom and its side.

The bowl is hollow: nothing in it can be reached without passing its rim, and from inside there is no way through its wall. The
user goes 3 cm into the bottom and, fingertips ahead, 4 cm into the side, which is less thick, all the way round.

In the 240 frames of a quick comparison the raw motion is inside bowl in 163 of them (up to 0.03 m deep).
"""

from math import cos, pi, sin

import numpy as np

from avatarsim.scene.body import Body, fixed
from avatarsim.scene.scene import Scene
from avatarsim.scene.shape import ConvexHull, Piece
from avatarsim.scene.tracker import TrackerSample
from avatarsim.spatial import rotation
from scenarios.building.avatars.hand import rigid_hand
from scenarios.building.promises import FINITE, FOLLOWS_WHEN_FREE, MOVES, NO_OVERLAP, RIGHT_SIDE
from scenarios.motion.keyframes import through
from scenarios.scenario import INFINITE, Motion, Region, Scenario

FRAMES = 240
SIDES = 12
"""Pieces of the side, straight ones."""
FOOT, RIM, THICK = 0.22, 0.30, 0.03
"""Inner radius at the bottom and at the rim, thickness of bottom and side [m]."""
DEEP = 0.25
"""From the rim to the bottom [m], whose upper face is z = 0."""
MIDDLE = 0.047
"""How far behind the middle between wrist and fingertips the hand's origin lies [m]."""
ROUND = 0.176
"""How far the hand's middle goes round from the bowl's [m]: fingertips ahead, 4 cm into the side."""


def bowl() -> Body:
    """The bottom, and twelve flat segments that lean outwards."""
    around = [2.0 * pi * k / SIDES for k in range(SIDES + 1)]
    bottom = [[(FOOT + THICK) * cos(a), (FOOT + THICK) * sin(a), z] for a in around[:-1] for z in (-THICK, 0.0)]
    pieces = [Piece(ConvexHull(np.array(bottom)))]
    for a, b in zip(around[:-1], around[1:], strict=True):
        ends = [(FOOT, 0.0), (FOOT + THICK, 0.0), (RIM, DEEP), (RIM + THICK, DEEP)]
        pieces.append(Piece(ConvexHull(np.array([[r * cos(t), r * sin(t), z] for t in (a, b) for r, z in ends]))))
    return fixed("bowl", tuple(pieces), "wood")


def build() -> Scene:
    """The bowl, and a hand over it."""
    return Scene("hand_in_bowl", (bowl(),), (rigid_hand(),), start=_at(0.0, 0.0, DEEP + 0.15, 0.0))


def motion(scene: Scene, seed: int) -> Motion:
    """Down into the bottom, round along the side, up and out."""
    keys = [(0.7, _at(0.0, 0.0, -0.014, 0.0)), (1.0, _at(0.02, 0.01, -0.014, 0.3))]
    for k in range(7):
        turn = 2.0 * pi * k / 6
        keys.append((1.4 + 0.3 * k, _at(ROUND * cos(turn), ROUND * sin(turn), 0.05, turn)))
    keys += [(3.5, _at(0.0, 0.0, 0.12, 2.0 * pi)), (4.0, _at(0.1, 0.0, DEEP + 0.15, 2.0 * pi))]
    return through(scene.first_sample, keys, FRAMES).motion()


def _at(x: float, y: float, z: float, turn: float) -> TrackerSample:
    """The hand with its middle over (x, y), its fingers at the angle `turn` [rad]."""
    place = np.array([[x - MIDDLE * cos(turn), y - MIDDLE * sin(turn), z]])
    return TrackerSample(0.0, place, rotation.from_axis_angle((0.0, 0.0, 1.0), turn)[None, :], np.zeros(0))


SCENARIO = Scenario(
    name="hand_in_bowl",
    title="A rigid hand stirs in a bowl, pressed into its bottom and its side.",
    judged="Overlap; that the hand stays on the inside; that it follows.",
    build=build,
    motion=motion,
    frames=FRAMES,
    bounds=(NO_OVERLAP, RIGHT_SIDE, FINITE, *MOVES, FOLLOWS_WHEN_FREE),
    regions=(
        Region(("hand",), (-RIM, -RIM, 0.0), (RIM, RIM, INFINITE), "the hand goes neither through the side nor the bottom"),
    ),
)
