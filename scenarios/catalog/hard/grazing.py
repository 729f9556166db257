"""Grazing impacts: bodies miss or graze one another by 1 mm down to 1e-15 m, and nothing jumps where the sign changes.

Balls fly past fixed balls so that their centres would come as near as the sum of the radii and a bit more, or a bit less. Closed
form, elastic and without friction: a ball that misses flies straight on; one that grazes at an offset b turns by 2 acos(b / R),
which goes to 0 with the square root of how much it grazes. Cubes pass a fixed face with the same gaps and feel nothing, friction
or not.
"""

from math import sqrt

from avatarsim.scene.body import Body, ContactLaw, fixed, simulated, solid
from avatarsim.scene.checks import Vector
from avatarsim.scene.scene import Scene
from avatarsim.scene.shape import Box, Piece, Sphere
from scenarios.building.cases import NOWHERE, pair_table
from scenarios.building.expected import Course, OfTime, uniform
from scenarios.building.promises import FINITE, NO_OVERLAP
from scenarios.motion.untracked import untracked
from scenarios.scenario import RENDERED, Bound, Scenario

FRAMES = 45
SPEED, MASS = 2.0, 1.0
"""[m/s], [kg]"""
RADIUS, REACH = 0.1, 0.2
"""Radius of every ball, and of two together [m]."""
BEFORE = 0.4
"""Distance of the centres along the way at the start [m]."""
EDGE, SLAB = 0.1, (1.6, 0.2, 0.2)
"""Edge of the cubes, and edges of the bars that they pass [m]."""
LANE = 0.7
"""Distance of neighbouring lanes [m]."""
CONTROL = -0.05
"""One that hits in earnest [m]."""
GAPS = (1e-3, 1e-6, 1e-9, 1e-12, 1e-15, -1e-15, -1e-12, -1e-9, -1e-6, -1e-3, CONTROL)
"""By how much the balls miss one another [m]; below 0 they graze."""
PASSING = tuple(gap for gap in GAPS if gap >= 1e-12)
"""Gaps between cube and bar [m]: a cube that had less would not begin free."""
STAND_OFF = 2.2e-8
"""A ball that turns at a gap of 2e-8 m turns as if it had grazed by so much more [m]; a tenth for the accuracy of that gap."""
TURNED = 2.0 * sqrt(2.0 * STAND_OFF / REACH)
"""The angle [rad] which that is at most: 2 acos(1 - s / R)."""


def build() -> Scene:
    """Balls above one another in one plane, cubes in another."""
    ball, cube, bar = (Piece(Sphere(RADIUS)),), (Piece(Box((EDGE, EDGE, EDGE))),), (Piece(Box(SLAB)),)
    along, bodies = (SPEED, 0.0, 0.0), list[Body]()
    for k, gap in enumerate(GAPS):
        bodies.append(fixed(f"post_{k}", ball, "post", (0.0, 0.0, LANE * k)))
        bodies.append(simulated(f"ball_{k}", ball, "ball", solid(ball, MASS), (-BEFORE, REACH + gap, LANE * k), velocity=along))
    for k, gap in enumerate(PASSING):
        bodies.append(fixed(f"bar_{k}", bar, "post", (0.5 * SLAB[0], 2.0 - 0.5 * SLAB[1], LANE * k)))
        bodies.append(simulated(f"cube_{k}", cube, "cube", solid(cube, MASS), cube_starts(gap, k), velocity=along))
    stated = {("ball", "post"): ContactLaw(1.0, 0.0), ("cube", "post"): ContactLaw(0.5, 0.5)}
    return Scene("grazing", tuple(bodies), materials=pair_table(("post", "ball", "cube"), stated), gravity=NOWHERE)


def cube_starts(gap: float, k: int) -> Vector:
    """A cube beside its bar, at so small a distance."""
    return EDGE, 2.0 + 0.5 * EDGE + gap, LANE * k


def ball_flies(gap: float, k: int) -> OfTime:
    """Place [m] of a ball at a time [s]: straight on, and turned by the impact if there is one."""
    start, offset = (-BEFORE, REACH + gap, LANE * k), REACH + gap
    if gap >= 0.0:
        return uniform(start, (SPEED, 0.0, 0.0))
    before = sqrt((REACH - offset) * (REACH + offset))
    due = (BEFORE - before) / SPEED
    nx, ny = -before / REACH, offset / REACH
    after = (SPEED - 2.0 * SPEED * nx * nx, -2.0 * SPEED * nx * ny, 0.0)
    first, then = uniform(start, (SPEED, 0.0, 0.0)), uniform((-before, offset, LANE * k), after)
    return lambda time: first(time) if time <= due else then(time - due)


def courses() -> tuple[Course, ...]:
    """Of every ball and every cube."""
    balls = (Course(f"ball_{k}", ball_flies(gap, k)) for k, gap in enumerate(GAPS))
    cubes = (Course(f"cube_{k}", uniform(cube_starts(gap, k), (SPEED, 0.0, 0.0))) for k, gap in enumerate(PASSING))
    return (*balls, *cubes)


SCENARIO = Scenario(
    name="grazing",
    title="Balls and cubes miss or graze one another by a millimetre down to 1e-15 m.",
    judged="Whether the way changes as little as the gap does.",
    build=build,
    motion=untracked(),
    frames=FRAMES,
    bounds=(
        NO_OVERLAP, FINITE,
        Bound(
            "course_error_max", TURNED * (SPEED * FRAMES * RENDERED - BEFORE),
            "a stand-off of 2e-8 m turns a near miss by 9e-4 rad at most, over the way that is left",
        ),
        Bound("energy_gain_max", 1e-12, "elastic at most"),
    ),
    expects={
        "courses": courses(),
        "alone": (*((f"ball_{k}",) for k in range(len(GAPS))), *((f"cube_{k}",) for k in range(len(PASSING)))),
    },
)
