"""Slivers: boxes with edges of 1 to 20, 1 to 30 and 1 to 1000 fly at a sheet of a millimetre, flat, edge on and corner on.

No gravity, elastic, no friction, every impact through the centre of mass: they come back the way they went. Beside them slivers
collide with slivers, turned at random: no closed form, but momentum and energy stay. The judge's depth of such boxes is the least
over all facet normals and pairs of edges, which is exact.
"""

import numpy as np

from avatarsim.scene.body import Body, ContactLaw, fixed, simulated, solid
from avatarsim.scene.checks import Quaternion, Vector
from avatarsim.scene.scene import Scene
from avatarsim.scene.shape import Box, Piece
from avatarsim.spatial import rotation
from scenarios.building.cases import NOWHERE, pair_table, turned_by
from scenarios.building.expected import Course, OfTime
from scenarios.building.promises import FINITE, NO_OVERLAP, RIGHT_SIDE
from scenarios.motion.untracked import untracked
from scenarios.scenario import INFINITE, RENDERED, Bound, Region, Scenario

RATIOS = (20, 30, 1000)
"""Longest edge over the shortest."""
EDGE, SHEET, MASS = 0.3, 1e-3, 0.5
"""Longest edge of the boxes [m], thickness of the sheet [m], mass of a box [kg]."""
SPEEDS = (2.0, 20.0)
"""[m/s]: a third of a metre per frame is three hundred times the sheet."""
WAYS = ("flat", "edge", "corner")
NEAR = 0.1
"""From the box's foremost point to the sheet at the start [m]."""
LANE = 1.0
"""Distance of neighbouring lanes [m]: wider than a box."""
FRAMES = 45
OFF = 2.0 * max(SPEEDS) * 3.0 / max(RATIOS) ** 2 * FRAMES * RENDERED
"""What the thinnest box may be off its way [m]. Turned corner on, two of its corners are 2e-7 m apart in depth: contact at both.
Hit up to half its thin edge t off centre it loses 2 v m (t/2)^2 / I = 6 v (t / L)^2 to spin, 4e-6 of its speed."""
CASES = tuple((ratio, way, speed) for ratio in RATIOS for way in WAYS for speed in SPEEDS)


def size(ratio: int) -> Vector:
    """Edges of a box [m], the thin one along x."""
    return EDGE / ratio, EDGE, EDGE


def turned(ratio: int, way: str) -> tuple[Quaternion, float]:
    """How a box is turned, and how far it reaches ahead of its centre [m]."""
    thin, long, _ = size(ratio)
    if way == "flat":
        return rotation.IDENTITY, 0.5 * thin
    if way == "edge":
        return turned_by((0.0, 0.0, 1.0), 0.5 * np.pi), 0.5 * long
    # the diagonal to a corner, laid along x
    corner = np.array([thin, long, long])
    half = 0.5 * float(np.linalg.norm(corner))
    axis = np.cross(corner, (1.0, 0.0, 0.0))
    x, y, z = axis.tolist()
    return turned_by((x, y, z), float(np.arctan2(np.linalg.norm(axis), corner[0]))), half


def build() -> Scene:
    """The sheet across x at 0, a lane per box before it; pairs far from it."""
    high, wide = LANE * (len(RATIOS) + 1), LANE * (len(WAYS) * len(SPEEDS) + 1)
    bodies: list[Body] = [fixed("sheet", (Piece(Box((SHEET, wide, high))),), "sheet")]
    for k, (ratio, way, speed) in enumerate(CASES):
        pieces, (turn, ahead) = (Piece(Box(size(ratio))),), turned(ratio, way)
        start = (-0.5 * SHEET - NEAR - ahead, *lane(k))
        bodies.append(simulated(name(ratio, way, speed), pieces, "box", solid(pieces, MASS), start, turn,
                                velocity=(speed, 0.0, 0.0)))
    for ratio in RATIOS:
        bodies += pair(ratio)
    materials = pair_table(("sheet", "box"), {("sheet", "box"): ContactLaw(1.0, 0.0), ("box", "box"): ContactLaw(1.0, 0.0)})
    return Scene("slivers", tuple(bodies), materials=materials, gravity=NOWHERE)


def name(ratio: int, way: str, speed: float) -> str:
    """Of the body of a case."""
    return f"{way}_{ratio}_{speed:g}"


def lane(k: int) -> tuple[float, float]:
    """Where case k flies, across the sheet [m]."""
    row, column = divmod(k, len(WAYS) * len(SPEEDS))
    return LANE * (column - 2.5), LANE * (row - 1)


def pair(ratio: int) -> tuple[Body, Body]:
    """Two boxes of one ratio that fly at each other off centre, turned and spinning at random."""
    random, pieces = np.random.default_rng(ratio), (Piece(Box(size(ratio))),)
    found = []
    for side in (-1.0, 1.0):
        axis, (sx, sy, sz) = random.normal(size=3), random.uniform(-3.0, 3.0, 3).tolist()
        x, y, z = axis.tolist()
        at = (-8.0 + 0.5 * side, 2.0 * RATIOS.index(ratio) + 0.03 * side, 0.05 * side)
        found.append(simulated(f"pair_{ratio}_{'left' if side < 0.0 else 'right'}", pieces, "box", solid(pieces, MASS), at,
                               turned_by((x, y, z), float(random.uniform(0.0, np.pi))), (-1.5 * side, 0.0, 0.0), (sx, sy, sz)))
    return found[0], found[1]


def there_and_back(k: int) -> OfTime:
    """Place [m] of the box of case k at a time [s]."""
    ratio, way, speed = CASES[k]
    start, due, across = -0.5 * SHEET - NEAR - turned(ratio, way)[1], NEAR / speed, lane(k)
    return lambda time: (start + speed * (time if time <= due else 2.0 * due - time), *across)


PAIRS = tuple((f"pair_{ratio}_left", f"pair_{ratio}_right") for ratio in RATIOS)

SCENARIO = Scenario(
    name="slivers",
    title="Boxes as thin as a thousandth of their length fly at a sheet of a millimetre and at one another.",
    judged="When they meet and where they go; momentum and energy of those that collide off centre.",
    build=build,
    motion=untracked(),
    frames=FRAMES,
    bounds=(
        NO_OVERLAP, RIGHT_SIDE, FINITE,
        Bound("course_error_max", OFF, "they come back the way they went; the thinnest may be hit at one end of its thin edge"),
        Bound("momentum_drift_max", 1e-11, "eq. 7 takes from one what it gives to the other, at some hundred impacts"),
        Bound("energy_gain_max", 1e-9, "elastic at most"),
    ),
    regions=(
        Region(tuple(f"{way}_*" for way in WAYS), (-INFINITE,) * 3, (0.0, INFINITE, INFINITE), "nothing gets through the sheet"),
    ),
    expects={
        "courses": tuple(Course(name(*case), there_and_back(k)) for k, case in enumerate(CASES)),
        "isolated": PAIRS,
        "alone": (*PAIRS, *((name(*case),) for case in CASES)),
    },
)
