"""Figure 1 of the paper: a finger of three hinges snips a ball over a table until it rolls off."""

import numpy as np

from avatarsim.scene.avatar import Avatar, Link
from avatarsim.scene.body import solid
from avatarsim.scene.joint import Free, Hinge, Hinges
from avatarsim.scene.scene import Scene
from avatarsim.scene.shape import Box, Capsule, Piece, Sphere
from avatarsim.scene.tracker import TrackerSample
from avatarsim.spatial import rotation
from scenarios.building.cases import fixture, loose, turned_by
from scenarios.building.promises import AVATAR
from scenarios.building.stage import above_floor, floor
from scenarios.motion.keyframes import Key
from scenarios.motion.rigid_hands import keyed
from scenarios.scenario import Bound, Scenario

FRAMES, SHORT = 300, 280
TOP, BALL = 0.75, 0.03
"""Height of the table's upper face, and radius of the ball [m]; the table's edge is at x = 0.5."""
BONES, RADIUS = (0.045, 0.028, 0.022), 0.008
"""Lengths of the finger's bones and its radius [m]."""
PALM = (0.09, 0.08, 0.028)
"""Edges of the hand [m], its frame in the knuckle at its front."""
BENT = float(np.radians(60.0))
"""Bend of each joint before it snaps [rad]."""
SNIPS = ((0.0, 0.02), (1.2, 0.14), (2.1, 0.26))
"""When a snip begins [s], and where the straight finger's tip gets along x [m]."""


def hand() -> Avatar:
    """Return a block for a palm and a finger along x, which bends downwards."""
    palm = (Piece(Box(PALM), (-0.5 * PALM[0] - RADIUS - 0.002, 0.0, 0.0)),)
    links, reached = [Link("palm", None, Free(), palm, solid(palm, 0.4))], 0.0
    for name, parent, bone in zip(("proximal", "middle", "distal"), ("palm", "proximal", "middle"), BONES, strict=True):
        bones = (Piece(Capsule(RADIUS, bone), (0.5 * bone, 0.0, 0.0), turned_by((0.0, 1.0, 0.0), np.pi / 2.0)),)
        bend = Hinges((Hinge((0.0, 1.0, 0.0), 0.0, 0.5 * np.pi),))
        links.append(Link(name, parent, bend, bones, solid(bones, 0.02), anchor=(reached, 0.0, 0.0)))
        reached = bone
    # a finger bent at both joints folds back to its own root
    return Avatar("hand", tuple(links), ("distal",), (("proximal", "distal"),))


def build() -> Scene:
    """Return floor, table, a ball on it and the hand behind the ball."""
    table = fixture("table", Box((1.0, 0.6, 0.05)), "wood", (0.0, 0.0, TOP - 0.5 * 0.05))
    ball = loose("ball", Sphere(BALL), "wood", 0.07, (0.1, 0.0, TOP + BALL + 1e-4))
    return Scene("ball_off_table", (floor(), table, ball), (hand(),), start=_at(SNIPS[0][1] - 0.05, 0.2))


def keys() -> list[Key]:
    """Return keys: bent, snap, stay a moment, bend again and move up to the next place."""
    keyframes: list[Key] = []
    for begin, tip in SNIPS:
        keyframes += [
            (begin + 0.4, _at(tip, BENT)), (begin + 0.5, _at(tip + 0.06, 0.0)), (begin + 0.7, _at(tip + 0.07, 0.05)),
            (begin + 0.85, _at(tip, BENT)),
        ]
    return [*keyframes, (3.4, _at(0.0, 0.3)), (FRAMES / 60.0, _at(-0.1, 0.3))]


def _at(tip: float, bend: float) -> TrackerSample:
    """Return the hand where its straight fingertip would be at x = `tip` [m], joints bent by `bend` [rad]."""
    positions = np.zeros((4, 3))
    positions[0] = (tip - sum(BONES) - RADIUS, 0.0, TOP + 0.048)
    return TrackerSample(0.0, positions, np.tile(rotation.IDENTITY, (4, 1)), np.array([0.5, 0.6, 0.4]) * bend)


SCENARIO = Scenario(
    "ball_off_table", "A finger snips a ball over a table until it rolls off.",
    "Overlap; the ball's path over the edge and down; limits of the finger.", build, keyed(keys(), FRAMES), FRAMES, SHORT,
    bounds=(*AVATAR, Bound("travel_missing", 0.0, "the ball has left the table: the floor beyond the edge is 0.8 m away")),
    expects={"travel": {"ball": 0.8}}, regions=(above_floor("ball", "hand/*"),),
)
