"""A recorded walk into a wall 0.3 m inside its reach, backwards out again, and once more; the arms hug the hips.

Real motion in two layers: the legs of the clip "walk" (1.3 s at 30 Hz) under chest, neck and arms of the clip "spin",
played forwards and backwards at 60 Hz. The walk alone never goes through itself; with those arms, whose user is slimmer
than this avatar, it does. The user does not see the wall. The raw motion is inside the wall in 42 of 331 frames (deepest
0.19 m, where the way out at the back gets shorter), inside the floor in 54 (0.010 m) and inside itself in 148 (0.051 m:
left hand in the hips).
"""

from avatarsim.scene.scene import Scene
from scenarios.building.promises import AVATAR
from scenarios.building.stage import before_wall, human_before_wall
from scenarios.motion.layers import upper_body_of
from scenarios.motion.mocap import load_clip, retimed
from scenarios.motion.track import LEAD_IN, to_and_fro
from scenarios.scenario import Motion, Scenario

FACE = 1.34
"""Where the wall begins along x [m]: the leading foot reaches 1.64 m, the root turns back at 1.22 m."""
FRAMES = LEAD_IN + 4 * 75 + 1
"""The clip has 76 postures at 60 Hz, and 75 steps between them: twice there and twice back."""


HUG = 170.0 / 60.0
"""Where in the clip "spin" the upper body starts [s]: the arms close round the hips and open again within the walk."""


def build() -> Scene:
    """The humanoid stands on the floor and looks at the wall, 1.3 m away."""
    return human_before_wall("mocap_walk_wall", FACE)


def motion(scene: Scene, seed: int) -> Motion:
    """Half a second into the stride, then into the wall and back, twice."""
    return to_and_fro(upper_body_of(retimed(load_clip("spin")), HUG, retimed(load_clip("walk"))), scene, FRAMES)


SCENARIO = Scenario(
    name="mocap_walk_wall",
    family="mocap",
    title="A recorded walk, hands on the hips, leads 0.3 m into a wall and backwards out again, twice.",
    judged="Overlap with wall, floor and itself; the right side of the wall; limits; offset from the user; jumps.",
    build=build,
    motion=motion,
    frames=FRAMES,
    bounds=AVATAR,
    regions=(before_wall(FACE, "human/*"),),
    everyday=True,
)
