"""A stick pushes a block out of the middle of a tower of seven layers, which stands."""

import math
from collections.abc import Iterator
from dataclasses import replace

from avatarsim.scene.body import Body
from avatarsim.scene.checks import Vector
from avatarsim.scene.shape import Box
from avatarsim.spatial import rotation
from scenarios.building.cases import driven, loose, one_law, slab, turned_by
from scenarios.building.expected import Tower
from scenarios.building.promises import CROWD, KEEPS_MOVING
from scenarios.building.scenes import led_hands
from scenarios.motion.rigid_hands import eased
from scenarios.scenario import INFINITE, Bound, Region

LONG, WIDE, HIGH, MASS = 0.075, 0.025, 0.015, 0.02
"""Edges [m] and mass [kg] of a block."""
LAYERS, PUSHED = 7, 2
"""Layers of three blocks, every other one turned by a quarter, and the one whose middle block is pushed."""
AIR, ASIDE = 2e-4, 3e-4
"""Gaps below each layer and between its blocks at the start [m]."""
BEGIN, WAY, PUSHES, BACK = -0.09, 0.0825, (0.3, 1.5), (1.6, 2.2)
"""Where the stick begins, how far its user goes [m]: 60 mm with the block before it; when it pushes and draws back [s]."""


def places(time: float) -> tuple[Vector]:
    """The stick, in line with the block."""
    x = BEGIN + WAY * (eased(time, *PUSHES) - eased(time, *BACK))
    return ((x, 0.0, (PUSHED + 0.5) * HIGH),)


def aside(layer: int, place: int) -> tuple[float, float]:
    """Where a block lies in its layer [m], of whose three places 1 is the middle."""
    away = (place - 1) * (WIDE + ASIDE)
    return (away, 0.0) if layer % 2 else (0.0, away)


def bodies() -> Iterator[Body]:
    """The tower on a floor."""
    yield slab(4.0, 4.0)
    for layer in range(LAYERS):
        turn = turned_by((0.0, 0.0, 1.0), 0.5 * math.pi) if layer % 2 else rotation.IDENTITY
        for place in range(3):
            at = (*aside(layer, place), 0.5 * HIGH + AIR + layer * (HIGH + AIR))
            yield loose(f"block_{layer}_{place}", Box((LONG, WIDE, HIGH)), "block", MASS, at, turn)


def top(place: int) -> Tower:
    """A block of the topmost layer stands where it settles."""
    return Tower(f"block_{LAYERS - 1}_{place}", 1.0, (*aside(LAYERS - 1, place), (LAYERS - 0.5) * HIGH), since=1.0)


SCENARIO = led_hands(
    "jenga", "A stick pushes a block out of a tower.", "That the block comes out and the tower stands; overlap.",
    bodies, lambda: (driven("stick", Box((0.06, 0.012, 0.008)), 0.3, "stick"),), places,
    one_law(0.0, 0.3, ("floor", "block"), ("block", "block"), ("block", "stick")), frames=240, short=96,
    bounds=(
        *CROWD, replace(KEEPS_MOVING, limit=5.0),
        Bound("travel_missing", 0.0, "the block is pushed out, less a spring's lag against friction"),
        Bound("towers_fallen", 0.0, "the topmost blocks stay where they settled, to a millimetre"),
    ),
    regions=(
        Region(("block_*",), (-INFINITE, -INFINITE, 0.0), (INFINITE, INFINITE, (LAYERS + 1) * HIGH), "no block is thrown up"),
        Region(("stick",), (-0.2, -0.05, 0.0), (0.2, 0.05, LAYERS * HIGH), "the stick stays with its user"),
    ),
    expects={"travel": {f"block_{PUSHED}_1": 0.058}, "towers": tuple(top(place) for place in range(3))},
)
