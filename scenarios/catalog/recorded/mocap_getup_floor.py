"""A recorded getting up from face down, first backwards so that the user lies down, beside a low table.

Real motion: the clip "getup_facedown" (3.0 s), at 60 Hz. Floor and table are where the user's are not.
The raw motion is inside the floor in 314 of 393 frames (deepest 0.062 m), inside the table in 111 (0.13 m) and inside
itself in 22 (0.019 m: one foot in the other).
"""

from avatarsim.scene.body import Body, fixed
from avatarsim.scene.scene import Scene
from avatarsim.scene.shape import Box, Piece
from scenarios.building.avatars.humanoid import humanoid
from scenarios.building.avatars.standing import standing
from scenarios.building.promises import AVATAR
from scenarios.building.stage import above_floor, floor
from scenarios.motion.mocap import load_clip, retimed
from scenarios.motion.track import LEAD_IN, track_of
from scenarios.scenario import Motion, Scenario

TABLE = (0.6, 1.2, 0.05)
"""Edges of the table's top [m]."""
TABLE_EDGE = 0.4
"""Where the table begins along x [m]: head and hands of the clip pass there."""
TABLE_HEIGHT = 0.3
"""Upper face of the table [m]."""
STANDS_AT = -0.25
"""Where the clip ends upright, along x [m]."""
FRAMES = LEAD_IN + 2 * 182 - 1
"""The clip has 182 postures at 60 Hz; the lowest one is shown once."""


def low_table() -> Body:
    """A table without legs: what is judged is the top, from above, from below and at the edge."""
    at = (TABLE_EDGE + 0.5 * TABLE[0], 0.0, TABLE_HEIGHT - 0.5 * TABLE[2])
    return fixed("low_table", (Piece(Box(TABLE)),), "wood", at)


def build() -> Scene:
    """The humanoid stands on the floor, the low table in front of it."""
    human = humanoid()
    start = standing(human, x=STANDS_AT)
    return Scene("mocap_getup_floor", (floor(), low_table()), (human,), start=start)


def motion(scene: Scene, seed: int) -> Motion:
    """Half a second into the clip's last pose, then down and up again."""
    clip = track_of(retimed(load_clip("getup_facedown")), scene.avatars[0])
    return clip.backwards().there_and_back(FRAMES - LEAD_IN).led_in(scene.first_sample).motion()


SCENARIO = Scenario(
    name="mocap_getup_floor",
    family="mocap",
    title="A recorded getting up from face down, played backwards and forwards beside a low table.",
    judged="Overlap with floor, table and itself; nothing below the floor; limits; offset from the user; jumps.",
    build=build,
    motion=motion,
    frames=FRAMES,
    bounds=AVATAR,
    regions=(above_floor("human/*"),),
    everyday=True,
)
