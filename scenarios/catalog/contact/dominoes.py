"""Forty dominoes in a row: the first leans, and the wave that it starts runs to the end.

The speed of the wave was found by an exact solution of every impact and contact, at a thousand times the cost of a frame.
"""

import math
from collections.abc import Iterator

from avatarsim.scene.body import Body
from avatarsim.scene.shape import Box
from scenarios.building.cases import LAID, loose, one_law, slab, turned_by
from scenarios.building.expected import Wave
from scenarios.building.promises import CROWD, GAINS_NOTHING
from scenarios.building.scenes import undriven
from scenarios.scenario import INFINITE, Bound, Region

THICK, WIDE, HIGH, MASS, PITCH = 0.0075, 0.024, 0.048, 0.012, 0.02
"""Edges [m] and mass [kg] of a domino, and distance of neighbours in the row [m]."""
LEAN = 0.2
"""Lean of the first [rad]: beyond its edge, so that it falls by itself."""
SPEED = 0.909
"""Speed of the wave [m/s] from the eleventh domino to the fifth from the end."""
NAMES = tuple(f"domino_{k}" for k in range(40))


def bodies() -> Iterator[Body]:
    """A row along x on a wide floor, the first domino on its edge."""
    yield slab(8.0, 8.0)
    across, up = math.cos(LEAN) * 0.5 * THICK - math.sin(LEAN) * 0.5 * HIGH, math.sin(LEAN) * 0.5 * THICK
    domino, first = Box((THICK, WIDE, HIGH)), (0.5 * THICK - across, 0.0, up + math.cos(LEAN) * 0.5 * HIGH + LAID)
    yield loose(NAMES[0], domino, "domino", MASS, first, turned_by((0.0, 1.0, 0.0), LEAN))
    for k, name in enumerate(NAMES[1:], 1):
        yield loose(name, domino, "domino", MASS, (PITCH * k, 0.0, 0.5 * HIGH + LAID))


SCENARIO = undriven(
    "dominoes", "Forty dominoes topple one another.",
    "How fast the wave runs and how many it reaches; overlap, time kept, energy.", bodies,
    one_law(0.2, 0.3, ("floor", "domino"), ("domino", "domino")), frames=300, short=105,
    bounds=(
        *CROWD, GAINS_NOTHING, Bound("wave_speed_error", 3.3, "0.91 m/s, give or take 0.03"),
        Bound("wave_missing", 0.0, "the wave runs to the end"),
    ),
    regions=(
        Region(("domino_*",), (-INFINITE, -INFINITE, 0.0), (INFINITE, INFINITE, HIGH), "no domino falls through the floor"),
    ),
    expects={"waves": (Wave(NAMES, PITCH, SPEED, 10, 35),), "alone": (NAMES,)},
)
