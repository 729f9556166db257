"""Deep overlap at the start: pairs of boxes that begin 1, 5, 10 and 20 cm inside each other, without gravity, must not fly apart.

An engine may refuse such a start and name the pairs, as a scene asks for by expecting a refusal; one that resolves it must add no
velocity. Engines that push with springs or with position errors turned into speed shoot the boxes apart.
"""

from avatarsim.scene.body import Body, simulated, solid
from avatarsim.scene.scene import Scene
from avatarsim.scene.shape import Box, Piece
from scenarios.building.cases import NOWHERE
from scenarios.building.promises import FINITE, NO_OVERLAP
from scenarios.motion.untracked import untracked
from scenarios.scenario import Bound, Scenario

DEPTHS = (0.01, 0.05, 0.1, 0.2)
"""[m]; the last two boxes are in the same place."""
EDGE, MASS, LANE = 0.2, 1.0, 2.0
"""Edge [m] and mass [kg] of a box, distance of the pairs [m]."""


def build() -> Scene:
    """Four pairs along y, each along x inside one another."""
    bodies: list[Body] = []
    pieces = (Piece(Box((EDGE, EDGE, EDGE))),)
    for k, depth in enumerate(DEPTHS):
        for side, sign in (("left", -0.5), ("right", 0.5)):
            at = (sign * (EDGE - depth), LANE * k, 0.0)
            bodies.append(simulated(f"{side}_{k}", pieces, "wood", solid(pieces, MASS), at))
    return Scene("deep_overlap", tuple(bodies), gravity=NOWHERE)


SCENARIO = Scenario(
    name="deep_overlap",
    title="Pairs of boxes begin 1 to 20 cm inside each other.",
    judged="Energy that removing the overlap adds; a refusal that names the pairs is right as well.",
    build=build,
    motion=untracked(),
    frames=60,
    bounds=(
        NO_OVERLAP, FINITE,
        Bound("energy_added_max", 0.0, "bodies at rest that are moved apart are still at rest"),
    ),
    metrics=("energy_added_max",),
    expects={"refusal": True},
)
