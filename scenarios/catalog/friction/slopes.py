"""Blocks on slopes: a tenth of a degree decides which slide, one degree which tall box tips.

Closed form: a = g (sin a - mu cos a) where that is positive, else none; a box tips where tan a > base / height.
"""

from collections.abc import Iterator
from math import cos, radians, sin, tan

import numpy as np

from avatarsim.scene.body import Body
from avatarsim.scene.checks import Quaternion, Vector
from avatarsim.scene.shape import Box
from reference.closed_form import incline_acceleration
from scenarios.building.cases import LAID, NOWHERE, fixture, laws, loose, turned_by
from scenarios.building.expected import Course, uniform
from scenarios.building.promises import NO_ENERGY, SOUND
from scenarios.building.scenes import above, each_alone, undriven
from scenarios.scenario import Bound

SLOPES, NEAR = (10.0, 20.0, 30.0, 40.0), 0.1
"""Slopes, and how far friction's own angle is from them [deg]."""
CASES: dict[str, tuple[float, float]] = {
    "slides": (30.0, 0.15),
    **{f"stays_{slope:g}": (slope, tan(radians(slope + NEAR))) for slope in SLOPES},
    **{f"slips_{slope:g}": (slope, tan(radians(slope - NEAR))) for slope in SLOPES},
}
"""Slope [deg] and friction."""
FLAT = 0.05
"""Height [m] of a block that does not tip even at 40 degrees."""
STEEP, BASE = 20.0, 0.2
"""Slope [deg] under the tall boxes, and edges of all boxes along and across it [m]."""
STANDS, TIPS = BASE / tan(radians(STEEP + 1.0)), BASE / tan(radians(STEEP - 1.0))
"""Heights of the tall boxes [m]: one degree from tipping, before and beyond."""
BOARD, START = (5.6, 0.6, 0.1), -1.6
"""Edges of a sloping board [m], and where on it blocks start, from its middle: one slides 4.1 m and stays on it."""


def turn(slope: float) -> Quaternion:
    """Return a board that falls towards +x by `slope` [deg]."""
    return turned_by((0.0, 1.0, 0.0), radians(slope))


def place(slope: float, along: float, above_it: float, lane: float) -> Vector:
    """Return the point `along` a slope and `above_it` [m]; the board's middle is at the origin of its lane."""
    a = radians(slope)
    return along * cos(a) + above_it * sin(a), lane, -along * sin(a) + above_it * cos(a)


def on_board(board: str, name: str, slope: float, height: float, start: float, material: str, lane: float) -> Iterator[Body]:
    """Yield a board, and a block on its upper part."""
    yield fixture(board, Box(BOARD), "board", place(slope, 0.0, -0.5 * BOARD[2], lane), turn(slope))
    at = place(slope, start, 0.5 * height + LAID, lane)
    yield loose(name, Box((BASE, BASE, height)), material, 1.0, at, turn(slope))


def bodies() -> Iterator[Body]:
    """Yield a board for every case, side by side along y."""
    for k, (name, (slope, _)) in enumerate(CASES.items()):
        yield from on_board(f"board_{name}", name, slope, FLAT, START, name, k)
    yield from on_board("board_stands", "stands", STEEP, STANDS, START, "rough", len(CASES))


def courses() -> Iterator[Course]:
    """Yield where each block is at any time: down the slope with a constant acceleration, or where it was."""
    for k, (name, (slope, friction)) in enumerate(CASES.items()):
        a = incline_acceleration(radians(slope), friction, 9.81)
        down = np.array(place(slope, 1.0, 0.0, 0.0))
        yield Course(name, uniform(place(slope, START, 0.5 * FLAT, k), NOWHERE, (a * down).tolist()))
    yield Course("stands", uniform(place(STEEP, START, 0.5 * STANDS, len(CASES)), NOWHERE))


SCENARIOS = (
    undriven(
        "incline", "Blocks on slopes of 10 to 40 degrees, with friction just below and just above what holds them.",
        "Which blocks slide and which stay, the acceleration of those that slide, and that a tall box does not tip.", bodies,
        laws({**{(name, "board"): (0.0, mu) for name, (_, mu) in CASES.items()}, ("rough", "board"): (0.0, 2.0)}),
        frames=90, short=60,
        bounds=(
            *SOUND, Bound("course_error_max", 2e-6, "at 0.1 degrees a block slides 9 mm or none; and 1e-6 m of air"),
            NO_ENERGY,
        ),
        regions=(above(-1.3, "sl*", "st*", reason="nothing falls through a board"),),
        expects={"courses": tuple(courses()), "alone": each_alone((*CASES, "stands"))},
    ),
    undriven(
        "incline_tips", "A box too tall for its slope tips over.", "That it tips, and that no energy comes of it.",
        lambda: on_board("board", "tips", STEEP, TIPS, -1.0, "rough", 0.0), laws({("board", "rough"): (0.0, 2.0)}),
        frames=90, family="incline",
        bounds=(
            *SOUND, Bound("travel_missing", 0.0, "it falls: its middle goes by a quarter of its height at least"), NO_ENERGY,
        ),
        regions=(above(-1.3, "tips", reason="it does not fall through the board"),),
        expects={"travel": {"tips": 0.15}, "alone": (("tips",),)},
    ),
)
