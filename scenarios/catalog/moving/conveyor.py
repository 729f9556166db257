"""A box is laid on a belt that runs: friction brings it to the belt's speed at mu g, and from then on it goes with the belt."""

from avatarsim.scene.body import ContactLaw, simulated, solid
from avatarsim.scene.checks import Vector
from avatarsim.scene.moving import moving
from avatarsim.scene.scene import Scene
from avatarsim.scene.shape import Box, Piece
from scenarios.building.cases import LAID, pair_table
from scenarios.building.expected import Course
from scenarios.building.promises import FINITE, KEEPS_TIME, NO_OVERLAP, RIGHT_SIDE
from scenarios.motion.moving_bodies import given
from scenarios.scenario import Bound, Region, Scenario

SPEED, FRICTION = 1.0, 0.5
"""Speed of the belt [m/s], and friction of box and belt."""
BELT, CUBE = (6.0, 0.6, 0.1), (0.1, 0.1, 0.1)
START: Vector = (-2.0, 0.0, 0.5 * (BELT[2] + CUBE[2]) + LAID)
PUSH = FRICTION * 9.81


def place(time: float) -> Vector:
    """Where the box is in closed form [m]."""
    slides = min(time, SPEED / PUSH)
    return START[0] + 0.5 * PUSH * slides * slides + SPEED * (time - slides), 0.0, START[2]


def build() -> Scene:
    """Return the belt and the box."""
    belt = moving("belt", (Piece(Box(BELT)),), "belt", surface_velocity=(SPEED, 0.0, 0.0))
    cube = (Piece(Box(CUBE)),)
    box = simulated("box", cube, "box", solid(cube, 1.0), START)
    return Scene("conveyor", (box,), (belt,), pair_table(("belt", "box"), {("belt", "box"): ContactLaw(0.0, FRICTION)}))


SCENARIO = Scenario(
    name="conveyor",
    title="A box is laid on a running belt.",
    judged="How far the box is from where friction and the belt bring it.",
    build=build,
    motion=given(lambda time: {}),
    frames=240,
    short=120,
    bounds=(
        NO_OVERLAP, RIGHT_SIDE, FINITE, KEEPS_TIME,
        Bound("course_error_max", 5e-3, "a substep of slip more or less is 4 mm of way at this speed"),
    ),
    regions=(Region(("box",), (-2.1, -0.1, 0.0), (2.5, 0.1, 0.2), "the box stays on the belt"),),
    expects={"courses": (Course("box", place),)},
)
