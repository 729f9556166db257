"""Coach and trainee: an obstacle is taken away, and the posture returns to the user's.

A slab as heavy as a house glides past, weightless and at a steady 0.5 m/s. The user keeps the right arm
stretched through it, so that the avatar's arm is folded back; once the slab has passed nothing is in the way any more. The
paper's attraction returns on an exponential; by the default method the slab is a load, and what it held back returns by eq. 6,
whose time constant is 2 m / R = 25 ms for a hand of half a kilogram.

In the 240 frames of a quick comparison the raw motion is inside slab in 224 of them (up to 0.089 m deep).
"""

import math

from avatarsim.scene.body import simulated, solid
from avatarsim.scene.scene import Scene
from avatarsim.scene.shape import Box, Piece
from avatarsim.scene.tracker import TrackerSample
from scenarios.building.avatars.humanoid import humanoid
from scenarios.building.avatars.standing import standing
from scenarios.building.promises import AVATAR, FOLLOWS_WHEN_FREE
from scenarios.motion.keyframes import posed, through
from scenarios.scenario import INFINITE, RENDERED, Bound, Motion, Region, Scenario

FRAMES, SHORT = 300, 240
SLAB, SLAB_MASS = (0.1, 1.2, 2.4), 1.0e6
"""Edges [m] and mass [kg] of the slab."""
FACE = 0.45
"""Where its near face is along x [m]; the stretched hand reaches about 0.6."""
FIRST, SPEED = -0.5, 0.5
"""Where its middle is along y at first [m] and how fast it glides [m/s]: it has passed the arm after 1.8 s."""


LAG, RETURN = 0.15, 0.025
"""Largest lag of the hand behind the slab [m], and time constant of its return [s]."""
FREE = 16
"""Frames of the short run in which nothing is in the way."""
RETURNS = Bound(
    "tracker_offset_rms_free", LAG / math.sqrt(FREE * (1.0 - math.exp(-2.0 * RENDERED / RETURN))),
    "from its greatest lag the hand returns by eq. 6, and then is where the user is",
)


def build() -> Scene:
    """The humanoid, the arm bent, and a slab before it that glides to the left. No weight: a slab on the ground would rub."""
    human = humanoid()
    pieces = (Piece(Box(SLAB)),)
    at = (FACE + 0.5 * SLAB[0], FIRST, 0.5 * SLAB[2])
    slab = simulated("slab", pieces, "metal", solid(pieces, SLAB_MASS), at, velocity=(0.0, SPEED, 0.0))
    return Scene("coach_release", (slab,), (human,), gravity=(0.0, 0.0, 0.0), start=standing(human))


def motion(scene: Scene, seed: int) -> Motion:
    """The arm is stretched into the slab within half a second and then held, swaying a little."""
    human, start = scene.avatars[0], scene.first_sample

    def stretched(lift: float) -> TrackerSample:
        return posed(human, start, {"right_shoulder": (-5.0, lift, 0.0)}, {"right_elbow": (10.0,)})

    keys = [(0.5 + 0.4 * k, stretched(-88.0 + 4.0 * (k % 2))) for k in range(12)]
    return through(start, keys, FRAMES).motion()


SCENARIO = Scenario(
    name="coach_release",
    title="A slab glides past a stretched arm and is gone: the posture returns to the user's.",
    judged="Overlap while the slab is there; how soon the avatar is where its user is once it is gone.",
    build=build,
    motion=motion,
    frames=FRAMES,
    short=SHORT,
    bounds=tuple(bound for bound in AVATAR if bound is not FOLLOWS_WHEN_FREE) + (RETURNS,),
    regions=(
        Region(
            ("slab",), (FACE - 0.3, -INFINITE, -INFINITE), (FACE + SLAB[0] + 0.3, INFINITE, INFINITE),
            "an arm that is stretched does not push a slab of a thousand tons aside",
        ),
    ),
)
