"""Hulls, capsules and boxes are poured into an open box and come to rest in a heap: 50 of them, and 100.

They begin in layers, drawn by a fixed seed. Where they come to lie is chance; how high they lie on the mean is not: the height
stated for 50 is that of an engine with fixed steps of 960 Hz, whose bodies are 2 mm deep in each other.
"""

import numpy as np

from avatarsim.scene.body import Body, ContactLaw, simulated, solid
from avatarsim.scene.scene import Scene
from scenarios.building.cases import pair_table
from scenarios.building.expected import Pile
from scenarios.building.promises import CROWD, GAINS_NOTHING
from scenarios.building.things import drawn_turn, mixed, open_box
from scenarios.motion.untracked import untracked
from scenarios.scenario import Bound, Region, Scenario

WIDTH, HEIGHT, THICK = 0.5, 1.6, 0.04
"""The open box [m]."""
MASS = 0.2
"""Mass of every body [kg]."""
LOW, LAYER, SIDE, CELL = 0.1, 0.12, 3, 0.127
"""Height of the lowest layer and distance of layers [m]; bodies along a side of a layer, and their distance [m]."""
SEED = 3
SETTLED = 0.0258
"""Mean height [m] of 50 bodies above the floor's top once they rest."""
RESTS = 1.7
"""From then on [s] they do."""


def names(count: int) -> tuple[str, ...]:
    """Of the bodies of a heap."""
    return tuple(f"thing_{k}" for k in range(count))


def build(name: str, count: int) -> Scene:
    """The open box, and the bodies in layers above its floor."""
    random = np.random.default_rng(SEED)
    bodies: list[Body] = list(open_box(WIDTH, HEIGHT, THICK, "wall"))
    cells = np.array([(i, j) for i in range(SIDE) for j in range(SIDE)]) - 0.5 * (SIDE - 1)
    for k, (thing, piece) in enumerate(zip(names(count), mixed(random, count), strict=True)):
        layer, place = divmod(k, len(cells))
        if place == 0:
            random.shuffle(cells)
        x, y = (CELL * cells[place] + random.uniform(-0.005, 0.005, size=2)).tolist()
        at = (x, y, LOW + layer * LAYER)
        bodies.append(simulated(thing, (piece,), "thing", solid((piece,), MASS), at, drawn_turn(random)))
    law = ContactLaw(0.0, 0.4)
    materials = pair_table(("wall", "thing"), {("wall", "thing"): law, ("thing", "thing"): law})
    return Scene(name, tuple(bodies), materials=materials)


def of(count: int, frames: int, short: int, settled: tuple[Bound, ...], expects: dict[str, object]) -> Scenario:
    """The scene with so many bodies."""
    name, things = f"heap_{count}", names(count)
    half = 0.5 * WIDTH
    return Scenario(
        name=name,
        title=f"{count} hulls, capsules and boxes are poured into a box.",
        judged="Overlap, time kept, energy; how high they lie.",
        build=lambda: build(name, count),
        motion=untracked(),
        frames=frames,
        short=short,
        bounds=(*CROWD, GAINS_NOTHING, Bound("travel_missing", 0.0, "all come down"), *settled),
        regions=(Region(things, (-half, -half, 0.0), (half, half, HEIGHT), "walls and floor hold what is poured"),),
        expects={"travel": dict.fromkeys(things, 0.03), "alone": (things,), **expects},
    )


SCENARIOS = (
    of(50, 480, 108, (Bound("pile_height_error_max", 15.0, "a heap that hangs in the air is three times as high"),),
       {"piles": (Pile(names(50), "floor", SETTLED, RESTS),)}),
    of(100, 300, 45, (), {}),
)
