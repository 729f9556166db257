"""Loads shown by friction: a body on three balls, one of them on a rough lane, brakes as hard as the load on that ball allows.

Contact forces are not shown by any engine, but friction shows them: feet on ice feel nothing, the rough one brakes with mu N.
With the centre of mass at height h above the ground and the rough foot at x_1, the two others at x_2, balance of forces and
moments is three equations for three loads: N_1 = m g x_2 / (x_2 - x_1 + mu h), measured along the way from the centre of mass.
"""

import numpy as np

from avatarsim.scene.body import Body, ContactLaw, Mass, fixed, simulated
from avatarsim.scene.checks import Vector
from avatarsim.scene.scene import Scene
from avatarsim.scene.shape import Box, Piece, Sphere
from reference.closed_form import tripod_load
from scenarios.building.cases import LAID, pair_table
from scenarios.building.expected import Course, steady, uniform
from scenarios.building.promises import FINITE, NO_OVERLAP, RIGHT_SIDE
from scenarios.motion.untracked import untracked
from scenarios.scenario import INFINITE, Bound, Region, Scenario

RADIUS, MASS, GRAVITY, FRICTION, SPEED = 0.1, 3.0, 9.81, 0.2, 3.0
"""Radius of the balls [m], mass [kg], gravity [m/s^2], friction of the rough lane, first speed [m/s]."""
WIDE = 0.4
"""Distance of the outer feet from the middle lane [m]."""
FEET = ((0.3, -0.3), (0.1, -0.5), (-0.4, 0.2), (-0.2, 0.4))
"""Places along the way [m] of the rough foot and of the two smooth ones, from the centre of mass: it leads, or it trails."""
LANE = 1.4
"""Distance of the lanes [m]."""


def build() -> Scene:
    """Every body straddles a rough lane between two of ice, all tops at z = 0."""
    bodies: list[Body] = []
    across = Mass(MASS, inertia=0.1 * MASS * np.eye(3))
    for k, (rough, smooth) in enumerate(FEET):
        y = LANE * (k - 1.5)
        bodies.append(fixed(f"rough_{k}", (Piece(Box((12.0, 0.2, 0.2))),), "rough", (3.0, y, -0.1)))
        for side, sign in (("left", 1.0), ("right", -1.0)):
            bodies.append(fixed(f"{side}_{k}", (Piece(Box((12.0, 0.2, 0.2))),), "ice", (3.0, y + sign * WIDE, -0.1)))
        places = ((rough, 0.0, 0.0), (smooth, WIDE, 0.0), (smooth, -WIDE, 0.0))
        feet = tuple(Piece(Sphere(RADIUS), place) for place in places)
        at = (0.0, y, RADIUS + LAID)
        bodies.append(simulated(f"three_{k}", feet, "ball", across, at, velocity=(SPEED, 0.0, 0.0)))
    stated = {("rough", "ball"): ContactLaw(0.0, FRICTION)}
    return Scene("triball", tuple(bodies), materials=pair_table(("rough", "ice", "ball"), stated))


def course(k: int) -> Course:
    """Uniform braking, for the first second."""
    rough, smooth = FEET[k]
    brake = FRICTION * tripod_load(MASS, GRAVITY, rough, smooth, FRICTION, RADIUS) / MASS
    start: Vector = (0.0, LANE * (k - 1.5), RADIUS)
    way = uniform(start, (SPEED, 0.0, 0.0), (-brake, 0.0, 0.0))
    return Course(f"three_{k}", way, uniform((SPEED, 0.0, 0.0), (-brake, 0.0, 0.0)), steady(0.0, 0.0, 0.0))


SCENARIO = Scenario(
    name="triball",
    title="Bodies on three balls slide along, one ball of each on a rough lane.",
    judged="How hard they brake: the load on the rough ball, from three equations of balance.",
    build=build,
    motion=untracked(),
    frames=60,
    bounds=(
        NO_OVERLAP, RIGHT_SIDE, FINITE,
        Bound("course_error_max", 2e-6, "the load fixes the braking: 1e-6 m, and 1e-6 m of air below the feet"),
        Bound("velocity_error_max", 2e-6, "as the place, over a second"),
        Bound("energy_gain_max", 1e-9, "friction only takes"),
    ),
    regions=(Region(("three_*",), (-INFINITE, -INFINITE, 0.0), (INFINITE,) * 3, "nothing falls through a lane"),),
    expects={"courses": tuple(course(k) for k in range(len(FEET))), "alone": tuple((f"three_{k}",) for k in range(len(FEET)))},
)
