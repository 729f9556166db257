"""A ball breaks a wall of 48 bricks without mortar."""

from collections.abc import Iterator

from avatarsim.scene.body import Body
from avatarsim.scene.shape import Box, Sphere
from scenarios.building.cases import loose, one_law, slab
from scenarios.building.promises import CROWD, GAINS_NOTHING
from scenarios.building.scenes import above, undriven
from scenarios.scenario import Bound

LONG, DEEP, HIGH = 0.2, 0.1, 0.065
"""Edges of a brick [m]."""
ROWS, COLUMNS = 8, 6
"""Layers of bricks, and bricks in a layer; every other layer is shifted by half a brick."""
JOINT, AIR = 5e-4, 1e-4
"""Gaps between bricks of a layer and below each layer at the start [m]."""
RADIUS, DISTANCE, HEIGHT = 0.1, 0.6, 0.3
"""Radius of the ball, and where it begins before and above [m]."""
NAMES = tuple(f"brick_{row}_{column}" for row in range(ROWS) for column in range(COLUMNS))


def bodies() -> Iterator[Body]:
    """The wall along x, and the ball, which arrives at the height at which it begins."""
    yield slab(40.0, 40.0)
    for k, name in enumerate(NAMES):
        row, column = divmod(k, COLUMNS)
        x = (column - 2.5 + (0.25 if row % 2 else -0.25)) * (LONG + JOINT)
        yield loose(name, Box((LONG, DEEP, HIGH)), "brick", 2.0, (x, 0.0, 0.5 * HIGH + AIR + row * (HIGH + AIR)))
    yield loose("ball", Sphere(RADIUS), "brick", 5.0, (0.03, -DISTANCE, HEIGHT), velocity=(0.0, 8.0, 0.6))


SCENARIO = undriven(
    "brick_wall", "A ball breaks a wall of bricks.", "Overlap, time kept, energy; that ball and bricks go on.", bodies,
    one_law(0.1, 0.5, ("floor", "brick"), ("brick", "brick")), frames=480, short=75,
    bounds=(*CROWD, GAINS_NOTHING, Bound("travel_missing", 0.0, "the ball comes to the wall and goes on into it")),
    regions=(above(0.0, "brick_*", "ball"),),
    expects={"travel": {"ball": DISTANCE - RADIUS - 0.5 * DEEP + 0.1}, "alone": ((*NAMES, "ball"),)},
)
