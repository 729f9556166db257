"""A palm presses a coin on a table with 20 N and holds: the coin has no reason to go anywhere."""

from dataclasses import replace

from avatarsim.scene.checks import Vector
from avatarsim.scene.shape import Box
from scenarios.building.cases import LAID, driven, loose, one_law, slab
from scenarios.building.expected import Pressed
from scenarios.building.promises import KEEPS_MOVING, SOUND
from scenarios.building.scenes import led_hands
from scenarios.building.things import COIN, COIN_MASS, COIN_THICK
from scenarios.motion.rigid_hands import eased
from scenarios.scenario import Bound, Region

AT = (0.004, 0.003)
"""Where the coin lies: not below the middle of the palm, so that the palm would tilt [m]."""
PALM = (0.1, 0.1, 0.02)
"""Edges of the palm [m]."""
ABOVE, DEEP = 0.04, 0.02
"""How high the palm begins above the coin, and how far its user goes beyond the coin's face [m]: 20 N by equation 6."""


def places(time: float) -> tuple[Vector]:
    """The palm, which comes down and presses."""
    return ((0.0, 0.0, COIN_THICK + 0.5 * PALM[2] + ABOVE - (ABOVE + DEEP) * eased(time, 0.1, 0.9)),)


SCENARIO = led_hands(
    "press_coin", "A palm presses a coin on a table.", "That the coin stays where it is.",
    lambda: (slab(2.0, 2.0, "wood", "table"), loose("coin", COIN, "coin", COIN_MASS, (*AT, 0.5 * COIN_THICK + LAID))),
    lambda: (driven("hand", Box(PALM), 0.5, "hand"),), places, one_law(0.0, 0.5, ("wood", "coin"), ("coin", "hand")),
    frames=1800, short=120,
    bounds=(
        *SOUND, replace(KEEPS_MOVING, limit=15.0, reason="while its user goes on into the coin the palm has nowhere to go"),
        Bound("pressed_sideways_max", 1e-5, "pressed straight down within friction's cone nothing slides"),
    ),
    regions=(
        Region(("coin", "hand"), (-0.1, -0.1, 0.0), (0.1, 0.1, 0.2), "the coin is neither shot away nor pressed into the table"),
    ),
    expects={"pressed": (Pressed("coin", 1.0),)},
)
