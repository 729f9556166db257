"""Balls fly at a wall of a centimetre at up to 1000 m/s, and boxes as thin as a thousandth of their length at a thin sheet.

No gravity, elastic, every impact through the centre of mass: contact at (d - r) / v, then back at the same speed. Slivers that
collide with slivers, turned at random, have no closed form, but momentum and energy stay.
"""

from collections.abc import Iterator

import numpy as np

from avatarsim.scene.body import Body
from avatarsim.scene.checks import Quaternion
from avatarsim.scene.shape import Box, Sphere
from avatarsim.spatial import rotation
from reference.closed_form import wall_contact_time
from scenarios.building.cases import NOWHERE, fixture, laws, loose, one_law, turned_by
from scenarios.building.expected import Course, OfTime
from scenarios.building.promises import SOUND
from scenarios.building.scenes import before, each_alone, undriven
from scenarios.scenario import RENDERED, Bound

RADIUS, WALL, APART = 0.01, 0.01, 0.1
"""Radius of the balls, thickness of their wall, and distance of neighbouring lanes [m]."""
SPEEDS, STARTS = (2.0, 10.0, 30.0, 100.0, 300.0, 1000.0), 20
"""Speeds of the balls [m/s], and starting points per speed, spread over the way of one frame: 17 m at 1000 m/s."""
BEFORE = 3.3 * RENDERED
"""Time [s] from the nearest start to the wall: every ball has been seen flying."""

RATIOS, EDGE, SHEET, MASS = (20, 30, 1000), 0.3, 1e-3, 0.5
"""Longest edge of a sliver over the shortest, longest edge [m], thickness of the sheet [m], mass of a sliver [kg]."""
WAYS, FAST, NEAR, LANE, FRAMES = ("flat", "edge", "corner"), 20.0, 0.1, 1.0, 45
"""Ways to meet the sheet, larger speed of slivers [m/s], first distance from the sheet, distance of lanes [m], frames."""
CASES = tuple((ratio, way, speed) for ratio in RATIOS for way in WAYS for speed in (2.0, FAST))
SLIVERS = tuple(f"{way}_{ratio}_{speed:g}" for ratio, way, speed in CASES)
PAIRS = tuple((f"pair_{ratio}_left", f"pair_{ratio}_right") for ratio in RATIOS)
OFF = 2.0 * FAST * 3.0 / max(RATIOS) ** 2 * FRAMES * RENDERED
"""Largest distance [m] of the thinnest sliver from its way. Corner on, two of its corners are 2e-7 m apart in depth; hit up to
half its thin edge t off centre it loses 2 v m (t/2)^2 / I = 6 v (t / L)^2 to spin, 4e-6 of its speed."""


def distance(speed: float, k: int) -> float:
    """Return the distance [m] from the ball's centre to the wall's middle at the start."""
    return speed * (BEFORE + RENDERED * k / STARTS) + RADIUS + 0.5 * WALL


def balls() -> Iterator[Body]:
    """Yield a wall across x at 0 and its balls; lanes of one speed lie side by side, speeds above each other."""
    yield fixture("wall", Box((WALL, APART * (STARTS + 1), APART * (len(SPEEDS) + 1))), "wall")
    for row, speed in enumerate(SPEEDS):
        for k in range(STARTS):
            start = (-distance(speed, k), APART * (k - 0.5 * (STARTS - 1)), APART * (row - 0.5 * (len(SPEEDS) - 1)))
            yield loose(f"ball_{speed:g}_{k}", Sphere(RADIUS), "ball", 0.03, start, velocity=(speed, 0.0, 0.0))


def ball_courses() -> Iterator[Course]:
    """Yield courses to the wall and back the same way: a contact found late by t seconds leaves a ball 2 v t off."""
    for body in balls():
        if body.mass is not None:
            away, speed = -body.position[0], body.velocity[0]
            due = wall_contact_time(away, RADIUS, WALL, speed)
            yield Course(body.name, there_and_back(-away, speed, due, *body.position[1:]))


def there_and_back(start: float, speed: float, due: float, y: float, z: float) -> OfTime:
    """Return the place [m] at a time [s] along x from `start` and, from the time `due` on, back."""
    return lambda time: (start + speed * (time if time <= due else 2.0 * due - time), y, z)


def sliver(ratio: int) -> Box:
    """Return a box, its thin edge along x."""
    return Box((EDGE / ratio, EDGE, EDGE))


def turned(ratio: int, way: str) -> tuple[Quaternion, float]:
    """Return the turn of a sliver, and its reach ahead of its centre [m]."""
    if way == "flat":
        return rotation.IDENTITY, 0.5 * (EDGE / ratio)
    if way == "edge":
        return turned_by((0.0, 0.0, 1.0), 0.5 * np.pi), 0.5 * EDGE
    # the diagonal to a corner, laid along x
    corner = np.array(sliver(ratio).size)
    axis = np.cross(corner, (1.0, 0.0, 0.0))
    x, y, z = axis.tolist()
    return turned_by((x, y, z), float(np.arctan2(np.linalg.norm(axis), corner[0]))), 0.5 * float(np.linalg.norm(corner))


def lane(k: int) -> tuple[float, float]:
    """Return where case k flies, across the sheet [m]."""
    row, column = divmod(k, len(CASES) // len(RATIOS))
    return LANE * (column - 2.5), LANE * (row - 1)


def slivers() -> Iterator[Body]:
    """Yield a sheet across x at 0, a lane per sliver before it; pairs that fly at each other off centre far from it."""
    yield fixture("sheet", Box((SHEET, LANE * 7.0, LANE * 4.0)), "sheet")
    for k, (ratio, way, speed) in enumerate(CASES):
        tilt, ahead = turned(ratio, way)
        start = (-0.5 * SHEET - NEAR - ahead, *lane(k))
        yield loose(SLIVERS[k], sliver(ratio), "box", MASS, start, tilt, velocity=(speed, 0.0, 0.0))
    for row, (ratio, names) in enumerate(zip(RATIOS, PAIRS, strict=True)):
        random = np.random.default_rng(ratio)
        for name, side in zip(names, (-1.0, 1.0), strict=True):
            (x, y, z), (a, b, c) = random.normal(size=3).tolist(), random.uniform(-3.0, 3.0, 3).tolist()
            at, angle = (-8.0 + 0.5 * side, 2.0 * row + 0.03 * side, 0.05 * side), random.uniform(0.0, np.pi)
            yield loose(name, sliver(ratio), "box", MASS, at, turned_by((x, y, z), angle), (-1.5 * side, 0.0, 0.0), (a, b, c))


def sliver_courses() -> Iterator[Course]:
    """Yield courses to the sheet and back the same way."""
    for k, (ratio, way, speed) in enumerate(CASES):
        yield Course(SLIVERS[k], there_and_back(-0.5 * SHEET - NEAR - turned(ratio, way)[1], speed, NEAR / speed, *lane(k)))


SCENARIOS = (
    undriven(
        "tunnelling", "A hundred and twenty balls fly at a thin wall with 2 to 1000 m/s.",
        "How many are stopped, and when each meets the wall.", balls, laws({("ball", "wall"): (1.0, 0.0)}),
        gravity=NOWHERE, frames=20,
        bounds=(
            *SOUND, Bound("escaped_bodies", 0.0, "a wall stops what cannot pass it, at any speed"),
            Bound("course_error_max", 2.1e-6, "a gap of 1e-6 m is contact, and a ball that turns there is twice that off"),
        ),
        regions=(before(0.0, "ball_*", reason="nothing gets through the wall"),), expects={"courses": tuple(ball_courses())},
    ),
    undriven(
        "slivers", "Boxes as thin as a thousandth of their length fly at a sheet of a millimetre and at one another.",
        "When they meet and where they go; momentum and energy of those that collide off centre.", slivers,
        one_law(1.0, 0.0, ("sheet", "box"), ("box", "box")), gravity=NOWHERE, frames=FRAMES,
        bounds=(
            *SOUND,
            Bound("course_error_max", OFF, "they come back; the thinnest may be hit at one end of its thin edge"),
            Bound("momentum_drift_max", 1e-11, "eq. 7 takes from one what it gives to the other, at some hundred impacts"),
            Bound("energy_gain_max", 1e-9, "elastic at most"),
        ),
        regions=(before(0.0, *(f"{way}_*" for way in WAYS), reason="nothing gets through the sheet"),),
        expects={"courses": tuple(sliver_courses()), "isolated": PAIRS, "alone": (*PAIRS, *each_alone(SLIVERS))},
    ),
)
