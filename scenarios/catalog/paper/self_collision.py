"""Table 2 of the paper: an avatar that runs into itself, again and again.

The user claps hands through each other, folds both arms into the chest, slaps a thigh or swings one leg through the
other, drawn by the seed; nothing else is near but the floor.

In the 600 frames of a quick comparison the raw motion is inside itself in 194 of them (up to 0.075 m deep).
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

FRAMES, SHORT = 2327, 600
"""The paper's run, and its beginning."""
AT = (-2.5, -1.8)
"""Where the user stands, in room one [m]."""


def build() -> Scene:
    """The gallery, the humanoid in the open."""
    human = humanoid()
    return Scene("self_collision", gallery(), (human,), start=standing(human, *AT))


def motion(scene: Scene, seed: int) -> Motion:
    """One of four ways into oneself after the other."""
    human, start = scene.avatars[0], scene.first_sample

    def pushed(random: np.random.Generator) -> TrackerSample:
        a, b, c = random.normal(0.0, SPREAD, 3)
        way = random.integers(4)
        if way == 0:
            # hands clapped: arms forward and each 25 degrees beyond the middle
            turned = {"left_shoulder": (a, -70.0 + b, -30.0 + c), "right_shoulder": (a, -70.0 - b, 30.0 + c)}
            return posed(human, start, turned, {"left_elbow": (25.0,), "right_elbow": (25.0,)})
        if way == 1:
            # arms folded: upper arms a little forward, forearms across the chest and into it
            turned = {"left_shoulder": (a, -25.0 + b, -70.0 + c), "right_shoulder": (a, -25.0 - b, 70.0 + c)}
            return posed(human, start, turned, {"left_elbow": (100.0 + a,), "right_elbow": (100.0 + b,)})
        if way == 2:
            # both hands into the thighs
            turned = {"left_shoulder": (-12.0 + a, -15.0 + b, 0.0), "right_shoulder": (12.0 - a, -15.0 + c, 0.0)}
            return posed(human, start, turned, {"left_elbow": (15.0,), "right_elbow": (15.0,)})
        # one leg swung through the other
        turned = {"left_hip": (-28.0 + a, 0.0, 0.0), "right_hip": (5.0, b, 0.0)}
        return posed(human, start, turned, {"left_knee": (-20.0,)})

    def ready(random: np.random.Generator) -> TrackerSample:
        lift, elbow = random.normal((-20.0, 40.0), SPREAD)
        turned = {"left_shoulder": (22.0, lift, 0.0), "right_shoulder": (-22.0, lift, 0.0)}
        return posed(human, start, turned, {"left_elbow": (elbow,), "right_elbow": (elbow,)})

    return again_and_again(start, ready, pushed, FRAMES, seed).motion()


SCENARIO = Scenario(
    name="self_collision",
    title="An avatar runs into itself, again and again: hands, arms and chest, thighs, legs.",
    judged="Overlap with itself; limits; offset from the user; Table 2's columns.",
    build=build,
    motion=motion,
    frames=FRAMES,
    short=SHORT,
    bounds=AVATAR,
    regions=(inside("human/*"),),
)
