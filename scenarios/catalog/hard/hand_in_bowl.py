"""A rigid hand of fifteen parts stirs in a bowl of thirteen pieces, pressed against its bottom and its side.

The user goes 3 cm into the bottom and, fingertips ahead, 4 cm into the side, which is less thick, all the way round.
"""

from math import cos, pi, sin

import numpy as np

from avatarsim.scene.body import Body
from avatarsim.scene.scene import Scene
from avatarsim.scene.shape import ConvexHull, Piece
from avatarsim.scene.tracker import TrackerSample
from scenarios.building.avatars.hand import rigid_hand
from scenarios.building.cases import fixture
from scenarios.building.promises import HAND
from scenarios.motion.keyframes import Key
from scenarios.motion.rigid_hands import keyed, turned_hand
from scenarios.scenario import INFINITE, Region, Scenario

FRAMES, SIDES = 240, 12
"""Frames, and straight pieces of the side."""
FOOT, RIM, THICK, DEEP = 0.22, 0.30, 0.03, 0.25
"""Inner radius at the bottom and at the rim, thickness of bottom and side, and depth to the bottom at z = 0 [m]."""
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
    return fixture("bowl", tuple(pieces), "wood")


def at(x: float, y: float, z: float, turn: float) -> TrackerSample:
    """The hand with its middle over (x, y), its fingers at the angle `turn` [rad]."""
    return turned_hand((x - MIDDLE * cos(turn), y - MIDDLE * sin(turn), z), turn)


def keys() -> list[Key]:
    """Down into the bottom, round along the side, up and out."""
    turns = [2.0 * pi * k / 6 for k in range(7)]
    return [
        (0.7, at(0.0, 0.0, -0.014, 0.0)), (1.0, at(0.02, 0.01, -0.014, 0.3)),
        *((1.4 + 0.3 * k, at(ROUND * cos(turn), ROUND * sin(turn), 0.05, turn)) for k, turn in enumerate(turns)),
        (3.5, at(0.0, 0.0, 0.12, 2.0 * pi)), (4.0, at(0.1, 0.0, DEEP + 0.15, 2.0 * pi)),
    ]


SCENARIO = Scenario(
    "hand_in_bowl", "A rigid hand stirs in a bowl, pressed into its bottom and its side.",
    "Overlap; that the hand stays on the inside; that it follows.",
    lambda: Scene("hand_in_bowl", (bowl(),), (rigid_hand(),), start=at(0.0, 0.0, DEEP + 0.15, 0.0)), keyed(keys(), FRAMES),
    FRAMES, bounds=HAND,
    regions=(Region(("hand",), (-RIM, -RIM, 0.0), (RIM, RIM, INFINITE), "the hand goes neither through side nor bottom"),),
)
