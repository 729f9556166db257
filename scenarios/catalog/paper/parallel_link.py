"""The paper's special case: a link almost parallel to the obstacle's surface, moved out by pure translation.

The user stands beside a wall, the arm hanging flat along it, and sidesteps into it again and again, so that upper arm and
forearm meet the wall with their whole length at once. A turn about the shoulder is no natural way out; the body gives way.

In the 240 frames of a quick comparison the raw motion is inside wall in 118 of them (up to 0.092 m deep).
"""

import numpy as np

from avatarsim.scene.body import fixed
from avatarsim.scene.scene import Scene
from avatarsim.scene.shape import Box, Piece
from avatarsim.scene.tracker import TrackerSample
from scenarios.building.avatars.humanoid import humanoid
from scenarios.building.avatars.standing import standing
from scenarios.building.promises import AVATAR
from scenarios.building.stage import HIGH, SPAN, THICK, floor
from scenarios.motion.keyframes import again_and_again, posed
from scenarios.scenario import INFINITE, Motion, Region, Scenario

FRAMES, SHORT = 600, 240
FACE = 0.5
"""Where the wall beside the user begins along y [m]."""
ASIDE = 0.3
"""How far the user steps towards it [m]: the arm goes about 0.1 m in."""


def build() -> Scene:
    """The humanoid on a floor, a wall on its left."""
    human = humanoid()
    wall = fixed("wall", (Piece(Box((SPAN, THICK, HIGH))),), "wood", (0.0, FACE + 0.5 * THICK, 0.5 * HIGH))
    start = standing(human)
    return Scene("parallel_link", (floor(), wall), (human,), start=start)


def motion(scene: Scene, seed: int) -> Motion:
    """Sidesteps with a hanging arm, now a little forward, now a little back."""
    human, start = scene.avatars[0], scene.first_sample
    hanging = {"left_shoulder": (8.0, 0.0, 0.0), "right_shoulder": (-20.0, 0.0, 0.0)}

    def aside(random: np.random.Generator) -> TrackerSample:
        swing = float(random.normal(0.0, 3.0))
        turned = {**hanging, "left_shoulder": (8.0, swing, 0.0)}
        moved = (float(random.normal(0.0, 0.03)), ASIDE + float(random.uniform(-0.03, 0.0)), 0.0)
        return posed(human, start, turned, {"left_elbow": (2.0,)}, moved)

    def back(random: np.random.Generator) -> TrackerSample:
        return posed(human, start, hanging, {"left_elbow": (10.0,)}, (float(random.normal(0.0, 0.03)), 0.0, 0.0))

    return again_and_again(start, back, aside, FRAMES, seed).motion()


SCENARIO = Scenario(
    name="parallel_link",
    title="A user sidesteps into a wall, an arm hanging flat along it.",
    judged="Overlap; the right side of the wall; how far the avatar is from its user; jumps.",
    build=build,
    motion=motion,
    frames=FRAMES,
    short=SHORT,
    bounds=AVATAR,
    regions=(
        Region(
            ("human/*",), (-INFINITE, -INFINITE, -0.5 * THICK), (INFINITE, FACE + 0.5 * THICK, INFINITE),
            "nothing goes through the wall, nor through the floor; it cannot be walked round",
        ),
    ),
)
