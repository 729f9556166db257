"""A mug that is attached to a hand is lifted, carried aside, tilted and pressed 3 cm into the floor: the hand stays above it."""

from dataclasses import replace

import numpy as np

from avatarsim.scene.avatar import rigid_avatar
from avatarsim.scene.body import ContactLaw, fixed, simulated, solid
from avatarsim.scene.scene import Scene
from avatarsim.scene.shape import Box, Piece, Sphere
from avatarsim.scene.tracker import TrackerSample
from avatarsim.settings import CouplingSettings
from avatarsim.spatial import rotation
from scenarios.building.cases import LAID, pair_table
from scenarios.building.expected import Carried
from scenarios.building.promises import FINITE, KEEPS_MOVING, NO_LEAP, NO_OVERLAP, RIGHT_SIDE
from scenarios.building.things import prism
from scenarios.motion.rigid_hands import eased
from scenarios.scenario import RENDERED, Bound, Motion, Region, Scenario

RADIUS, HIGH, MASS = 0.035, 0.09, 0.35
"""Of the mug [m, kg]."""
FIST, FIST_MASS, ASIDE_OF = 0.045, 0.5, 0.082
"""Radius [m] and mass [kg] of the hand, and how far it is beside the mug's axis [m]."""
SAG = 9.81 * MASS / CouplingSettings().spring * (1.0 + (ASIDE_OF / FIST) ** 2)
"""How far the mug hangs below its user [m]: m g / K, and its lever squared over the size of the hand, by which eq. 6 turns."""
RISES, ASIDE, TILTS, UPRIGHT, SINKS, LIFTS = (0.2, 1.0), (1.2, 2.2), (2.2, 2.7), (2.7, 3.2), (3.3, 4.1), (5.0, 5.6)
"""When the user does what [s]."""
RISE, CARRY, TILT, INTO = 0.2, 0.3, 0.6, 0.03
"""How far up, aside [m], the tilt [rad], and how far into the floor the user sets the mug down [m]."""


def at(time: float) -> TrackerSample:
    """The user at a time [s]."""
    height = 0.5 * HIGH + LAID + RISE * eased(time, *RISES) + (RISE + INTO) * (eased(time, *LIFTS) - eased(time, *SINKS))
    turn = rotation.from_axis_angle((0.0, 1.0, 0.0), TILT * (eased(time, *TILTS) - eased(time, *UPRIGHT)))
    place = (CARRY * eased(time, *ASIDE) - ASIDE_OF, 0.0, height)
    return TrackerSample(time, np.array([place]), turn[None], np.zeros(0))


def build() -> Scene:
    """Return the mug on a floor, and the hand beside it that holds it."""
    mug, fist = (prism(24, RADIUS, HIGH),), (Piece(Sphere(FIST)),)
    floor = fixed("floor", (Piece(Box((4.0, 4.0, 0.2))),), "floor", (0.0, 0.0, -0.1))
    body = simulated("mug", mug, "mug", solid(mug, MASS), (0.0, 0.0, 0.5 * HIGH + LAID))
    law = ContactLaw(0.0, 0.7)
    materials = pair_table(("floor", "mug", "hand"), {("floor", "mug"): law, ("mug", "hand"): law})
    hand = rigid_avatar("hand", fist, solid(fist, FIST_MASS), "hand")
    return Scene("carried_mug", (floor, body), (hand,), materials, start=at(0.0), attached=(("mug", "hand"),))


def motion(scene: Scene, seed: int) -> Motion:
    """The same with every seed."""
    return lambda frame: at((frame + 1) * RENDERED)


SCENARIO = Scenario(
    name="carried_mug",
    title="A mug attached to a hand is carried, tilted and pressed onto the floor.",
    judged="Overlap; that the mug keeps its place on the hand, in the air and pressed onto the floor.",
    build=build,
    motion=motion,
    frames=345,
    bounds=(
        NO_OVERLAP, RIGHT_SIDE, FINITE, replace(KEEPS_MOVING, limit=5.0), NO_LEAP,
        Bound("height_missing", 1.05 * SAG, "the mug rises with its user, less what eq. 6 sags and turns under its weight"),
        Bound("grip_slip_max", 1e-6, "what is attached is one body with the hand"),
    ),
    regions=(Region(("mug",), (-0.2, -0.2, 0.0), (0.6, 0.2, 0.4), "the mug is neither shot away nor pressed into the floor"),),
    expects={"carried": (Carried("mug", ("hand",), 0.1, SINKS[0]), Carried("mug", ("hand",), SINKS[0]))},
)
