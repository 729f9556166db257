"""Boxes on one another settle and rest; other stacks come down: boxes and bricks that a ball strikes, and a lattice of balls.

Boxes begin with a millimetre of air below each, so that an engine that does nothing at all is not at rest but in the air. The
lattice is SimBenchmark's 666 test.
"""

from collections.abc import Iterator

from avatarsim.scene.body import Body
from avatarsim.scene.shape import Box, Sphere
from scenarios.building.cases import loose, one_law, slab
from scenarios.building.expected import Course, Rest, Tower, steady
from scenarios.building.promises import CROWD, GAINS_NOTHING, NO_ENERGY, SOUND
from scenarios.building.scenes import above, undriven
from scenarios.scenario import INFINITE, Bound, Region, Scenario

EDGE, AIR = 0.2, 1e-3
"""Edge of a box, air below each at the start [m]."""
BOXES = tuple(f"box_{k}" for k in range(10))
DULL = one_law(0.0, 0.5, ("floor", "box"), ("box", "box"))
RESTING = (
    Bound("drift_max", 1e-6, "bodies at rest stay where they are"), Bound("rest_energy_end", 1e-12, "bodies at rest are still"),
)

LONG, DEEP, HIGH, JOINT, BED = 0.2, 0.1, 0.065, 5e-4, 1e-4
"""Edges of a brick, gaps between bricks of a layer and below each layer at the start [m]."""
RADIUS, DISTANCE = 0.1, 0.6
"""Radius of all balls, and how far before the wall of bricks the one that strikes it begins [m]."""
BRICKS = tuple(f"brick_{row}_{column}" for row in range(8) for column in range(6))
BALLS = tuple(f"ball_{k}" for k in range(6**3))
PITCH, LOW, SHEAR = 0.2002, 0.01, 0.004
"""Distance of neighbours in the lattice, height of the lowest balls above the floor, and sideways offset of a layer against the
one below along x, and half as much along y [m]: a lattice that is not sheared balances on itself."""
NEVER_HALTS = Bound("halted_frames", 0.0, "a budget that is spent ends in a plastic step and not in a halt")


def ten() -> Iterator[Body]:
    """Yield ten boxes on one another."""
    for k, name in enumerate(BOXES):
        yield loose(name, Box((EDGE, EDGE, EDGE)), "box", 1.0, (0.0, 0.0, (k + 0.5) * EDGE + (k + 1) * AIR))


def of_ten(name: str, title: str, frames: int, others: tuple[Body, ...] = ()) -> Scenario:
    """Return the scene of ten boxes, and others by themselves."""
    alone = tuple(other.name for other in others)
    falls = {box: 0.9 * (k + 1) * AIR for k, box in enumerate(BOXES)} | dict.fromkeys(alone, 0.9 * AIR)
    return undriven(
        name, title, "Overlap, drift and motion left.", lambda: (slab(4.0, 4.0), *ten(), *others), DULL, family="stack_ten",
        # a body that has rested for 2 s may be put to sleep: for a median, in more than half of the frames
        frames=frames, short=300,
        bounds=(
            *SOUND, *RESTING, Bound("travel_missing", 0.0, "every box comes down on the one below"),
            Bound("halted_frames", 0.0, "no box hangs in the air"),
        ),
        regions=(
            Region(("box_*",), (-0.1, -0.1, 0.0), (0.1, 0.1, INFINITE), "no box falls through the floor or off the stack"),
        ),
        expects={"rests": (Rest((*BOXES, *alone), 0.5),), "travel": falls},
    )


def of_towers(name: str, ratios: tuple[float, ...], title: str, shift: float, reason: str) -> Scenario:
    """Return towers of two boxes, the upper one `ratio` times as heavy; a landing may shift a box by `shift` [m]."""
    places = {name: (place, mass) for k, ratio in enumerate(ratios) for name, place, mass in (
        (f"light_{ratio:g}", (k - 2.0, 0.0, 1), 1.0), (f"heavy_{ratio:g}", (k - 2.0, 0.0, 2), ratio),
    )}

    def bodies() -> Iterator[Body]:
        yield slab(8.0, 4.0)
        for box, ((x, y, storey), mass) in places.items():
            yield loose(box, Box((EDGE, EDGE, EDGE)), "box", mass, (x, y, (storey - 0.5) * EDGE + storey * AIR))

    touching = {box: (x, y, (storey - 0.5) * EDGE) for box, ((x, y, storey), _) in places.items()}
    return undriven(
        name, title, "Whether each tower stands, and how far into each other.", bodies, DULL, family="heavy_on_light",
        frames=600, short=60,
        bounds=(
            *SOUND, Bound("course_error_max", shift, reason),
            Bound("towers_fallen", 0.0, "a thousand to one is what is sought, and ten thousand to one can be had"), *RESTING,
        ),
        regions=(above(0.0, "light_*", "heavy_*"),),
        expects={
            "courses": tuple(Course(box, steady(*place), since=0.4) for box, place in touching.items()),
            "rests": (Rest(tuple(places), 0.4),),
            "towers": tuple(Tower(f"heavy_{ratio:g}", ratio, touching[f"heavy_{ratio:g}"], 0.4) for ratio in ratios),
        },
    )


def struck_stack() -> Iterator[Body]:
    """Yield ten boxes on a wide floor, and a ball 0.9 m before them that strikes the middle."""
    yield slab(40.0, 40.0)
    yield from ten()
    yield loose("ball", Sphere(RADIUS), "box", 4.0, (-1.1, 0.02, 1.1), velocity=(6.0, 0.0, 0.0))


def wall() -> Iterator[Body]:
    """Yield a wall along x, every other layer shifted by half a brick; the ball arrives at the height at which it begins."""
    yield slab(40.0, 40.0)
    for k, name in enumerate(BRICKS):
        row, column = divmod(k, 6)
        x = (column - 2.5 + (0.25 if row % 2 else -0.25)) * (LONG + JOINT)
        yield loose(name, Box((LONG, DEEP, HIGH)), "brick", 2.0, (x, 0.0, 0.5 * HIGH + BED + row * (HIGH + BED)))
    yield loose("ball", Sphere(RADIUS), "brick", 5.0, (0.03, -DISTANCE, 0.3), velocity=(0.0, 8.0, 0.6))


def lattice() -> Iterator[Body]:
    """Yield the lattice over a floor so wide that no ball rolls off it."""
    yield slab(200.0, 200.0)
    for k, name in enumerate(BALLS):
        i, j, layer = k % 6, k // 6 % 6, k // 36
        at = (PITCH * (i - 2.5) + SHEAR * layer, PITCH * (j - 2.5) + 0.5 * SHEAR * layer, RADIUS + LOW + PITCH * layer)
        yield loose(name, Sphere(RADIUS), "ball", 1.0, at)


SCENARIOS = (
    of_ten("stack_ten", "Ten boxes settle on one another and rest.", 600),
    of_ten("rest_ten_minutes", "A box, and a stack of ten, rest for ten minutes.", 36_000,
           (loose("alone", Box((EDGE, EDGE, EDGE)), "box", 1.0, (1.0, 0.0, 0.5 * EDGE + AIR)),)),
    of_towers("heavy_on_light", (1e3,), "A heavy box on a light one, a thousand to one.",
              1e-5, "boxes that stand are where they touch, to what a landing may shift them"),
    of_towers("heavy_on_light_ratios", (1.0, 10.0, 100.0, 1e3, 1e4),
              "Heavy boxes on light ones: 1, 10, 100, 1000 and 10,000 to one.",
              1e-4, "impulses one after the other turn a heavy box as it lands: it slides by 20 micrometres"),
    undriven(
        "stack_struck", "A ball at 6 m/s strikes a stack of ten boxes, which comes down.",
        "Overlap, energy, and that nothing halts; the time of the worst frame.", struck_stack,
        one_law(0.3, 0.4, ("floor", "box"), ("box", "box")), frames=600, short=60,
        bounds=(
            *SOUND, NO_ENERGY, NEVER_HALTS,
            Bound("travel_missing", 0.0, "the stack is struck: the box in the middle goes 0.3 m at least"),
        ),
        regions=(above(0.0, "box_*", "ball"),), expects={"alone": ((*BOXES, "ball"),), "travel": {"box_5": 0.3}},
    ),
    undriven(
        "brick_wall", "A ball breaks a wall of bricks.", "Overlap, time kept, energy; that ball and bricks go on.", wall,
        one_law(0.1, 0.5, ("floor", "brick"), ("brick", "brick")), frames=480, short=75,
        bounds=(*CROWD, GAINS_NOTHING, Bound("travel_missing", 0.0, "the ball comes to the wall and goes on into it")),
        regions=(above(0.0, "brick_*", "ball"),),
        expects={"travel": {"ball": DISTANCE - RADIUS - 0.5 * DEEP + 0.1}, "alone": ((*BRICKS, "ball"),)},
    ),
    undriven(
        "balls_216", "A lattice of 216 balls lands and topples.", "Overlap, energy, and the time of the worst frame.", lattice,
        one_law(0.3, 0.3, ("floor", "ball"), ("ball", "ball")), frames=600, short=45,
        bounds=(*SOUND, NO_ENERGY, NEVER_HALTS, Bound("travel_missing", 0.0, "every ball comes down")),
        regions=(above(0.0, "ball_*"),), expects={"alone": (BALLS,), "travel": dict.fromkeys(BALLS, 0.5 * LOW)},
    ),
)
