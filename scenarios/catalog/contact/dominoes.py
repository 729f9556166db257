"""Forty dominoes in a row: the first leans, and the wave that it starts runs to the end.

The speed of the wave, once steady, was found by this project's exact solution of every impact and contact, which takes a
thousand times the work that a frame may cost: 0.909 m/s. Engines with fixed steps of 240 Hz give 0.78 to 0.86, with dominoes
2 to 5 mm deep in each other.
"""

import math

from avatarsim.scene.body import Body, ContactLaw, fixed, simulated, solid
from avatarsim.scene.scene import Scene
from avatarsim.scene.shape import Box, Piece
from scenarios.building.cases import LAID, pair_table, turned_by
from scenarios.building.expected import Wave
from scenarios.building.promises import CROWD, GAINS_NOTHING
from scenarios.motion.untracked import untracked
from scenarios.scenario import INFINITE, Bound, Region, Scenario

THICK, WIDE, HIGH = 0.0075, 0.024, 0.048
"""Edges of a domino [m]: those of a common set."""
MASS, PITCH = 0.012, 0.02
"""Mass [kg], and distance of neighbours in the row [m]."""
LEAN = 0.2
"""Lean of the first [rad]: beyond its edge, so that it falls by itself."""
SPEED = 0.909
"""Speed of the wave [m/s] from the eleventh domino to the fifth from the end."""
NAMES = tuple(f"domino_{k}" for k in range(40))


def build() -> Scene:
    """A row along x on a wide floor, the first domino on its edge."""
    pieces = (Piece(Box((THICK, WIDE, HIGH))),)
    bodies: list[Body] = [fixed("floor", (Piece(Box((8.0, 8.0, 0.2))),), "floor", (0.0, 0.0, -0.1))]
    across, up = math.cos(LEAN) * 0.5 * THICK - math.sin(LEAN) * 0.5 * HIGH, math.sin(LEAN) * 0.5 * THICK
    first = (0.5 * THICK - across, 0.0, up + math.cos(LEAN) * 0.5 * HIGH + LAID)
    bodies.append(simulated(NAMES[0], pieces, "domino", solid(pieces, MASS), first, turned_by((0.0, 1.0, 0.0), LEAN)))
    for k, name in enumerate(NAMES[1:], 1):
        bodies.append(simulated(name, pieces, "domino", solid(pieces, MASS), (PITCH * k, 0.0, 0.5 * HIGH + LAID)))
    law = ContactLaw(0.2, 0.3)
    materials = pair_table(("floor", "domino"), {("floor", "domino"): law, ("domino", "domino"): law})
    return Scene("dominoes", tuple(bodies), materials=materials)


SCENARIO = Scenario(
    name="dominoes",
    title="Forty dominoes topple one another.",
    judged="How fast the wave runs and how many it reaches; overlap, time kept, energy.",
    build=build,
    motion=untracked(),
    frames=300,
    short=105,
    bounds=(
        *CROWD, GAINS_NOTHING,
        Bound("wave_speed_error", 3.3, "0.91 m/s, give or take 0.03"),
        Bound("wave_missing", 0.0, "the wave runs to the end"),
    ),
    regions=(
        Region(("domino_*",), (-INFINITE, -INFINITE, 0.0), (INFINITE, INFINITE, HIGH), "no domino falls through the floor"),
    ),
    expects={"waves": (Wave(NAMES, PITCH, SPEED, 10, 35),), "alone": (NAMES,)},
)
