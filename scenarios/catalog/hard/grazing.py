"""Balls and cubes miss or graze one another by 1 mm down to 1e-15 m, and nothing jumps where the sign changes.

Closed form, elastic and without friction: a ball that misses flies straight on; one that grazes at an offset b turns by
2 acos(b / R), which goes to 0 with the square root of how much it grazes. Cubes pass a fixed face and feel nothing.
"""

from collections.abc import Iterator
from math import sqrt

from avatarsim.scene.body import Body
from avatarsim.scene.checks import Vector
from avatarsim.scene.shape import Box, Sphere
from scenarios.building.cases import NOWHERE, fixture, laws, loose
from scenarios.building.expected import Course, OfTime, uniform
from scenarios.building.promises import FINITE, NO_OVERLAP
from scenarios.building.scenes import each_alone, undriven
from scenarios.scenario import RENDERED, Bound

FRAMES, SPEED = 45, 2.0
ALONG = (SPEED, 0.0, 0.0)
"""Velocity of all [m/s]."""
RADIUS, REACH, BEFORE = 0.1, 0.2, 0.4
"""Radius of every ball and of two together, and distance of their centres along the way at the start [m]."""
EDGE, BAR, LANE = 0.1, (1.6, 0.2, 0.2), 0.7
"""Edge of the cubes, edges of the bars that they pass, and distance of neighbouring lanes [m]."""
GAPS = (1e-3, 1e-6, 1e-9, 1e-12, 1e-15, -1e-15, -1e-12, -1e-9, -1e-6, -1e-3, -0.05)
"""By how much the balls miss one another [m]; below 0 they graze, and the last one hits."""
PASSING = tuple(gap for gap in GAPS if gap >= 1e-12)
"""Gaps between cube and bar [m]: a cube that had less would not begin free."""
TURNED = 2.0 * sqrt(2.0 * 2.2e-8 / REACH)
"""Largest angle [rad] by which a near miss turns a ball: 2 acos(1 - s / R), s being the gap of contact, 2e-8 m, and a tenth."""


def bodies() -> Iterator[Body]:
    """Yield balls above one another in one plane, cubes in another."""
    for k, gap in enumerate(GAPS):
        yield fixture(f"post_{k}", Sphere(RADIUS), "post", (0.0, 0.0, LANE * k))
        yield loose(f"ball_{k}", Sphere(RADIUS), "ball", 1.0, (-BEFORE, REACH + gap, LANE * k), velocity=ALONG)
    for k, gap in enumerate(PASSING):
        yield fixture(f"bar_{k}", Box(BAR), "post", (0.5 * BAR[0], 2.0 - 0.5 * BAR[1], LANE * k))
        yield loose(f"cube_{k}", Box((EDGE, EDGE, EDGE)), "cube", 1.0, cube_starts(gap, k), velocity=ALONG)


def cube_starts(gap: float, k: int) -> Vector:
    """Return the start of a cube at so small a distance from its bar."""
    return EDGE, 2.0 + 0.5 * EDGE + gap, LANE * k


def ball_flies(gap: float, k: int) -> OfTime:
    """Return the place [m] of a ball at a time [s]: straight on, and turned by the impact if there is one."""
    start, offset = (-BEFORE, REACH + gap, LANE * k), REACH + gap
    if gap >= 0.0:
        return uniform(start, ALONG)
    near = sqrt((REACH - offset) * (REACH + offset))
    due = (BEFORE - near) / SPEED
    nx, ny = -near / REACH, offset / REACH
    after = (SPEED - 2.0 * SPEED * nx * nx, -2.0 * SPEED * nx * ny, 0.0)
    first, then = uniform(start, ALONG), uniform((-near, offset, LANE * k), after)
    return lambda time: first(time) if time <= due else then(time - due)


BALLS = {f"ball_{k}": ball_flies(gap, k) for k, gap in enumerate(GAPS)}
CUBES = {f"cube_{k}": uniform(cube_starts(gap, k), ALONG) for k, gap in enumerate(PASSING)}

SCENARIO = undriven(
    "grazing", "Balls and cubes miss or graze one another by a millimetre down to 1e-15 m.",
    "Whether the way changes as little as the gap does.", bodies,
    laws({("ball", "post"): (1.0, 0.0), ("cube", "post"): (0.5, 0.5)}), gravity=NOWHERE, frames=FRAMES,
    bounds=(
        NO_OVERLAP, FINITE,
        Bound("course_error_max", TURNED * (SPEED * FRAMES * RENDERED - BEFORE),
              "a stand-off of 2e-8 m turns a near miss by 9e-4 rad at most, over the way that is left"),
        Bound("energy_gain_max", 1e-12, "elastic at most"),
    ),
    expects={
        "courses": tuple(Course(name, at) for name, at in (BALLS | CUBES).items()), "alone": each_alone((*BALLS, *CUBES)),
    },
)
