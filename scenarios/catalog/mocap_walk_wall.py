"""A recorded walk into a wall 0.3 m inside its reach, backwards out again, and once more.

Real motion: the clip "walk" (1.3 s at 30 Hz), played forwards and backwards at 60 Hz. The user does not see the wall.
The raw motion is inside the wall in 42 of 331 frames (deepest 0.19 m, where the way out at the back gets shorter) and
inside the floor in 54 (0.010 m). It never goes through itself: that is for the other two recorded scenes.
"""

from avatarsim.scene.scene import Scene
from scenarios.avatars.humanoid import humanoid
from scenarios.avatars.standing import standing
from scenarios.mocap import load_clip, retimed
from scenarios.promises import AVATAR
from scenarios.scenario import Motion, Scenario
from scenarios.stage import before_wall, floor, wall_ahead
from scenarios.track import LEAD_IN, track_of

FACE = 1.34
"""Where the wall begins along x [m]: the leading hand and foot reach 1.64 m, the root turns back at 1.24 m."""
FRAMES = LEAD_IN + 4 * 75 + 1
"""The clip has 76 postures at 60 Hz, and 75 steps between them: twice there and twice back."""


def build() -> Scene:
    """The humanoid stands on the floor and looks at the wall, 1.3 m away."""
    human = humanoid()
    return Scene("mocap_walk_wall", (floor(), wall_ahead(FACE)), (human,), start=standing(human))


def motion(scene: Scene, seed: int) -> Motion:
    """Half a second into the stride, then into the wall and back, twice."""
    clip = track_of(retimed(load_clip("walk")), scene.avatars[0])
    return clip.there_and_back(FRAMES - LEAD_IN).led_in(scene.first_sample).motion()


SCENARIO = Scenario(
    name="mocap_walk_wall",
    title="A recorded walk leads 0.3 m into a wall and backwards out again, twice.",
    judged="Overlap with wall, floor and itself; the right side of the wall; limits; offset from the user; jumps.",
    build=build,
    motion=motion,
    frames=FRAMES,
    bounds=AVATAR,
    regions=(before_wall(FACE, "human/*"),),
)
