"""Coulomb friction of blocks on slopes: a tenth of a degree below and above the slope decides whether they stay.

Closed form: a = g (sin a - mu cos a) where that is positive, else none; a box tips where tan a > base / height.
"""

from math import cos, radians, sin, tan

import numpy as np

from avatarsim.scene.body import Body, ContactLaw, fixed, simulated, solid
from avatarsim.scene.checks import Quaternion, Vector
from avatarsim.scene.scene import Scene
from avatarsim.scene.shape import Box, Piece
from reference.closed_form import incline_acceleration
from scenarios.building.cases import LAID, NOWHERE, pair_table, turned_by
from scenarios.building.expected import Course, uniform
from scenarios.building.promises import FINITE, NO_OVERLAP, RIGHT_SIDE
from scenarios.motion.untracked import untracked
from scenarios.scenario import INFINITE, Bound, Region, Scenario

GRAVITY = 9.81
NEAR = 0.1
"""How far [deg] friction's own angle is from the slope in the cases beside the boundary."""
SLOPES = (10.0, 20.0, 30.0, 40.0)
"""[deg]"""
CASES: tuple[tuple[str, float, float], ...] = (
    ("slides", 30.0, 0.15),
    *((f"stays_{slope:g}", slope, tan(radians(slope + NEAR))) for slope in SLOPES),
    *((f"slips_{slope:g}", slope, tan(radians(slope - NEAR))) for slope in SLOPES),
)
"""Name, slope [deg], friction."""
SIZE = (0.2, 0.2, 0.05)
"""Edges of a block [m]: so flat that it does not tip even at 40 degrees."""
BOARD, START = (5.6, 0.6, 0.1), -1.6
"""Edges of a sloping board [m], and where on it blocks start, from its middle: one slides 4.1 m and is still on it at the end."""
MASS = 1.0
"""[kg]"""
TALL = {"stands": 0.2 / tan(radians(20.0 + 1.0))}
"""Height [m] of a box of base 0.2 m on a rough slope of 20 degrees: one degree from tipping."""


def _turn(slope: float) -> Quaternion:
    """A board that falls towards +x by `slope` [deg]."""
    return turned_by((0.0, 1.0, 0.0), radians(slope))


def place(slope: float, along: float, above: float, lane: float) -> Vector:
    """The point `along` a slope and `above` its surface [m]; the board's middle is at the origin of its lane."""
    a = radians(slope)
    return along * cos(a) + above * sin(a), lane, -along * sin(a) + above * cos(a)


def build() -> Scene:
    """A board for every case, side by side along y; the block starts on its upper part."""
    bodies: list[Body] = []
    stated: dict[tuple[str, str], ContactLaw] = {}
    for k, (name, slope, friction) in enumerate(CASES):
        bodies.append(fixed(f"board_{name}", (Piece(Box(BOARD)),), "board", place(slope, 0.0, -0.5 * BOARD[2], k), _turn(slope)))
        pieces = (Piece(Box(SIZE)),)
        at = place(slope, START, 0.5 * SIZE[2] + LAID, k)
        bodies.append(simulated(name, pieces, name, solid(pieces, MASS), at, _turn(slope)))
        stated[name, "board"] = ContactLaw(0.0, friction)
    for k, (name, height) in enumerate(TALL.items(), start=len(CASES)):
        bodies.append(fixed(f"board_{name}", (Piece(Box(BOARD)),), "board", place(20.0, 0.0, -0.5 * BOARD[2], k), _turn(20.0)))
        pieces = (Piece(Box((0.2, 0.2, height))),)
        at = place(20.0, START, 0.5 * height + LAID, k)
        bodies.append(simulated(name, pieces, "rough", solid(pieces, MASS), at, _turn(20.0)))
    stated["rough", "board"] = ContactLaw(0.0, 2.0)
    materials = pair_table(["board", "rough", *(name for name, _, _ in CASES)], stated)
    return Scene("incline", tuple(bodies), materials=materials)


def courses() -> tuple[Course, ...]:
    """Where each block is at any time: down the slope with a constant acceleration, or where it was."""
    found = []
    for k, (name, slope, friction) in enumerate(CASES):
        a = incline_acceleration(radians(slope), friction, GRAVITY)
        down = np.array(place(slope, 1.0, 0.0, 0.0))
        found.append(Course(name, uniform(place(slope, START, 0.5 * SIZE[2], k), NOWHERE, (a * down).tolist())))
    k = len(CASES)
    found.append(Course("stands", uniform(place(20.0, START, 0.5 * TALL["stands"], k), NOWHERE)))
    return tuple(found)


SCENARIO = Scenario(
    name="incline",
    title="Blocks on slopes of 10 to 40 degrees, with friction just below and just above what holds them.",
    judged="Which blocks slide and which stay, the acceleration of those that slide, and that a tall box does not tip.",
    build=build,
    motion=untracked(),
    frames=90,
    short=60,
    bounds=(
        NO_OVERLAP, RIGHT_SIDE, FINITE,
        Bound("course_error_max", 2e-6, "at a tenth of a degree a block slides 9 mm in a second or none; plus 1e-6 m of air"),
        Bound("energy_gain_max", 1e-9, "friction only takes"),
    ),
    regions=(Region(("sl*", "st*"), (-INFINITE, -INFINITE, -1.3), (INFINITE,) * 3, "nothing falls through a board"),),
    expects={
        "courses": courses(),
        "alone": tuple((name,) for name in (*(name for name, _, _ in CASES), *TALL)),
    },
)
