"""Table 2 of the paper: an arm pushed into a corner of two walls, the costliest of its scenes, again and again.

The user stands in room two where the screen meets the south wall and thrusts the right arm at the corner, now more into
one wall, now more into the other, and slides along both before letting go.

In the 600 frames of a quick comparison the raw motion is inside wall_screen in 178 of them (up to 0.083 m deep),
inside wall_south_two in 139 (0.094 m).
"""

import numpy as np

from avatarsim.scene.scene import Scene
from avatarsim.scene.tracker import TrackerSample
from scenarios.building.avatars.humanoid import humanoid
from scenarios.building.avatars.standing import standing
from scenarios.building.gallery import gallery, inside
from scenarios.building.promises import AVATAR
from scenarios.catalog.paper.two_arms import SPREAD
from scenarios.motion.keyframes import again_and_again, posed
from scenarios.scenario import Motion, Scenario

FRAMES, SHORT = 2146, 600
"""The paper's run, and its beginning."""
AT, HEADING = (2.58, -2.66), float(np.radians(225.0))
"""Where the user stands [m] and looks [rad]: the corner of the screen (x = 2.1) and the south wall (y = -3) is ahead."""


def build() -> Scene:
    """The gallery, the humanoid before the corner."""
    human = humanoid()
    return Scene("arm_in_corner", gallery(), (human,), start=standing(human, *AT, HEADING))


def motion(scene: Scene, seed: int) -> Motion:
    """Thrust after thrust of the right arm."""
    human, start = scene.avatars[0], scene.first_sample

    def pushed(random: np.random.Generator) -> TrackerSample:
        lift, aside, elbow, lean = random.normal((-80.0, 15.0, 8.0, 5.0), (10.0, 18.0, SPREAD, SPREAD))
        turned = {"right_shoulder": (0.0, lift, aside), "chest": (0.0, abs(lean), 0.0)}
        return posed(human, start, turned, {"right_elbow": (abs(elbow),)})

    def ready(random: np.random.Generator) -> TrackerSample:
        lift, elbow = random.normal((-15.0, 90.0), SPREAD)
        return posed(human, start, {"right_shoulder": (-15.0, lift, 0.0)}, {"right_elbow": (elbow,)})

    return again_and_again(start, ready, pushed, FRAMES, seed).motion()


SCENARIO = Scenario(
    name="arm_in_corner",
    title="An arm is pushed into a corner of two walls of the gallery, again and again.",
    judged="Overlap; the right side of both walls; Table 2's columns.",
    build=build,
    motion=motion,
    frames=FRAMES,
    short=SHORT,
    bounds=AVATAR,
    regions=(inside("human/*"),),
)
