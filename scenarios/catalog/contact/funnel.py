"""A block of 125 balls falls into a funnel of four plates and runs out through its hole into a bin."""

import math

import numpy as np

from avatarsim.scene.body import Body, ContactLaw, fixed, simulated, solid
from avatarsim.scene.checks import Vector
from avatarsim.scene.scene import Scene
from avatarsim.scene.shape import Box, Piece, Sphere
from scenarios.building.cases import pair_table, turned_by
from scenarios.building.promises import CROWD, GAINS_NOTHING
from scenarios.motion.untracked import untracked
from scenarios.scenario import Bound, Region, Scenario

SIDE, RADIUS, MASS, PITCH, LOW = 5, 0.02, 0.03, 0.043, 0.55
"""Balls along an edge of the block; radius [m] and mass [kg] of a ball, distance of neighbours, height of the lowest [m]."""
SLOPE, PLATE, WIDE, THIN = math.radians(50.0), 0.42, 0.9, 0.02
"""Slope of a plate [rad], its length down the slope, width and thickness [m]."""
HOLE, RIM = 0.06, 0.35
"""Half width of the hole, and its height above the floor [m]."""
BIN, BIN_HIGH = 0.42, 0.2
"""Width and height of the bin below [m]."""
SEED = 5
NAMES = tuple(f"ball_{k}" for k in range(SIDE**3))


def plates() -> list[Body]:
    """Four plates that slope down to the hole, from +x, -x, +y and -y. They cross at the corners: what is fixed may."""
    bodies: list[Body] = []
    run, rise = math.cos(SLOPE), math.sin(SLOPE)
    out = HOLE + 0.5 * PLATE * run + 0.5 * THIN * rise
    up = RIM + 0.5 * PLATE * rise - 0.5 * THIN * run
    for k, (x, y) in enumerate(((1, 0), (-1, 0), (0, 1), (0, -1))):
        axis: Vector = (0.0, -float(x), 0.0) if x else (float(y), 0.0, 0.0)
        size = (PLATE, WIDE, THIN) if x else (WIDE, PLATE, THIN)
        bodies.append(fixed(f"plate_{k}", (Piece(Box(size)),), "wall", (x * out, y * out, up), turned_by(axis, SLOPE)))
    return bodies


def build() -> Scene:
    """Floor, bin, funnel, and the block of balls above it."""
    random, pieces = np.random.default_rng(SEED), (Piece(Sphere(RADIUS)),)
    bodies: list[Body] = [fixed("floor", (Piece(Box((2.0, 2.0, 0.1))),), "wall", (0.0, 0.0, -0.05)), *plates()]
    for k, (x, y) in enumerate(((1, 0), (-1, 0), (0, 1), (0, -1))):
        size = (0.02, BIN, BIN_HIGH) if x else (BIN - 0.04, 0.02, BIN_HIGH)
        bodies.append(fixed(f"bin_{k}", (Piece(Box(size)),), "wall", (0.5 * BIN * x, 0.5 * BIN * y, 0.5 * BIN_HIGH)))
    for k, name in enumerate(NAMES):
        j, i, layer = k % SIDE, k // SIDE % SIDE, k // SIDE**2
        x, y = (PITCH * (np.array([i, j]) - 0.5 * (SIDE - 1)) + random.uniform(-1e-3, 1e-3, size=2)).tolist()
        bodies.append(simulated(name, pieces, "ball", solid(pieces, MASS), (x, y, LOW + PITCH * layer)))
    law = ContactLaw(0.3, 0.2)
    materials = pair_table(("wall", "ball"), {("wall", "ball"): law, ("ball", "ball"): law})
    return Scene("funnel", tuple(bodies), materials=materials)


SCENARIO = Scenario(
    name="funnel",
    title="A block of 125 balls runs through a funnel.",
    judged="Overlap, time kept, energy.",
    build=build,
    motion=untracked(),
    frames=480,
    short=36,
    bounds=(*CROWD, GAINS_NOTHING, Bound("travel_missing", 0.0, "all come down into the funnel")),
    regions=(Region(NAMES, (-0.7, -0.7, 0.0), (0.7, 0.7, 2.0), "no ball goes through a plate, nor through the floor"),),
    expects={"travel": dict.fromkeys(NAMES, 0.15), "alone": (NAMES,)},
)
