"""Energy drift: an elastic ball bounces for twenty seconds, 44 times from one metre, and loses nothing.

The question of SimBenchmark's bouncing test: how the energy drifts. Impact n is at (2 n - 1) sqrt(2 h / g).
"""

from avatarsim.scene.body import ContactLaw, fixed, simulated, solid
from avatarsim.scene.scene import Scene
from avatarsim.scene.shape import Box, Piece, Sphere
from scenarios.building.cases import pair_table
from scenarios.building.promises import FINITE, NO_OVERLAP, RIGHT_SIDE
from scenarios.motion.untracked import untracked
from scenarios.scenario import INFINITE, Bound, Drop, Region, Scenario

RADIUS, MASS, HEIGHT = 0.1, 1.0, 1.0
"""Radius [m], mass [kg], height of the lowest point at the start [m]."""


def build() -> Scene:
    """The ball over a slab."""
    pieces = (Piece(Sphere(RADIUS)),)
    materials = pair_table(("ball", "floor"), {("ball", "floor"): ContactLaw(1.0, 0.0)})
    return Scene("elastic_20s", (
        fixed("floor", (Piece(Box((2.0, 2.0, 0.2))),), "floor", (0.0, 0.0, -0.1)),
        simulated("ball", pieces, "ball", solid(pieces, MASS), (0.0, 0.0, RADIUS + HEIGHT)),
    ), materials=materials)


SCENARIO = Scenario(
    name="elastic_20s",
    title="An elastic ball bounces for twenty seconds.",
    judged="Energy, and the time and apex of every bounce.",
    build=build,
    motion=untracked(),
    frames=1200,
    short=300,
    bounds=(
        NO_OVERLAP, RIGHT_SIDE, FINITE,
        Bound("energy_drift_max", 1e-10, "nothing takes or gives energy; rounding of 44 impacts and 1200 frames"),
        Bound("bounce_time_error_max", 1e-6, "44 impacts, each 2e-8 m above the floor: 9e-9 s early each, 4e-7 s together"),
        Bound("apex_error_max", 1e-6, "the apex is h every time"),
        Bound("restitution_error_max", 1e-6, "eq. 8 with e = 1"),
    ),
    regions=(Region(("ball",), (-INFINITE, -INFINITE, 0.0), (INFINITE,) * 3, "the ball does not fall through the floor"),),
    expects={"drops": (Drop("ball", "floor", 1.0, HEIGHT),), "elastic": (("ball",),)},
)
