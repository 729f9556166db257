"""A rigid hand is driven through a wall of two millimetres, as fast as a hand can be thrown, and faster.

The wall is endless, so behind it is the wrong side; a hand that is checked only where it arrives is through it within a
frame. Speeds rise from 2 to 20 m/s: the raw tracker is wholly behind the wall in half of the frames.

In the 300 frames of a quick comparison the raw motion is inside wall in 32 of them (up to 0.037 m deep).
"""

import numpy as np

from avatarsim.scene.body import fixed
from avatarsim.scene.scene import Scene
from avatarsim.scene.shape import Box, Piece
from avatarsim.scene.tracker import TrackerSample
from avatarsim.spatial import rotation
from scenarios.building.avatars.hand import rigid_hand
from scenarios.building.promises import FINITE, FOLLOWS_WHEN_FREE, MOVES, NO_OVERLAP, RIGHT_SIDE
from scenarios.building.stage import HIGH, SPAN
from scenarios.scenario import INFINITE, RENDERED, Motion, Region, Scenario

FRAMES = 300
THIN = 2e-3
"""Thickness of the wall [m]; it stands across the x axis, its near face at 0."""
BEFORE, BEHIND = -0.35, 0.4
"""Where the hand is at rest before the wall, and how far it is driven behind it [m]."""
SLOWEST, FASTEST = 2.0, 20.0
"""Speed of the first thrust and of the last [m/s]."""
CYCLE = 50
"""Frames of a thrust: there, a while behind the wall, back, a while before it."""


def build() -> Scene:
    """A thin wall and a hand before it."""
    wall = fixed("wall", (Piece(Box((THIN, SPAN, HIGH))),), "wood", (0.5 * THIN, 0.0, 0.5 * HIGH))
    return Scene("thin_wall_hand", (wall,), (rigid_hand(),), start=_sample(0.0, BEFORE, 0.0, 0.0))


def motion(scene: Scene, seed: int) -> Motion:
    """Thrust after thrust, each from another side and faster than the one before."""
    random = np.random.default_rng(seed)
    thrusts = FRAMES // CYCLE
    speeds = np.geomspace(SLOWEST, FASTEST, thrusts)
    aims = random.uniform(-0.3, 0.3, (thrusts, 2))

    def sample(frame: int) -> TrackerSample:
        k = min(frame // CYCLE, thrusts - 1)
        inside = frame - k * CYCLE + 1
        # at the stated speed to the far end, there until half-time, at the same speed back
        way = min(inside, max(CYCLE // 2 - inside + _frames_for(speeds[k]), 0)) * RENDERED * speeds[k]
        share = float(np.clip(way / (BEHIND - BEFORE), 0.0, 1.0))
        y, yaw = share * aims[k] * (1.0, 2.0)
        # a hand trembles: it never rests altogether
        tremble = 2e-3 * np.sin(0.9 * frame)
        return _sample((frame + 1) * RENDERED, BEFORE + share * (BEHIND - BEFORE) + tremble, float(y), float(yaw))

    return sample


def _frames_for(speed: float) -> int:
    """Frames that the way from end to end takes at `speed` [m/s]."""
    return int(np.ceil((BEHIND - BEFORE) / (speed * RENDERED)))


def _sample(time: float, x: float, y: float, yaw: float) -> TrackerSample:
    turned = rotation.from_axis_angle((0.0, 0.0, 1.0), yaw)
    return TrackerSample(time, np.array([[x, y, 0.5 * HIGH]]), turned.reshape(1, 4), np.zeros(0))


SCENARIO = Scenario(
    name="thin_wall_hand",
    title="A rigid hand is driven through a wall of two millimetres, at 2 to 20 m/s.",
    judged="The right side of the wall, sub-steps included; overlap.",
    build=build,
    motion=motion,
    frames=FRAMES,
    bounds=(NO_OVERLAP, RIGHT_SIDE, FINITE, *MOVES, FOLLOWS_WHEN_FREE),
    regions=(
        Region(
            ("hand",), (-INFINITE, -INFINITE, -INFINITE), (0.5 * THIN, INFINITE, INFINITE),
            "the wall is endless: there is no way behind it",
        ),
    ),
)
