"""Arms that go where no arm can: straight through the chest, behind the back and out at the front, and through each other.

A user of another build, or a tracker that swaps two markers, does this. Each arm is swung across the body in a third of a
second, as far as the joints allow and beyond, held, and led back the way it came; it must not stay tied.

In the 288 frames of a quick comparison the raw motion is inside itself in 132 of them (up to 0.1 m deep).
"""

import numpy as np

from avatarsim.scene.checks import Vector
from avatarsim.scene.scene import Scene
from scenarios.building.avatars.humanoid import humanoid
from scenarios.building.avatars.standing import standing
from scenarios.building.promises import AVATAR
from scenarios.building.stage import above_floor, floor
from scenarios.motion.keyframes import Key, posed, through
from scenarios.scenario import Motion, Scenario

FRAMES = 360
ROUND = 1.2
"""Length of one swing there and back [s]."""


def build() -> Scene:
    """The humanoid on a floor."""
    human = humanoid()
    return Scene("arms_through_chest", (floor(),), (human,), start=standing(human))


def motion(scene: Scene, seed: int) -> Motion:
    """Four ways through oneself, over and over, each a little different."""
    human, start, random = scene.avatars[0], scene.first_sample, np.random.default_rng(seed)
    # forward and across the chest; from behind through the back; both arms through each other; forearms through the neck
    ways = (
        ({"left_shoulder": (-45.0, -45.0, -60.0)}, {"left_elbow": 30.0}),
        ({"right_shoulder": (35.0, 25.0, 0.0)}, {"right_elbow": 60.0}),
        (
            {"left_shoulder": (-30.0, -60.0, -40.0), "right_shoulder": (30.0, -60.0, 40.0)},
            {"left_elbow": 20.0, "right_elbow": 20.0},
        ),
        (
            {"left_shoulder": (0.0, -100.0, -50.0), "right_shoulder": (0.0, -100.0, 50.0)},
            {"left_elbow": 110.0, "right_elbow": 110.0},
        ),
    )

    def astray(turn: Vector) -> Vector:
        x, y, z = random.normal(turn, 4.0)
        return float(x), float(y), float(z)

    keys: list[Key] = []
    for k in range(int(FRAMES / 60.0 / ROUND) + 1):
        turned, bent = ways[k % len(ways)]
        there = posed(human, start, {link: astray(turn) for link, turn in turned.items()}, {e: (a,) for e, a in bent.items()})
        begin = k * ROUND
        keys += [(begin + 0.35, there), (begin + 0.55, there), (begin + 0.95, start), (begin + ROUND, start)]
    return through(start, keys, FRAMES).motion()


SCENARIO = Scenario(
    name="arms_through_chest",
    title="Arms are swung through the chest, the back, the neck and each other, and led back.",
    judged="Overlap with itself; limits; whether the arms come back with their user, or stay tied.",
    build=build,
    motion=motion,
    frames=FRAMES,
    short=288,
    bounds=AVATAR,
    regions=(above_floor("human/*"),),
)
