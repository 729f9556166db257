"""Thirty coins fall into a small tray, on their edges and on one another, and come to rest."""

import numpy as np

from avatarsim.scene.body import Body, ContactLaw, simulated, solid
from avatarsim.scene.scene import Scene
from scenarios.building.cases import pair_table
from scenarios.building.promises import CROWD, GAINS_NOTHING
from scenarios.building.things import drawn_turn, open_box, prism
from scenarios.motion.untracked import untracked
from scenarios.scenario import Bound, Region, Scenario

RADIUS, THICK, MASS = 0.012, 0.002, 0.007
"""Of a coin, a prism of 20 sides [m, kg]."""
WIDTH, HEIGHT, WALL = 0.12, 1.0, 0.02
"""The tray [m]; its walls reach above the highest coin."""
LOW, PITCH, ASIDE, SEED = 0.03, 0.028, 0.035, 6
"""Height of the first coin, distance of one from the next, and how far aside they begin at most [m]."""
NAMES = tuple(f"coin_{k}" for k in range(30))


def build() -> Scene:
    """The tray, and a column of coins above it."""
    random, coin = np.random.default_rng(SEED), (prism(20, RADIUS, THICK),)
    bodies: list[Body] = list(open_box(WIDTH, HEIGHT, WALL, "tray"))
    for k, name in enumerate(NAMES):
        x, y = random.uniform(-ASIDE, ASIDE, size=2).tolist()
        bodies.append(simulated(name, coin, "coin", solid(coin, MASS), (x, y, LOW + k * PITCH), drawn_turn(random)))
    law = ContactLaw(0.2, 0.3)
    materials = pair_table(("tray", "coin"), {("tray", "coin"): law, ("coin", "coin"): law})
    return Scene("coins", tuple(bodies), materials=materials)


SCENARIO = Scenario(
    name="coins",
    title="Thirty coins fall into a tray.",
    judged="Overlap, time kept, energy.",
    build=build,
    motion=untracked(),
    frames=480,
    short=75,
    bounds=(*CROWD, GAINS_NOTHING, Bound("travel_missing", 0.0, "all come down")),
    regions=(
        Region(NAMES, (-0.5 * WIDTH, -0.5 * WIDTH, 0.0), (0.5 * WIDTH, 0.5 * WIDTH, HEIGHT), "the tray holds its coins"),
    ),
    expects={"travel": {name: 0.01 + 0.3 * k * PITCH for k, name in enumerate(NAMES)}, "alone": (NAMES,)},
)
