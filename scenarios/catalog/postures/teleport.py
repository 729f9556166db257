"""A tracker that loses its user and finds them elsewhere: jumps to any place and posture in a room, walls and table included.

Every half second the user is somewhere else in room one of the gallery, up to half a metre beyond its walls, turned
anyhow, every joint drawn anew, knees and elbows up to a radian beyond their limits; between jumps the user moves slowly.
The raw tracker is inside a wall, the table or the user's own body most of the time.

In the 240 frames of a quick comparison the raw motion is inside itself in 172 of them (up to 0.11 m deep), inside
wall_west in 60 (0.21 m), inside wall_door_north in 30 (0.069 m), inside table in 30 (0.082 m).
"""

import numpy as np

from avatarsim.scene.joint import Ball, Hinges
from avatarsim.scene.scene import Scene
from avatarsim.scene.tracker import TrackerSample
from avatarsim.spatial import rotation
from scenarios.building.avatars.humanoid import humanoid
from scenarios.building.avatars.standing import standing
from scenarios.building.gallery import gallery, inside
from scenarios.building.promises import FINITE, MOVES, NO_OVERLAP, RIGHT_SIDE, WITHIN_LIMITS
from scenarios.scenario import RENDERED, Motion, Scenario

FRAMES, SHORT = 600, 240
HELD = 30
"""Frames between two jumps."""
PLACES = ((-5.5, -3.5, 0.7), (0.2, 3.5, 1.3))
"""Corners of the box from which the root's place is drawn [m]: room one and what is around it, not behind its doorway."""
BEYOND = 1.0
"""How far beyond its limits a hinge is driven [rad]."""
SWAY = 0.05
"""How far every joint sways between jumps [rad]."""


def build() -> Scene:
    """The gallery, the humanoid in room one."""
    human = humanoid()
    return Scene("teleport", gallery(), (human,), start=standing(human, -2.5, -1.8))


def motion(scene: Scene, seed: int) -> Motion:
    """A new place and posture every half second."""
    human = scene.avatars[0]
    balls = np.array([isinstance(link.joint, Ball) for link in human.links])
    limits = [hinge for link in human.links if isinstance(link.joint, Hinges) for hinge in link.joint.hinges]

    def sample(frame: int) -> TrackerSample:
        random = np.random.default_rng((seed, frame // HELD))
        positions = np.zeros((len(human.links), 3))
        positions[0] = random.uniform(*PLACES)
        vectors = np.where(balls[:, None], random.uniform(-1.2, 1.2, (len(human.links), 3)), 0.0)
        vectors[0] = random.uniform(-0.4, 0.4, 2).tolist() + [random.uniform(-np.pi, np.pi)]
        angles = np.array([random.uniform(hinge.lower - BEYOND, hinge.upper + BEYOND) for hinge in limits])
        sway = SWAY * np.sin(2.0 * np.pi * (frame % HELD) / HELD)
        vectors[balls] += sway
        return TrackerSample((frame + 1) * RENDERED, positions, rotation.from_rotation_vector(vectors), angles + sway)

    return sample


SCENARIO = Scenario(
    name="teleport",
    title="The tracker jumps every half second to another place and posture, into walls, furniture and the body itself.",
    judged="Overlap, the right side of every wall, limits. The avatar may go as far as its user leaps, but through nothing.",
    build=build,
    motion=motion,
    frames=FRAMES,
    short=SHORT,
    bounds=(NO_OVERLAP, RIGHT_SIDE, FINITE, WITHIN_LIMITS, *MOVES),
    regions=(inside("human/*"),),
)
