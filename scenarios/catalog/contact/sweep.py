"""A hand sweeps thirty things off a table: boxes, balls, prisms and lying capsules, which it pushes into one another."""

import math

import numpy as np

from avatarsim.scene.avatar import rigid_avatar
from avatarsim.scene.body import Body, ContactLaw, fixed, simulated, solid
from avatarsim.scene.checks import Vector
from avatarsim.scene.scene import Scene
from avatarsim.scene.shape import Box, Capsule, Piece, Sphere
from scenarios.building.cases import LAID, pair_table, turned_by
from scenarios.building.promises import CROWD, KEEPS_MOVING
from scenarios.building.things import prism
from scenarios.motion.rigid_hands import hands_at, led
from scenarios.scenario import INFINITE, Bound, Region, Scenario

COUNT, SIDE, FIELD = 30, 6, 0.6
"""Things, how many stand in a row, and the width of the field that they stand on [m]."""
TABLE: Vector = (1.0, 0.8, 0.04)
"""Edges of the table, its top at z = 0 [m]."""
FALL = 0.4
"""Depth of the floor below [m]."""
HAND, HAND_MASS = (0.03, 0.6, 0.1), 0.5
"""Edges [m] and mass [kg] of the hand."""
BEGIN, END, SWEEPS = -0.36, 0.56, (0.1, 2.1)
"""From where to where the hand goes along x [m], and when [s]."""
NAMES = tuple(f"thing_{k}" for k in range(COUNT))
KINDS: tuple[tuple[Piece, float], ...] = (
    (Piece(Box((0.05, 0.05, 0.08))), 0.04), (Piece(Sphere(0.03)), 0.03), (prism(12, 0.03, 0.07), 0.035),
    (Piece(Capsule(0.02, 0.05), orientation=turned_by((1.0, 0.0, 0.0), 0.5 * math.pi)), 0.02),
)
"""What they are in turn, and how high the middle of each stands [m]."""


def places(time: float) -> tuple[Vector]:
    """The hand, which goes across the table and over its edge at 0.46 m/s, a little to and fro on its way."""
    share = min(max((time - SWEEPS[0]) / (SWEEPS[1] - SWEEPS[0]), 0.0), 1.0)
    return ((BEGIN + (END - BEGIN) * share, 0.03 * math.sin(2.0 * math.pi * share), 0.5 * HAND[2] + 0.005),)


def build() -> Scene:
    """The things in rows on the table, and the hand behind them."""
    bodies: list[Body] = [
        fixed("floor", (Piece(Box((8.0, 8.0, 0.2))),), "wood", (0.0, 0.0, -FALL - 0.1)),
        fixed("table", (Piece(Box(TABLE)),), "wood", (0.0, 0.0, -0.5 * TABLE[2])),
    ]
    for k, name in enumerate(NAMES):
        x, y = (FIELD * ((np.array([k % SIDE, k // SIDE]) + 0.5) / SIDE - 0.5)).tolist()
        piece, high = KINDS[k % len(KINDS)]
        bodies.append(simulated(name, (piece,), "thing", solid((piece,), 0.2), (x, y, high + LAID)))
    palm = (Piece(Box(HAND)),)
    law = ContactLaw(0.1, 0.4)
    pairs = (("wood", "thing"), ("thing", "thing"), ("thing", "hand"))
    materials = pair_table(("wood", "thing", "hand"), dict.fromkeys(pairs, law))
    hand = rigid_avatar("hand", palm, solid(palm, HAND_MASS), "hand")
    return Scene("sweep", tuple(bodies), (hand,), materials, start=hands_at(places(0.0)))


SCENARIO = Scenario(
    name="sweep",
    title="A hand sweeps thirty things off a table.",
    judged="Overlap, time kept; that all are swept, and that the hand stays with its user.",
    build=build,
    motion=led(places),
    frames=300,
    short=140,
    bounds=(
        *CROWD, KEEPS_MOVING,
        Bound("travel_missing", 0.0, "the hand comes to all of them and pushes each; one may slip past its end after 0.1 m"),
        Bound("tracker_offset_max", 0.03, "thirty things of 0.2 kg hold a hand back by their friction over K, 24 mm"),
    ),
    regions=(
        Region(NAMES, (-INFINITE, -INFINITE, -FALL), (INFINITE,) * 3, "nothing falls through the floor"),
        Region(("hand",), (-INFINITE, -INFINITE, 0.0), (INFINITE,) * 3, "the hand stays above the table"),
    ),
    expects={"travel": dict.fromkeys(NAMES, 0.1)},
)
