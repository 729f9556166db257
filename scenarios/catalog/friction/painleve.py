"""Painleve's paradox: rods slide with their lower end ahead over ever rougher floors.

At an angle of arctan 2 from upright no finite force is consistent from mu = 4/3 on; impulses are. Nothing but invariants is
judged: the rod is a number, above the floor, and has no more energy than before.
"""

import numpy as np

from avatarsim.scene.body import Body, ContactLaw, Mass, fixed, simulated
from avatarsim.scene.scene import Scene
from avatarsim.scene.shape import Box, Capsule, Piece
from scenarios.building.cases import LAID, pair_table, turned_by
from scenarios.building.promises import FINITE, NO_OVERLAP, RIGHT_SIDE
from scenarios.motion.untracked import untracked
from scenarios.scenario import INFINITE, Bound, Region, Scenario

FRICTIONS = (0.5, 1.2, 1.4, 2.0, 5.0)
"""Two below the critical 4/3, three above."""
LENGTH, RADIUS, MASS, SPEED = 1.0, 0.01, 1.0, 3.0
"""Length of the axis and radius [m], mass [kg], first speed [m/s]."""
LEAN = float(np.arctan(2.0))
"""First angle from upright [rad]: the lower end ahead in the direction of motion, where friction presses it into the floor."""


def build() -> Scene:
    """Five rods side by side, each of a roughness of its own."""
    bodies: list[Body] = [fixed("floor", (Piece(Box((20.0, 8.0, 0.2))),), "floor", (0.0, 0.0, -0.1))]
    pieces = (Piece(Capsule(RADIUS, LENGTH)),)
    across = MASS * LENGTH**2 / 12.0
    mass = Mass(MASS, inertia=np.diag([across, across, 1e-3 * across]))
    turn = turned_by((0.0, 1.0, 0.0), -LEAN)
    high = 0.5 * LENGTH * float(np.cos(LEAN)) + RADIUS + LAID
    for k, friction in enumerate(FRICTIONS):
        at = (0.0, 1.4 * (k - 2), high)
        bodies.append(simulated(f"rod_{friction:g}", pieces, f"mu_{friction:g}", mass, at, turn, velocity=(SPEED, 0.0, 0.0)))
    stated = {(f"mu_{friction:g}", "floor"): ContactLaw(0.0, friction) for friction in FRICTIONS}
    names = ["floor", *(f"mu_{friction:g}" for friction in FRICTIONS)]
    return Scene("painleve", tuple(bodies), materials=pair_table(names, stated))


RODS = tuple(f"rod_{friction:g}" for friction in FRICTIONS)

SCENARIO = Scenario(
    name="painleve",
    title="Leaning rods slide with their lower end ahead over ever rougher floors.",
    judged="That the paradox ends in a number, above the floor, without more energy than before.",
    build=build,
    motion=untracked(),
    frames=60,
    bounds=(
        NO_OVERLAP, RIGHT_SIDE, FINITE,
        Bound("energy_gain_max", 1e-9, "neither floor nor friction gives energy"),
        Bound("travel_missing", 0.0, "rods fall over, whatever friction does: the middle comes down by 0.15 m at least"),
        Bound("halted_frames", 0.0, "the paradox does not stop the world"),
    ),
    regions=(Region(("rod_*",), (-INFINITE, -INFINITE, 0.0), (INFINITE,) * 3, "no rod falls through the floor"),),
    expects={"alone": tuple((rod,) for rod in RODS), "travel": dict.fromkeys(RODS, 0.15)},
)
