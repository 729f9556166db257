"""Internal edges of one body: a floor cut into 1, 2, 8 and 64 pieces, and into slivers, is the same to what moves on it.

Each floor has a box that slides until it stops, a ball that bounces on a seam, and a ball that slides until it rolls, and all
seams across their way. Closed forms as in `stop_distance`, `bounce_ladder` and `slide_to_roll`. Engines that find a normal per
piece trip over inner edges.
"""

from collections.abc import Callable

import numpy as np

from avatarsim.scene.body import Body, ContactLaw, fixed, simulated, solid
from avatarsim.scene.scene import Scene
from avatarsim.scene.shape import Box, Piece, Sphere
from reference.closed_form import bounce_state, roll_distance, roll_speed, roll_time, stop_distance, stop_time
from scenarios.building.cases import LAID, pair_table
from scenarios.building.expected import Course, OfTime
from scenarios.building.promises import FINITE, NO_OVERLAP, RIGHT_SIDE
from scenarios.motion.untracked import untracked
from scenarios.scenario import INFINITE, Bound, Region, Scenario

LONG, WIDE, THICK = 4.0, 1.0, 0.2
"""Edges of every floor [m], seams across x, one of them at x = 0."""
SLIVER = 1e-4
"""Width of the thin pieces of the last floor [m]: a two-thousandth of their height."""
LANE = 1.5
"""Distance of neighbouring floors [m]."""
SPEED, FRICTION, GRAVITY, MASS = 2.0, 0.5, 9.81, 1.0
RADIUS, HEIGHT, RESTITUTION = 0.1, 0.5, 0.5
"""Radius of both balls [m]; where the bouncing one begins [m], and its restitution."""
BOX = (0.3, 0.3, 0.1)
"""Edges of the box that slides [m]."""
SLIDES_FROM, ROLLS_FROM = -1.0, -0.5
"""Where the sliding box and the rolling ball begin along x [m]."""


def _even(pieces: int) -> list[float]:
    return [-0.5 * LONG + LONG * k / pieces for k in range(pieces + 1)]


CUTS: dict[str, list[float]] = {
    "1": _even(1), "2": _even(2), "8": _even(8), "64": _even(64),
    "slivers": sorted([*_even(16), *(edge + SLIVER for edge in _even(16)[:-1])]),
}
"""Where each floor is cut along x, its ends included [m]."""


def floor(name: str, lane: float) -> Body:
    """One floor, its top at z = 0."""
    cuts = np.array(CUTS[name])
    pieces = tuple(
        Piece(Box((float(b - a), WIDE, THICK)), (float(0.5 * (a + b)), 0.0, 0.0))
        for a, b in zip(cuts[:-1], cuts[1:], strict=True)
    )
    return fixed(f"floor_{name}", pieces, "floor", (0.0, lane, -0.5 * THICK))


def build() -> Scene:
    """Five floors beside one another, three bodies on each."""
    box, ball = (Piece(Box(BOX)),), (Piece(Sphere(RADIUS)),)
    bodies: list[Body] = []
    for k, name in enumerate(CUTS):
        y, forwards = LANE * (k - 2), (SPEED, 0.0, 0.0)
        bodies.append(floor(name, y))
        bodies.append(simulated(f"slides_{name}", box, "box", solid(box, MASS), (SLIDES_FROM, y - 0.3, 0.5 * BOX[2] + LAID),
                                velocity=forwards))
        bodies.append(simulated(f"bounces_{name}", ball, "ball", solid(ball, MASS), (0.0, y, RADIUS + HEIGHT)))
        bodies.append(simulated(f"rolls_{name}", ball, "cloth", solid(ball, MASS), (ROLLS_FROM, y + 0.3, RADIUS + LAID),
                                velocity=forwards))
    stated = {
        ("box", "floor"): ContactLaw(0.0, FRICTION), ("ball", "floor"): ContactLaw(RESTITUTION, FRICTION),
        ("cloth", "floor"): ContactLaw(0.0, FRICTION),
    }
    return Scene("split_invariance", tuple(bodies), materials=pair_table(("floor", "box", "ball", "cloth"), stated))


def slides(y: float) -> OfTime:
    """The box at a time [s]."""
    ends, way = stop_time(SPEED, FRICTION, GRAVITY), stop_distance(SPEED, FRICTION, GRAVITY)
    return lambda time: (SLIDES_FROM + way * (1.0 - max(0.0, 1.0 - time / ends) ** 2), y - 0.3, 0.5 * BOX[2])


def bounces(y: float) -> OfTime:
    """The ball that was dropped."""
    return lambda time: (0.0, y, RADIUS + bounce_state(HEIGHT, RESTITUTION, GRAVITY, time)[0])


def rolls(y: float) -> OfTime:
    """The ball that slides until it rolls."""
    begins = roll_time(SPEED, FRICTION, GRAVITY)

    def at(time: float) -> tuple[float, float, float]:
        sliding = SPEED * time - 0.5 * FRICTION * GRAVITY * time * time
        rolling = roll_distance(SPEED, FRICTION, GRAVITY) + roll_speed(SPEED) * (time - begins)
        return ROLLS_FROM + (sliding if time < begins else rolling), y + 0.3, RADIUS

    return at


def courses() -> tuple[Course, ...]:
    """Where all are at any time, whatever they stand on."""
    kinds: dict[str, Callable[[float], OfTime]] = {"slides": slides, "bounces": bounces, "rolls": rolls}
    return tuple(
        Course(f"{kind}_{name}", course(LANE * (k - 2))) for k, name in enumerate(CUTS) for kind, course in kinds.items()
    )


MOVING = tuple(f"{kind}_{name}" for name in CUTS for kind in ("slides", "bounces", "rolls"))

SCENARIO = Scenario(
    name="split_invariance",
    title="Boxes slide and balls bounce and roll over the same floor cut into 1 to 64 pieces, and into slivers.",
    judged="Whether a seam changes any motion.",
    build=build,
    motion=untracked(),
    frames=75,
    bounds=(
        NO_OVERLAP, RIGHT_SIDE, FINITE,
        Bound("course_error_max", 2e-6, "the closed forms know nothing of seams; the rest is the gap at which bodies are laid"),
        Bound("energy_gain_max", 1e-9, "a seam adds no energy"),
    ),
    regions=(Region(("slides_*", "bounces_*", "rolls_*"), (-INFINITE, -INFINITE, 0.0), (INFINITE,) * 3, "no floor has a gap"),),
    expects={"courses": courses(), "alone": tuple((name,) for name in MOVING)},
)
