"""Every recorded clip as it was recorded, in a gallery whose floor and furniture are not the user's.

Real motion: all fifteen human clips of pybullet_data at 60 Hz, after half a second in which the user walks from a free
posture into the clip's first one. Where a clip begins, and which way it faces, is ours: so that it stays in the room.
The raw motion is inside the floor in every clip, for 31 frames (walk) to 178 (getup_faceup), 0.01 to 0.2 m deep; inside
itself in seven of them (punch: 0.08 m); inside walls and exhibits in six (spin: 0.18 m). tests/scenarios/raw_overlap.py
has each.
"""

from dataclasses import dataclass

import numpy as np

from avatarsim.scene.body import Body
from avatarsim.scene.scene import Scene
from scenarios.building.avatars.humanoid import humanoid
from scenarios.building.avatars.standing import standing
from scenarios.building.gallery import gallery, inside
from scenarios.building.promises import AVATAR
from scenarios.motion.mocap import load_clip, placed, retimed
from scenarios.motion.track import LEAD_IN, track_of
from scenarios.scenario import Motion, Scenario

NEAR = 2.0
"""Distance [m] from where a clip begins beyond which exhibits of many pieces are left out. None is ever met there (the raw
motions say so), and fifteen scenes would pay for them in every engine; the scenes of Table 2 keep them all."""


@dataclass(frozen=True)
class Played:
    """A clip of `postures` at 60 Hz that begins at (x, y) [m] and faces `heading` [degrees] from the x axis."""

    clip: str
    postures: int
    x: float
    y: float
    heading: float
    what: str

    @property
    def name(self) -> str:
        """Name of the scene."""
        return f"mocap_{self.clip}"

    def build(self) -> Scene:
        """The gallery without far exhibits, the humanoid standing where the clip begins."""
        human = humanoid()
        start = standing(human, self.x, self.y, float(np.radians(self.heading)))
        return Scene(self.name, tuple(body for body in gallery() if self.counts(body)), (human,), start=start)

    def counts(self, body: Body) -> bool:
        """Walls, floor and whatever is one piece; of what is made of many, only what is near enough to be met."""
        away = np.hypot(body.position[0] - self.x, body.position[1] - self.y)
        return len(body.pieces) == 1 or bool(away < NEAR)

    def motion(self, scene: Scene, seed: int) -> Motion:
        """Half a second into the clip's first posture, then the clip."""
        clip = placed(retimed(load_clip(self.clip)), self.x, self.y, float(np.radians(self.heading)))
        return track_of(clip, scene.avatars[0]).led_in(scene.first_sample).motion()

    def scenario(self) -> Scenario:
        """The scene with its bounds."""
        return Scenario(
            name=self.name,
            family="mocap",
            title=f"Recorded motion in the gallery, as recorded: {self.what}.",
            judged="Overlap with floor, furniture and itself; limits; offset from the user; jumps.",
            build=self.build,
            motion=self.motion,
            frames=LEAD_IN + self.postures,
            bounds=AVATAR,
            regions=(inside("human/*"),),
        )


PLAYED = (
    Played("backflip", 106, 1.0, 0.8, 90.0, "a backflip"),
    Played("cartwheel", 163, 0.9, -1.0, 0.0, "a cartwheel"),
    Played("crawl", 176, 1.0, -0.6, 90.0, "crawling"),
    Played("dance_a", 97, 0.9, -0.6, 0.0, "a dance"),
    Played("dance_b", 152, 0.9, 0.4, 0.0, "another dance"),
    Played("getup_facedown", 182, 1.0, 0.0, 90.0, "getting up from face down"),
    Played("getup_faceup", 226, 1.0, 0.0, 90.0, "getting up from face up"),
    Played("jump", 106, 1.0, -0.5, 90.0, "a jump"),
    Played("kick", 92, 1.4, -0.4, 0.0, "a kick, beside a sculpture"),
    Played("punch", 128, 1.0, -0.8, 0.0, "punches, ending at a sculpture"),
    Played("roll", 121, 1.0, -0.5, 90.0, "a roll"),
    Played("run", 48, 0.6, -0.3, 90.0, "a run that ends at a wall"),
    Played("spin", 266, 0.9, -1.0, 0.0, "a spin"),
    Played("spinkick", 77, 1.5, -0.2, 0.0, "a spinning kick, beside a sculpture"),
    Played("walk", 76, -0.9, 0.25, 0.0, "a walk through the doorway, too near to one of its posts"),
)

SCENARIOS = tuple(played.scenario() for played in PLAYED)
