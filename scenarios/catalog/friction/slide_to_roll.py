"""Sliding until rolling: balls slide over a table without spin until friction has them rolling, at 5/7 of their speed.

Closed form: v0 - mu g t until 2 v0 / (7 mu g), after 12 v0^2 / (49 mu g); from then on 5/7 v0.
"""

from avatarsim.scene.body import Body, ContactLaw, fixed, simulated, solid
from avatarsim.scene.checks import Vector
from avatarsim.scene.scene import Scene
from avatarsim.scene.shape import Box, Piece, Sphere
from reference.closed_form import roll_distance, roll_speed, roll_time
from scenarios.building.cases import LAID, pair_table
from scenarios.building.expected import Course, OfTime
from scenarios.building.promises import FINITE, NO_OVERLAP, RIGHT_SIDE
from scenarios.motion.untracked import untracked
from scenarios.scenario import INFINITE, Bound, Region, Scenario

SPEED, RADIUS, MASS, GRAVITY = 3.0, 0.05, 0.5, 9.81
"""First speed [m/s], radius [m] and mass [kg] of the balls, gravity [m/s^2]."""
FRICTIONS = (0.1, 0.2, 0.5)
"""They roll after 0.87, 0.44 and 0.17 s."""
LANE = 0.5
"""Distance of the lanes [m]."""


def build() -> Scene:
    """A long table, its top at z = 0, and three balls of different cloth."""
    bodies: list[Body] = [fixed("table", (Piece(Box((12.0, 3.0, 0.2))),), "table", (5.0, 0.0, -0.1))]
    pieces = (Piece(Sphere(RADIUS)),)
    for k, friction in enumerate(FRICTIONS):
        start, velocity = (0.0, LANE * (k - 1), RADIUS + LAID), (SPEED, 0.0, 0.0)
        name, cloth = f"ball_{friction:g}", f"cloth_{friction:g}"
        bodies.append(simulated(name, pieces, cloth, solid(pieces, MASS), start, velocity=velocity))
    stated = {(f"cloth_{friction:g}", "table"): ContactLaw(0.0, friction) for friction in FRICTIONS}
    names = ["table", *(f"cloth_{friction:g}" for friction in FRICTIONS)]
    return Scene("slide_to_roll", tuple(bodies), materials=pair_table(names, stated))


def course(friction: float, lane: float) -> Course:
    """Place, velocity and spin of one ball at any time."""
    rolls = roll_time(SPEED, friction, GRAVITY)

    def position(time: float) -> Vector:
        sliding = SPEED * time - 0.5 * friction * GRAVITY * time * time
        rolling = roll_distance(SPEED, friction, GRAVITY) + roll_speed(SPEED) * (time - rolls)
        return (sliding if time < rolls else rolling, lane, RADIUS)

    def velocity(time: float) -> Vector:
        return (SPEED - friction * GRAVITY * time if time < rolls else roll_speed(SPEED), 0.0, 0.0)

    def spin(time: float) -> Vector:
        return (0.0, (2.5 * friction * GRAVITY * time if time < rolls else roll_speed(SPEED)) / RADIUS, 0.0)

    forms: tuple[OfTime, OfTime, OfTime] = (position, velocity, spin)
    return Course(f"ball_{friction:g}", *forms)


SCENARIO = Scenario(
    name="slide_to_roll",
    title="Three balls slide over a table until friction has them rolling.",
    judged="Place, velocity and spin at every frame; 5/7 of the speed at the end.",
    build=build,
    motion=untracked(),
    frames=180,
    short=75,
    bounds=(
        NO_OVERLAP, RIGHT_SIDE, FINITE,
        Bound("velocity_error_max", 2e-6, "5/7 v0 within 1e-6 of itself, at the time that Coulomb's law gives"),
        Bound("course_error_max", 2e-6, "the way until it rolls within 1e-6 of itself, and 1e-6 m of air below it"),
        Bound("spin_error_max", 4e-5, "as the velocity, over the radius"),
        Bound("energy_gain_max", 1e-9, "friction only takes"),
    ),
    regions=(Region(("ball_*",), (-INFINITE, -INFINITE, 0.0), (INFINITE,) * 3, "nothing falls through the table"),),
    expects={
        "courses": tuple(course(friction, LANE * (k - 1)) for k, friction in enumerate(FRICTIONS)),
        "alone": tuple((f"ball_{friction:g}",) for friction in FRICTIONS),
    },
)
