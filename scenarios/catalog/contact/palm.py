"""A flat hand lifts a box off two posts and carries it away: 2 m/s^2 forth and back again, well below what friction holds."""

from avatarsim.scene.checks import Vector
from scenarios.building.expected import Carried
from scenarios.building.posts import HIGH, LOW, box_across_posts
from scenarios.building.promises import FINITE, KEEPS_MOVING, KEEPS_TIME, NO_OVERLAP, RIGHT_SIDE
from scenarios.motion.rigid_hands import eased, led
from scenarios.scenario import Bound, Region, Scenario

MASS, FRICTION = 0.4, 0.6
"""Mass of the box [kg], and friction of all pairs: it holds up to 5.9 m/s^2."""
LIFTED, GOES, TURNS = (0.1, 0.7), 1.0, 0.5
"""When the hand rises, from when on it goes, and how long it gains and then loses speed [s]."""
PUSH = 2.0
"""Acceleration of the user [m/s^2]."""


def along(time: float) -> float:
    """Way of the user [m]: constant acceleration, the same backwards, then rest."""
    t = min(max(time - GOES, 0.0), 2.0 * TURNS)
    late = max(t - TURNS, 0.0)
    return 0.5 * PUSH * t * t - PUSH * late * late


def places(time: float) -> tuple[Vector]:
    """The hand, which rises and then goes along y, between the posts and away."""
    return ((0.0, along(time), LOW + (HIGH - LOW) * eased(time, *LIFTED)),)


SCENARIO = Scenario(
    name="palm",
    title="A flat hand lifts a box and carries it away.",
    judged="That the box comes along and does not slip.",
    build=lambda: box_across_posts("palm", MASS, FRICTION),
    motion=led(places),
    frames=300,
    short=140,
    bounds=(
        NO_OVERLAP, RIGHT_SIDE, FINITE, KEEPS_MOVING, KEEPS_TIME,
        Bound("grip_slip_max", 2e-3, "a third of what friction holds; where acceleration jumps springs yield by 0.5 mm"),
        Bound("height_missing", 1e-3, "the box stays on the hand"),
        Bound("travel_missing", 0.0, "the box comes along: half a metre"),
    ),
    regions=(Region(("box", "hand"), (-0.1, -0.1, 0.2), (0.1, 0.7, 0.6), "the box stays on the hand"),),
    expects={
        "carried": (Carried("box", ("hand",), GOES - 0.05),), "travel": {"box": PUSH * TURNS * TURNS - 0.01},
    },
)
