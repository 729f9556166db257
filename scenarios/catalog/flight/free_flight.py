"""Free flight: a ball and a turning box are thrown through the air, and a second ball falls on a slab at the end.

Closed form: z = h + v t - g t^2 / 2. Engines that step semi-implicitly are g t dt / 2 too low at any time t. The last ball shows
that the same engine sees contact at all.
"""

from avatarsim.scene.body import fixed, simulated, solid
from avatarsim.scene.checks import Vector
from avatarsim.scene.scene import EARTH, Scene
from avatarsim.scene.shape import Box, Piece, Sphere
from scenarios.building.expected import Course, OfTime, steady, uniform
from scenarios.building.promises import FINITE, NO_OVERLAP, RIGHT_SIDE
from scenarios.motion.untracked import untracked
from scenarios.scenario import INFINITE, Bound, Drop, Region, Scenario

RADIUS, EDGE, MASS = 0.05, 0.2, 1.0
"""Radius of the balls, edge of the box [m], mass of each [kg]."""
THROWN: Vector = (2.0, 1.0, 6.0)
"""First velocity of ball and box [m/s]: up for 0.6 s, back at its height after 1.22 s."""
SPIN: Vector = (3.0, -2.0, 5.0)
"""First angular velocity of the box [rad/s]; a cube keeps it."""
STARTS: dict[str, Vector] = {"ball": (0.0, 0.0, 5.0), "box": (0.0, 3.0, 5.0)}
HEIGHT = 1.0
"""From the slab's top to the lowest point of the ball that falls on it [m]."""


def build() -> Scene:
    """Ball and box in the air five metres up; a slab with a ball above it to one side."""
    ball, box = (Piece(Sphere(RADIUS)),), (Piece(Box((EDGE, EDGE, EDGE))),)
    return Scene("free_flight", (
        fixed("slab", (Piece(Box((1.0, 1.0, 0.1))),), "wood", (-3.0, 0.0, -0.05)),
        simulated("ball", ball, "wood", solid(ball, MASS), STARTS["ball"], velocity=THROWN),
        simulated("box", box, "wood", solid(box, MASS), STARTS["box"], velocity=THROWN, angular_velocity=SPIN),
        simulated("falls", ball, "wood", solid(ball, MASS), (-3.0, 0.0, RADIUS + HEIGHT)),
    ))


def speed() -> OfTime:
    """Velocity [m/s] of both at a time [s]."""
    return uniform(THROWN, EARTH)


SCENARIO = Scenario(
    name="free_flight",
    title="A ball and a turning box are thrown through the air; another ball falls on a slab.",
    judged="Place and velocity at every frame against the parabola.",
    build=build,
    motion=untracked(),
    frames=90,
    bounds=(
        NO_OVERLAP, RIGHT_SIDE, FINITE,
        Bound("course_error_max", 1e-9, "the parabola is exact at any frame time; only rounding is left"),
        Bound("velocity_error_max", 1e-9, "v - g t, likewise"),
        Bound("spin_error_max", 1e-9, "a cube keeps its spin"),
        Bound("restitution_error_max", 1e-6, "eq. 8 fixes v+/v- of the ball that lands"),
    ),
    regions=(Region(("falls",), (-INFINITE, -INFINITE, 0.0), (INFINITE,) * 3, "the slab is not passed"),),
    expects={
        "drops": (Drop("falls", "slab", 0.3, HEIGHT),),
        "courses": (
            Course("ball", uniform(STARTS["ball"], THROWN, EARTH), speed()),
            Course("box", uniform(STARTS["box"], THROWN, EARTH), speed(), steady(*SPIN)),
        ),
    },
)
