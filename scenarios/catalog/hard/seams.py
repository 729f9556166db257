"""Internal edges of floors: bodies that slide, roll and bounce over seams go as far as on one piece.

`seams`: every stone is a body of its own, seams lean or cross, and sliding bodies are of pieces themselves or carry others.
`split_invariance`: one floor is cut into pieces, straight across the way. `worn_floor`: each stone is a micrometre lower than
the last, which adds three hundredths of a thousandth to the way. Closed forms: v^2 / (2 mu g), and 5/7 v for a ball that begins
without spin.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from math import cos, pi, radians, sin

import numpy as np

from avatarsim.scene.body import Body
from avatarsim.scene.checks import Quaternion, Vector
from avatarsim.scene.shape import Box, Capsule, ConvexHull, Piece, Shape, Sphere
from reference.closed_form import bounce_state, stop_distance, stop_time
from scenarios.building.cases import LAID, NOWHERE, Solid, fixture, laws, loose, turned_by
from scenarios.building.expected import Course, OfFloat, Stop, ball_to_roll, slides_to_roll, slides_to_stop
from scenarios.building.promises import SOUND
from scenarios.building.scenes import above, each_alone, undriven
from scenarios.scenario import Bound

SPEED, FRICTION, GRAVITY = 2.0, 0.5, 9.81
"""First speed [m/s] of all that slide or roll, friction on floors, gravity [m/s^2]."""
BOX, RADIUS, THICK = (0.3, 0.3, 0.1), 0.1, 0.2
"""Edges of boxes that slide, radius of balls and logs, thickness of floors [m]."""
WAY, BY = stop_distance(SPEED, FRICTION, GRAVITY), stop_time(SPEED, FRICTION, GRAVITY)
SLID, SLIDES = slides_to_stop(SPEED, FRICTION, GRAVITY)
ROLLED, ROLLS = ball_to_roll(SPEED, FRICTION, GRAVITY)
FREE = slides_to_roll(SPEED, FRICTION * GRAVITY, 0.0, 0.0, SPEED)
"""Ways and speeds by time of a box, of a ball that begins without spin, and of one that rolls from the start."""
START = -1.5
"""Where all begin along x on floors of stones [m]; a ball that rolls gets to 1.5 m in the time of the scene."""
LONG = 5.0
"""Length of floors of stones [m]."""

WIDE, LANE = 2.0, 2.4
"""Width of every floor of `seams`, and the distance of neighbouring floors [m]."""
STONES = {"rows": (12, 1), "leaning": (12, 1), "chequered": (12, 4), "fine": (64, 1)}
"""Stones along and across each floor. The last has a seam every eight centimetres: up to six under a box at once."""
LEAN = 0.12
"""Offset of a leaning seam at the sides of its floor [m], to and fro from seam to seam."""
THREE = tuple(Piece(Box((0.1, 0.3, 0.1)), (x, 0.0, 0.0)) for x in (-0.1, 0.0, 0.1))
"""A box like the others in three pieces: seams above and below."""
PILE = ("bottom", "middle", "top")
"""Three boxes on one another on the fine floor: they slide as one, for they hold one another by more than the floor does."""


@dataclass(frozen=True)
class Slider:
    """A body that slides: its floor, its shape, how high it lies [m], how it is turned, the angle of its way [rad]."""

    floor: str
    shape: Solid = Box(BOX)
    height: float = 0.5 * BOX[2]
    turned: Quaternion = (1.0, 0.0, 0.0, 0.0)
    way: float = 0.0


SLIDERS = {
    "straight": Slider("rows"),
    "turned": Slider("rows", turned=turned_by((0.0, 0.0, 1.0), 0.5)),
    "leaning": Slider("leaning"),
    "pieces": Slider("leaning", THREE, turned=turned_by((0.0, 0.0, 1.0), 0.3)),
    "askew": Slider("chequered", turned=turned_by((0.0, 0.0, 1.0), 0.2), way=radians(22.5)),
    "log": Slider("chequered", Capsule(RADIUS, 0.4), RADIUS, turned_by((0.0, 1.0, 0.0), 0.5 * pi)),
    **{name: Slider("fine", height=(k + 0.5) * BOX[2]) for k, name in enumerate(PILE)},
}
ROLLERS = {"skids": 0.0, "rolls": SPEED / RADIUS}
"""Balls on the floor in rows, by their first spin [rad/s]."""


def lane(floor: str) -> float:
    """Return the middle of a floor along y [m]."""
    return LANE * (list(STONES).index(floor) - 1)


def side(name: str) -> float:
    """Return where a body begins along y [m], none in the way of another."""
    if name in PILE:
        return lane("fine")
    if name in ROLLERS:
        return lane("rows") + (-0.8 if name == "rolls" else 0.8)
    others = [other for other in SLIDERS if SLIDERS[other].floor == SLIDERS[name].floor]
    return lane(SLIDERS[name].floor) + (-0.35, 0.35)[others.index(name)]


def stone(floor: str, k: int, i: int) -> tuple[Shape, Vector]:
    """Return stone i abreast of stone k along a floor, and where it lies on that floor."""
    count, abreast = STONES[floor]
    if floor == "leaning":
        x = np.linspace(-0.5 * LONG, 0.5 * LONG, count + 1)
        corners = [(float(x[j]) + s * LEAN * (-1) ** j, 0.5 * s * WIDE) for j in (k, k + 1) for s in (-1, 1)]
        return ConvexHull(np.array([(*corner, z) for corner in corners for z in (-THICK, 0.0)])), NOWHERE
    long, wide = LONG / count, WIDE / abreast
    return Box((long, wide, THICK)), ((k + 0.5) * long - 0.5 * LONG, (i + 0.5) * wide - 0.5 * WIDE, -0.5 * THICK)


def over_stones() -> Iterator[Body]:
    """Yield four floors of stones, and the bodies that slide and roll over them."""
    for floor, (count, abreast) in STONES.items():
        for k in range(count):
            for i in range(abreast):
                shape, (x, y, z) = stone(floor, k, i)
                yield fixture(f"{floor}_{k}_{i}", shape, "stone", (x, y + lane(floor), z))
    for name, it in SLIDERS.items():
        at = (START, side(name), it.height + LAID * (1 + (PILE.index(name) if name in PILE else 0)))
        yield loose(name, it.shape, "thing", 1.0, at, it.turned, (SPEED * cos(it.way), SPEED * sin(it.way), 0.0))
    for name, spin in ROLLERS.items():
        at = (START, side(name), RADIUS + LAID)
        yield loose(name, Sphere(RADIUS), "thing", 1.0, at, velocity=(SPEED, 0.0, 0.0), spin=(0.0, spin, 0.0))


def along(name: str, height: float, angle: float, way: OfFloat, speed: OfFloat) -> Course:
    """Return the place and velocity of a body that goes straight on, at an `angle` [rad] from the x axis."""
    x, y = cos(angle), sin(angle)
    return Course(
        name, lambda t: (START + way(t) * x, side(name) + way(t) * y, height), lambda t: (speed(t) * x, speed(t) * y, 0.0)
    )


CUTS: dict[str, list[float]] = {str(n): [-2.0 + 4.0 * k / n for k in range(n + 1)] for n in (1, 2, 8, 64)}
CUTS["slivers"] = sorted([*(edges := [-2.0 + 4.0 * k / 16 for k in range(17)]), *(edge + 1e-4 for edge in edges[:-1])])
"""Where each floor is cut along x, its ends included [m]; thin pieces are a two-thousandth as wide as high."""
HEIGHT, RESTITUTION = 0.5, 0.5
"""Height of the ball that bounces on a seam [m], and its restitution."""
CUT_LANES = {name: 1.5 * (k - 2) for k, name in enumerate(CUTS)}


def over_cuts() -> Iterator[Body]:
    """Yield five floors side by side; on each a box slides, a ball bounces on a seam, and a ball slides until it rolls."""
    for name, y in CUT_LANES.items():
        pieces = tuple(
            Piece(Box((b - a, 1.0, THICK)), (0.5 * (a + b), 0.0, 0.0)) for a, b in zip(CUTS[name], CUTS[name][1:], strict=False)
        )
        yield fixture(f"floor_{name}", pieces, "floor", (0.0, y, -0.5 * THICK))
        at = (-1.0, y - 0.3, 0.5 * BOX[2] + LAID)
        yield loose(f"slides_{name}", Box(BOX), "box", 1.0, at, velocity=(SPEED, 0.0, 0.0))
        yield loose(f"bounces_{name}", Sphere(RADIUS), "ball", 1.0, (0.0, y, RADIUS + HEIGHT))
        at = (-0.5, y + 0.3, RADIUS + LAID)
        yield loose(f"rolls_{name}", Sphere(RADIUS), "cloth", 1.0, at, velocity=(SPEED, 0.0, 0.0))


def cut_courses(name: str, y: float) -> tuple[Course, ...]:
    """Return where the three bodies on a floor are at any time, whatever its pieces."""
    return (
        Course(f"slides_{name}", lambda t: (-1.0 + SLID(t), y - 0.3, 0.5 * BOX[2])),
        Course(f"bounces_{name}", lambda t: (0.0, y, RADIUS + bounce_state(HEIGHT, RESTITUTION, GRAVITY, t)[0])),
        Course(f"rolls_{name}", lambda t: (-0.5 + ROLLED(t), y + 0.3, RADIUS)),
    )


CUT_COURSES = tuple(course for name, y in CUT_LANES.items() for course in cut_courses(name, y))

STEPS, STEP, EVEN = 64, 1e-6, -1.2
"""Stones along a worn floor, how much lower each is than the last, and up to where along x all are level [m]."""
WORN = {f"{turn}_on_{kind}": (angle, kind) for kind in ("one", "many") for turn, angle in (("straight", 0.0), ("turned", 0.5))}
"""Turn of the box [rad], and a floor of one body or of a body for each stone."""


def over_steps() -> Iterator[Body]:
    """Yield four floors side by side, a box on each."""
    long, down, steps = LONG / STEPS, 0, list[Piece]()
    for k in range(STEPS):
        x = (k + 0.5) * long - 0.5 * LONG
        down += 1 if x > EVEN else 0
        steps.append(Piece(Box((long, 0.8, THICK)), (x, 0.0, -0.5 * THICK - STEP * down)))
    for row, (name, (angle, kind)) in enumerate(WORN.items()):
        y = row - 1.5
        if kind == "one":
            yield fixture(f"one_{y:g}", tuple(steps), "stone", (0.0, y, 0.0))
        else:
            yield from (fixture(f"many_{y:g}_{k}", step, "stone", (0.0, y, 0.0)) for k, step in enumerate(steps))
        at = (START, y, 0.5 * BOX[2] + LAID)
        yield loose(name, Box(BOX), "box", 1.0, at, turned_by((0.0, 0.0, 1.0), angle), (SPEED, 0.0, 0.0))


SCENARIOS = (
    undriven(
        "seams", "Boxes, a pile of them, balls and a log slide and roll over floors of stones laid side by side.",
        "Place and velocity at every frame; how far, and how straight.", over_stones,
        laws({("thing", "stone"): (0.0, FRICTION), ("thing", "thing"): (0.0, 0.9)}), frames=90,
        bounds=(
            *SOUND, Bound("course_error_max", 3e-6, "the closed forms know of no seams; a micrometre for each box of the pile"),
            Bound("velocity_error_max", 2e-6, "no body is thrown, braked or turned aside by a seam"),
            Bound("stop_distance_error_max", 0.01, "v^2 / (2 mu g) to a ten-thousandth, as on one piece"),
            Bound("stop_direction_error_max", 0.01, "a seam across the way at any angle pushes no body aside"),
            Bound("energy_gain_max", 1e-9, "a seam adds no energy"),
        ),
        regions=(above(0.0, *SLIDERS, *ROLLERS, reason="nothing falls between the stones"),),
        expects={
            "courses": (
                *(along(name, it.height, it.way, SLID, SLIDES) for name, it in SLIDERS.items()),
                along("skids", RADIUS, 0.0, ROLLED, ROLLS), along("rolls", RADIUS, 0.0, *FREE),
            ),
            "stops": tuple(Stop(name, WAY, (cos(it.way), sin(it.way), 0.0), BY) for name, it in SLIDERS.items()),
            "alone": (PILE, *each_alone(name for name in (*SLIDERS, *ROLLERS) if name not in PILE)),
        },
    ),
    undriven(
        "split_invariance",
        "Boxes slide and balls bounce and roll over the same floor cut into 1 to 64 pieces, and into slivers.",
        "Whether a seam changes any motion.", over_cuts,
        laws({(name, "floor"): (e, FRICTION) for name, e in (("box", 0.0), ("ball", RESTITUTION), ("cloth", 0.0))}),
        frames=75,
        bounds=(
            *SOUND, Bound("course_error_max", 2e-6, "the closed forms know of no seams; the rest is the gap of laid bodies"),
            Bound("energy_gain_max", 1e-9, "a seam adds no energy"),
        ),
        regions=(above(0.0, "slides_*", "bounces_*", "rolls_*", reason="no floor has a gap"),),
        expects={"courses": CUT_COURSES, "alone": each_alone(course.body for course in CUT_COURSES)},
    ),
    undriven(
        "worn_floor", "Boxes slide over floors whose stones are a micrometre lower one after another.",
        # at 60 frames per second the end of the last slip is found to a fifth of a millimetre only
        "How far, and how straight.", over_steps, laws({("stone", "box"): (0.0, FRICTION)}), frames=120, dt=1.0 / 240,
        bounds=(
            *SOUND, Bound("stop_distance_error_max", 0.01, "v^2 / (2 mu g) to a ten-thousandth; steps are a quarter of that"),
            Bound("stop_direction_error_max", 0.01, "no step is higher on one side than on the other"),
            Bound("energy_gain_max", 1e-9, "a step gives what the box was higher, and no more"),
        ),
        regions=(above(0.0, *WORN, reason="nothing falls between the stones"),),
        expects={"stops": tuple(Stop(name, WAY, (1.0, 0.0, 0.0), BY) for name in WORN), "alone": each_alone(WORN)},
    ),
)
