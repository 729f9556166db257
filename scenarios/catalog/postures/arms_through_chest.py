"""Arms are swung straight through the chest, behind the back and out at the front, and through each other, and led back.

A user of another build, or a tracker that swaps two markers, does this. The arms must not stay tied.
"""

import numpy as np

from avatarsim.scene.checks import Vector
from avatarsim.scene.scene import Scene
from scenarios.building.stage import above_floor, with_human
from scenarios.motion.keyframes import Key, posed, through
from scenarios.scenario import Motion

FRAMES, ROUND = 360, 1.2
"""Frames, and length of one swing there and back [s]."""
ELBOWS = ("left_elbow", "right_elbow")
# forward and across the chest; from behind through the back; both arms through each other; forearms through the neck
WAYS: tuple[tuple[dict[str, Vector], dict[str, float]], ...] = (
    ({"left_shoulder": (-45.0, -45.0, -60.0)}, {"left_elbow": 30.0}),
    ({"right_shoulder": (35.0, 25.0, 0.0)}, {"right_elbow": 60.0}),
    ({"left_shoulder": (-30.0, -60.0, -40.0), "right_shoulder": (30.0, -60.0, 40.0)}, dict.fromkeys(ELBOWS, 20.0)),
    ({"left_shoulder": (0.0, -100.0, -50.0), "right_shoulder": (0.0, -100.0, 50.0)}, dict.fromkeys(ELBOWS, 110.0)),
)


def motion(scene: Scene, seed: int) -> Motion:
    """Return four ways through oneself, over and over, each a little different."""
    start, random, keys = scene.first_sample, np.random.default_rng(seed), list[Key]()

    def astray(turn: Vector) -> Vector:
        x, y, z = random.normal(turn, 4.0).tolist()
        return x, y, z

    for k in range(int(FRAMES / 60.0 / ROUND) + 1):
        turned, bent = WAYS[k % len(WAYS)]
        there = posed(
            scene.avatars[0], start, {link: astray(turn) for link, turn in turned.items()}, {e: (a,) for e, a in bent.items()}
        )
        begin = k * ROUND
        keys += [(begin + 0.35, there), (begin + 0.55, there), (begin + 0.95, start), (begin + ROUND, start)]
    return through(start, keys, FRAMES).motion()


SCENARIO = with_human(
    "arms_through_chest", "Arms are swung through the chest, the back, the neck and each other, and led back.",
    "Overlap with itself; limits; whether the arms come back with their user, or stay tied.", motion, frames=FRAMES, short=288,
    region=above_floor("human/*"),
)
