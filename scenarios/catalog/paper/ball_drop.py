"""Table 1 in motion: six balls fall one metre, each onto its own slab, one for every pair of materials.

Closed form: the ball meets the slab at sqrt(2 g h), leaves at e times that (eq. 8), first apex e^2 h.
There is no avatar: what is judged is the bounce alone.
"""

from avatarsim.scene.body import TABLE_1, Body, fixed, simulated, solid
from avatarsim.scene.scene import Scene
from avatarsim.scene.shape import Box, Piece, Sphere
from avatarsim.scene.tracker import TrackerSample, rest
from scenarios.building.promises import FINITE, NO_OVERLAP, RIGHT_SIDE
from scenarios.scenario import INFINITE, RENDERED, Bound, Drop, Motion, Region, Scenario

PAIRS = (
    ("wood", "wood"), ("wood", "human"), ("wood", "metal"),
    ("human", "human"), ("human", "metal"), ("metal", "metal"),
)
"""Ball and slab, in the order of Table 1."""
RADIUS = 0.05
"""Radius of a ball [m]."""
MASS = 0.2
"""Mass of a ball [kg]; a fixed slab cancels it out of the bounce."""
HEIGHT = 1.0
"""From the slab's top to the ball's lowest point at the start [m]."""
SLAB = (0.5, 0.5, 0.1)
"""Edges of a slab [m], its top at z = 0."""
APART = 1.0
"""Distance of neighbouring balls [m]: they never meet."""

DROPS = tuple(
    Drop(f"ball_{a}_{b}", f"slab_{a}_{b}", TABLE_1.contact(a, b).restitution, HEIGHT) for a, b in PAIRS
)


def build() -> Scene:
    """Six slabs in a row along x and a ball above each."""
    bodies: list[Body] = []
    for k, ((ball, slab), drop) in enumerate(zip(PAIRS, DROPS, strict=True)):
        x = APART * k
        bodies.append(fixed(drop.floor, (Piece(Box(SLAB)),), slab, (x, 0.0, -0.5 * SLAB[2])))
        pieces = (Piece(Sphere(RADIUS)),)
        bodies.append(simulated(drop.ball, pieces, ball, solid(pieces, MASS), (x, 0.0, RADIUS + HEIGHT)))
    return Scene("ball_drop", tuple(bodies))


def motion(scene: Scene, seed: int) -> Motion:
    """Without an avatar: empty samples at the right times."""

    def sample(frame: int) -> TrackerSample:
        return rest(scene.avatars, (frame + 1) * RENDERED)

    return sample


SCENARIO = Scenario(
    name="ball_drop",
    title="Six balls fall one metre onto slabs, one for each pair of materials of Table 1.",
    judged="Restitution at the first impact and the height of the first apex, pair by pair.",
    build=build,
    motion=motion,
    frames=180,
    bounds=(
        NO_OVERLAP,
        RIGHT_SIDE,
        FINITE,
        Bound("restitution_error_max", 1e-6, "eq. 8 fixes v+/v-"),
        Bound(
            "apex_error_max", 1e-6,
            "the first apex is e^2 h, and the stand-off lifts the floor by 2e-8 m; the engine's own snapshots have the impact. "
            "A ball that never came down has no apex, which counts as broken",
        ),
    ),
    regions=(
        Region(
            tuple(drop.ball for drop in DROPS),
            (-INFINITE, -INFINITE, -0.5 * SLAB[2]),
            (INFINITE, INFINITE, INFINITE),
            "no ball falls through its slab",
        ),
    ),
    metrics=("restitution_error_max", "apex_error_max"),
    expects={"drops": DROPS},
    everyday=True,
)
