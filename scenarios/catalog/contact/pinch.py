"""Two flat pads press a box between them, lift it, hold it and let it go: boxes of 0.3 and of 1 kg.

Each user goes one or two centimetres into the box, which by equation 6 is 10 or 20 N: with a friction of 0.6 the pads hold
4 times the weight of the light box, and 2.4 times that of the heavy one. They sag under it by m g / 2 K.
"""

from dataclasses import replace

from avatarsim.scene.avatar import rigid_avatar
from avatarsim.scene.body import ContactLaw, fixed, simulated, solid
from avatarsim.scene.checks import Vector
from avatarsim.scene.scene import Scene
from avatarsim.scene.shape import Box, Piece
from avatarsim.settings import CouplingSettings
from scenarios.building.cases import LAID, pair_table
from scenarios.building.expected import Carried
from scenarios.building.promises import FINITE, KEEPS_MOVING, KEEPS_TIME, NO_OVERLAP, RIGHT_SIDE
from scenarios.motion.rigid_hands import eased, hands_at, led
from scenarios.scenario import INFINITE, Bound, Region, Scenario

EDGE, LIGHT, HEAVY = 0.08, 0.3, 1.0
"""Edge [m] and masses [kg] of the box."""
PAD, HAND_MASS = (0.02, 0.06, 0.06), 0.5
"""Edges [m] and mass [kg] of a pad."""
OPEN, HIGH, RISE = 0.10, 0.05, 0.3
"""Where a pad begins beside and above [m], and how far both rise."""
CLOSED, UP, LET_GO = (0.1, 0.6), (0.8, 1.8), (2.8, 3.2)
"""When the pads close, rise and open [s]."""
PAIRS = (("pad", "box"), ("pad", "floor"), ("box", "floor"))


def places(time: float, into: float) -> tuple[Vector, Vector]:
    """The pads at +x and -x, which press `into` the box [m]."""
    touching = 0.5 * EDGE + 0.5 * PAD[0]
    x = OPEN - (OPEN - touching + into) * (eased(time, *CLOSED) - eased(time, *LET_GO))
    z = HIGH + RISE * eased(time, *UP)
    return (x, 0.0, z), (-x, 0.0, z)


def build(name: str, mass: float, into: float) -> Scene:
    """The box on a floor, a pad on either side."""
    pieces, pad = (Piece(Box((EDGE, EDGE, EDGE))),), (Piece(Box(PAD)),)
    floor = fixed("floor", (Piece(Box((4.0, 4.0, 0.2))),), "floor", (0.0, 0.0, -0.1))
    box = simulated("box", pieces, "box", solid(pieces, mass), (0.0, 0.0, 0.5 * EDGE + LAID))
    pads = tuple(rigid_avatar(name, pad, solid(pad, HAND_MASS), "pad") for name in ("right", "left"))
    law = ContactLaw(0.0, 0.6)
    materials = pair_table(("pad", "box", "floor"), dict.fromkeys(PAIRS, law))
    return Scene(name, (floor, box), pads, materials, start=hands_at(places(0.0, into)))


def of(name: str, mass: float, into: float) -> Scenario:
    """The scene with a box of `mass` [kg], pressed by `into` [m] on either side."""
    sag = 9.81 * mass / (2.0 * CouplingSettings().spring)
    return Scenario(
        name=name,
        title=f"Two pads pinch a box of {mass:g} kg and lift it.",
        judged="Overlap; that the box comes along, and does not slip.",
        build=lambda: build(name, mass, into),
        motion=led(lambda time: places(time, into)),
        frames=240,
        short=140,
        bounds=(
            NO_OVERLAP, RIGHT_SIDE, FINITE, replace(KEEPS_MOVING, limit=5.0), KEEPS_TIME,
            Bound("height_missing", sag + 1e-3, "the box rises with its users, less the sag m g / 2 K, to a millimetre"),
            Bound("grip_slip_max", 1e-4, "within Coulomb's cone nothing slips; what springs yield as they rise is less"),
        ),
        regions=(
            Region(("box",), (-0.2, -0.2, 0.0), (0.2, 0.2, 0.6), "the box is neither shot away nor pressed into the floor"),
            Region(("right", "left"), (-INFINITE, -INFINITE, 0.0), (INFINITE,) * 3, "no pad goes through the floor"),
        ),
        expects={"carried": (Carried("box", ("right", "left"), CLOSED[1] + 0.1, LET_GO[0]),)},
    )


SCENARIOS = (of("pinch_light", LIGHT, 0.01), of("pinch_heavy", HEAVY, 0.02))
