"""Coins fall into a tray, balls run through a funnel, and hulls, capsules and boxes are poured into a box.

The mean height of 50 bodies at rest in the box is that of an engine with fixed steps of 960 Hz, whose bodies overlap by 2 mm.
"""

import math
from collections.abc import Callable, Iterator

import numpy as np

from avatarsim.scene.body import Body
from avatarsim.scene.checks import Vector
from avatarsim.scene.shape import Box, Sphere
from scenarios.building.cases import fixture, loose, one_law, turned_by
from scenarios.building.expected import Pile
from scenarios.building.promises import CROWD, GAINS_NOTHING
from scenarios.building.scenes import undriven
from scenarios.building.things import COIN, COIN_MASS, drawn_turn, mixed, open_box
from scenarios.scenario import Bound, Region, Scenario

TRAY, HIGH, LOW, PITCH, ASIDE = 0.12, 1.0, 0.03, 0.028, 0.035
"""Width and height of the tray, height of the first coin, distance of one from the next, largest way aside [m]."""
COINS = {f"coin_{k}": LOW + k * PITCH for k in range(30)}
"""First heights of the coins [m]."""

SIDE, RADIUS, SPACED = 5, 0.02, 0.043
"""Balls along an edge of their block, their radius, and distance of neighbours [m]."""
SLOPE, PLATE, WIDE, THIN = math.radians(50.0), 0.42, 0.9, 0.02
"""Slope of a plate of the funnel [rad], its length down the slope, width and thickness [m]."""
HOLE, RIM, BIN, BIN_HIGH = 0.06, 0.35, 0.42, 0.2
"""Half width of the hole and its height above the floor, width and height of the bin below [m]."""
SIDES = ((1, 0), (-1, 0), (0, 1), (0, -1))
BALLS = tuple(f"ball_{k}" for k in range(SIDE**3))

WIDTH, HEIGHT = 0.5, 1.6
"""Width and height of the box [m]."""
FIRST, LAYER, ABREAST, CELL = 0.1, 0.12, 3, 0.127
"""Height of the lowest layer and distance of layers [m]; bodies along a side of a layer, and their distance [m]."""


def coins() -> Iterator[Body]:
    """Yield the tray, and a column of coins above it."""
    random = np.random.default_rng(6)
    yield from open_box(TRAY, HIGH, 0.02, "tray")
    for name, z in COINS.items():
        x, y = random.uniform(-ASIDE, ASIDE, size=2).tolist()
        yield loose(name, COIN, "coin", COIN_MASS, (x, y, z), drawn_turn(random))


def funnel() -> Iterator[Body]:
    """Yield floor, four plates that slope down to the hole and cross at the corners, a bin, and the block of balls above."""
    yield fixture("floor", Box((2.0, 2.0, 0.1)), "wall", (0.0, 0.0, -0.05))
    run, rise = math.cos(SLOPE), math.sin(SLOPE)
    out = HOLE + 0.5 * PLATE * run + 0.5 * THIN * rise
    up = RIM + 0.5 * PLATE * rise - 0.5 * THIN * run
    for k, (x, y) in enumerate(SIDES):
        axis: Vector = (0.0, -float(x), 0.0) if x else (float(y), 0.0, 0.0)
        size = (PLATE, WIDE, THIN) if x else (WIDE, PLATE, THIN)
        yield fixture(f"plate_{k}", Box(size), "wall", (x * out, y * out, up), turned_by(axis, SLOPE))
    for k, (x, y) in enumerate(SIDES):
        size = (0.02, BIN, BIN_HIGH) if x else (BIN - 0.04, 0.02, BIN_HIGH)
        yield fixture(f"bin_{k}", Box(size), "wall", (0.5 * BIN * x, 0.5 * BIN * y, 0.5 * BIN_HIGH))
    random = np.random.default_rng(5)
    for k, name in enumerate(BALLS):
        j, i, layer = k % SIDE, k // SIDE % SIDE, k // SIDE**2
        x, y = (SPACED * (np.array([i, j]) - 0.5 * (SIDE - 1)) + random.uniform(-1e-3, 1e-3, size=2)).tolist()
        yield loose(name, Sphere(RADIUS), "ball", 0.03, (x, y, 0.55 + SPACED * layer))


def heap(names: tuple[str, ...]) -> Iterator[Body]:
    """Yield the open box, and the bodies in layers above its floor."""
    random = np.random.default_rng(3)
    yield from open_box(WIDTH, HEIGHT, 0.04, "wall")
    cells = np.array([(i, j) for i in range(ABREAST) for j in range(ABREAST)]) - 0.5 * (ABREAST - 1)
    for k, (name, piece) in enumerate(zip(names, mixed(random, len(names)), strict=True)):
        layer, place = divmod(k, len(cells))
        if place == 0:
            random.shuffle(cells)
        x, y = (CELL * cells[place] + random.uniform(-0.005, 0.005, size=2)).tolist()
        yield loose(name, piece, "thing", 0.2, (x, y, FIRST + layer * LAYER), drawn_turn(random))


def poured(
    name: str, title: str, judged: str, bodies: Callable[[], Iterator[Body]], materials: tuple[str, str],
    law: tuple[float, float], frames: int, short: int, falls: dict[str, float], half: float, high: float,
    family: str = "", settled: tuple[Bound, ...] = (), piles: tuple[Pile, ...] = (),
) -> Scenario:
    """Return a scene of bodies that fall into a container, whose materials are that of the container and theirs."""
    names, (walls, own) = tuple(falls), materials
    return undriven(
        name, title, judged, bodies, one_law(*law, (walls, own), (own, own)), frames=frames, short=short, family=family,
        bounds=(*CROWD, GAINS_NOTHING, Bound("travel_missing", 0.0, "all come down"), *settled),
        regions=(Region(names, (-half, -half, 0.0), (half, half, high), "nothing goes through a wall, nor through the floor"),),
        expects={"travel": falls, "alone": (names,), **({"piles": piles} if piles else {})},
    )


def of(count: int, frames: int, short: int, settled: tuple[Bound, ...] = (), heights: tuple[float, ...] = ()) -> Scenario:
    """Return the heap of so many bodies."""
    names = tuple(f"thing_{k}" for k in range(count))
    return poured(
        f"heap_{count}", f"{count} hulls, capsules and boxes are poured into a box.",
        "Overlap, time kept, energy; how high they lie.", lambda: heap(names), ("wall", "thing"), (0.0, 0.4), frames, short,
        dict.fromkeys(names, 0.03), 0.5 * WIDTH, HEIGHT, "heap", settled,
        tuple(Pile(names, "floor", height, 1.7) for height in heights),
    )


SCENARIOS = (
    poured(
        "coins", "Thirty coins fall into a tray.", "Overlap, time kept, energy.", coins, ("tray", "coin"), (0.2, 0.3), 480, 75,
        {name: 0.01 + 0.3 * k * PITCH for k, name in enumerate(COINS)}, 0.5 * TRAY, HIGH,
    ),
    poured(
        "funnel", "A block of 125 balls runs through a funnel.", "Overlap, time kept, energy.", funnel, ("wall", "ball"),
        (0.3, 0.2), 480, 36, dict.fromkeys(BALLS, 0.15), 0.7, 2.0,
    ),
    of(50, 480, 108, (Bound("pile_height_error_max", 15.0, "a heap that hangs in the air is three times as high"),), (0.0258,)),
    of(100, 300, 45),
)
