"""Painleve's paradox: rods slide with their lower end ahead over ever rougher floors.

At an angle of arctan 2 from upright no finite force is consistent from mu = 4/3 on; impulses are. Only invariants are judged.
"""

from collections.abc import Iterator
from math import atan, cos

import numpy as np

from avatarsim.scene.body import Body, Mass
from avatarsim.scene.shape import Capsule
from scenarios.building.cases import LAID, laws, loose, slab, turned_by
from scenarios.building.promises import NO_ENERGY, SOUND
from scenarios.building.scenes import above, each_alone, undriven
from scenarios.scenario import Bound

RODS = {f"rod_{friction:g}": friction for friction in (0.5, 1.2, 1.4, 2.0, 5.0)}
"""Friction of each: two below the critical 4/3, three above."""
LENGTH, RADIUS = 1.0, 0.01
"""Length of the axis and radius [m]."""
LEAN = atan(2.0)
"""First angle from upright [rad]: the lower end ahead in the direction of motion, where friction presses it into the floor."""


def bodies() -> Iterator[Body]:
    """Five rods side by side, each of a roughness of its own."""
    yield slab(20.0, 8.0)
    across, high = LENGTH**2 / 12.0, 0.5 * LENGTH * cos(LEAN) + RADIUS + LAID
    mass = Mass(1.0, inertia=np.diag([across, across, 1e-3 * across]))
    for k, (name, friction) in enumerate(RODS.items()):
        at, turn = (0.0, 1.4 * (k - 2), high), turned_by((0.0, 1.0, 0.0), -LEAN)
        yield loose(name, Capsule(RADIUS, LENGTH), f"mu_{friction:g}", mass, at, turn, velocity=(3.0, 0.0, 0.0))


SCENARIO = undriven(
    "painleve", "Leaning rods slide with their lower end ahead over ever rougher floors.",
    "That the paradox ends in a number, above the floor, without more energy than before.", bodies,
    laws({(f"mu_{friction:g}", "floor"): (0.0, friction) for friction in RODS.values()}), frames=60,
    bounds=(
        *SOUND, NO_ENERGY,
        Bound("travel_missing", 0.0, "rods fall over, whatever friction does: the middle comes down by 0.15 m at least"),
        Bound("halted_frames", 0.0, "the paradox does not stop the world"),
    ),
    regions=(above(0.0, "rod_*"),), expects={"alone": each_alone(RODS), "travel": dict.fromkeys(RODS, 0.15)},
)
