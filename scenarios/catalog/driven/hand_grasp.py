"""An articulated hand of 24 hinges closes on a duck that is fixed, and then on a mug that is not.

Both objects are non-convex: the duck comes in five convex pieces, the mug is a ring of boxes with a bottom and a handle. The
user closes all fingers far beyond the object's surface, twice on each, as one does without feeling anything, and opens
them again. The mug stands on a narrow pedestal; it may be pushed, and fall to the floor, but neither be passed through nor shot
away.

In the 420 frames of a quick comparison the raw motion is inside duck in 98 of them (up to 0.026 m deep), inside mug
in 69 (0.023 m).
"""

from functools import cache

import numpy as np

from avatarsim.scene.avatar import Avatar
from avatarsim.scene.body import Body, fixed, simulated, solid
from avatarsim.scene.joint import Hinges
from avatarsim.scene.scene import Scene
from avatarsim.scene.shape import Box, Piece
from avatarsim.scene.tracker import TrackerSample, rest
from avatarsim.spatial import rotation
from scenarios.building.avatars.shadow_hand import shadow_hand
from scenarios.building.obj_pieces import convex_pieces
from scenarios.building.promises import AVATAR
from scenarios.data_folder import data_file
from scenarios.motion.keyframes import Key, through
from scenarios.scenario import Motion, Region, Scenario

FRAMES, SHORT = 600, 420
"""Two closings on each object, and two on the duck with one on the mug."""
SIDEWAYS = rotation.from_matrix(np.array([[0.0, 0.0, 1.0], [0.0, -1.0, 0.0], [1.0, 0.0, 0.0]]))
"""Turns fingers that point along z to point along x, the thumb up, the palm towards +y."""
DUCK_SCALE = 0.05
"""Metres per unit of the duck's file: 9 cm tall."""
MUG_RADIUS, MUG_WALL, MUG_HEIGHT, MUG_MASS = 0.035, 0.006, 0.09, 0.3
"""Middle radius, thickness and height of the mug [m], and its mass [kg]."""
STAVES = 8
"""Boxes that make the mug's ring."""
MUG_AT = (0.6, 0.0)
"""Where the mug stands [m]; the duck sits at the origin, on a pedestal of its own."""
TOP, GAP = 1.0, 1e-4
"""Height of the pedestals' tops, and of the objects over them at first [m]."""
REACH = (-0.365, -0.075)
"""Where the elbow is against an object that is grasped [m]: the fingers' roots just before it, the palm beside it."""
CLOSED, WRAP = 75.0, 25.0
"""How far the fingers' joints are bent when closed, and the thumb's [degrees]; around a mug 45 would do."""


@cache
def mug() -> Body:
    """A ring of boxes, a bottom and a handle: one body that hulls would fill."""
    staves = []
    width = 2.0 * (MUG_RADIUS + 0.5 * MUG_WALL) * float(np.tan(np.pi / STAVES))
    for k in range(STAVES):
        angle = 2.0 * np.pi * k / STAVES
        w, x, y, z = (float(value) for value in rotation.from_axis_angle((0.0, 0.0, 1.0), angle))
        at = (MUG_RADIUS * float(np.cos(angle)), MUG_RADIUS * float(np.sin(angle)), 0.5 * MUG_HEIGHT)
        staves.append(Piece(Box((MUG_WALL, width, MUG_HEIGHT)), at, (w, x, y, z)))
    bottom = Piece(Box((1.4 * MUG_RADIUS, 1.4 * MUG_RADIUS, MUG_WALL)), (0.0, 0.0, 0.5 * MUG_WALL))
    handle = Piece(Box((0.03, 0.008, 0.05)), (MUG_RADIUS + 0.017, 0.0, 0.5 * MUG_HEIGHT))
    pieces = (*staves, bottom, handle)
    return simulated("mug", pieces, "wood", solid(pieces, MUG_MASS), (*MUG_AT, TOP + GAP))


def build() -> Scene:
    """A floor, two pedestals with duck and mug, and an open hand behind the duck."""
    floor = fixed("floor", (Piece(Box((4.0, 4.0, 0.2))),), "wood", (0.5 * MUG_AT[0], 0.0, -0.1))
    places = (("pedestal_duck", 0.0, 0.02, (0.04, 0.04, 0.3)), ("pedestal_mug", MUG_AT[0], 0.1, (0.1, 0.3, 0.02)))
    pedestals = tuple(
        fixed(name, (Piece(Box(size)),), "wood", (x, y, TOP - 0.5 * size[2])) for name, x, y, size in places
    )
    duck = fixed("duck", convex_pieces(data_file("duck_vhacd.obj"), DUCK_SCALE, True), "wood", (0.0, 0.0, TOP))
    return Scene("hand_grasp", (floor, *pedestals, duck, mug()), (shadow_hand(),), start=_at(shadow_hand(), 0.0, -0.25, 0.0))


def motion(scene: Scene, seed: int) -> Motion:
    """Beside the duck, close, open, close, open; across to the mug, and the same."""
    hand, keys = scene.avatars[0], list[Key]()
    time = 0.0
    for x in (0.0, MUG_AT[0]):
        for seconds, back, share in (
            (0.7, -0.25, 0.0), (0.5, 0.0, 0.0), (0.6, 0.0, 1.0), (0.5, 0.0, 0.9), (0.6, 0.0, 0.1),
            (0.5, 0.0, 1.0), (0.5, 0.0, 0.1), (0.5, -0.25, 0.0),
        ):
            time += seconds
            keys.append((time, _at(hand, x, back, share)))
    return through(scene.first_sample, keys, FRAMES).motion()


def _at(hand: Avatar, x: float, back: float, share: float) -> TrackerSample:
    """The hand at the object at `x` [m], `back` [m] to its side, closed by `share`."""
    base = rest((hand,))
    positions, rotations = base.positions.copy(), base.rotations.copy()
    positions[0] = (x + REACH[0], REACH[1] + back, TOP + 0.055)
    rotations[0] = SIDEWAYS
    bends = [
        WRAP if link.name in ("thproximal", "thbase") else CLOSED
        if link.name.endswith(("proximal", "middle", "distal")) and not link.name.startswith("th") else 0.0
        for link in hand.links if isinstance(link.joint, Hinges)
    ]
    return TrackerSample(0.0, positions, rotations, base.angles + share * np.radians(bends))


SCENARIO = Scenario(
    name="hand_grasp",
    title="An articulated hand closes on a fixed duck and on a mug that can be moved.",
    judged="Overlap; limits; that the mug is neither squeezed through nor shot away.",
    build=build,
    motion=motion,
    frames=FRAMES,
    short=SHORT,
    bounds=AVATAR,
    expects={"grasped": ("mug",)},
    regions=(
        Region(
            ("mug",), (MUG_AT[0] - 0.5, MUG_AT[1] - 0.5, 0.0), (MUG_AT[0] + 0.5, MUG_AT[1] + 0.5, TOP + 0.3),
            "a mug that fingers close on is pushed aside or off its pedestal at most, not shot away, nor through the floor",
        ),
    ),
)
