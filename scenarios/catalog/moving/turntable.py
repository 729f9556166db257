"""A turntable comes to 3 rad/s in two seconds; a box on it needs 18 % of its friction to stay at its radius."""

import numpy as np

from avatarsim.scene.body import ContactLaw, simulated, solid
from avatarsim.scene.moving import moving
from avatarsim.scene.scene import Scene
from avatarsim.scene.shape import Box, ConvexHull, Piece
from scenarios.building.cases import LAID, pair_table
from scenarios.building.expected import Carried
from scenarios.building.promises import FINITE, KEEPS_MOVING, KEEPS_TIME, NO_OVERLAP, RIGHT_SIDE
from scenarios.motion.moving_bodies import about_z, given
from scenarios.scenario import Bound, Region, Scenario

SPEED, TAKES = 3.0, 2.0
"""Angular velocity of the table [rad/s], and in how long it comes to it [s]."""
RADIUS, AT = 0.6, 0.2
"""Radius of the table, and where the box stands on it [m]."""
THICK, EDGE = 0.04, 0.1
"""Thickness of the table, and edge of the box [m]."""


def angle(time: float) -> float:
    """Angle of the table [rad]: constant acceleration, then constant speed."""
    t = min(time, TAKES)
    return 0.5 * SPEED / TAKES * t * t + SPEED * (time - t)


def build() -> Scene:
    """Return the table and the box."""
    around = np.linspace(0.0, 2.0 * np.pi, 32, endpoint=False)
    rim = [(RADIUS * np.cos(a), RADIUS * np.sin(a), z) for a in around for z in (-0.5 * THICK, 0.5 * THICK)]
    table = moving("table", (Piece(ConvexHull(np.array(rim))),), "wood")
    cube = (Piece(Box((EDGE, EDGE, EDGE))),)
    box = simulated("box", cube, "box", solid(cube, 1.0), (AT, 0.0, 0.5 * (THICK + EDGE) + LAID))
    return Scene("turntable", (box,), (table,), pair_table(("wood", "box"), {("wood", "box"): ContactLaw(0.0, 1.0)}))


SCENARIO = Scenario(
    name="turntable",
    title="A turntable turns with a box on it.",
    judged="How far the box drifts on the table.",
    build=build,
    motion=given(lambda time: {"table": ((0.0, 0.0, 0.0), about_z(angle(time)))}),
    frames=600,
    short=240,
    bounds=(
        NO_OVERLAP, RIGHT_SIDE, FINITE, KEEPS_MOVING, KEEPS_TIME,
        Bound("grip_slip_max", 1e-4, "friction holds it five times over: a tenth of a millimetre in ten seconds is not seen"),
    ),
    regions=(Region(("box",), (-0.5, -0.5, 0.0), (0.5, 0.5, 0.2), "the box stays on the table"),),
    expects={"carried": (Carried("box", ("table",), 0.1),)},
)
