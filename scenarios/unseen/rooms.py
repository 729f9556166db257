"""The five rooms of the unseen motions; the motion is placed in each by its seed."""

from collections.abc import Callable

import numpy as np

from avatarsim.scene.body import Body
from avatarsim.scene.scene import Scene
from avatarsim.scene.shape import Box
from runfiles.naming import UNSEEN_PREFIX
from scenarios.building import gallery, stage
from scenarios.building.cases import fixture
from scenarios.building.promises import SOUND, WITHIN_CONES, WITHIN_LIMITS
from scenarios.scenario import Motion, Region, Scenario
from scenarios.unseen.drawn_motion import Corner, drawn_motion

FRAMES = 600
"""Ten seconds: four to eight pieces of clips."""
FACE, ENDLESS = 0.55, 200.0
"""Where the endless wall begins along x, and its width and that of its floor [m]: a path round an end of it is 100 m long, and
an avatar goes 50 m in the ten seconds (5 m/s, the setting catch_up_move)."""
NARROW, LOW, MOUTH, LONG = 0.5, 1.5, 0.5, 15.0
"""Width of the corridor and height of its ceiling, where it begins along x, and its length [m]; the avatar is 1.6 m high."""
PARTED, DOOR, LINTEL = 1.2, 0.9, 2.1
"""Where the wall between two rooms begins along x, the width and height of its doorway [m]."""
PROMISES = (*SOUND, WITHIN_LIMITS, WITHIN_CONES)
"""Bounds that hold whatever the motion is. How it looks is measured and has no bound."""


def wall() -> tuple[Body, ...]:
    """Return a floor, and a wall that nothing can walk round."""
    thick = stage.THICK
    return (
        fixture("floor", Box((ENDLESS, ENDLESS, thick)), "wood", (0.0, 0.0, -0.5 * thick)),
        fixture("wall", Box((thick, ENDLESS, stage.HIGH)), "wood", (FACE + 0.5 * thick, 0.0, 0.5 * stage.HIGH)),
    )


def corridor() -> tuple[Body, ...]:
    """Return two walls NARROW apart under a ceiling lower than the avatar, open at both ends."""
    middle, thick = MOUTH + 0.5 * LONG, stage.THICK
    side, aside = Box((LONG, thick, stage.HIGH)), 0.5 * (NARROW + thick)
    return (
        stage.floor(),
        fixture("wall_left", side, "wood", (middle, aside, 0.5 * stage.HIGH)),
        fixture("wall_right", side, "wood", (middle, -aside, 0.5 * stage.HIGH)),
        fixture("ceiling", Box((LONG, stage.HIGH, thick)), "wood", (middle, 0.0, LOW + 0.5 * thick)),
    )


def door() -> tuple[Body, ...]:
    """Return an endless wall with one doorway, and so two rooms."""
    x, wide = PARTED + 0.5 * stage.THICK, 0.5 * (stage.SPAN - DOOR)
    side, aside, above = Box((stage.THICK, wide, stage.HIGH)), 0.5 * (wide + DOOR), stage.HIGH - LINTEL
    return (
        stage.floor(),
        fixture("wall_left", side, "wood", (x, aside, 0.5 * stage.HIGH)),
        fixture("wall_right", side, "wood", (x, -aside, 0.5 * stage.HIGH)),
        fixture("lintel", Box((stage.THICK, DOOR, above)), "wood", (x, 0.0, LINTEL + 0.5 * above)),
    )


def room(
    name: str, what: str, bodies: Callable[[], tuple[Body, ...]], start: tuple[float, float, float], low: Corner, high: Corner,
    allowed: Region,
) -> Scenario:
    """Return a room of `bodies`, where the avatar starts at x, y [m] and a heading [rad], and whose links stay in `allowed`.

    The user's ways end in the rectangle from `low` to `high` [m], which may go beyond the avatar's reach.
    """

    def motion(scene: Scene, seed: int) -> Motion:
        # with the room's name, so that one seed is another motion in each room
        random = np.random.default_rng([seed, *name.encode()])
        return drawn_motion(scene.avatars[0], scene.first_sample, start[2], low, high, FRAMES, random).motion()

    return stage.with_human(
        f"{UNSEEN_PREFIX}{name}",
        f"Motions that nothing was tuned for, {what}: clips recombined, mirrored, time-warped, layered.",
        "Overlap, limits and the right side, as promised; without a bound, how it looks: chatter, reversals, dashes.",
        motion, bodies, start, frames=FRAMES, bounds=PROMISES, region=allowed,
        metrics=("chatter_frames", "reversal_p95", "own_acceleration_rms", "dash_frames", "silent_offset_frames"),
    )


LINKS = "human/*"
ABOVE = stage.above_floor(LINKS)
ROOMS = (
    room("floor", "on a floor", lambda: (stage.floor(),), (0.0, 0.0, 0.0), (-2.0, -2.0), (2.0, 2.0), ABOVE),
    room("wall", "before an endless wall", wall, (0.0, 0.0, 0.0), (-0.8, -1.5), (0.95, 1.5), stage.before_wall(FACE, LINKS)),
    room("gallery", "in the gallery", gallery.gallery, (1.0, -0.8, 0.0), (-4.4, -2.4), (4.4, 2.4), gallery.inside(LINKS)),
    room("corridor", "in a narrow, low corridor", corridor, (0.0, 0.0, 0.0), (-0.3, -0.15), (3.5, 0.15), ABOVE),
    room("door", "between two rooms with a door", door, (0.0, 0.0, 0.0), (-1.0, -1.2), (3.4, 1.2), ABOVE),
)
