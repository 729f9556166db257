"""A mug that is attached to a hand is lifted, carried aside, tilted and pressed 3 cm into the floor: the hand stays above it."""

from dataclasses import replace

import numpy as np

from avatarsim.scene.avatar import rigid_avatar
from avatarsim.scene.body import solid
from avatarsim.scene.scene import Scene
from avatarsim.scene.shape import Piece, Sphere
from avatarsim.scene.tracker import TrackerSample
from avatarsim.settings import CouplingSettings
from avatarsim.spatial import rotation
from scenarios.building.cases import LAID
from scenarios.building.expected import Carried
from scenarios.building.promises import FINITE, KEEPS_MOVING, NO_LEAP, NO_OVERLAP, RIGHT_SIDE
from scenarios.building.things import MUG_HEIGHT, MUG_MASS, mug_on_floor
from scenarios.motion.rigid_hands import eased
from scenarios.scenario import RENDERED, Bound, Motion, Region, Scenario

FIST, FIST_MASS, ASIDE_OF = 0.045, 0.5, 0.082
"""Radius [m] and mass [kg] of the hand, and its distance from the axis of the mug [m]."""
SAG = 9.81 * MUG_MASS / CouplingSettings().spring * (1.0 + (ASIDE_OF / FIST) ** 2)
"""Sag of the mug below its user [m]: m g / K, and a turn by eq. 6 with the squared ratio of lever and hand."""
RISES, ASIDE, TILTS, UPRIGHT, SINKS, LIFTS = (0.2, 1.0), (1.2, 2.2), (2.2, 2.7), (2.7, 3.2), (3.3, 4.1), (5.0, 5.6)
"""Begin and end [s] of each part of the user's motion."""
RISE, CARRY, TILT, INTO = 0.2, 0.3, 0.6, 0.03
"""Height of the lift, distance aside [m], tilt [rad], and depth below the floor to which the user lowers the mug [m]."""


def at(time: float) -> TrackerSample:
    """The user at a time [s]."""
    height = 0.5 * MUG_HEIGHT + LAID + RISE * eased(time, *RISES) + (RISE + INTO) * (eased(time, *LIFTS) - eased(time, *SINKS))
    turn = rotation.from_axis_angle((0.0, 1.0, 0.0), TILT * (eased(time, *TILTS) - eased(time, *UPRIGHT)))
    place = (CARRY * eased(time, *ASIDE) - ASIDE_OF, 0.0, height)
    return TrackerSample(time, np.array([place]), turn[None], np.zeros(0))


def build() -> Scene:
    """Return the mug on a floor, and the hand beside it that holds it."""
    fist = (Piece(Sphere(FIST)),)
    hand = rigid_avatar("hand", fist, solid(fist, FIST_MASS), "hand")
    return mug_on_floor("carried_mug", hand, at(0.0), (("mug", "hand"),))


def motion(scene: Scene, seed: int) -> Motion:
    """Return the motion, equal for all seeds."""
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
