"""Table 2 and Figure 8 of the paper: two arms pushed into a wall of the gallery, again and again.

The user stands half an arm's length before the west wall, stretches both arms through it, holds, lets go, and never
does it twice the same. The paper's avatar had mouse and keyboard for a user; this one is scripted with the minimum-jerk
profile of human reaching, drawn by the seed.

In the 600 frames of a quick comparison the raw motion is inside wall_west in 431 of them (up to 0.14 m deep).
"""

import numpy as np

from avatarsim.scene.scene import Scene
from avatarsim.scene.tracker import TrackerSample
from scenarios.building.avatars.humanoid import humanoid
from scenarios.building.avatars.standing import standing
from scenarios.building.gallery import gallery, inside
from scenarios.building.promises import AVATAR
from scenarios.motion.keyframes import again_and_again, posed
from scenarios.scenario import Motion, Scenario

FRAMES, SHORT = 1496, 600
"""The paper's run, and its beginning."""
AT, HEADING = (-4.6, 1.0), float(np.pi)
"""Where the user stands [m] and looks [rad]: the west wall's face is at x = -5."""
SPREAD = 6.0
"""Standard deviation [degrees] of what the user does differently each time."""


def build() -> Scene:
    """The gallery, the humanoid before its west wall."""
    human = humanoid()
    return Scene("two_arms", gallery(), (human,), start=standing(human, *AT, HEADING))


def motion(scene: Scene, seed: int) -> Motion:
    """Push after push; between them the arms come half-way back."""
    human, start = scene.avatars[0], scene.first_sample

    def pushed(random: np.random.Generator) -> TrackerSample:
        lift, spread, elbow, lean = random.normal((-85.0, 8.0, 12.0, 6.0), SPREAD)
        # whole arms forward, hands a little apart; a positive turn about x moves a hanging left arm outwards
        turned = {"left_shoulder": (spread, lift, 0.0), "right_shoulder": (-spread, lift + random.normal(0.0, SPREAD), 0.0)}
        return posed(
            human, start, {**turned, "chest": (0.0, abs(lean), 0.0)},
            {"left_elbow": (abs(elbow),), "right_elbow": (abs(elbow + random.normal(0.0, SPREAD)),)},
        )

    def ready(random: np.random.Generator) -> TrackerSample:
        lift, elbow = random.normal((-20.0, 70.0), SPREAD)
        turned = {"left_shoulder": (15.0, lift, 0.0), "right_shoulder": (-15.0, lift, 0.0)}
        return posed(human, start, turned, {"left_elbow": (elbow,), "right_elbow": (elbow,)})

    return again_and_again(start, ready, pushed, FRAMES, seed).motion()


SCENARIO = Scenario(
    name="two_arms",
    title="Two arms are pushed into a wall of the gallery, again and again.",
    judged="Overlap; the right side of the wall; Table 2's columns; the frame's cost, which rises as a push begins.",
    build=build,
    motion=motion,
    frames=FRAMES,
    short=SHORT,
    bounds=AVATAR,
    regions=(inside("human/*"),),
)
