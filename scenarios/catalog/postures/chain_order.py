"""Does it matter in which order the chains are treated? The same motion for every seed; the seed is the engine's alone.

Both arms, crossed, and a leg meet a wall at once, the head bent towards it; then with the other leg. The arms overlap each
other too: chains that meet nothing but a wall give way in the same manner in every order. The paper draws the order of the
chains at random. A method without an order shows the same frames, bit for bit.

In the 120 frames of a quick comparison the raw motion is inside wall in 74 of them (up to 0.19 m deep), self in 54 (0.03 m).
"""

from avatarsim.scene.scene import Scene
from scenarios.building.promises import AVATAR
from scenarios.building.stage import before_wall, human_before_wall
from scenarios.motion.keyframes import Key, posed, through
from scenarios.scenario import Motion, Scenario

FRAMES = 120
FACE = 0.45
"""Where the wall begins along x [m]."""


def build() -> Scene:
    """The humanoid stands on the floor close before a wall."""
    return human_before_wall("chain_order", FACE)


def motion(scene: Scene, seed: int) -> Motion:
    """Arms crossed into the wall, a knee up, the head forward; twice, once with each leg."""
    human, start, keys = scene.avatars[0], scene.first_sample, list[Key]()
    for k, leg in enumerate(("left", "right")):
        turned = {
            "left_shoulder": (0.0, -80.0, -45.0), "right_shoulder": (0.0, -70.0, 45.0), f"{leg}_hip": (0.0, -75.0, 0.0),
            "neck": (0.0, 40.0, 0.0), "chest": (0.0, 15.0, 0.0),
        }
        bent = {"left_elbow": (15.0,), "right_elbow": (20.0,), f"{leg}_knee": (-60.0,)}
        there = posed(human, start, turned, bent, (0.1, 0.0, 0.0))
        keys += [(k + 0.4, there), (k + 0.6, there), (k + 1.0, start)]
    return through(start, keys, FRAMES).motion()


SCENARIO = Scenario(
    name="chain_order",
    title="Arms, a leg and the neck are in contact at once; the seed is the engine's alone.",
    judged="Overlap; the spread of what is shown over the order in which chains are treated.",
    build=build,
    motion=motion,
    frames=FRAMES,
    bounds=AVATAR,
    regions=(before_wall(FACE, "human/*"),),
)
