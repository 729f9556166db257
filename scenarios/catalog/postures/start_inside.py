"""A first pose that overlaps: the user begins with a hand inside the table. Refused, with the pairs that overlap.

There is no last state without overlap to come from, so any answer would be a guess; an engine is expected to say so
rather than to push the hand out some way or other. The raw motion is inside the table in all 60 frames, 0.016 m deep.
"""

import numpy as np

from avatarsim.scene.body import fixed
from avatarsim.scene.scene import Scene
from avatarsim.scene.shape import Box, Piece
from avatarsim.scene.tracker import TrackerSample
from avatarsim.spatial import rotation
from scenarios.building.avatars.hand import rigid_hand
from scenarios.building.promises import FINITE, MOVES, NO_OVERLAP
from scenarios.scenario import REFUSAL, RENDERED, Motion, Scenario

FRAMES = 60
TABLE = (1.0, 1.0, 0.05)
"""Edges of the table's top [m], its upper face at z = 0."""


def build() -> Scene:
    """A table and a hand whose middle is in its surface."""
    table = fixed("table", (Piece(Box(TABLE)),), "wood", (0.0, 0.0, -0.5 * TABLE[2]))
    return Scene("start_inside", (table,), (rigid_hand(),), start=_at(0.0, 0.0))


def motion(scene: Scene, seed: int) -> Motion:
    """Slowly along in the table."""

    def sample(frame: int) -> TrackerSample:
        time = (frame + 1) * RENDERED
        return _at(time, 0.2 * time)

    return sample


def _at(time: float, x: float) -> TrackerSample:
    return TrackerSample(time, np.array([[x, 0.0, 0.0]]), np.array([rotation.IDENTITY]), np.zeros(0))


SCENARIO = Scenario(
    name="start_inside",
    title="The first pose overlaps: a hand begins inside a table.",
    judged="Whether the engine refuses to begin and says which pairs overlap.",
    build=build,
    motion=motion,
    frames=FRAMES,
    bounds=(NO_OVERLAP, FINITE, *MOVES),
    expects={REFUSAL: True},
)
