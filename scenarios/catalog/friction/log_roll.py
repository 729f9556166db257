"""Sliding until rolling, for logs: capsules across their way slide over a table until they roll, or roll from the start.

With k = I / (m r^2) about its axis a log slides with v0 - mu g t until v0 k / ((1 + k) mu g) and then rolls at v0 / (1 + k). The
line on which it touches stays below its axis however it turns: no engine may carry it round with the body.
"""

from avatarsim.scene.body import Body, ContactLaw, fixed, simulated, solid
from avatarsim.scene.checks import Vector
from avatarsim.scene.scene import Scene
from avatarsim.scene.shape import Box, Capsule, Piece
from scenarios.building.cases import LAID, pair_table, turned_by
from scenarios.building.expected import Course, OfTime
from scenarios.building.promises import FINITE, NO_OVERLAP, RIGHT_SIDE
from scenarios.motion.untracked import untracked
from scenarios.scenario import INFINITE, Bound, Region, Scenario

SPEED, RADIUS, LENGTH, MASS, GRAVITY, FRICTION = 2.0, 0.05, 0.2, 0.5, 9.81, 0.3
"""First speed [m/s], radius [m], length of the axis [m] and mass [kg] of the logs, gravity [m/s^2], friction."""
SHAPE = (Piece(Capsule(RADIUS, LENGTH)),)
SHARE = float(solid(SHAPE, MASS).inertia[2, 2]) / (MASS * RADIUS * RADIUS)
"""I / (m r^2) about the axis; 0.475."""
LANES = {"slides": -0.5, "rolls": 0.5}
"""Where the logs begin along y [m]: one without spin, one that rolls."""
ACROSS = turned_by((1.0, 0.0, 0.0), 1.5707963267948966)
"""Axis along y."""


def build() -> Scene:
    """A long table, its top at z = 0, and two logs."""
    bodies: list[Body] = [fixed("table", (Piece(Box((12.0, 3.0, 0.2))),), "table", (5.0, 0.0, -0.1))]
    for name, lane in LANES.items():
        start, spin = (0.0, lane, RADIUS + LAID), (0.0, SPEED / RADIUS if name == "rolls" else 0.0, 0.0)
        bodies.append(simulated(
            name, SHAPE, "wood", solid(SHAPE, MASS), start, ACROSS, velocity=(SPEED, 0.0, 0.0), angular_velocity=spin
        ))
    return Scene("log_roll", tuple(bodies), materials=pair_table(
        ("table", "wood"), {("table", "wood"): ContactLaw(0.0, FRICTION)}
    ))


def course(name: str) -> Course:
    """Place, velocity and spin of one log at any time."""
    end = SPEED if name == "rolls" else SPEED / (1.0 + SHARE)
    begins = (SPEED - end) / (FRICTION * GRAVITY)
    way = 0.5 * (SPEED + end) * begins

    def position(time: float) -> Vector:
        slid = SPEED * time - 0.5 * FRICTION * GRAVITY * time * time
        return (slid if time < begins else way + end * (time - begins), LANES[name], RADIUS)

    def velocity(time: float) -> Vector:
        return (SPEED - FRICTION * GRAVITY * time if time < begins else end, 0.0, 0.0)

    def spin(time: float) -> Vector:
        return (0.0, (FRICTION * GRAVITY * time / SHARE if time < begins else end) / RADIUS, 0.0)

    forms: tuple[OfTime, OfTime, OfTime] = (position, velocity, spin)
    return Course(name, *forms)


SCENARIO = Scenario(
    name="log_roll",
    title="Two logs across a table: one slides until it rolls, one rolls from the start.",
    judged="Place, velocity and spin at every frame.",
    build=build,
    motion=untracked(),
    frames=180,
    short=75,
    bounds=(
        NO_OVERLAP, RIGHT_SIDE, FINITE,
        Bound("velocity_error_max", 2e-6, "what is left of v0 within 1e-6 of itself, at the time that Coulomb's law gives"),
        Bound("course_error_max", 2e-6, "the way until it rolls within 1e-6 of itself, and 1e-6 m of air below it"),
        Bound("spin_error_max", 4e-5, "as the velocity, over the radius"),
        Bound("energy_gain_max", 1e-9, "friction only takes"),
    ),
    regions=(Region(tuple(LANES), (-INFINITE, -INFINITE, 0.0), (INFINITE,) * 3, "nothing falls through the table"),),
    expects={"courses": tuple(course(name) for name in LANES), "alone": tuple((name,) for name in LANES)},
)
