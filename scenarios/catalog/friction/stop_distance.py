"""Boxes slide over the floor at 3 m/s in three directions and stop after v^2 / (2 mu g), straight on.

A friction pyramid gets the diagonal wrong by up to 41 %, a Coulomb cone does not. The boxes are turned with their way, so that
each is the same question.
"""

from collections.abc import Iterator
from math import cos, radians, sin

from avatarsim.scene.body import Body
from avatarsim.scene.shape import Box
from reference.closed_form import stop_distance, stop_time
from scenarios.building.cases import LAID, laws, loose, slab, turned_by
from scenarios.building.expected import Stop
from scenarios.building.promises import NO_ENERGY, SOUND
from scenarios.building.scenes import above, each_alone, undriven
from scenarios.scenario import Bound, Scenario

SPEED, FRICTION, GRAVITY = 3.0, 0.5, 9.81
"""First speed [m/s], coefficient of friction, gravity [m/s^2]: they stop after 0.6116 s and 0.9174 m."""
BOXES = {f"box_{angle:g}": radians(angle) for angle in (0.0, 22.5, 45.0)}
"""Directions from the x axis [rad]."""
SIZE = (0.4, 0.4, 0.1)
"""Edges of a box [m]: so flat that it does not tip."""


def bodies() -> Iterator[Body]:
    """One floor, its top at z = 0, and three boxes, one of them to each direction."""
    yield slab(8.0, 8.0)
    for k, (name, angle) in enumerate(BOXES.items()):
        start, velocity = (-1.0, 1.2 * (k - 1), 0.5 * SIZE[2] + LAID), (SPEED * cos(angle), SPEED * sin(angle), 0.0)
        yield loose(name, Box(SIZE), "box", 2.0, start, turned_by((0.0, 0.0, 1.0), angle), velocity)


def at_rate(rate: int) -> Scenario:
    """The three boxes at so many frames per second, for a second."""
    way, by = stop_distance(SPEED, FRICTION, GRAVITY), stop_time(SPEED, FRICTION, GRAVITY)
    return undriven(
        "stop_distance" if rate == 60 else f"stop_distance_{rate}",
        f"Boxes slide at 3 m/s in three directions until they stop, at {rate} frames per second.",
        "How far, and how straight.", bodies, laws({("floor", "box"): (0.0, FRICTION)}), frames=rate, dt=1.0 / rate,
        bounds=(
            *SOUND, Bound("stop_distance_error_max", 1e-5, "v^2 / (2 mu g) in every direction, to a ten-millionth"),
            Bound("stop_direction_error_max", 1e-5, "friction acts against the motion, and there is nothing sideways"), NO_ENERGY,
        ),
        regions=(above(0.0, "box_*"),),
        expects={
            "stops": tuple(Stop(name, way, (cos(angle), sin(angle), 0.0), by) for name, angle in BOXES.items()),
            "alone": each_alone(BOXES),
        },
    )


SCENARIOS = tuple(map(at_rate, (30, 60, 240)))
