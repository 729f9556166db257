"""A hand sweeps thirty things off a table: boxes, balls, prisms and lying capsules, which it pushes into one another."""

import math
from collections.abc import Iterator

import numpy as np

from avatarsim.scene.body import Body
from avatarsim.scene.checks import Vector
from avatarsim.scene.shape import Box, Capsule, Piece, Sphere
from scenarios.building.cases import LAID, Solid, driven, fixture, loose, one_law, slab, turned_by
from scenarios.building.promises import CROWD, KEEPS_MOVING
from scenarios.building.scenes import above, led_hands
from scenarios.building.things import prism
from scenarios.scenario import Bound

SIDE, FIELD = 6, 0.6
"""Things in a row, and the width of the field that they stand on [m]."""
TABLE: Vector = (1.0, 0.8, 0.04)
"""Edges of the table, its top at z = 0 [m]."""
FALL = 0.4
"""Depth of the floor below [m]."""
HAND = (0.03, 0.6, 0.1)
"""Edges of the hand [m]."""
BEGIN, END, SWEEPS = -0.36, 0.56, (0.1, 2.1)
"""From where to where the hand goes along x [m], and when [s]."""
NAMES = tuple(f"thing_{k}" for k in range(30))
KINDS: tuple[tuple[Solid, float], ...] = (
    (Box((0.05, 0.05, 0.08)), 0.04), (Sphere(0.03), 0.03), (prism(12, 0.03, 0.07), 0.035),
    (Piece(Capsule(0.02, 0.05), orientation=turned_by((1.0, 0.0, 0.0), 0.5 * math.pi)), 0.02),
)
"""Shapes of the things in turn, and how high the middle of each stands [m]."""


def places(time: float) -> tuple[Vector]:
    """The hand, which goes across the table and over its edge at 0.46 m/s, a little to and fro on its way."""
    share = min(max((time - SWEEPS[0]) / (SWEEPS[1] - SWEEPS[0]), 0.0), 1.0)
    return ((BEGIN + (END - BEGIN) * share, 0.03 * math.sin(2.0 * math.pi * share), 0.5 * HAND[2] + 0.005),)


def bodies() -> Iterator[Body]:
    """The things in rows on the table."""
    yield slab(8.0, 8.0, "wood", z=-FALL)
    yield fixture("table", Box(TABLE), "wood", (0.0, 0.0, -0.5 * TABLE[2]))
    for k, name in enumerate(NAMES):
        x, y = (FIELD * ((np.array([k % SIDE, k // SIDE]) + 0.5) / SIDE - 0.5)).tolist()
        shape, high = KINDS[k % len(KINDS)]
        yield loose(name, shape, "thing", 0.2, (x, y, high + LAID))


SCENARIO = led_hands(
    "sweep", "A hand sweeps thirty things off a table.",
    "Overlap, time kept; that all are swept, and that the hand stays with its user.",
    bodies, lambda: (driven("hand", Box(HAND), 0.5, "hand"),), places,
    one_law(0.1, 0.4, ("wood", "thing"), ("thing", "thing"), ("thing", "hand")), frames=300, short=140,
    bounds=(
        *CROWD, KEEPS_MOVING,
        Bound("travel_missing", 0.0, "the hand comes to all of them and pushes each; one may slip past its end after 0.1 m"),
        Bound("tracker_offset_max", 0.03, "thirty things of 0.2 kg hold a hand back by their friction over K, 24 mm"),
    ),
    regions=(above(-FALL, *NAMES), above(0.0, "hand", reason="the hand stays above the table")),
    expects={"travel": dict.fromkeys(NAMES, 0.1)},
)
