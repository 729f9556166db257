"""A thin rod falls over on a frictionless floor; its centre comes straight down.

Closed form: w^2 = 12 g (cos a0 - cos a) / (L (1 + 3 sin^2 a)), a the angle from upright. It holds for a rod with round ends too,
since the floor pushes through the middle of the end.
"""

import numpy as np

from avatarsim.scene.body import ContactLaw, Mass, fixed, simulated
from avatarsim.scene.scene import Scene
from avatarsim.scene.shape import Box, Capsule, Piece
from reference.closed_form import rod_angular_velocity
from scenarios.building.cases import LAID, pair_table, turned_by
from scenarios.building.expected import Pivot
from scenarios.building.promises import FINITE, NO_OVERLAP, RIGHT_SIDE
from scenarios.motion.untracked import untracked
from scenarios.scenario import INFINITE, Bound, Region, Scenario

LENGTH, RADIUS, MASS, START, GRAVITY = 1.0, 0.01, 1.0, 0.1, 9.81
"""Length of the rod's axis and its radius [m], mass [kg], first angle from upright [rad], gravity [m/s^2]."""
DOWN = 1.5
"""Angle [rad] until which the rod is followed: just before it lies."""


def build() -> Scene:
    """The rod stands on its lower end, leaning towards +x."""
    pieces = (Piece(Capsule(RADIUS, LENGTH)),)
    across = MASS * LENGTH**2 / 12.0
    mass = Mass(MASS, inertia=np.diag([across, across, 1e-4 * across]))
    at = (0.0, 0.0, 0.5 * LENGTH * float(np.cos(START)) + RADIUS + LAID)
    return Scene("falling_rod", (
        fixed("floor", (Piece(Box((4.0, 4.0, 0.2))),), "ice", (0.0, 0.0, -0.1)),
        simulated("rod", pieces, "rod", mass, at, turned_by((0.0, 1.0, 0.0), START)),
    ), materials=pair_table(("ice", "rod"), {("ice", "rod"): ContactLaw(0.0, 0.0)}))


SCENARIO = Scenario(
    name="falling_rod",
    title="A thin rod falls over on a frictionless floor.",
    judged="Its angular speed at every angle; that its centre comes straight down.",
    build=build,
    motion=untracked(),
    frames=75,
    bounds=(
        NO_OVERLAP, RIGHT_SIDE, FINITE,
        Bound("pivot_rate_error_max", 5e-3, "energy fixes the speed at every angle; a thousandth of the 5.4 rad/s at the end"),
        Bound("pivot_missing", 0.0, "it falls: from 0.1 rad it is down after 0.85 s"),
        Bound("energy_gain_max", 1e-9, "a floor without friction gives nothing"),
    ),
    regions=(Region(("rod",), (-1e-6, -1e-6, 0.0), (1e-6, 1e-6, INFINITE), "nothing pushes the rod sideways"),),
    expects={
        "pivots": (Pivot("rod", lambda angle: rod_angular_velocity(START, max(angle, START), LENGTH, GRAVITY), DOWN),),
        "alone": (("rod",),),
    },
)
