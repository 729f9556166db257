"""A recorded punch, thrown again and again where a wall stands 0.3 m inside its reach.

Real motion: the clip "punch" (2.1 s at 30 Hz), played forwards and backwards at 60 Hz. The user does not see the wall.
The raw motion is inside the wall in 155 of 300 frames (deepest 0.19 m, where the way out at the back gets shorter),
inside the floor in 296 (0.044 m) and inside itself in 8 (0.078 m: right foot in left shin).
"""

from avatarsim.scene.scene import Scene
from scenarios.building.promises import AVATAR
from scenarios.building.stage import before_wall, human_before_wall
from scenarios.motion.mocap import load_clip
from scenarios.motion.resampled import at_rate
from scenarios.motion.track import to_and_fro
from scenarios.scenario import Motion, Scenario

FACE = 1.43
"""Where the wall begins along x [m]: the fist reaches 1.73 m, so it is meant to go 0.3 m in, 0.1 m out at the back."""
FRAMES = 300


def build() -> Scene:
    """The humanoid stands on the floor and looks at the wall, 1.4 m away."""
    return human_before_wall("mocap_punch_wall", FACE)


def motion(scene: Scene, seed: int) -> Motion:
    """Half a second into the fighting stance, then the clip, back and forth."""
    return to_and_fro(load_clip("punch"), scene, FRAMES)


SCENARIO = Scenario(
    name="mocap_punch_wall",
    family="mocap",
    title="A recorded punch is thrown again and again at a wall that stands 0.3 m inside its reach.",
    judged="Overlap with wall, floor and itself; the right side of the wall; limits; offset from the user; jumps.",
    build=build,
    motion=motion,
    frames=FRAMES,
    bounds=AVATAR,
    regions=(before_wall(FACE, "human/*"),),
    everyday=True,
)
SCENARIOS = (SCENARIO, at_rate(SCENARIO))
