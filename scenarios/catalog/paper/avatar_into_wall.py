"""Figure 2 of the paper: an avatar moves into a wall; the extended arm and a leg are pushed back.

The user stands with the right arm and the left leg stretched forward and walks the body to and fro, up to where the chest
nearly touches: arm and leg then stick through the wall and have to fold.

In the 300 frames of a quick comparison the raw motion is inside wall in 139 of them (up to 0.25 m deep).
"""

import numpy as np

from avatarsim.scene.scene import Scene
from avatarsim.scene.tracker import TrackerSample
from scenarios.building.promises import AVATAR
from scenarios.building.stage import before_wall, human_before_wall
from scenarios.motion.keyframes import again_and_again, posed
from scenarios.scenario import Motion, Scenario

FACE = 0.75
"""Where the wall begins along x [m]: out of reach of arm and leg while the user stands back at the origin."""
NEAR = 0.45
"""How far the body moves towards the wall [m]."""
FRAMES = 600
"""Seven walks into the wall."""


def build() -> Scene:
    """The humanoid stands on the floor and looks at the wall."""
    return human_before_wall("avatar_into_wall", FACE)


def motion(scene: Scene, seed: int) -> Motion:
    """Forward with arm and leg stretched, back again, each time a little differently."""
    human, start = scene.avatars[0], scene.first_sample

    def forward(random: np.random.Generator) -> TrackerSample:
        lift, thigh = random.normal((-90.0, -45.0), 5.0)
        turned = {"right_shoulder": (-5.0, lift, 0.0), "left_hip": (0.0, thigh, 0.0)}
        moved = (NEAR + random.uniform(-0.1, 0.0), 0.0, 0.02)
        return posed(human, start, turned, {"right_elbow": (5.0,), "left_knee": (-5.0,)}, moved)

    def back(random: np.random.Generator) -> TrackerSample:
        return posed(human, start, {"right_shoulder": (-10.0, random.normal(-40.0, 5.0), 0.0)}, moved=(0.0, 0.0, 0.02))

    return again_and_again(start, back, forward, FRAMES, seed).motion()


SCENARIO = Scenario(
    name="avatar_into_wall",
    title="An avatar moves into a wall: the extended arm and a leg are pushed back.",
    judged="Overlap; the right side of the wall; limits; offset from the user; jumps.",
    build=build,
    motion=motion,
    frames=FRAMES,
    short=300,
    bounds=AVATAR,
    regions=(before_wall(FACE, "human/*"),),
)
