"""Coach and trainee: an obstacle is taken away, and the posture returns to the user's.

A slab as heavy as a house glides past, weightless and at a steady 0.5 m/s, and the avatar's arm is folded back; once the slab
has passed nothing is in the way. The paper's attraction returns on an exponential; by the default method the slab is a load,
and the lag returns by eq. 6, whose time constant is 2 m / R = 25 ms for a hand of half a kilogram.
"""

import math

from avatarsim.scene.scene import Scene
from avatarsim.scene.shape import Box
from scenarios.building.avatars.humanoid import humanoid
from scenarios.building.avatars.standing import standing
from scenarios.building.cases import NOWHERE, loose
from scenarios.building.promises import AVATAR, FOLLOWS_WHEN_FREE
from scenarios.motion.keyframes import posed, through
from scenarios.scenario import INFINITE, RENDERED, Bound, Motion, Region, Scenario

FRAMES, SHORT = 300, 240
FACE, THICK, SPEED = 0.45, 0.1, 0.5
"""Near face of the slab along x, where the stretched hand reaches about 0.6, its thickness [m], and its speed along y [m/s]."""
LAG, RETURN, FREE = 0.15, 0.025, 16
"""Largest lag of the hand behind the slab [m], time constant of its return [s], frames of the short run without the slab."""
RETURNS = Bound(
    "tracker_offset_rms_free", LAG / math.sqrt(FREE * (1.0 - math.exp(-2.0 * RENDERED / RETURN))),
    "from its greatest lag the hand returns by eq. 6, and then is where the user is",
)


def build() -> Scene:
    """Return the humanoid, arm bent, and a slab before it that glides to the left. No weight: on the ground it would rub."""
    slab = loose("slab", Box((THICK, 1.2, 2.4)), "metal", 1.0e6, (FACE + 0.5 * THICK, -0.5, 1.2), velocity=(0.0, SPEED, 0.0))
    return Scene("coach_release", (slab,), (humanoid(),), gravity=NOWHERE, start=standing(humanoid()))


def motion(scene: Scene, seed: int) -> Motion:
    """Return a motion: the arm is stretched into the slab within half a second and then held, swaying a little."""
    human, start = scene.avatars[0], scene.first_sample
    stretched = [
        posed(human, start, {"right_shoulder": (-5.0, lift, 0.0)}, {"right_elbow": (10.0,)}) for lift in (-88.0, -84.0)
    ]
    return through(start, [(0.5 + 0.4 * k, stretched[k % 2]) for k in range(12)], FRAMES).motion()


SCENARIO = Scenario(
    "coach_release", "A slab glides past a stretched arm and is gone: the posture returns to the user's.",
    "Overlap while the slab is there; how soon the avatar is where its user is once it is gone.", build, motion, FRAMES, SHORT,
    bounds=tuple(bound for bound in AVATAR if bound is not FOLLOWS_WHEN_FREE) + (RETURNS,),
    regions=(
        Region(("slab",), (FACE - 0.3, -INFINITE, -INFINITE), (FACE + THICK + 0.3, INFINITE, INFINITE),
               "an arm that is stretched does not push a slab of a thousand tons aside"),
    ),
)
