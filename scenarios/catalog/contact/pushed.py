"""Pushes: dominoes topple one another, a stick pushes a block out of a tower, and a hand sweeps thirty things off a table.

The speed of the wave of dominoes was found by an exact solution of every impact and contact, at a thousand times the cost of a
frame.
"""

import math
from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from avatarsim.scene.body import Body
from avatarsim.scene.checks import Vector
from avatarsim.scene.shape import Box, Capsule, Piece, Sphere
from avatarsim.spatial import rotation
from scenarios.building.cases import LAID, Solid, driven, fixture, loose, one_law, slab, turned_by
from scenarios.building.expected import Tower, Wave
from scenarios.building.promises import CROWD, GAINS_NOTHING, KEEPS_MOVING
from scenarios.building.scenes import above, led_hands, undriven
from scenarios.building.things import prism
from scenarios.motion.rigid_hands import eased
from scenarios.scenario import INFINITE, Bound, Region

THICK, TALL, PITCH = 0.0075, 0.048, 0.02
"""Thickness and height of a domino, and distance of neighbours in the row [m]."""
LEAN = 0.2
"""Lean of the first [rad]: beyond its edge, so that it falls by itself."""
DOMINOES = tuple(f"domino_{k}" for k in range(40))

LONG, WIDE, HIGH = 0.075, 0.025, 0.015
"""Edges of a block of the tower [m]."""
LAYERS, PUSHED = 7, 2
"""Layers of three blocks, every other one turned by a quarter, and the one whose middle block is pushed."""
AIR, APART = 2e-4, 3e-4
"""Gaps below each layer and between its blocks at the start [m]."""
BEGIN, WAY, PUSHES, BACK = -0.09, 0.0825, (0.3, 1.5), (1.6, 2.2)
"""Where the stick begins, how far its user goes [m]: 60 mm with the block before it; when it pushes and draws back [s]."""

SIDE, FIELD, FALL = 6, 0.6, 0.4
"""Things in a row, width of their field, and depth of the floor below the table [m]."""
HAND, FIRST, LAST, SWEEPS = (0.03, 0.6, 0.1), -0.36, 0.56, (0.1, 2.1)
"""Edges of the hand, from where to where it goes along x [m], and when [s]."""
THINGS = tuple(f"thing_{k}" for k in range(30))
KINDS: tuple[tuple[Solid, float], ...] = (
    (Box((0.05, 0.05, 0.08)), 0.04), (Sphere(0.03), 0.03), (prism(12, 0.03, 0.07), 0.035),
    (Piece(Capsule(0.02, 0.05), orientation=turned_by((1.0, 0.0, 0.0), 0.5 * math.pi)), 0.02),
)
"""Shapes of the things in turn, and the height of the middle of each [m]."""


def dominoes() -> Iterator[Body]:
    """Yield a row along x on a wide floor, the first domino on its edge."""
    yield slab(8.0, 8.0)
    across, up = math.cos(LEAN) * 0.5 * THICK - math.sin(LEAN) * 0.5 * TALL, math.sin(LEAN) * 0.5 * THICK
    domino, first = Box((THICK, 0.024, TALL)), (0.5 * THICK - across, 0.0, up + math.cos(LEAN) * 0.5 * TALL + LAID)
    yield loose(DOMINOES[0], domino, "domino", 0.012, first, turned_by((0.0, 1.0, 0.0), LEAN))
    for k, name in enumerate(DOMINOES[1:], 1):
        yield loose(name, domino, "domino", 0.012, (PITCH * k, 0.0, 0.5 * TALL + LAID))


def at_block(time: float) -> tuple[Vector]:
    """Return the stick, in line with the block."""
    return ((BEGIN + WAY * (eased(time, *PUSHES) - eased(time, *BACK)), 0.0, (PUSHED + 0.5) * HIGH),)


def aside(layer: int, place: int) -> tuple[float, float]:
    """Return where a block lies in its layer [m], of whose three places 1 is the middle."""
    away = (place - 1) * (WIDE + APART)
    return (away, 0.0) if layer % 2 else (0.0, away)


def tower() -> Iterator[Body]:
    """Yield the tower on a floor."""
    yield slab(4.0, 4.0)
    for layer in range(LAYERS):
        turn = turned_by((0.0, 0.0, 1.0), 0.5 * math.pi) if layer % 2 else rotation.IDENTITY
        for place in range(3):
            at = (*aside(layer, place), 0.5 * HIGH + AIR + layer * (HIGH + AIR))
            yield loose(f"block_{layer}_{place}", Box((LONG, WIDE, HIGH)), "block", 0.02, at, turn)


def top(place: int) -> Tower:
    """Return the entry of a block of the topmost layer, which stays where it settles."""
    return Tower(f"block_{LAYERS - 1}_{place}", 1.0, (*aside(LAYERS - 1, place), (LAYERS - 0.5) * HIGH), since=1.0)


def sweeping(time: float) -> tuple[Vector]:
    """Return the hand, which goes across the table and over its edge at 0.46 m/s, a little to and fro on its way."""
    share = min(max((time - SWEEPS[0]) / (SWEEPS[1] - SWEEPS[0]), 0.0), 1.0)
    return ((FIRST + (LAST - FIRST) * share, 0.03 * math.sin(2.0 * math.pi * share), 0.5 * HAND[2] + 0.005),)


def on_table() -> Iterator[Body]:
    """Yield the things in rows on a table, its top at z = 0."""
    yield slab(8.0, 8.0, "wood", z=-FALL)
    yield fixture("table", Box((1.0, 0.8, 0.04)), "wood", (0.0, 0.0, -0.5 * 0.04))
    for k, name in enumerate(THINGS):
        x, y = (FIELD * ((np.array([k % SIDE, k // SIDE]) + 0.5) / SIDE - 0.5)).tolist()
        shape, high = KINDS[k % len(KINDS)]
        yield loose(name, shape, "thing", 0.2, (x, y, high + LAID))


SCENARIOS = (
    undriven(
        "dominoes", "Forty dominoes topple one another.",
        "How fast the wave runs and how many it reaches; overlap, time kept, energy.", dominoes,
        one_law(0.2, 0.3, ("floor", "domino"), ("domino", "domino")), frames=300, short=105,
        bounds=(
            *CROWD, GAINS_NOTHING, Bound("wave_speed_error", 3.3, "0.91 m/s, give or take 0.03"),
            Bound("wave_missing", 0.0, "the wave runs to the end"),
        ),
        regions=(
            Region(("domino_*",), (-INFINITE, -INFINITE, 0.0), (INFINITE, INFINITE, TALL), "no domino falls through the floor"),
        ),
        expects={"waves": (Wave(DOMINOES, PITCH, 0.909, 10, 35),), "alone": (DOMINOES,)},
    ),
    led_hands(
        "jenga", "A stick pushes a block out of a tower.", "That the block comes out and the tower stands; overlap.",
        tower, lambda: (driven("stick", Box((0.06, 0.012, 0.008)), 0.3, "stick"),), at_block,
        one_law(0.0, 0.3, ("floor", "block"), ("block", "block"), ("block", "stick")), frames=240, short=96,
        bounds=(
            *CROWD, replace(KEEPS_MOVING, limit=5.0),
            Bound("travel_missing", 0.0, "the block is pushed out, less a spring's lag against friction"),
            Bound("towers_fallen", 0.0, "the topmost blocks stay where they settled, to a millimetre"),
        ),
        regions=(
            Region(("block_*",), (-INFINITE, -INFINITE, 0.0), (INFINITE, INFINITE, (LAYERS + 1) * HIGH), "no block flies up"),
            Region(("stick",), (-0.2, -0.05, 0.0), (0.2, 0.05, LAYERS * HIGH), "the stick stays with its user"),
        ),
        expects={"travel": {f"block_{PUSHED}_1": 0.058}, "towers": tuple(top(place) for place in range(3))},
    ),
    led_hands(
        "sweep", "A hand sweeps thirty things off a table.",
        "Overlap, time kept; that all are swept, and that the hand stays with its user.",
        on_table, lambda: (driven("hand", Box(HAND), 0.5, "hand"),), sweeping,
        one_law(0.1, 0.4, ("wood", "thing"), ("thing", "thing"), ("thing", "hand")), frames=300, short=140,
        bounds=(
            *CROWD, KEEPS_MOVING,
            Bound("travel_missing", 0.0, "the hand comes to all of them and pushes each; one may slip past after 0.1 m"),
            Bound("tracker_offset_max", 0.03, "thirty things of 0.2 kg hold a hand back by their friction over K, 24 mm"),
        ),
        regions=(above(-FALL, *THINGS), above(0.0, "hand", reason="the hand stays above the table")),
        expects={"travel": dict.fromkeys(THINGS, 0.1)},
    ),
)
