"""An articulated hand of 24 hinges closes on a duck that is fixed, and then on a mug that is not.

Both are non-convex: the duck comes in five convex pieces, the mug is a ring of boxes with a bottom and a handle. The user
closes all fingers far beyond the surface, twice on each. The mug may be pushed and fall, but neither be passed through nor shot
away.
"""

from functools import cache

import numpy as np

from avatarsim.scene.avatar import Avatar
from avatarsim.scene.body import Body
from avatarsim.scene.joint import Hinges
from avatarsim.scene.scene import Scene
from avatarsim.scene.shape import Box, Piece
from avatarsim.scene.tracker import TrackerSample, rest
from avatarsim.spatial import rotation
from scenarios.building.avatars.shadow_hand import bends_finger, shadow_hand
from scenarios.building.cases import fixture, loose, slab, turned_by
from scenarios.building.gallery import convex_pieces
from scenarios.building.promises import AVATAR
from scenarios.data_folder import data_file
from scenarios.motion.keyframes import Key, through
from scenarios.scenario import Motion, Region, Scenario

FRAMES, SHORT = 600, 420
"""Two closings on each object, and two on the duck with one on the mug."""
SIDEWAYS = rotation.from_matrix(np.array([[0.0, 0.0, 1.0], [0.0, -1.0, 0.0], [1.0, 0.0, 0.0]]))
"""Turns fingers that point along z to point along x, the thumb up, the palm towards +y."""
RADIUS, WALL, HEIGHT, STAVES = 0.035, 0.006, 0.09, 8
"""Middle radius, thickness and height of the mug [m], and boxes that make its ring."""
MUG_AT, TOP = 0.6, 1.0
"""Place of the mug along x, and height of both pedestals' tops [m]; the duck is at the origin."""
REACH = (-0.365, -0.075)
"""Where the elbow is relative to a grasped object [m]: the fingers' roots just before it, the palm at its side."""
CLOSED, WRAP = 75.0, 25.0
"""Bend of the fingers' joints when closed, and of the thumb's [degrees]; around a mug 45 would do."""


@cache
def mug() -> Body:
    """Return a ring of boxes, a bottom and a handle: one body that hulls would fill."""
    staves, width = [], 2.0 * (RADIUS + 0.5 * WALL) * float(np.tan(np.pi / STAVES))
    for k in range(STAVES):
        angle = 2.0 * np.pi * k / STAVES
        at = (RADIUS * float(np.cos(angle)), RADIUS * float(np.sin(angle)), 0.5 * HEIGHT)
        staves.append(Piece(Box((WALL, width, HEIGHT)), at, turned_by((0.0, 0.0, 1.0), angle)))
    bottom = Piece(Box((1.4 * RADIUS, 1.4 * RADIUS, WALL)), (0.0, 0.0, 0.5 * WALL))
    handle = Piece(Box((0.03, 0.008, 0.05)), (RADIUS + 0.017, 0.0, 0.5 * HEIGHT))
    return loose("mug", (*staves, bottom, handle), "wood", 0.3, (MUG_AT, 0.0, TOP + 1e-4))


def build() -> Scene:
    """Return a floor, two pedestals with duck and mug, and an open hand behind the duck."""
    places = (("pedestal_duck", 0.0, 0.02, (0.04, 0.04, 0.3)), ("pedestal_mug", MUG_AT, 0.1, (0.1, 0.3, 0.02)))
    pedestals = (fixture(name, Box(size), "wood", (x, y, TOP - 0.5 * size[2])) for name, x, y, size in places)
    duck = fixture("duck", convex_pieces(data_file("duck_vhacd.obj"), 0.05, True), "wood", (0.0, 0.0, TOP))
    bodies = (slab(4.0, 4.0, "wood", x=0.5 * MUG_AT), *pedestals, duck, mug())
    return Scene("hand_grasp", bodies, (shadow_hand(),), start=_at(shadow_hand(), 0.0, -0.25, 0.0))


def motion(scene: Scene, seed: int) -> Motion:
    """Return a motion: next to the duck, close, open, close, open; across to the mug, and the same there."""
    hand, keys, time = scene.avatars[0], list[Key](), 0.0
    for x in (0.0, MUG_AT):
        for seconds, back, share in (
            (0.7, -0.25, 0.0), (0.5, 0.0, 0.0), (0.6, 0.0, 1.0), (0.5, 0.0, 0.9), (0.6, 0.0, 0.1),
            (0.5, 0.0, 1.0), (0.5, 0.0, 0.1), (0.5, -0.25, 0.0),
        ):
            time += seconds
            keys.append((time, _at(hand, x, back, share)))
    return through(scene.first_sample, keys, FRAMES).motion()


def _at(hand: Avatar, x: float, back: float, share: float) -> TrackerSample:
    """Return the hand at the object at `x` [m], `back` [m] to its side, closed by `share`."""
    base = rest((hand,))
    positions, rotations = base.positions.copy(), base.rotations.copy()
    positions[0], rotations[0] = (x + REACH[0], REACH[1] + back, TOP + 0.055), SIDEWAYS
    bends = [
        WRAP if link.name in ("thproximal", "thbase") else CLOSED if bends_finger(link) else 0.0
        for link in hand.links if isinstance(link.joint, Hinges)
    ]
    return TrackerSample(0.0, positions, rotations, base.angles + share * np.radians(bends))


SCENARIO = Scenario(
    "hand_grasp", "An articulated hand closes on a fixed duck and on a mug that can be moved.",
    "Overlap; limits; that the mug is neither squeezed through nor shot away.", build, motion, FRAMES, SHORT, bounds=AVATAR,
    expects={"grasped": ("mug",)},
    regions=(
        Region(("mug",), (MUG_AT - 0.5, -0.5, 0.0), (MUG_AT + 0.5, 0.5, TOP + 0.3),
               "fingers push a mug aside or off its pedestal at most; it is not shot away, nor goes through the floor"),
    ),
)
