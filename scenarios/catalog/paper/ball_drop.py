"""Table 1 in motion: six balls fall one metre, each onto its own slab, one for every pair of materials.

Closed form: the ball meets the slab at sqrt(2 g h), leaves at e times that (eq. 8), first apex e^2 h.
"""

from collections.abc import Iterator

from avatarsim.scene.body import TABLE_1, Body
from avatarsim.scene.shape import Box, Sphere
from scenarios.building.cases import fixture, loose
from scenarios.building.promises import SOUND
from scenarios.building.scenes import above, undriven
from scenarios.scenario import Bound, Drop

PAIRS = (
    ("wood", "wood"), ("wood", "human"), ("wood", "metal"), ("human", "human"), ("human", "metal"), ("metal", "metal"),
)
"""Ball and slab, in the order of Table 1."""
RADIUS, HEIGHT = 0.05, 1.0
"""Radius of a ball, and height of its lowest point above the slab's top at the start [m]."""
DROPS = tuple(Drop(f"ball_{a}_{b}", f"slab_{a}_{b}", TABLE_1.contact(a, b).restitution, HEIGHT) for a, b in PAIRS)


def bodies() -> Iterator[Body]:
    """Yield six slabs in a row along x, their tops at z = 0, and a ball above each."""
    for k, ((ball, slab), drop) in enumerate(zip(PAIRS, DROPS, strict=True)):
        yield fixture(drop.floor, Box((0.5, 0.5, 0.1)), slab, (1.0 * k, 0.0, -0.05))
        yield loose(drop.ball, Sphere(RADIUS), ball, 0.2, (1.0 * k, 0.0, RADIUS + HEIGHT))


SCENARIO = undriven(
    "ball_drop", "Six balls fall one metre onto slabs, one for each pair of materials of Table 1.",
    "Restitution at the first impact and the height of the first apex, pair by pair.", bodies, frames=180,
    bounds=(
        *SOUND, Bound("restitution_error_max", 1e-6, "eq. 8 fixes v+/v-"),
        Bound("apex_error_max", 1e-6, "the first apex is e^2 h; a ball that never came down has none, which counts as broken"),
    ),
    regions=(above(-0.05, *(drop.ball for drop in DROPS), reason="no ball falls through its slab"),),
    metrics=("restitution_error_max", "apex_error_max"), expects={"drops": DROPS}, everyday=True,
)
