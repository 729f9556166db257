"""SimBenchmark's 666 test: a lattice of 6 x 6 x 6 balls falls a little, lands, and topples.

The lattice is sheared by a hair, so that it does not balance on itself. How deep are balls in one another, and does energy
appear?
"""

from avatarsim.scene.body import Body, ContactLaw, fixed, simulated, solid
from avatarsim.scene.scene import Scene
from avatarsim.scene.shape import Box, Piece, Sphere
from scenarios.building.cases import pair_table
from scenarios.building.promises import FINITE, NO_OVERLAP, RIGHT_SIDE
from scenarios.motion.untracked import untracked
from scenarios.scenario import INFINITE, Bound, Region, Scenario

SIDE, RADIUS, MASS = 6, 0.1, 1.0
"""Balls along an edge of the lattice, radius [m] and mass [kg] of a ball."""
PITCH, LOW = 0.2002, 0.01
"""Distance of neighbours in the lattice [m]; height of the lowest balls above the floor [m]."""
SHEAR = 0.004
"""Sideways offset of a layer against the one below, along x and half as much along y [m]."""
NAMES = tuple(f"ball_{k}" for k in range(SIDE**3))


def build() -> Scene:
    """The lattice over a floor so wide that no ball rolls off it."""
    bodies: list[Body] = [fixed("floor", (Piece(Box((200.0, 200.0, 0.2))),), "floor", (0.0, 0.0, -0.1))]
    pieces = (Piece(Sphere(RADIUS)),)
    for k, name in enumerate(NAMES):
        i, j, layer = k % SIDE, k // SIDE % SIDE, k // SIDE**2
        at = (PITCH * (i - 2.5) + SHEAR * layer, PITCH * (j - 2.5) + 0.5 * SHEAR * layer, RADIUS + LOW + PITCH * layer)
        bodies.append(simulated(name, pieces, "ball", solid(pieces, MASS), at))
    lively = ContactLaw(0.3, 0.3)
    materials = pair_table(("floor", "ball"), {("floor", "ball"): lively, ("ball", "ball"): lively})
    return Scene("balls_216", tuple(bodies), materials=materials)


SCENARIO = Scenario(
    name="balls_216",
    title="A lattice of 216 balls lands and topples.",
    judged="Overlap, energy, and the time of the worst frame.",
    build=build,
    motion=untracked(),
    frames=600,
    short=45,
    bounds=(
        NO_OVERLAP, RIGHT_SIDE, FINITE,
        Bound("energy_gain_max", 1e-9, "impacts and friction take energy"),
        Bound("halted_frames", 0.0, "a budget that is spent ends in a plastic step and not in a halt"),
        Bound("travel_missing", 0.0, "every ball comes down"),
    ),
    regions=(Region(("ball_*",), (-INFINITE, -INFINITE, 0.0), (INFINITE,) * 3, "no ball falls through the floor"),),
    expects={"alone": (NAMES,), "travel": dict.fromkeys(NAMES, 0.5 * LOW)},
)
