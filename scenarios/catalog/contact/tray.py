"""A flat hand lifts a box of 0.3 kg off two posts and holds still: by equation 6 it sags by m g / K, 2.943 mm, and no more."""

from avatarsim.scene.checks import Vector
from avatarsim.settings import CouplingSettings
from scenarios.building.expected import Carried, Sag
from scenarios.building.posts import HIGH, LOW, box_across_posts
from scenarios.building.promises import FINITE, KEEPS_MOVING, KEEPS_TIME, NO_OVERLAP, RIGHT_SIDE
from scenarios.motion.rigid_hands import eased, led
from scenarios.scenario import Bound, Region, Scenario

MASS = 0.3
"""Mass of the box [kg]."""
LIFTED = (0.1, 0.8)
"""When the hand rises [s]."""
STILL = 1.5
"""From then on [s] all is still: the spring of equation 6 has lost all but 1e-9 of its swing."""
SAG = 9.81 * MASS / CouplingSettings().spring


def places(time: float) -> tuple[Vector]:
    """The hand, which rises and then holds still."""
    return ((0.0, 0.0, LOW + (HIGH - LOW) * eased(time, *LIFTED)),)


SCENARIO = Scenario(
    name="tray",
    title="A flat hand lifts a box and holds it still.",
    judged="How far the hand sags under the load; that the box does not slip.",
    build=lambda: box_across_posts("tray", MASS, 0.5),
    motion=led(places),
    frames=600,
    short=110,
    bounds=(
        NO_OVERLAP, RIGHT_SIDE, FINITE, KEEPS_MOVING, KEEPS_TIME,
        Bound("sag_error_max", 1e-5, "equation 6 at rest: K times the lag is the load; a hundredth of a millimetre is not seen"),
        Bound("height_missing", 1e-4, "the box stays on the hand"),
        Bound("grip_slip_max", 1e-4, "what lies on a hand that holds still lies still"),
    ),
    regions=(
        Region(("box", "hand"), (-0.1, -0.1, 0.2), (0.1, 0.1, 0.6), "the box lies on the hand, and the hand is below its user"),
    ),
    expects={"sags": (Sag("hand", SAG, STILL),), "carried": (Carried("box", ("hand",), STILL),)},
)
