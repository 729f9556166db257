"""Two flat pads press a box between them, lift it, hold it and let it go.

Each user goes one or two centimetres into the box, by equation 6 10 or 20 N: the pads hold 4 times the weight of the light box,
and 2.4 times that of the heavy one, and sag under it by m g / 2 K.
"""

from dataclasses import replace

from avatarsim.scene.checks import Vector
from avatarsim.scene.shape import Box
from avatarsim.settings import CouplingSettings
from scenarios.building.cases import LAID, driven, loose, one_law, slab
from scenarios.building.expected import Carried
from scenarios.building.promises import KEEPS_MOVING, KEEPS_TIME, SOUND
from scenarios.building.scenes import above, led_hands
from scenarios.motion.rigid_hands import eased
from scenarios.scenario import Bound, Region, Scenario

EDGE, PAD = 0.08, (0.02, 0.06, 0.06)
"""Edges of the box and of a pad [m]."""
OPEN, HIGH, RISE = 0.10, 0.05, 0.3
"""Where a pad begins beside and above [m], and how far both rise."""
CLOSED, UP, LET_GO = (0.1, 0.6), (0.8, 1.8), (2.8, 3.2)
"""When the pads close, rise and open [s]."""


def places(time: float, into: float) -> tuple[Vector, Vector]:
    """The pads at +x and -x, which press `into` the box [m]."""
    touching = 0.5 * EDGE + 0.5 * PAD[0]
    x = OPEN - (OPEN - touching + into) * (eased(time, *CLOSED) - eased(time, *LET_GO))
    z = HIGH + RISE * eased(time, *UP)
    return (x, 0.0, z), (-x, 0.0, z)


def of(name: str, mass: float, into: float) -> Scenario:
    """The scene with a box of `mass` [kg], pressed by `into` [m] on either side."""
    sag = 9.81 * mass / (2.0 * CouplingSettings().spring)
    return led_hands(
        name, f"Two pads pinch a box of {mass:g} kg and lift it.", "Overlap; that the box comes along, and does not slip.",
        lambda: (slab(4.0, 4.0), loose("box", Box((EDGE, EDGE, EDGE)), "box", mass, (0.0, 0.0, 0.5 * EDGE + LAID))),
        lambda: (driven("right", Box(PAD), 0.5, "pad"), driven("left", Box(PAD), 0.5, "pad")),
        lambda time: places(time, into), one_law(0.0, 0.6, ("pad", "box"), ("pad", "floor"), ("box", "floor")),
        frames=240, short=140,
        bounds=(
            *SOUND, replace(KEEPS_MOVING, limit=5.0), KEEPS_TIME,
            Bound("height_missing", sag + 1e-3, "the box rises with its users, less the sag m g / 2 K, to a millimetre"),
            Bound("grip_slip_max", 1e-4, "within Coulomb's cone nothing slips; springs yield by less as they rise"),
        ),
        regions=(
            Region(("box",), (-0.2, -0.2, 0.0), (0.2, 0.2, 0.6), "the box is neither shot away nor pressed into the floor"),
            above(0.0, "right", "left"),
        ),
        expects={"carried": (Carried("box", ("right", "left"), CLOSED[1] + 0.1, LET_GO[0]),)},
    )


SCENARIOS = (of("pinch_light", 0.3, 0.01), of("pinch_heavy", 1.0, 0.02))
