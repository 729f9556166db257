"""Zeno sequences: balls bounce ever faster and lower until, after infinitely many bounces in a finite time, they lie still.

Closed form of that time: sqrt(2 h / g) (1 + e) / (1 - e), after a way of h (1 + e^2) / (1 - e^2). An engine that takes bounces
one by one never gets there, one that stops counting gets there early.
"""

from avatarsim.scene.body import Body, ContactLaw, fixed, simulated, solid
from avatarsim.scene.scene import Scene
from avatarsim.scene.shape import Box, Piece, Sphere
from scenarios.building.cases import pair_table
from scenarios.building.expected import Rest
from scenarios.building.promises import FINITE, NO_OVERLAP, RIGHT_SIDE
from scenarios.motion.untracked import untracked
from scenarios.scenario import INFINITE, Bound, Drop, Region, Scenario

RESTITUTIONS = (0.1, 0.3, 0.5)
RADIUS, MASS, HEIGHT = 0.05, 0.2, 0.5
"""Radius [m], mass [kg], height of the lowest point at the start [m]: the ends are at 0.39, 0.59 and 0.96 s."""
RESTS = 1.2
"""From then on [s] all lie still."""
DROPS = tuple(Drop(f"ball_{e:g}", "floor", e, HEIGHT) for e in RESTITUTIONS)


def build() -> Scene:
    """Three balls over one floor."""
    bodies: list[Body] = [fixed("floor", (Piece(Box((4.0, 2.0, 0.2))),), "floor", (0.0, 0.0, -0.1))]
    pieces = (Piece(Sphere(RADIUS)),)
    for k, drop in enumerate(DROPS):
        at = (k - 1.0, 0.0, RADIUS + HEIGHT)
        bodies.append(simulated(drop.ball, pieces, f"e_{drop.restitution:g}", solid(pieces, MASS), at))
    stated = {(f"e_{e:g}", "floor"): ContactLaw(e, 0.3) for e in RESTITUTIONS}
    names = ["floor", *(f"e_{e:g}" for e in RESTITUTIONS)]
    return Scene("zeno", tuple(bodies), materials=pair_table(names, stated))


SCENARIO = Scenario(
    name="zeno",
    title="Three balls bounce until they have done so infinitely often, and lie still.",
    judged="When they lie still, and that they do.",
    build=build,
    motion=untracked(),
    frames=90,
    bounds=(
        NO_OVERLAP, RIGHT_SIDE, FINITE,
        Bound("zeno_end_error_max", 1e-6, "the sum of all flights is finite and known; nothing allows an engine to end it early"),
        Bound("restitution_error_max", 1e-6, "eq. 8 fixes v+/v- at every impact"),
        Bound("drift_max", 1e-9, "what lies still stays where it is"),
        Bound("rest_energy_end", 1e-12, "what lies still does not move"),
    ),
    regions=(Region(("ball_*",), (-INFINITE, -INFINITE, 0.0), (INFINITE,) * 3, "no ball falls through the floor"),),
    expects={"drops": DROPS, "zeno": True, "rests": (Rest(tuple(drop.ball for drop in DROPS), RESTS),)},
)
