"""Balls and logs slide over a table until friction has them rolling; one log rolls from the start.

With k = I / (m r^2) about its axis a body slides with v0 - mu g t until v0 k / ((1 + k) mu g), and then rolls at v0 / (1 + k):
a ball at 5/7 of its speed. The line on which a log touches stays below its axis however it turns.
"""

from collections.abc import Iterator
from math import pi

from avatarsim.scene.body import Body, solid
from avatarsim.scene.shape import Capsule, Sphere
from reference.closed_form import roll_speed, roll_time
from scenarios.building.cases import LAID, laws, loose, pieces_of, slab, turned_by
from scenarios.building.expected import Course, OfFloat, ball_to_roll, slides_to_roll
from scenarios.building.promises import NO_ENERGY, SOUND
from scenarios.building.scenes import above, each_alone, undriven
from scenarios.scenario import Bound

RADIUS, MASS, GRAVITY = 0.05, 0.5, 9.81
"""Radius [m] and mass [kg] of all bodies, gravity [m/s^2]."""
BALLS, SPEED = {f"ball_{friction:g}": friction for friction in (0.1, 0.2, 0.5)}, 3.0
"""Friction of the balls, which roll after 0.87, 0.44 and 0.17 s, and their first speed [m/s]."""
LOGS, LOG_SPEED, FRICTION = {"slides": -0.5, "rolls": 0.5}, 2.0, 0.3
"""Where the logs begin along y [m], their first speed [m/s] and friction."""
LOG = Capsule(RADIUS, 0.2)
SHARE = float(solid(pieces_of(LOG), MASS).inertia[2, 2]) / (MASS * RADIUS * RADIUS)
"""I / (m r^2) of a log about its axis; 0.475."""
TABLE = slab(12.0, 3.0, "table", "table", x=5.0)
REACHED = Bound("course_error_max", 2e-6, "the way until it rolls within 1e-6 of itself, and 1e-6 m of air below it")
SPINS = Bound("spin_error_max", 4e-5, "as the velocity, over the radius")


def balls() -> Iterator[Body]:
    """Yield three balls of different cloth side by side."""
    yield TABLE
    for k, (name, friction) in enumerate(BALLS.items()):
        start = (0.0, 0.5 * (k - 1), RADIUS + LAID)
        yield loose(name, Sphere(RADIUS), f"cloth_{friction:g}", MASS, start, velocity=(SPEED, 0.0, 0.0))


def logs() -> Iterator[Body]:
    """Yield two logs across their way."""
    yield TABLE
    for name, lane in LOGS.items():
        spin = (0.0, LOG_SPEED / RADIUS if name == "rolls" else 0.0, 0.0)
        start = (0.0, lane, RADIUS + LAID)
        yield loose(name, LOG, "wood", MASS, start, turned_by((1.0, 0.0, 0.0), 0.5 * pi), (LOG_SPEED, 0.0, 0.0), spin)


def along_lane(name: str, lane: float, way: OfFloat, speed: OfFloat, spin: OfFloat) -> Course:
    """Return the course of a body along x."""
    return Course(
        name, lambda t: (way(t), lane, RADIUS), lambda t: (speed(t), 0.0, 0.0), lambda t: (0.0, spin(t) / RADIUS, 0.0)
    )


def ball_course(name: str, lane: float) -> Course:
    """Return the place, velocity and spin of a ball at any time."""
    friction, rolls = BALLS[name], roll_time(SPEED, BALLS[name], GRAVITY)
    way, speed = ball_to_roll(SPEED, friction, GRAVITY)
    return along_lane(name, lane, way, speed, lambda t: 2.5 * friction * GRAVITY * t if t < rolls else roll_speed(SPEED))


def log_course(name: str) -> Course:
    """Return the place, velocity and spin of a log at any time."""
    end, drag = LOG_SPEED if name == "rolls" else LOG_SPEED / (1.0 + SHARE), FRICTION * GRAVITY
    begins = (LOG_SPEED - end) / drag
    way, speed = slides_to_roll(LOG_SPEED, drag, begins, 0.5 * (LOG_SPEED + end) * begins, end)
    return along_lane(name, LOGS[name], way, speed, lambda t: drag * t / SHARE if t < begins else end)


SCENARIOS = (
    undriven(
        "slide_to_roll", "Three balls slide over a table until friction has them rolling.",
        "Place, velocity and spin at every frame; 5/7 of the speed at the end.", balls,
        laws({(f"cloth_{friction:g}", "table"): (0.0, friction) for friction in BALLS.values()}),
        frames=180, short=75,
        bounds=(
            *SOUND, Bound("velocity_error_max", 2e-6, "5/7 v0 within 1e-6 of itself, at the time that Coulomb's law gives"),
            REACHED, SPINS, NO_ENERGY,
        ),
        regions=(above(0.0, "ball_*"),),
        expects={
            "courses": tuple(ball_course(name, 0.5 * (k - 1)) for k, name in enumerate(BALLS)), "alone": each_alone(BALLS),
        },
    ),
    undriven(
        "log_roll", "Two logs across a table: one slides until it rolls, one rolls from the start.",
        "Place, velocity and spin at every frame.", logs, laws({("table", "wood"): (0.0, FRICTION)}),
        frames=180, short=75,
        bounds=(
            *SOUND, Bound("velocity_error_max", 2e-6, "the closed form within 1e-6 of v0, at the time of Coulomb's law"),
            REACHED, SPINS, NO_ENERGY,
        ),
        regions=(above(0.0, *LOGS),), expects={"courses": tuple(map(log_course, LOGS)), "alone": each_alone(LOGS)},
    ),
)
