"""A recorded punch, thrown again and again where a wall stands 0.3 m inside its reach.

Real motion: the clip "punch" (2.1 s at 30 Hz), played forwards and backwards at 60 Hz. The user does not see the wall.
The raw motion is inside the wall in 155 of 300 frames (deepest 0.19 m, where the way out at the back gets shorter),
inside the floor in 296 (0.044 m) and inside itself in 8 (0.078 m: right foot in left shin).
"""

from avatarsim.scene.scene import Scene
from scenarios.avatars.humanoid import humanoid
from scenarios.avatars.standing import standing
from scenarios.mocap import load_clip, retimed
from scenarios.promises import AVATAR
from scenarios.scenario import Motion, Scenario
from scenarios.stage import before_wall, floor, wall_ahead
from scenarios.track import LEAD_IN, track_of

FACE = 1.43
"""Where the wall begins along x [m]: the fist reaches 1.73 m, so it is meant to go 0.3 m in, 0.1 m out at the back."""
FRAMES = 300


def build() -> Scene:
    """The humanoid stands on the floor and looks at the wall, 1.4 m away."""
    human = humanoid()
    return Scene("mocap_punch_wall", (floor(), wall_ahead(FACE)), (human,), start=standing(human))


def motion(scene: Scene, seed: int) -> Motion:
    """Half a second into the fighting stance, then the clip, back and forth."""
    clip = track_of(retimed(load_clip("punch")), scene.avatars[0])
    return clip.there_and_back(FRAMES - LEAD_IN).led_in(scene.first_sample).motion()


SCENARIO = Scenario(
    name="mocap_punch_wall",
    title="A recorded punch is thrown again and again at a wall that stands 0.3 m inside its reach.",
    judged="Overlap with wall, floor and itself; the right side of the wall; limits; offset from the user; jumps.",
    build=build,
    motion=motion,
    frames=FRAMES,
    bounds=AVATAR,
    regions=(before_wall(FACE, "human/*"),),
)
