"""A ball and a turning box are thrown through the air, and a second ball falls on a slab.

Closed form: z = h + v t - g t^2 / 2. The last ball shows that the same engine sees contact at all.
"""

from avatarsim.scene.checks import Vector
from avatarsim.scene.scene import EARTH
from avatarsim.scene.shape import Box, Sphere
from scenarios.building.cases import fixture, loose
from scenarios.building.expected import Course, steady, uniform
from scenarios.building.promises import SOUND
from scenarios.building.scenes import above, undriven
from scenarios.scenario import Bound, Drop

BALL, BOX = Sphere(0.05), Box((0.2, 0.2, 0.2))
THROWN: Vector = (2.0, 1.0, 6.0)
"""First velocity of ball and box [m/s]: up for 0.6 s, back at its height after 1.22 s."""
SPIN: Vector = (3.0, -2.0, 5.0)
"""First angular velocity of the box [rad/s]; a cube keeps it."""
FROM: dict[str, Vector] = {"ball": (0.0, 0.0, 5.0), "box": (0.0, 3.0, 5.0)}
HEIGHT = 1.0
"""From the slab's top to the lowest point of the ball that falls on it [m]."""
SPEED = uniform(THROWN, EARTH)

SCENARIO = undriven(
    "free_flight", "A ball and a turning box are thrown through the air; another ball falls on a slab.",
    "Place and velocity at every frame against the parabola.",
    lambda: (
        fixture("slab", Box((1.0, 1.0, 0.1)), "wood", (-3.0, 0.0, -0.05)),
        loose("ball", BALL, "wood", 1.0, FROM["ball"], velocity=THROWN),
        loose("box", BOX, "wood", 1.0, FROM["box"], velocity=THROWN, spin=SPIN),
        loose("falls", BALL, "wood", 1.0, (-3.0, 0.0, BALL.radius + HEIGHT)),
    ),
    frames=90,
    bounds=(
        *SOUND, Bound("course_error_max", 1e-9, "the parabola is exact at any frame time; only rounding is left"),
        Bound("velocity_error_max", 1e-9, "v - g t, likewise"), Bound("spin_error_max", 1e-9, "a cube keeps its spin"),
        Bound("restitution_error_max", 1e-6, "eq. 8 fixes v+/v- of the ball that lands"),
    ),
    regions=(above(0.0, "falls", reason="the slab is not passed"),),
    expects={
        "drops": (Drop("falls", "slab", 0.3, HEIGHT),),
        "courses": (
            Course("ball", uniform(FROM["ball"], THROWN, EARTH), SPEED),
            Course("box", uniform(FROM["box"], THROWN, EARTH), SPEED, steady(*SPIN)),
        ),
    },
)
