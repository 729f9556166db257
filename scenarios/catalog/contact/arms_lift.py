"""A person takes a box from a stand between both hands, lifts it, holds it, sets it down and lets go."""

import math
from dataclasses import dataclass, replace
from functools import reduce

import numpy as np

from avatarsim.scene.checks import Vector
from avatarsim.scene.scene import Scene
from avatarsim.scene.shape import Box
from avatarsim.scene.tracker import TrackerSample
from avatarsim.settings import CouplingSettings
from avatarsim.spatial import rotation
from scenarios.building.avatars.humanoid import humanoid
from scenarios.building.avatars.standing import standing
from scenarios.building.cases import LAID, fixture, loose, one_law, slab
from scenarios.building.expected import Carried
from scenarios.building.promises import KEEPS_MOVING, NO_LEAP, NO_LEAP_OF_THE_ROOT, SOUND, WITHIN_LIMITS
from scenarios.motion.keyframes import posed
from scenarios.motion.rigid_hands import by_time, eased
from scenarios.scenario import Bound, Region, Scenario

STAND = (0.2, 0.1, 0.9)
"""Edges of the stand [m]."""
OPEN, RISE = 0.08, 0.2
"""First distance of the hands from the sides of the box, and how far the user lifts it [m]."""
CLOSES, RISES, SINKS, OPENS = (0.2, 0.8), (1.0, 1.8), (3.0, 3.8), (4.0, 4.5)
"""Begin and end [s] of each action of the user."""
SHOULDER, UPPER_ARM, FOREARM, HAND = (-0.02405, 0.18311, 0.479651), 0.274788, 0.258947, 0.04
"""Left shoulder of the humanoid above its root, lengths of its arms, and radius of its hands [m]."""


@dataclass(frozen=True)
class Lift:
    """A box of edges [m] and mass [kg], friction of all pairs, and how a person takes the box.

    It is `ahead` of the root [m]; the hands `grip` above its middle and go `into` it [m]; elbows are turned `outward` from
    below [rad], so that the hands alone touch the box.
    """

    box: Vector = (0.2, 0.3, 0.2)
    mass: float = 1.0
    friction: float = 0.8
    ahead: float = 0.32
    grip: float = 0.05
    into: float = 0.03
    outward: float = 1.0

    def at(self, time: float) -> TrackerSample:
        """Return the user at a time [s]."""
        human = humanoid()
        start = standing(human)
        closed, raised = eased(time, *CLOSES) - eased(time, *OPENS), eased(time, *RISES) - eased(time, *SINKS)
        apart = 0.5 * self.box[1] + HAND + OPEN - (OPEN + self.into) * closed
        level = STAND[2] + 0.5 * self.box[2] + self.grip + RISE * raised - float(start.positions[0, 2])
        turned, bent = {}, {}
        for name, side in (("left", 1.0), ("right", -1.0)):
            way = (self.ahead - SHOULDER[0], side * (apart - SHOULDER[1]), level - SHOULDER[2])
            turned[f"{name}_shoulder"], bend = reached(way, side * self.outward)
            bent[f"{name}_elbow"] = (bend,)
        return replace(posed(human, start, turned, bent), time=time)

    def scene(self, name: str = "arms_lift") -> Scene:
        """Return the box on a stand, and a person before it with open arms."""
        bodies = (
            slab(4.0, 4.0), fixture("stand", Box(STAND), "floor", (self.ahead, 0.0, 0.5 * STAND[2])),
            loose("box", Box(self.box), "box", self.mass, (self.ahead, 0.0, STAND[2] + 0.5 * self.box[2] + LAID)),
        )
        materials = one_law(0.0, self.friction, ("floor", "box"), ("human", "box"))
        return Scene(name, bodies, (humanoid(),), materials, start=self.at(0.0))


def reached(way: Vector, outward: float) -> tuple[Vector, float]:
    """Return rotation vector of a shoulder and bend of its elbow [degrees] that take the hand ``way`` [m] from the shoulder."""
    x, y, z = way
    distance = math.sqrt(x * x + y * y + z * z)
    bend = math.pi - math.acos((UPPER_ARM**2 + FOREARM**2 - distance**2) / (2.0 * UPPER_ARM * FOREARM))
    inner = math.acos((UPPER_ARM**2 + distance**2 - FOREARM**2) / (2.0 * UPPER_ARM * distance))
    turns = (
        rotation.from_axis_angle((x / distance, y / distance, z / distance), outward),
        rotation.from_axis_angle((0.0, 0.0, 1.0), math.atan2(y, x)),
        rotation.from_axis_angle((0.0, 1.0, 0.0), inner - math.atan2(math.hypot(x, y), -z)),
    )
    a, b, c = np.degrees(rotation.to_rotation_vector(reduce(rotation.multiply, turns)))
    return (float(a), float(b), float(c)), math.degrees(bend)


SCENARIO = Scenario(
    "arms_lift", "A person lifts a box between both hands.", "Overlap; limits; that the box comes along.",
    Lift().scene, by_time(Lift().at), frames=300, short=150,
    bounds=(
        *SOUND, WITHIN_LIMITS, NO_LEAP, NO_LEAP_OF_THE_ROOT, replace(KEEPS_MOVING, limit=5.0),
        Bound("height_missing", 9.81 * Lift().mass / (2.0 * CouplingSettings().spring) + 1e-3,
              "the box rises with its user, less the sag m g / 2 K of two hands, to a millimetre"),
    ),
    regions=(Region(("box",), (0.0, -0.3, 0.8), (0.6, 0.3, 1.5), "the box is neither shot away nor dropped"),),
    expects={"carried": (Carried("box", ("human/right_wrist", "human/left_wrist"), CLOSES[1] + 0.1, SINKS[0]),)},
)
