"""A humanoid follows recorded motion of pybullet_data: fifteen human clips in the gallery, three before obstacles, one sunken.

At 60 Hz, after half a second in which the user walks from a free posture into the clip's first one. Floor, furniture and walls
are not the user's, whose motion leads into them.
"""

from typing import NamedTuple

import numpy as np

from avatarsim.scene.body import Body
from avatarsim.scene.scene import Scene
from avatarsim.scene.shape import Box
from scenarios.building.cases import fixture
from scenarios.building.gallery import gallery, inside
from scenarios.building.promises import AVATAR
from scenarios.building.reach import reach
from scenarios.building.stage import above_floor, before_wall, floor, wall_ahead, with_human
from scenarios.motion.mocap import load_clip, placed, repeated, retimed, upper_body_of
from scenarios.motion.resampled import at_rate
from scenarios.motion.track import LEAD_IN, to_and_fro, track_of
from scenarios.scenario import Bound, Motion, Scenario

NEAR = 2.0
"""Distance [m] from where a clip begins beyond which exhibits of many pieces are left out: none is ever met there."""


class Played(NamedTuple):
    """A clip of `postures` at 60 Hz that begins at (x, y) [m] and faces `heading` [degrees] from the x axis."""

    clip: str
    postures: int
    x: float
    y: float
    heading: float
    what: str


STANDS = Bound("creep_mean", 0.1, "a foot that its user sets down stands: 0.1 m/s is up to where a link counts as still")

PLAYED = (
    Played("backflip", 106, 1.0, 0.8, 90.0, "a backflip"),
    Played("cartwheel", 163, 0.9, -1.0, 0.0, "a cartwheel"),
    Played("crawl", 176, 1.0, -0.6, 90.0, "crawling"),
    Played("dance_a", 97, 0.9, -0.6, 0.0, "a dance"),
    Played("dance_b", 152, 0.9, 0.4, 0.0, "another dance"),
    Played("getup_facedown", 182, 1.0, 0.0, 90.0, "getting up from face down"),
    Played("getup_faceup", 226, 1.0, 0.0, 90.0, "getting up from face up"),
    Played("jump", 106, 1.0, -0.5, 90.0, "a jump"),
    Played("kick", 92, 1.4, -0.4, 0.0, "a kick, beside a sculpture"),
    Played("punch", 128, 1.0, -0.8, 0.0, "punches, ending at a sculpture"),
    Played("roll", 121, 1.0, -0.5, 90.0, "a roll"),
    Played("run", 48, 0.6, -0.3, 90.0, "a run that ends at a wall"),
    Played("spin", 266, 0.9, -1.0, 0.0, "a spin"),
    Played("spinkick", 77, 1.5, -0.2, 0.0, "a spinning kick, beside a sculpture"),
    Played("walk", 76, -0.9, 0.25, 0.0, "a walk through the doorway, too near to one of its posts"),
)

GETUP_FRAMES = LEAD_IN + 2 * 182 - 1
"""The clip has 182 postures at 60 Hz; the lowest one is shown once."""
PUNCH_FACE = 1.43
"""Where the wall begins along x [m]: the fist reaches 1.73 m."""
WALK_FACE, WALK_FRAMES = 1.34, LEAD_IN + 4 * 75 + 1
"""Where the wall begins along x [m], and frames: the leading foot reaches 1.64 m; twice there and twice back."""
SUNKEN, SUNKEN_FRAMES = 0.05, LEAD_IN + 3 * 75 + 1
"""Depth [m] of the soles below the floor, and frames of three rounds."""
HUG = 170.0 / 60.0
"""Time in the clip "spin" at which the upper body starts [s]: the arms close round the hips and open again within the walk."""


def in_gallery(played: Played) -> Scenario:
    """Return the scene of a clip in the gallery without far exhibits."""
    at = played.x, played.y, float(np.radians(played.heading))

    def counts(body: Body) -> bool:
        """Return True for walls, floor and all bodies of one piece, and for others that are near."""
        away = np.hypot(body.position[0] - played.x, body.position[1] - played.y)
        return len(body.pieces) == 1 or bool(away < NEAR)

    def motion(scene: Scene, seed: int) -> Motion:
        track = track_of(placed(retimed(load_clip(played.clip)), *at), scene.avatars[0])
        return track.led_in(scene.first_sample).motion()

    return with_human(
        f"mocap_{played.clip}", f"Recorded motion in the gallery, as recorded: {played.what}.",
        "Overlap with floor, furniture and itself; limits; offset from the user; jumps.", motion,
        lambda: tuple(filter(counts, gallery())), at, frames=LEAD_IN + played.postures, region=inside("human/*"), family="mocap",
    )


def low_table() -> Body:
    """Return a table without legs, which head and hands of the clip pass."""
    return fixture("low_table", Box((0.6, 1.2, 0.05)), "wood", (0.4 + 0.5 * 0.6, 0.0, 0.3 - 0.5 * 0.05))


def getup(scene: Scene, seed: int) -> Motion:
    """Return a motion: half a second into the clip's last pose, then down and up again."""
    clip = track_of(retimed(load_clip("getup_facedown")), scene.avatars[0])
    return clip.backwards().there_and_back(GETUP_FRAMES - LEAD_IN).led_in(scene.first_sample).motion()


def walk(scene: Scene, seed: int) -> Motion:
    """Return a motion: the legs of one clip under the upper body of another: into the wall and back, twice."""
    return to_and_fro(upper_body_of(retimed(load_clip("spin")), HUG, retimed(load_clip("walk"))), scene, WALK_FRAMES)


def sunken_walk(scene: Scene, seed: int) -> Motion:
    """Return three rounds of a walk whose lowest points are SUNKEN below the floor: the user is taller than the avatar."""
    avatar = scene.avatars[0]
    track = track_of(placed(retimed(repeated(load_clip("walk"), 3)), 0.0, 0.0, 0.0), avatar)
    lowest = -reach((avatar,), [track.posture(k) for k in range(len(track))], (0.0, 0.0, -1.0))
    track.positions[:, 0, 2] -= SUNKEN + lowest.min()
    return track.led_in(scene.first_sample).motion()


PUNCH = with_human(
    "mocap_punch_wall", "A recorded punch is thrown again and again at a wall that stands 0.3 m inside its reach.",
    "Overlap with wall, floor and itself; the right side of the wall; limits; offset from the user; jumps.",
    lambda scene, seed: to_and_fro(load_clip("punch"), scene, 300), lambda: (floor(), wall_ahead(PUNCH_FACE)), frames=300,
    region=before_wall(PUNCH_FACE, "human/*"), family="mocap", everyday=True,
)

SCENARIOS = (
    *map(in_gallery, PLAYED), PUNCH, at_rate(PUNCH),
    with_human(
        "mocap_getup_floor", "A recorded getting up from face down, played backwards and forwards beside a low table.",
        "Overlap with floor, table and itself; nothing below the floor; limits; offset from the user; jumps.",
        getup, lambda: (floor(), low_table()), (-0.25,), frames=GETUP_FRAMES, region=above_floor("human/*"),
        family="mocap", everyday=True,
    ),
    with_human(
        "mocap_walk_wall", "A recorded walk, hands on the hips, leads 0.3 m into a wall and backwards out again, twice.",
        "Overlap with wall, floor and itself; the right side of the wall; limits; offset from the user; jumps.",
        walk, lambda: (floor(), wall_ahead(WALK_FACE)), frames=WALK_FRAMES, region=before_wall(WALK_FACE, "human/*"),
        family="mocap", everyday=True,
    ),
    with_human(
        "mocap_sunken_walk", "A recorded walk whose user is 5 cm taller than the avatar: each step leads into the floor.",
        "Feet that skid while their user's stand; overlap, limits, offset from the user.", sunken_walk,
        frames=SUNKEN_FRAMES, region=above_floor("human/*"), family="mocap", bounds=(*AVATAR, STANDS),
    ),
)
