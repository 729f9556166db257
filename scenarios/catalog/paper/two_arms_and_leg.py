"""Table 2 of the paper: two arms and a leg pushed into a wall of the gallery, again and again.

As `two_arms`, with one knee lifted and its foot kicked through the wall in the same push, left and right by turns.

In the 600 frames of a quick comparison the raw motion is inside wall_west in 396 of them (up to 0.25 m deep).
"""

import numpy as np

from avatarsim.scene.scene import Scene
from avatarsim.scene.tracker import TrackerSample
from scenarios.building.avatars.humanoid import humanoid
from scenarios.building.avatars.standing import standing
from scenarios.building.gallery import gallery, inside
from scenarios.building.promises import AVATAR
from scenarios.catalog.paper.two_arms import AT, HEADING, SPREAD
from scenarios.motion.keyframes import again_and_again, posed
from scenarios.scenario import Motion, Scenario

FRAMES, SHORT = 2440, 600
"""The paper's run, and its beginning."""


def build() -> Scene:
    """The gallery, the humanoid before its west wall."""
    human = humanoid()
    return Scene("two_arms_and_leg", gallery(), (human,), start=standing(human, *AT, HEADING))


def motion(scene: Scene, seed: int) -> Motion:
    """Push after push, each with one leg."""
    human, start = scene.avatars[0], scene.first_sample

    def pushed(random: np.random.Generator) -> TrackerSample:
        lift, spread, elbow, thigh, knee = random.normal((-80.0, 8.0, 15.0, -65.0, -25.0), SPREAD)
        leg = "left" if random.random() < 0.5 else "right"
        turned = {"left_shoulder": (spread, lift, 0.0), "right_shoulder": (-spread, lift + random.normal(0.0, SPREAD), 0.0)}
        bent = {"left_elbow": (abs(elbow),), "right_elbow": (abs(elbow),)}
        return posed(human, start, {**turned, f"{leg}_hip": (0.0, thigh, 0.0)}, {**bent, f"{leg}_knee": (min(knee, 0.0),)})

    def ready(random: np.random.Generator) -> TrackerSample:
        lift, elbow = random.normal((-20.0, 70.0), SPREAD)
        turned = {"left_shoulder": (15.0, lift, 0.0), "right_shoulder": (-15.0, lift, 0.0)}
        return posed(human, start, turned, {"left_elbow": (elbow,), "right_elbow": (elbow,)})

    return again_and_again(start, ready, pushed, FRAMES, seed).motion()


SCENARIO = Scenario(
    name="two_arms_and_leg",
    family="two_arms",
    title="Two arms and a leg are pushed into a wall of the gallery, again and again.",
    judged="Overlap; the right side of the wall; Table 2's columns.",
    build=build,
    motion=motion,
    frames=FRAMES,
    short=SHORT,
    bounds=AVATAR,
    regions=(inside("human/*"),),
)
