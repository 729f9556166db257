"""A door swings against eight boxes that walls keep from going away: it stops, and says so."""

from avatarsim.scene.body import ContactLaw, fixed, simulated, solid
from avatarsim.scene.joint import Hinge, Hinges
from avatarsim.scene.moving import moving
from avatarsim.scene.scene import Scene
from avatarsim.scene.shape import Box, Piece
from scenarios.building.cases import LAID, pair_table
from scenarios.building.expected import Rest
from scenarios.building.promises import FINITE, KEEPS_TIME, NO_OVERLAP, RIGHT_SIDE
from scenarios.motion.moving_bodies import given
from scenarios.scenario import Bound, Region, Scenario

SPEED, FARTHEST = 0.8, 1.5
"""Angular velocity of the door [rad/s], and how far it is to turn [rad]."""
EDGE, PITCH = 0.18, 0.19
"""Edge of a box, and how far apart their middles are [m]."""
NAMES = tuple(f"box_{k}" for k in range(8))


def build() -> Scene:
    """Return floor, three walls, eight boxes in two rows, and the door."""
    floor = fixed("floor", (Piece(Box((4.0, 4.0, 0.2))),), "wood", (0.0, 0.0, -0.1))
    walls = tuple(
        fixed(name, (Piece(Box(size)),), "wood", place) for name, size, place in (
            ("back", (2.0, 0.1, 0.6), (0.4, -0.6, 0.3)), ("side", (0.1, 1.2, 0.6), (0.97, -0.6, 0.3)),
            ("near", (0.1, 0.45, 0.6), (0.1, -0.4, 0.3)),
        )
    )
    cube = (Piece(Box((EDGE, EDGE, EDGE))),)
    boxes = tuple(
        simulated(name, cube, "box", solid(cube, 2.0), (0.25 + PITCH * (k % 4), -0.25 - PITCH * (k // 4), 0.5 * EDGE + LAID))
        for k, name in enumerate(NAMES)
    )
    leaf = (Piece(Box((0.8, 0.04, 1.0)), (0.42, 0.0, 0.52)),)
    door = moving("door", leaf, "wood", joint=Hinges((Hinge((0.0, 0.0, 1.0), -2.0, 2.0),)))
    law = ContactLaw(0.0, 0.4)
    table = pair_table(("wood", "box"), {("wood", "box"): law, ("box", "box"): law})
    return Scene("door_and_boxes", (floor, *walls, *boxes), (door,), table)


SCENARIO = Scenario(
    name="door_and_boxes",
    title="A door swings against boxes that cannot go away.",
    judged="That the door stops and the boxes come to rest.",
    build=build,
    motion=given(lambda time: {"door": -min(SPEED * time, FARTHEST)}),
    frames=300,
    short=180,
    bounds=(
        NO_OVERLAP, RIGHT_SIDE, FINITE, KEEPS_TIME,
        Bound("travel_missing", 0.0, "the door pushes the boxes together"),
        Bound("drift_max", 1e-4, "boxes between a door at rest and walls are at rest"),
    ),
    regions=(Region(NAMES, (0.1, -0.6, 0.0), (0.97, 0.2, 0.4), "the boxes stay between door and walls"),),
    expects={"rests": (Rest(NAMES, 2.0),), "travel": {"box_3": 0.01}},
)
