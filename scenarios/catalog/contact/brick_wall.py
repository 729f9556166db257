"""A wall of 48 bricks without mortar, struck by a ball: it stands until then, breaks, and its pieces come to rest."""

from avatarsim.scene.body import Body, ContactLaw, fixed, simulated, solid
from avatarsim.scene.scene import Scene
from avatarsim.scene.shape import Box, Piece, Sphere
from scenarios.building.cases import pair_table
from scenarios.building.promises import CROWD, GAINS_NOTHING
from scenarios.motion.untracked import untracked
from scenarios.scenario import INFINITE, Bound, Region, Scenario

LONG, DEEP, HIGH = 0.2, 0.1, 0.065
"""Edges of a brick [m]."""
ROWS, COLUMNS = 8, 6
"""Layers of bricks, and bricks in a layer; every other layer is shifted by half a brick."""
BRICK, BALL = 2.0, 5.0
"""Masses [kg]."""
JOINT, AIR = 5e-4, 1e-4
"""Gaps between bricks of a layer and below each layer at the start [m]."""
RADIUS, DISTANCE, HEIGHT = 0.1, 0.6, 0.3
"""Radius of the ball, and where it begins before and above [m]."""
SPEED = (0.0, 8.0, 0.6)
"""Its velocity [m/s]: a throw that arrives at the height it began at."""
NAMES = tuple(f"brick_{row}_{column}" for row in range(ROWS) for column in range(COLUMNS))


def build() -> Scene:
    """The wall along x, and the ball on its way."""
    pieces, round_ = (Piece(Box((LONG, DEEP, HIGH))),), (Piece(Sphere(RADIUS)),)
    bodies: list[Body] = [fixed("floor", (Piece(Box((40.0, 40.0, 0.2))),), "floor", (0.0, 0.0, -0.1))]
    for k, name in enumerate(NAMES):
        row, column = divmod(k, COLUMNS)
        x = (column - 2.5 + (0.25 if row % 2 else -0.25)) * (LONG + JOINT)
        bodies.append(simulated(name, pieces, "brick", solid(pieces, BRICK), (x, 0.0, 0.5 * HIGH + AIR + row * (HIGH + AIR))))
    bodies.append(simulated("ball", round_, "brick", solid(round_, BALL), (0.03, -DISTANCE, HEIGHT), velocity=SPEED))
    law = ContactLaw(0.1, 0.5)
    materials = pair_table(("floor", "brick"), {("floor", "brick"): law, ("brick", "brick"): law})
    return Scene("brick_wall", tuple(bodies), materials=materials)


SCENARIO = Scenario(
    name="brick_wall",
    title="A ball breaks a wall of bricks.",
    judged="Overlap, time kept, energy; that ball and bricks go on.",
    build=build,
    motion=untracked(),
    frames=480,
    short=75,
    bounds=(*CROWD, GAINS_NOTHING, Bound("travel_missing", 0.0, "the ball comes to the wall and goes on into it")),
    regions=(Region(("brick_*", "ball"), (-INFINITE, -INFINITE, 0.0), (INFINITE,) * 3, "nothing falls through the floor"),),
    expects={"travel": {"ball": DISTANCE - RADIUS - 0.5 * DEEP + 0.1}, "alone": ((*NAMES, "ball"),)},
)
