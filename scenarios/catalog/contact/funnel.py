"""A block of 125 balls falls into a funnel of four plates and runs out through its hole into a bin."""

import math
from collections.abc import Iterator

import numpy as np

from avatarsim.scene.body import Body
from avatarsim.scene.checks import Vector
from avatarsim.scene.shape import Box, Sphere
from scenarios.building.cases import fixture, loose, one_law, turned_by
from scenarios.building.promises import CROWD, GAINS_NOTHING
from scenarios.building.scenes import undriven
from scenarios.scenario import Bound, Region

SIDE, RADIUS, MASS, PITCH, LOW = 5, 0.02, 0.03, 0.043, 0.55
"""Balls along an edge of the block; radius [m] and mass [kg] of a ball, distance of neighbours, height of the lowest [m]."""
SLOPE, PLATE, WIDE, THIN = math.radians(50.0), 0.42, 0.9, 0.02
"""Slope of a plate [rad], its length down the slope, width and thickness [m]."""
HOLE, RIM = 0.06, 0.35
"""Half width of the hole, and its height above the floor [m]."""
BIN, BIN_HIGH = 0.42, 0.2
"""Width and height of the bin below [m]."""
SIDES = ((1, 0), (-1, 0), (0, 1), (0, -1))
NAMES = tuple(f"ball_{k}" for k in range(SIDE**3))


def plates() -> Iterator[Body]:
    """Four plates that slope down to the hole. They cross at the corners: what is fixed may."""
    run, rise = math.cos(SLOPE), math.sin(SLOPE)
    out = HOLE + 0.5 * PLATE * run + 0.5 * THIN * rise
    up = RIM + 0.5 * PLATE * rise - 0.5 * THIN * run
    for k, (x, y) in enumerate(SIDES):
        axis: Vector = (0.0, -float(x), 0.0) if x else (float(y), 0.0, 0.0)
        size = (PLATE, WIDE, THIN) if x else (WIDE, PLATE, THIN)
        yield fixture(f"plate_{k}", Box(size), "wall", (x * out, y * out, up), turned_by(axis, SLOPE))


def bodies() -> Iterator[Body]:
    """Floor, funnel, bin, and the block of balls above."""
    random = np.random.default_rng(5)
    yield fixture("floor", Box((2.0, 2.0, 0.1)), "wall", (0.0, 0.0, -0.05))
    yield from plates()
    for k, (x, y) in enumerate(SIDES):
        size = (0.02, BIN, BIN_HIGH) if x else (BIN - 0.04, 0.02, BIN_HIGH)
        yield fixture(f"bin_{k}", Box(size), "wall", (0.5 * BIN * x, 0.5 * BIN * y, 0.5 * BIN_HIGH))
    for k, name in enumerate(NAMES):
        j, i, layer = k % SIDE, k // SIDE % SIDE, k // SIDE**2
        x, y = (PITCH * (np.array([i, j]) - 0.5 * (SIDE - 1)) + random.uniform(-1e-3, 1e-3, size=2)).tolist()
        yield loose(name, Sphere(RADIUS), "ball", MASS, (x, y, LOW + PITCH * layer))


SCENARIO = undriven(
    "funnel", "A block of 125 balls runs through a funnel.", "Overlap, time kept, energy.", bodies,
    one_law(0.3, 0.2, ("wall", "ball"), ("ball", "ball")), frames=480, short=36,
    bounds=(*CROWD, GAINS_NOTHING, Bound("travel_missing", 0.0, "all come down into the funnel")),
    regions=(Region(NAMES, (-0.7, -0.7, 0.0), (0.7, 0.7, 2.0), "no ball goes through a plate, nor through the floor"),),
    expects={"travel": dict.fromkeys(NAMES, 0.15), "alone": (NAMES,)},
)
