"""A person takes a box from a stand between both hands, lifts it, holds it, sets it down and lets go.

Both arms have ball joints at the shoulders. The user's hands go three centimetres into the box, above its middle, so that it
hangs between them. Only friction carries it.
"""

import math
from dataclasses import replace
from functools import reduce

import numpy as np

from avatarsim.scene.body import ContactLaw, fixed, simulated, solid
from avatarsim.scene.checks import Vector
from avatarsim.scene.scene import Scene
from avatarsim.scene.shape import Box, Piece
from avatarsim.scene.tracker import TrackerSample
from avatarsim.settings import CouplingSettings
from avatarsim.spatial import rotation
from scenarios.building.avatars.humanoid import humanoid
from scenarios.building.avatars.standing import standing
from scenarios.building.cases import LAID, pair_table
from scenarios.building.expected import Carried
from scenarios.building.promises import FINITE, KEEPS_MOVING, NO_LEAP, NO_LEAP_OF_THE_ROOT, NO_OVERLAP, RIGHT_SIDE, WITHIN_LIMITS
from scenarios.motion.keyframes import posed
from scenarios.motion.rigid_hands import eased
from scenarios.scenario import RENDERED, Bound, Motion, Region, Scenario

BOX, MASS, FRICTION = (0.2, 0.3, 0.2), 1.0, 0.8
"""Edges [m] and mass [kg] of the box, and friction of all pairs."""
STAND, AHEAD = (0.2, 0.2, 0.9), 0.32
"""Edges of the stand [m], and how far ahead of the user its middle and the box are [m]."""
GRIP, OPEN, INTO = 0.05, 0.08, 0.03
"""Height of the hands above the box's middle, their first distance from its sides, and how far the user goes into it [m]."""
RISE = 0.2
"""How far the user lifts the box [m]."""
CLOSES, RISES, SINKS, OPENS = (0.2, 0.8), (1.0, 1.8), (3.0, 3.8), (4.0, 4.5)
"""When the user does what [s]."""
OUTWARD = 1.0
"""How far the elbows are turned out from below [rad], so that the hands alone touch the box."""
UPPER_ARM, FOREARM, HAND = 0.274788, 0.258947, 0.04
"""Lengths of the humanoid's arms, and radius of its hands [m]."""


def reached(side: float, shoulder: Vector, hand: Vector) -> tuple[Vector, float]:
    """Rotation vector of a shoulder and bend of its elbow [degrees] that take a hand there, the elbow outward."""
    x, y, z = (h - s for h, s in zip(hand, shoulder, strict=True))
    across, distance = math.hypot(x, y), math.sqrt(x * x + y * y + z * z)
    bend = math.pi - math.acos((UPPER_ARM**2 + FOREARM**2 - distance**2) / (2.0 * UPPER_ARM * FOREARM))
    inner = math.acos((UPPER_ARM**2 + distance**2 - FOREARM**2) / (2.0 * UPPER_ARM * distance))
    pitch = math.atan2(across, -z) - inner
    turns = (
        rotation.from_axis_angle((x / distance, y / distance, z / distance), side * OUTWARD),
        rotation.from_axis_angle((0.0, 0.0, 1.0), math.atan2(y, x)), rotation.from_axis_angle((0.0, 1.0, 0.0), -pitch),
    )
    a, b, c = np.degrees(rotation.to_rotation_vector(reduce(rotation.multiply, turns)))
    return (float(a), float(b), float(c)), math.degrees(bend)


def at(time: float) -> TrackerSample:
    """The user at a time [s]."""
    human = humanoid()
    start = standing(human)
    height = start.positions[0, 2] + 0.236151 + 0.2435
    apart = 0.5 * BOX[1] + HAND + OPEN - (OPEN + INTO) * (eased(time, *CLOSES) - eased(time, *OPENS))
    level = STAND[2] + 0.5 * BOX[2] + GRIP + RISE * (eased(time, *RISES) - eased(time, *SINKS))
    turned, bent = {}, {}
    for name, side in (("left", 1.0), ("right", -1.0)):
        turned[f"{name}_shoulder"], bend = reached(side, (-0.02405, 0.18311 * side, height), (AHEAD, side * apart, level))
        bent[f"{name}_elbow"] = (bend,)
    return replace(posed(human, start, turned, bent), time=time)


def build() -> Scene:
    """The box on a stand, and a person before it with open arms."""
    pieces = (Piece(Box(BOX)),)
    floor = fixed("floor", (Piece(Box((4.0, 4.0, 0.2))),), "floor", (0.0, 0.0, -0.1))
    stand = fixed("stand", (Piece(Box(STAND)),), "floor", (AHEAD, 0.0, 0.5 * STAND[2]))
    box = simulated("box", pieces, "box", solid(pieces, MASS), (AHEAD, 0.0, STAND[2] + 0.5 * BOX[2] + LAID))
    law = ContactLaw(0.0, FRICTION)
    materials = pair_table(("floor", "box", "human"), {("floor", "box"): law, ("human", "box"): law})
    return Scene("arms_lift", (floor, stand, box), (humanoid(),), materials, start=at(0.0))


def motion(scene: Scene, seed: int) -> Motion:
    """The same with every seed."""
    return lambda frame: at((frame + 1) * RENDERED)


SCENARIO = Scenario(
    name="arms_lift",
    title="A person lifts a box between both hands.",
    judged="Overlap; limits; that the box comes along.",
    build=build,
    motion=motion,
    frames=300,
    short=150,
    bounds=(
        NO_OVERLAP, RIGHT_SIDE, FINITE, WITHIN_LIMITS, NO_LEAP, NO_LEAP_OF_THE_ROOT, replace(KEEPS_MOVING, limit=5.0),
        Bound("height_missing", 9.81 * MASS / (2.0 * CouplingSettings().spring) + 1e-3,
              "the box rises with its user, less the sag m g / 2 K of two hands, to a millimetre; other links share it"),
    ),
    regions=(Region(("box",), (0.0, -0.3, 0.8), (0.6, 0.3, 1.5), "the box is neither shot away nor dropped"),),
    expects={"carried": (Carried("box", ("human/right_wrist", "human/left_wrist"), CLOSES[1] + 0.1, SINKS[0]),)},
)
