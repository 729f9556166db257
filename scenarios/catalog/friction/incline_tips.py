"""Tipping: a box on a rough slope of 20 degrees, one degree taller than what stands (`incline` has that one)."""

from math import radians, tan

from avatarsim.scene.body import ContactLaw, fixed, simulated, solid
from avatarsim.scene.scene import Scene
from avatarsim.scene.shape import Box, Piece
from scenarios.building.cases import LAID, pair_table, turned_by
from scenarios.building.promises import FINITE, NO_OVERLAP, RIGHT_SIDE
from scenarios.catalog.friction.incline import BOARD, MASS, place
from scenarios.motion.untracked import untracked
from scenarios.scenario import INFINITE, Bound, Region, Scenario

SLOPE, BASE = 20.0, 0.2
"""[deg], [m]"""
HEIGHT = BASE / tan(radians(SLOPE - 1.0))
"""tan a > base / height, by one degree [m]."""


def build() -> Scene:
    """One board and one tall box on its upper part."""
    turn, board, pieces = turned_by((0.0, 1.0, 0.0), radians(SLOPE)), (Piece(Box(BOARD)),), (Piece(Box((BASE, BASE, HEIGHT))),)
    at = place(SLOPE, -1.0, 0.5 * HEIGHT + LAID, 0.0)
    return Scene("incline_tips", (
        fixed("board", board, "board", place(SLOPE, 0.0, -0.5 * BOARD[2], 0.0), turn),
        simulated("tips", pieces, "rough", solid(pieces, MASS), at, turn),
    ), materials=pair_table(("board", "rough"), {("board", "rough"): ContactLaw(0.0, 2.0)}))


SCENARIO = Scenario(
    name="incline_tips",
    family="incline",
    title="A box too tall for its slope tips over.",
    judged="That it tips, and that no energy comes of it.",
    build=build,
    motion=untracked(),
    frames=90,
    bounds=(
        NO_OVERLAP, RIGHT_SIDE, FINITE,
        Bound("travel_missing", 0.0, "it falls: its middle goes by a quarter of its height at least"),
        Bound("energy_gain_max", 1e-9, "friction only takes"),
    ),
    regions=(Region(("tips",), (-INFINITE, -INFINITE, -1.3), (INFINITE,) * 3, "it does not fall through the board"),),
    expects={"travel": {"tips": 0.15}, "alone": (("tips",),)},
)
