"""Thirty coins fall into a small tray, on their edges and on one another, and come to rest."""

from collections.abc import Iterator

import numpy as np

from avatarsim.scene.body import Body
from scenarios.building.cases import loose, one_law
from scenarios.building.promises import CROWD, GAINS_NOTHING
from scenarios.building.scenes import undriven
from scenarios.building.things import COIN, COIN_MASS, drawn_turn, open_box
from scenarios.scenario import Bound, Region

WIDTH, HEIGHT, WALL = 0.12, 1.0, 0.02
"""The tray [m]; its walls reach above the highest coin."""
LOW, PITCH, ASIDE = 0.03, 0.028, 0.035
"""Height of the first coin, distance of one from the next, and how far aside they begin at most [m]."""
NAMES = tuple(f"coin_{k}" for k in range(30))


def bodies() -> Iterator[Body]:
    """The tray, and a column of coins above it."""
    random = np.random.default_rng(6)
    yield from open_box(WIDTH, HEIGHT, WALL, "tray")
    for k, name in enumerate(NAMES):
        x, y = random.uniform(-ASIDE, ASIDE, size=2).tolist()
        yield loose(name, COIN, "coin", COIN_MASS, (x, y, LOW + k * PITCH), drawn_turn(random))


SCENARIO = undriven(
    "coins", "Thirty coins fall into a tray.", "Overlap, time kept, energy.", bodies,
    one_law(0.2, 0.3, ("tray", "coin"), ("coin", "coin")), frames=480, short=75,
    bounds=(*CROWD, GAINS_NOTHING, Bound("travel_missing", 0.0, "all come down")),
    regions=(Region(NAMES, (-0.5 * WIDTH, -0.5 * WIDTH, 0.0), (0.5 * WIDTH, 0.5 * WIDTH, HEIGHT), "the tray holds its coins"),),
    expects={"travel": {name: 0.01 + 0.3 * k * PITCH for k, name in enumerate(NAMES)}, "alone": (NAMES,)},
)
