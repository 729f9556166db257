"""Stacks that come down: ten boxes and a wall of bricks struck by a ball, and a lattice of 216 balls (SimBenchmark's 666 test).

Bodies in motion that touch one another keep their pace, whatever it costs.
"""

from collections.abc import Iterator

from avatarsim.scene.body import Body
from avatarsim.scene.shape import Box, Sphere
from scenarios.building.cases import loose, one_law, slab
from scenarios.building.promises import CROWD, GAINS_NOTHING, NO_ENERGY, SOUND
from scenarios.building.scenes import above, undriven
from scenarios.catalog.stacks.stacks import BOXES, ten
from scenarios.scenario import Bound

LONG, DEEP, HIGH, JOINT, AIR = 0.2, 0.1, 0.065, 5e-4, 1e-4
"""Edges of a brick, gaps between bricks of a layer and below each layer at the start [m]."""
RADIUS, DISTANCE = 0.1, 0.6
"""Radius of all balls, and how far before the wall of bricks the one that strikes it begins [m]."""
BRICKS = tuple(f"brick_{row}_{column}" for row in range(8) for column in range(6))
BALLS = tuple(f"ball_{k}" for k in range(6**3))
PITCH, LOW, SHEAR = 0.2002, 0.01, 0.004
"""Distance of neighbours in the lattice, height of the lowest balls above the floor, and sideways offset of a layer against the
one below along x, and half as much along y [m]: a lattice that is not sheared balances on itself."""
NEVER_HALTS = Bound("halted_frames", 0.0, "a budget that is spent ends in a plastic step and not in a halt")


def struck_stack() -> Iterator[Body]:
    """Ten boxes on a wide floor, and a ball 0.9 m before them that strikes the middle."""
    yield slab(40.0, 40.0)
    yield from ten()
    yield loose("ball", Sphere(RADIUS), "box", 4.0, (-1.1, 0.02, 1.1), velocity=(6.0, 0.0, 0.0))


def wall() -> Iterator[Body]:
    """A wall along x, every other layer shifted by half a brick; the ball arrives at the height at which it begins."""
    yield slab(40.0, 40.0)
    for k, name in enumerate(BRICKS):
        row, column = divmod(k, 6)
        x = (column - 2.5 + (0.25 if row % 2 else -0.25)) * (LONG + JOINT)
        yield loose(name, Box((LONG, DEEP, HIGH)), "brick", 2.0, (x, 0.0, 0.5 * HIGH + AIR + row * (HIGH + AIR)))
    yield loose("ball", Sphere(RADIUS), "brick", 5.0, (0.03, -DISTANCE, 0.3), velocity=(0.0, 8.0, 0.6))


def lattice() -> Iterator[Body]:
    """The lattice over a floor so wide that no ball rolls off it."""
    yield slab(200.0, 200.0)
    for k, name in enumerate(BALLS):
        i, j, layer = k % 6, k // 6 % 6, k // 36
        at = (PITCH * (i - 2.5) + SHEAR * layer, PITCH * (j - 2.5) + 0.5 * SHEAR * layer, RADIUS + LOW + PITCH * layer)
        yield loose(name, Sphere(RADIUS), "ball", 1.0, at)


SCENARIOS = (
    undriven(
        "stack_struck", "A ball at 6 m/s strikes a stack of ten boxes, which comes down.",
        "Overlap, energy, and that nothing halts; the time of the worst frame.", struck_stack,
        one_law(0.3, 0.4, ("floor", "box"), ("box", "box")), family="stack_struck", frames=600, short=60,
        bounds=(
            *SOUND, NO_ENERGY, NEVER_HALTS,
            Bound("travel_missing", 0.0, "the stack is struck: the box in the middle goes 0.3 m at least"),
        ),
        regions=(above(0.0, "box_*", "ball"),), expects={"alone": ((*BOXES, "ball"),), "travel": {"box_5": 0.3}},
    ),
    undriven(
        "brick_wall", "A ball breaks a wall of bricks.", "Overlap, time kept, energy; that ball and bricks go on.", wall,
        one_law(0.1, 0.5, ("floor", "brick"), ("brick", "brick")), family="brick_wall", frames=480, short=75,
        bounds=(*CROWD, GAINS_NOTHING, Bound("travel_missing", 0.0, "the ball comes to the wall and goes on into it")),
        regions=(above(0.0, "brick_*", "ball"),),
        expects={"travel": {"ball": DISTANCE - RADIUS - 0.5 * DEEP + 0.1}, "alone": ((*BRICKS, "ball"),)},
    ),
    undriven(
        "balls_216", "A lattice of 216 balls lands and topples.", "Overlap, energy, and the time of the worst frame.", lattice,
        one_law(0.3, 0.3, ("floor", "ball"), ("ball", "ball")), family="balls_216", frames=600, short=45,
        bounds=(*SOUND, NO_ENERGY, NEVER_HALTS, Bound("travel_missing", 0.0, "every ball comes down")),
        regions=(above(0.0, "ball_*"),), expects={"alone": (BALLS,), "travel": dict.fromkeys(BALLS, 0.5 * LOW)},
    ),
)
