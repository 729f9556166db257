"""Figure 1 of the paper: a ball is snipped over a table with a finger until it rolls off.

The finger has three hinges on a hand that is led by the user. It is bent, snaps straight within a tenth of a second behind
the ball, is led after it, and snips again; the ball rolls, reaches the edge and falls to the floor.

In the 240 frames of a quick comparison the raw motion is inside table in 128 of them (up to 0.03 m deep), inside ball
in 126 (0.038 m).
"""

import numpy as np

from avatarsim.scene.avatar import Avatar, Link
from avatarsim.scene.body import fixed, simulated, solid
from avatarsim.scene.joint import Free, Hinge, Hinges
from avatarsim.scene.scene import Scene
from avatarsim.scene.shape import Box, Capsule, Piece, Sphere
from avatarsim.scene.tracker import TrackerSample
from avatarsim.spatial import rotation
from scenarios.building.promises import FINITE, FOLLOWS_WHEN_FREE, MOVES, NO_OVERLAP, RIGHT_SIDE, WITHIN_LIMITS
from scenarios.building.stage import THICK, floor
from scenarios.motion.keyframes import Key, through
from scenarios.scenario import INFINITE, Bound, Motion, Region, Scenario

FRAMES, SHORT = 300, 240
TABLE, TOP = (1.0, 0.6, 0.05), 0.75
"""Edges of the table's top [m] and the height of its upper face."""
BALL_RADIUS, BALL_MASS, GAP = 0.03, 0.07, 1e-4
"""Radius [m] and mass [kg] of a wooden ball, and its height over the table at first [m]."""
BALL_X = 0.1
"""Where the ball lies along x [m]; the table's edge is at 0.5."""
BONES, RADIUS = (0.045, 0.028, 0.022), 0.008
"""Lengths of the finger's bones and its radius [m]."""
PALM = (0.09, 0.08, 0.028)
"""Edges of the hand [m], its frame in the knuckle at its front."""
BENT = float(np.radians(60.0))
"""Bend of each joint before it snaps [rad]."""
SNIPS = ((0.0, 0.02), (1.2, 0.14), (2.1, 0.26))
"""When a snip begins [s], and where the straight finger's tip gets along x [m]."""


def hand() -> Avatar:
    """A block for a palm and a finger along x, which bends downwards."""
    w, x, y, z = (float(value) for value in rotation.from_axis_angle((0.0, 1.0, 0.0), np.pi / 2.0))
    palm = (Piece(Box(PALM), (-0.5 * PALM[0] - RADIUS - 0.002, 0.0, 0.0)),)
    links = [Link("palm", None, Free(), palm, solid(palm, 0.4))]
    reached = 0.0
    for name, parent, bone in zip(("proximal", "middle", "distal"), ("palm", "proximal", "middle"), BONES, strict=True):
        bones = (Piece(Capsule(RADIUS, bone), (0.5 * bone, 0.0, 0.0), (w, x, y, z)),)
        bend = Hinges((Hinge((0.0, 1.0, 0.0), 0.0, 0.5 * np.pi),))
        links.append(Link(name, parent, bend, bones, solid(bones, 0.02), anchor=(reached, 0.0, 0.0)))
        reached = bone
    # a finger bent at both joints folds back to its own root
    return Avatar("hand", tuple(links), ("distal",), (("proximal", "distal"),))


def build() -> Scene:
    """Floor, table, a ball on it and the hand behind the ball."""
    ball = (Piece(Sphere(BALL_RADIUS)),)
    bodies = (
        floor(), fixed("table", (Piece(Box(TABLE)),), "wood", (0.0, 0.0, TOP - 0.5 * TABLE[2])),
        simulated("ball", ball, "wood", solid(ball, BALL_MASS), (BALL_X, 0.0, TOP + BALL_RADIUS + GAP)),
    )
    return Scene("ball_off_table", bodies, (hand(),), start=_at(SNIPS[0][1] - 0.05, 0.2))


def motion(scene: Scene, seed: int) -> Motion:
    """Bent, snap, stay a moment, bend again and move up to the next place."""
    keys: list[Key] = []
    for begin, tip in SNIPS:
        keys += [
            (begin + 0.4, _at(tip, BENT)), (begin + 0.5, _at(tip + 0.06, 0.0)), (begin + 0.7, _at(tip + 0.07, 0.05)),
            (begin + 0.85, _at(tip, BENT)),
        ]
    keys += [(3.4, _at(0.0, 0.3)), (FRAMES / 60.0, _at(-0.1, 0.3))]
    return through(scene.first_sample, keys, FRAMES).motion()


def _at(tip: float, bend: float) -> TrackerSample:
    """The hand where its straight fingertip would be at x = `tip` [m], joints bent by `bend` [rad]."""
    positions = np.zeros((4, 3))
    positions[0] = (tip - sum(BONES) - RADIUS, 0.0, TOP + 0.048)
    return TrackerSample(0.0, positions, np.tile(rotation.IDENTITY, (4, 1)), np.array([0.5, 0.6, 0.4]) * bend)


SCENARIO = Scenario(
    name="ball_off_table",
    title="A finger snips a ball over a table until it rolls off.",
    judged="Overlap; the ball's path over the edge and down; limits of the finger.",
    build=build,
    motion=motion,
    frames=FRAMES,
    short=SHORT,
    bounds=(
        NO_OVERLAP, RIGHT_SIDE, FINITE, WITHIN_LIMITS, *MOVES, FOLLOWS_WHEN_FREE,
        Bound("travel_missing", 0.0, "the ball has left the table: from where it lay the floor beyond the edge is 0.8 m away"),
    ),
    expects={"travel": {"ball": 0.8}},
    regions=(
        Region(
            ("ball", "hand/*"), (-INFINITE, -INFINITE, -0.5 * THICK), (INFINITE, INFINITE, INFINITE),
            "nothing sinks through the floor",
        ),
    ),
)
