"""A palm with three hinged fingers closes on a mug from above, lifts it, carries it aside, tilts it and sets it down."""

import math
from dataclasses import replace

import numpy as np

from avatarsim.scene.avatar import Avatar, Link
from avatarsim.scene.body import solid
from avatarsim.scene.checks import Vector
from avatarsim.scene.joint import Free, Hinge, Hinges
from avatarsim.scene.shape import Capsule, Piece
from avatarsim.scene.tracker import TrackerSample
from avatarsim.settings import CouplingSettings
from avatarsim.spatial import rotation
from scenarios.building.expected import Carried
from scenarios.building.promises import KEEPS_MOVING, NO_LEAP, NO_LEAP_OF_THE_ROOT, SOUND, WITHIN_LIMITS
from scenarios.building.things import MUG_MASS, mug_on_floor, prism
from scenarios.motion.rigid_hands import by_time, eased
from scenarios.scenario import Bound, Region, Scenario

PALM, PALM_MASS, BOTTOM = (0.07, 0.02), 0.5, 0.125
"""Radius and thickness [m] and mass [kg] of the palm, and how high its face begins above the floor [m]."""
FINGER, FINGER_MASS, KNUCKLE = (0.009, 0.08), 0.08, 0.062
"""Radius and length [m] and mass [kg] of a finger, and how far from the palm's middle its hinge is [m]."""
OPEN, CLOSED, LIMIT = 0.25, -0.35, 0.6
"""Angles of the fingers' user, outward, and the hinges' limits to both sides [rad]: a finger meets the mug at -0.19."""
CLOSES, RISES, ASIDE, TILTS, UPRIGHT, SINKS, OPENS = (
    (0.1, 0.7), (0.9, 1.7), (2.2, 3.2), (3.3, 3.8), (3.8, 4.3), (4.5, 5.3), (5.5, 5.9),
)
"""When the user does what [s]."""
RISE, CARRY, TILT = 0.15, 0.3, 0.5
"""How far up and aside [m], and how far the user tilts the mug [rad]."""
FINGERS = tuple(f"finger_{k}" for k in range(3))


def hand() -> Avatar:
    """A round palm whose three fingers hang from its rim; positive angles open them."""
    palm = (prism(24, PALM[0], PALM[1]),)
    finger = (Piece(Capsule(*FINGER), (0.0, 0.0, -0.5 * FINGER[1] - FINGER[0] - 0.001)),)
    links = [Link("palm", None, Free(), palm, solid(palm, PALM_MASS), "hand")]
    for k, name in enumerate(FINGERS):
        angle = 2.0 * math.pi * k / len(FINGERS)
        x, y = math.cos(angle), math.sin(angle)
        hinge = Hinges((Hinge((y, -x, 0.0), -LIMIT, LIMIT),))
        anchor = (KNUCKLE * x, KNUCKLE * y, -0.5 * PALM[1] - 0.002)
        links.append(Link(name, "palm", hinge, finger, solid(finger, FINGER_MASS), "hand", anchor))
    return Avatar("hand", tuple(links), chains=FINGERS)


def at(time: float) -> TrackerSample:
    """The user at a time [s]."""
    height = BOTTOM + 0.5 * PALM[1] + RISE * (eased(time, *RISES) - eased(time, *SINKS))
    place: Vector = (CARRY * eased(time, *ASIDE), 0.0, height)
    turn = rotation.from_axis_angle((0.0, 1.0, 0.0), TILT * (eased(time, *TILTS) - eased(time, *UPRIGHT)))
    bend = OPEN + (CLOSED - OPEN) * (eased(time, *CLOSES) - eased(time, *OPENS))
    rests = np.tile(rotation.IDENTITY, (len(FINGERS), 1))
    return TrackerSample(
        time, np.vstack([place, np.zeros((len(FINGERS), 3))]), np.vstack([turn, rests]), np.full(len(FINGERS), bend),
    )


SCENARIO = Scenario(
    "mug_in_fingers", "Three hinged fingers lift a mug, carry, tilt it and set it down.",
    "Overlap; limits; that the mug comes along and does not slip.",
    lambda: mug_on_floor("mug_in_fingers", hand(), at(0.0)), by_time(at), frames=372, short=126,
    bounds=(
        *SOUND, WITHIN_LIMITS, NO_LEAP, NO_LEAP_OF_THE_ROOT, replace(KEEPS_MOVING, limit=5.0),
        Bound("height_missing", 9.81 * MUG_MASS / CouplingSettings().spring + 1e-3,
              "the mug rises with its user, less the sag m g / K of one link, to a millimetre; four links share it"),
        Bound("grip_slip_max", 1e-3, "fingers do not let the mug slip; as the palm tilts their springs yield a little"),
    ),
    regions=(Region(("mug",), (-0.3, -0.3, 0.0), (0.6, 0.3, 0.4), "the mug is neither shot away nor pressed into the floor"),),
    expects={"carried": (Carried("mug", ("hand/palm",), CLOSES[1] + 0.1, SINKS[0]),)},
)
