"""A palm presses a coin on a table with 20 N and holds: the coin has no reason to go anywhere."""

from dataclasses import replace

from avatarsim.scene.avatar import rigid_avatar
from avatarsim.scene.body import ContactLaw, fixed, simulated, solid
from avatarsim.scene.checks import Vector
from avatarsim.scene.scene import Scene
from avatarsim.scene.shape import Box, Piece
from scenarios.building.cases import LAID, pair_table
from scenarios.building.expected import Pressed
from scenarios.building.promises import FINITE, KEEPS_MOVING, NO_OVERLAP, RIGHT_SIDE
from scenarios.building.things import prism
from scenarios.motion.rigid_hands import eased, hands_at, led
from scenarios.scenario import Bound, Region, Scenario

RADIUS, THICK, MASS = 0.012, 0.002, 0.007
"""Of the coin, a prism of 20 sides [m, kg]."""
AT = (0.004, 0.003)
"""Where it lies: not below the middle of the palm, so that the palm would tilt [m]."""
PALM, PALM_MASS = (0.1, 0.1, 0.02), 0.5
"""Edges [m] and mass [kg] of the palm."""
ABOVE, DEEP = 0.04, 0.02
"""How high the palm begins above the coin, and how far its user goes beyond the coin's face [m]: 20 N by equation 6."""
DOWN = (0.1, 0.9)
"""When the user goes down [s]."""
HELD = 1.0
"""From then on [s] the coin is pressed."""


def places(time: float) -> tuple[Vector]:
    """The palm, which comes down and presses."""
    return ((0.0, 0.0, THICK + 0.5 * PALM[2] + ABOVE - (ABOVE + DEEP) * eased(time, *DOWN)),)


def build() -> Scene:
    """A coin on a table, and a palm above it."""
    coin, palm = (prism(20, RADIUS, THICK),), (Piece(Box(PALM)),)
    table = fixed("table", (Piece(Box((2.0, 2.0, 0.2))),), "wood", (0.0, 0.0, -0.1))
    body = simulated("coin", coin, "coin", solid(coin, MASS), (*AT, 0.5 * THICK + LAID))
    hand = rigid_avatar("hand", palm, solid(palm, PALM_MASS), "hand")
    law = ContactLaw(0.0, 0.5)
    materials = pair_table(("wood", "coin", "hand"), {("wood", "coin"): law, ("coin", "hand"): law})
    return Scene("press_coin", (table, body), (hand,), materials, start=hands_at(places(0.0)))


SCENARIO = Scenario(
    name="press_coin",
    title="A palm presses a coin on a table.",
    judged="That the coin stays where it is.",
    build=build,
    motion=led(places),
    frames=1800,
    short=120,
    bounds=(
        NO_OVERLAP, RIGHT_SIDE, FINITE,
        replace(KEEPS_MOVING, limit=15.0, reason="while its user goes on into the coin the palm has nowhere to go"),
        Bound("pressed_sideways_max", 1e-5, "pressed straight down within friction's cone nothing slides"),
    ),
    regions=(
        Region(("coin", "hand"), (-0.1, -0.1, 0.0), (0.1, 0.1, 0.2), "the coin is neither shot away nor pressed into the table"),
    ),
    expects={"pressed": (Pressed("coin", HELD),)},
)
