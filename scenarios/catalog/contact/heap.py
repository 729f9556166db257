"""Hulls, capsules and boxes are poured into an open box and come to rest in a heap.

The mean height of 50 bodies at rest is that of an engine with fixed steps of 960 Hz, whose bodies are 2 mm deep in each other.
"""

from collections.abc import Iterator

import numpy as np

from avatarsim.scene.body import Body
from scenarios.building.cases import loose, one_law
from scenarios.building.expected import Pile
from scenarios.building.promises import CROWD, GAINS_NOTHING
from scenarios.building.scenes import undriven
from scenarios.building.things import drawn_turn, mixed, open_box
from scenarios.scenario import Bound, Region, Scenario

WIDTH, HEIGHT, THICK = 0.5, 1.6, 0.04
"""The open box [m]."""
LOW, LAYER, SIDE, CELL = 0.1, 0.12, 3, 0.127
"""Height of the lowest layer and distance of layers [m]; bodies along a side of a layer, and their distance [m]."""


def names(count: int) -> tuple[str, ...]:
    """Of the bodies of a heap."""
    return tuple(f"thing_{k}" for k in range(count))


def bodies(count: int) -> Iterator[Body]:
    """The open box, and the bodies in layers above its floor."""
    random = np.random.default_rng(3)
    yield from open_box(WIDTH, HEIGHT, THICK, "wall")
    cells = np.array([(i, j) for i in range(SIDE) for j in range(SIDE)]) - 0.5 * (SIDE - 1)
    for k, (name, piece) in enumerate(zip(names(count), mixed(random, count), strict=True)):
        layer, place = divmod(k, len(cells))
        if place == 0:
            random.shuffle(cells)
        x, y = (CELL * cells[place] + random.uniform(-0.005, 0.005, size=2)).tolist()
        yield loose(name, piece, "thing", 0.2, (x, y, LOW + layer * LAYER), drawn_turn(random))


def of(count: int, frames: int, short: int, settled: tuple[Bound, ...], expects: dict[str, object]) -> Scenario:
    """The scene with so many bodies."""
    things, half = names(count), 0.5 * WIDTH
    return undriven(
        f"heap_{count}", f"{count} hulls, capsules and boxes are poured into a box.",
        "Overlap, time kept, energy; how high they lie.", lambda: bodies(count),
        one_law(0.0, 0.4, ("wall", "thing"), ("thing", "thing")), frames=frames, short=short,
        bounds=(*CROWD, GAINS_NOTHING, Bound("travel_missing", 0.0, "all come down"), *settled),
        regions=(Region(things, (-half, -half, 0.0), (half, half, HEIGHT), "walls and floor hold what is poured"),),
        expects={"travel": dict.fromkeys(things, 0.03), "alone": (things,), **expects},
    )


SCENARIOS = (
    of(50, 480, 108, (Bound("pile_height_error_max", 15.0, "a heap that hangs in the air is three times as high"),),
       {"piles": (Pile(names(50), "floor", 0.0258, 1.7),)}),
    of(100, 300, 45, (), {}),
)
