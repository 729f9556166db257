"""A stick pushes a block out of the middle of a tower of seven layers, which stands."""

import math
from dataclasses import replace

from avatarsim.scene.avatar import rigid_avatar
from avatarsim.scene.body import Body, ContactLaw, fixed, simulated, solid
from avatarsim.scene.checks import Vector
from avatarsim.scene.scene import Scene
from avatarsim.scene.shape import Box, Piece
from avatarsim.spatial import rotation
from scenarios.building.cases import pair_table, turned_by
from scenarios.building.expected import Tower
from scenarios.building.promises import CROWD, KEEPS_MOVING
from scenarios.motion.rigid_hands import eased, hands_at, led
from scenarios.scenario import INFINITE, Bound, Region, Scenario

LONG, WIDE, HIGH, MASS = 0.075, 0.025, 0.015, 0.02
"""Edges [m] and mass [kg] of a block."""
LAYERS, PUSHED = 7, 2
"""Layers of three blocks, every other one turned by a quarter, and the one whose middle block is pushed."""
AIR, ASIDE = 2e-4, 3e-4
"""Gaps below each layer and between its blocks at the start [m]."""
STICK, STICK_MASS = (0.06, 0.012, 0.008), 0.3
"""Edges [m] and mass [kg] of the stick."""
BEGIN, WAY, PUSHES, BACK = -0.09, 0.0825, (0.3, 1.5), (1.6, 2.2)
"""Where the stick begins, how far its user goes [m]: 60 mm with the block before it; when it pushes and draws back [s]."""
OUT = 0.058
"""Least way of the block [m]: what the user pushes, less the sag of a spring against friction."""
STANDS = 1.0
"""From then on [s] the tower stands where it settled."""


def places(time: float) -> tuple[Vector]:
    """The stick, in line with the block."""
    x = BEGIN + WAY * (eased(time, *PUSHES) - eased(time, *BACK))
    return ((x, 0.0, (PUSHED + 0.5) * HIGH),)


def name_of(layer: int, place: int) -> str:
    """Of a block: its layer, and its place in it, of which 1 is the middle."""
    return f"block_{layer}_{place}"


def build() -> Scene:
    """The tower on a floor, and the stick before it."""
    pieces, stick = (Piece(Box((LONG, WIDE, HIGH))),), (Piece(Box(STICK)),)
    bodies: list[Body] = [fixed("floor", (Piece(Box((4.0, 4.0, 0.2))),), "floor", (0.0, 0.0, -0.1))]
    for layer in range(LAYERS):
        turn = turned_by((0.0, 0.0, 1.0), 0.5 * math.pi) if layer % 2 else rotation.IDENTITY
        for place in range(3):
            aside = (place - 1) * (WIDE + ASIDE)
            x, y = (aside, 0.0) if layer % 2 else (0.0, aside)
            at = (x, y, 0.5 * HIGH + AIR + layer * (HIGH + AIR))
            bodies.append(simulated(name_of(layer, place), pieces, "block", solid(pieces, MASS), at, turn))
    law = ContactLaw(0.0, 0.3)
    pairs = (("floor", "block"), ("block", "block"), ("block", "stick"))
    materials = pair_table(("floor", "block", "stick"), dict.fromkeys(pairs, law))
    hand = rigid_avatar("stick", stick, solid(stick, STICK_MASS), "stick")
    return Scene("jenga", tuple(bodies), (hand,), materials, start=hands_at(places(0.0)))


def top(place: int) -> Tower:
    """A block of the topmost layer stands where it settles."""
    aside = (place - 1) * (WIDE + ASIDE)
    x, y = (aside, 0.0) if LAYERS % 2 == 0 else (0.0, aside)
    return Tower(name_of(LAYERS - 1, place), 1.0, (x, y, (LAYERS - 0.5) * HIGH), STANDS)


SCENARIO = Scenario(
    name="jenga",
    title="A stick pushes a block out of a tower.",
    judged="That the block comes out and the tower stands; overlap.",
    build=build,
    motion=led(places),
    frames=240,
    short=96,
    bounds=(
        *CROWD, replace(KEEPS_MOVING, limit=5.0),
        Bound("travel_missing", 0.0, "the block is pushed out, less a spring's lag against friction"),
        Bound("towers_fallen", 0.0, "the topmost blocks stay where they settled, to a millimetre"),
    ),
    regions=(
        Region(("block_*",), (-INFINITE, -INFINITE, 0.0), (INFINITE, INFINITE, (LAYERS + 1) * HIGH), "no block is thrown up"),
        Region(("stick",), (-0.2, -0.05, 0.0), (0.2, 0.05, LAYERS * HIGH), "the stick stays with its user"),
    ),
    expects={"travel": {name_of(PUSHED, 1): OUT}, "towers": tuple(top(place) for place in range(3))},
)
