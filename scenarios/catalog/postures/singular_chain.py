"""A straight chain whose goal lies on its own axis: the fixed point of cyclic coordinate descent.

An arm of three hinges, anchored to the world, is stretched by its user straight at a wall, along the wall's normal. To give
way it has to fold, but every hinge sees its goal and its tip in one line, and no first-order step says which way to turn.
The user comes from a fold to one side, then from the other, and sways through the straight posture while stretched.

In the 240 frames of a quick comparison the raw motion is inside wall in 140 of them (up to 0.08 m deep).
"""

import numpy as np

from avatarsim.scene.avatar import Avatar, Link
from avatarsim.scene.body import solid
from avatarsim.scene.joint import Hinge, Hinges
from avatarsim.scene.scene import Scene
from avatarsim.scene.shape import Capsule, Piece
from avatarsim.scene.tracker import TrackerSample
from avatarsim.spatial import rotation
from scenarios.building.promises import AVATAR
from scenarios.building.stage import THICK, wall_ahead
from scenarios.motion.keyframes import Key, through
from scenarios.scenario import INFINITE, Motion, Region, Scenario

FRAMES, SHORT = 480, 240
LENGTH, RADIUS = 0.3, 0.04
"""Length of a link from joint to joint and its radius [m]."""
BEND = float(np.radians(150.0))
"""How far each hinge turns either way [rad]."""
DEEP = 0.12
"""How far the straight arm reaches into the wall [m]."""
FACE = 3.0 * LENGTH + RADIUS - DEEP
"""Where the wall begins along x [m]."""
UP = 1.5
"""Height of the arm [m]."""


def arm() -> Avatar:
    """Three capsules along x, one hinge about y each, the first one anchored to the world."""
    along = tuple(float(value) for value in rotation.from_axis_angle((0.0, 1.0, 0.0), np.pi / 2.0))
    w, x, y, z = along
    # shorter than the link by a radius at each end, so that folded neighbours of neighbours stay apart
    piece = (Piece(Capsule(RADIUS, LENGTH - 2.0 * RADIUS), (0.5 * LENGTH, 0.0, 0.0), (w, x, y, z)),)
    hinge = Hinges((Hinge((0.0, 1.0, 0.0), -BEND, BEND),))
    links = [Link("upper", None, hinge, piece, solid(piece, 2.0), anchor=(0.0, 0.0, UP))]
    for name, parent in (("fore", "upper"), ("hand", "fore")):
        links.append(Link(name, parent, hinge, piece, solid(piece, 1.0), anchor=(LENGTH, 0.0, 0.0)))
    return Avatar("arm", tuple(links), ("hand",))


def build() -> Scene:
    """The arm, folded to one side, before a wall."""
    return Scene("singular_chain", (wall_ahead(FACE),), (arm(),), start=_bent(60.0))


def motion(scene: Scene, seed: int) -> Motion:
    """Stretched from one side, swayed, let go to the other side, stretched again, and so on."""
    keys: list[Key] = []
    for k in range(FRAMES // 120):
        begin, side = 2.0 * k, 1.0 if k % 2 == 0 else -1.0
        keys += [
            (begin + 0.5, _bent(0.0)), (begin + 0.7, _bent(-side)), (begin + 0.9, _bent(side)),
            (begin + 1.1, _bent(0.0)), (begin + 1.6, _bent(-60.0 * side)), (begin + 2.0, _bent(-50.0 * side)),
        ]
    return through(scene.first_sample, keys, FRAMES).motion()


def _bent(degrees: float) -> TrackerSample:
    """Folded like a Z: the shoulder down, the elbow up, the wrist down, so that the hand stays near the middle."""
    angle = np.radians(degrees)
    return TrackerSample(0.0, np.zeros((3, 3)), np.tile(rotation.IDENTITY, (3, 1)), np.array([angle, -1.6 * angle, angle]))


SCENARIO = Scenario(
    name="singular_chain",
    title="A straight arm of three hinges is stretched at a wall along its own axis.",
    judged="Overlap; whether the arm finds a way to fold; jumps; that it is straight again once there is room.",
    build=build,
    motion=motion,
    frames=FRAMES,
    short=SHORT,
    bounds=AVATAR,
    regions=(
        Region(
            ("arm/*",), (-INFINITE, -INFINITE, -INFINITE), (FACE + 0.5 * THICK, INFINITE, INFINITE),
            "nothing goes through the wall; it cannot be walked round",
        ),
    ),
)
