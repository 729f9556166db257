"""A body on three balls, one of them on a rough lane, brakes as hard as the load on that ball allows: friction shows loads.

With the centre of mass at height h above the ground and the rough foot at x_1, the two others at x_2, balance of forces and
moments is three equations for three loads: N_1 = m g x_2 / (x_2 - x_1 + mu h), measured along the way from the centre of mass.
"""

from collections.abc import Iterator

import numpy as np

from avatarsim.scene.body import Body, Mass
from avatarsim.scene.shape import Box, Piece, Sphere
from reference.closed_form import tripod_load
from scenarios.building.cases import LAID, NOWHERE, fixture, laws, loose
from scenarios.building.expected import Course, steady, uniform
from scenarios.building.promises import NO_ENERGY, SOUND
from scenarios.building.scenes import above, each_alone, undriven
from scenarios.scenario import Bound

RADIUS, MASS, GRAVITY, FRICTION, VELOCITY = 0.1, 3.0, 9.81, 0.2, (3.0, 0.0, 0.0)
"""Radius of the balls [m], mass [kg], gravity [m/s^2], friction of the rough lane, first velocity [m/s]."""
WIDE, LANE = 0.4, 1.4
"""Distance of the outer feet from the middle lane, and of the lanes [m]."""
FEET = {"three_0": (0.3, -0.3), "three_1": (0.1, -0.5), "three_2": (-0.4, 0.2), "three_3": (-0.2, 0.4)}
"""Places along the way [m] of the rough foot and of the two smooth ones, from the centre of mass: it leads, or it trails."""


def bodies() -> Iterator[Body]:
    """Every body straddles a rough lane between two of ice, all tops at z = 0."""
    for k, (name, (rough, smooth)) in enumerate(FEET.items()):
        y = LANE * (k - 1.5)
        for kind, lane, aside in (("rough", "rough", 0.0), ("left", "ice", WIDE), ("right", "ice", -WIDE)):
            yield fixture(f"{kind}_{k}", Box((12.0, 0.2, 0.2)), lane, (3.0, y + aside, -0.1))
        feet = tuple(Piece(Sphere(RADIUS), at) for at in ((rough, 0.0, 0.0), (smooth, WIDE, 0.0), (smooth, -WIDE, 0.0)))
        mass = Mass(MASS, inertia=0.1 * MASS * np.eye(3))
        yield loose(name, feet, "ball", mass, (0.0, y, RADIUS + LAID), velocity=VELOCITY)


def courses() -> Iterator[Course]:
    """Uniform braking, for the first second."""
    for k, (name, (rough, smooth)) in enumerate(FEET.items()):
        brake = (-FRICTION * tripod_load(MASS, GRAVITY, rough, smooth, FRICTION, RADIUS) / MASS, 0.0, 0.0)
        way = uniform((0.0, LANE * (k - 1.5), RADIUS), VELOCITY, brake)
        yield Course(name, way, uniform(VELOCITY, brake), steady(*NOWHERE))


SCENARIO = undriven(
    "triball", "Bodies on three balls slide along, one ball of each on a rough lane.",
    "How hard they brake: the load on the rough ball, from three equations of balance.", bodies,
    laws({("rough", "ball"): (0.0, FRICTION)}, "ice"), frames=60,
    bounds=(
        *SOUND, Bound("course_error_max", 2e-6, "the load fixes the braking: 1e-6 m, and 1e-6 m of air below the feet"),
        Bound("velocity_error_max", 2e-6, "as the place, over a second"), NO_ENERGY,
    ),
    regions=(above(0.0, "three_*", reason="nothing falls through a lane"),),
    expects={"courses": tuple(courses()), "alone": each_alone(FEET)},
)
