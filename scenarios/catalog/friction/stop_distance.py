"""Stopping distance: boxes slide over the floor at 3 m/s in three directions and stop after v^2 / (2 mu g), straight on.

A friction pyramid gets the diagonal wrong by up to 41 %, a Coulomb cone does not. The boxes are turned with their way, so that
each is the same question.
"""

from math import cos, radians, sin

from avatarsim.scene.body import Body, ContactLaw, fixed, simulated, solid
from avatarsim.scene.checks import Vector
from avatarsim.scene.scene import Scene
from avatarsim.scene.shape import Box, Piece
from reference.closed_form import stop_distance, stop_time
from scenarios.building.cases import LAID, pair_table, turned_by
from scenarios.building.expected import Stop
from scenarios.building.promises import FINITE, NO_OVERLAP, RIGHT_SIDE
from scenarios.motion.untracked import untracked
from scenarios.scenario import INFINITE, Bound, Region, Scenario

SPEED, FRICTION, GRAVITY = 3.0, 0.5, 9.81
"""First speed [m/s], coefficient of friction, gravity [m/s^2]: they stop after 0.6116 s and 0.9174 m."""
ANGLES = (0.0, 22.5, 45.0)
"""Directions [deg] from the x axis."""
SIZE = (0.4, 0.4, 0.1)
"""Edges of a box [m]: so flat that it does not tip."""
MASS = 2.0
"""[kg]"""
RATES = (30, 60, 240)
"""Frames per second."""
SECONDS = 1.0
"""Length of the run [s]."""


def direction(angle: float) -> Vector:
    """Unit vector at `angle` [deg] from the x axis."""
    return cos(radians(angle)), sin(radians(angle)), 0.0


def build(name: str) -> Scene:
    """One floor, its top at z = 0, and three boxes, one of them to each direction."""
    bodies: list[Body] = [fixed("floor", (Piece(Box((8.0, 8.0, 0.2))),), "floor", (0.0, 0.0, -0.1))]
    pieces = (Piece(Box(SIZE)),)
    for k, angle in enumerate(ANGLES):
        x, y, _ = direction(angle)
        turned = turned_by((0.0, 0.0, 1.0), radians(angle))
        start, velocity = (-1.0, 1.2 * (k - 1), 0.5 * SIZE[2] + LAID), (SPEED * x, SPEED * y, 0.0)
        bodies.append(simulated(f"box_{angle:g}", pieces, "box", solid(pieces, MASS), start, turned, velocity))
    materials = pair_table(("floor", "box"), {("floor", "box"): ContactLaw(0.0, FRICTION)})
    return Scene(name, tuple(bodies), materials=materials)


def at_rate(rate: int) -> Scenario:
    """The three boxes at so many frames per second."""
    name = "stop_distance" if rate == 60 else f"stop_distance_{rate}"
    way, by = stop_distance(SPEED, FRICTION, GRAVITY), stop_time(SPEED, FRICTION, GRAVITY)
    return Scenario(
        name=name,
        title=f"Boxes slide at 3 m/s in three directions until they stop, at {rate} frames per second.",
        judged="How far, and how straight.",
        build=lambda: build(name),
        motion=untracked(1.0 / rate),
        frames=round(SECONDS * rate),
        dt=1.0 / rate,
        bounds=(
            NO_OVERLAP, RIGHT_SIDE, FINITE,
            Bound("stop_distance_error_max", 1e-5, "v^2 / (2 mu g) in every direction, to a ten-millionth"),
            Bound("stop_direction_error_max", 1e-5, "friction acts against the motion, and there is nothing sideways"),
            Bound("energy_gain_max", 1e-9, "friction only takes"),
        ),
        regions=(Region(("box_*",), (-INFINITE, -INFINITE, 0.0), (INFINITE,) * 3, "no box falls through the floor"),),
        expects={
            "stops": tuple(Stop(f"box_{angle:g}", way, direction(angle), by) for angle in ANGLES),
            "alone": tuple((f"box_{angle:g}",) for angle in ANGLES),
        },
    )


SCENARIOS = tuple(at_rate(rate) for rate in RATES)
