"""Internal edges of floors made of bodies: what slides or rolls across the seams goes as far as on one piece.

`split_invariance` cuts one body, straight across the way. Here every stone is a body of its own, seams lean or cross, the way
leads over them at an angle, and what slides is of pieces itself or carries others. Closed forms: v^2 / (2 mu g), 5/7 v for a ball
that begins without spin, and v for ever for one that rolls from the start.
"""

from dataclasses import dataclass
from math import cos, pi, radians, sin

import numpy as np

from avatarsim.scene.body import Body, ContactLaw, fixed, simulated, solid
from avatarsim.scene.checks import Quaternion, Vector
from avatarsim.scene.scene import Scene
from avatarsim.scene.shape import Box, Capsule, ConvexHull, Piece, Shape, Sphere
from reference.closed_form import roll_distance, roll_speed, roll_time, stop_distance, stop_time
from scenarios.building.cases import LAID, NOWHERE, pair_table, turned_by
from scenarios.building.expected import Course, Stop
from scenarios.building.promises import FINITE, NO_OVERLAP, RIGHT_SIDE
from scenarios.motion.untracked import untracked
from scenarios.scenario import INFINITE, Bound, Region, Scenario

SPEED, FRICTION, GRAVITY, MASS = 2.0, 0.5, 9.81, 1.0
"""First speed [m/s], friction of all bodies on the stones, gravity [m/s^2], mass of each that moves [kg]."""
LONG, WIDE, THICK, LANE = 5.0, 2.0, 0.2, 2.4
"""Edges of every floor [m], and the distance of neighbouring floors [m]."""
START = -1.5
"""Where all begin along x [m]; a ball that rolls gets to 1.5 m in the time of the scene."""
STONES = {"rows": 12, "leaning": 12, "chequered": 12, "fine": 64}
"""Stones along each floor. The last has a seam every eight centimetres: up to six under a box at once."""
ABREAST = {"chequered": 4}
"""Stones across a floor, where these are more than one."""
LEAN = 0.12
"""How far a leaning seam is off at the sides of its floor [m], to and fro from seam to seam."""
BOX, RADIUS, AXIS = (0.3, 0.3, 0.1), 0.1, 0.4
"""Edges of what slides, radius of what rolls, length of the axis of the log [m]."""
ALONG = turned_by((0.0, 1.0, 0.0), 0.5 * pi)
"""A capsule's axis along x."""
THREE = tuple(Piece(Box((0.1, 0.3, 0.1)), (x, 0.0, 0.0)) for x in (-0.1, 0.0, 0.1))
"""The same box in three pieces: seams above and below."""
PILE = ("bottom", "middle", "top")
"""Three boxes on one another on the fine floor: they slide as one, for they hold one another by more than the floor does."""
CLINGS = 0.9
"""Friction among them."""


@dataclass(frozen=True)
class Slider:
    """A body that slides: its floor, its pieces, how high it lies [m], how it is turned, and the angle of its way [rad]."""

    floor: str
    pieces: tuple[Piece, ...]
    height: float
    turned: Quaternion = (1.0, 0.0, 0.0, 0.0)
    way: float = 0.0


SLIDERS = {
    "straight": Slider("rows", (Piece(Box(BOX)),), 0.5 * BOX[2]),
    "turned": Slider("rows", (Piece(Box(BOX)),), 0.5 * BOX[2], turned_by((0.0, 0.0, 1.0), 0.5)),
    "leaning": Slider("leaning", (Piece(Box(BOX)),), 0.5 * BOX[2]),
    "pieces": Slider("leaning", THREE, 0.5 * BOX[2], turned_by((0.0, 0.0, 1.0), 0.3)),
    "askew": Slider("chequered", (Piece(Box(BOX)),), 0.5 * BOX[2], turned_by((0.0, 0.0, 1.0), 0.2), radians(22.5)),
    "log": Slider("chequered", (Piece(Capsule(RADIUS, AXIS)),), RADIUS, ALONG),
    **{name: Slider("fine", (Piece(Box(BOX)),), (k + 0.5) * BOX[2]) for k, name in enumerate(PILE)},
}
ROLLERS = {"skids": 0.0, "rolls": SPEED / RADIUS}
"""Balls on the floor in rows, by their first spin [rad/s]."""


def lane(floor: str) -> float:
    """Middle of a floor along y [m]."""
    return LANE * (list(STONES).index(floor) - 1)


def side(name: str) -> float:
    """Where a body begins along y [m], none in the way of another."""
    if name in PILE:
        return lane("fine")
    if name in ROLLERS:
        return lane("rows") + (-0.8 if name == "rolls" else 0.8)
    others = [other for other in SLIDERS if SLIDERS[other].floor == SLIDERS[name].floor]
    return lane(SLIDERS[name].floor) + (-0.35, 0.35)[others.index(name)]


def leaning(k: int) -> tuple[Shape, Vector]:
    """Stone k of the floor whose seams lean to and fro, and where it lies on that floor."""
    x = np.linspace(-0.5 * LONG, 0.5 * LONG, STONES["leaning"] + 1)
    corners = [(float(x[i]) + s * LEAN * (-1) ** i, 0.5 * s * WIDE) for i in (k, k + 1) for s in (-1, 1)]
    return ConvexHull(np.array([(*corner, z) for corner in corners for z in (-THICK, 0.0)])), NOWHERE


def upright(floor: str, k: int, i: int) -> tuple[Shape, Vector]:
    """Stone i abreast of stone k along a floor whose seams are square, and where it lies on that floor."""
    long, wide = LONG / STONES[floor], WIDE / ABREAST.get(floor, 1)
    return Box((long, wide, THICK)), ((k + 0.5) * long - 0.5 * LONG, (i + 0.5) * wide - 0.5 * WIDE, -0.5 * THICK)


def stones(floor: str) -> list[Body]:
    """Fixed bodies side by side, all tops at z = 0."""
    found: list[Body] = []
    for k in range(STONES[floor]):
        for i in range(ABREAST.get(floor, 1)):
            shape, at = leaning(k) if floor == "leaning" else upright(floor, k, i)
            found.append(fixed(f"{floor}_{k}_{i}", (Piece(shape),), "stone", (at[0], at[1] + lane(floor), at[2])))
    return found


def direction(way: float) -> Vector:
    """Unit vector at an angle [rad] from the x axis."""
    return cos(way), sin(way), 0.0


def build() -> Scene:
    """Four floors of stones, and the bodies that slide and roll over them."""
    bodies = [stone for floor in STONES for stone in stones(floor)]
    for name, it in SLIDERS.items():
        x, y, _ = direction(it.way)
        at = (START, side(name), it.height + LAID * (1 + (PILE.index(name) if name in PILE else 0)))
        bodies.append(simulated(name, it.pieces, "thing", solid(it.pieces, MASS), at, it.turned, (SPEED * x, SPEED * y, 0.0)))
    ball = (Piece(Sphere(RADIUS)),)
    for name, spin in ROLLERS.items():
        at = (START, side(name), RADIUS + LAID)
        bodies.append(simulated(
            name, ball, "thing", solid(ball, MASS), at, velocity=(SPEED, 0.0, 0.0), angular_velocity=(0.0, spin, 0.0)
        ))
    stated = {("thing", "stone"): ContactLaw(0.0, FRICTION), ("thing", "thing"): ContactLaw(0.0, CLINGS)}
    return Scene("seams", tuple(bodies), materials=pair_table(("thing", "stone"), stated))


def sliding(name: str) -> Course:
    """Place and velocity of a slider at any time."""
    it, ends = SLIDERS[name], stop_time(SPEED, FRICTION, GRAVITY)
    x, y, _ = direction(it.way)

    def left(time: float) -> float:
        return max(0.0, 1.0 - time / ends)

    def position(time: float) -> Vector:
        way = stop_distance(SPEED, FRICTION, GRAVITY) * (1.0 - left(time) ** 2)
        return START + way * x, side(name) + way * y, it.height

    def velocity(time: float) -> Vector:
        return SPEED * left(time) * x, SPEED * left(time) * y, 0.0

    return Course(name, position, velocity)


def rolling(name: str) -> Course:
    """Place and velocity of a ball at any time."""
    skids = ROLLERS[name] == 0.0
    begins, end = (roll_time(SPEED, FRICTION, GRAVITY), roll_speed(SPEED)) if skids else (0.0, SPEED)
    way = roll_distance(SPEED, FRICTION, GRAVITY) if skids else 0.0

    def position(time: float) -> Vector:
        slid = SPEED * time - 0.5 * FRICTION * GRAVITY * time * time
        return START + (slid if time < begins else way + end * (time - begins)), side(name), RADIUS

    def velocity(time: float) -> Vector:
        return SPEED - FRICTION * GRAVITY * time if time < begins else end, 0.0, 0.0

    return Course(name, position, velocity)


SCENARIO = Scenario(
    name="seams",
    title="Boxes, a pile of them, balls and a log slide and roll over floors of stones laid side by side.",
    judged="Place and velocity at every frame; how far, and how straight.",
    build=build,
    motion=untracked(),
    frames=90,
    bounds=(
        NO_OVERLAP, RIGHT_SIDE, FINITE,
        Bound("course_error_max", 3e-6, "the closed forms know nothing of seams; a micrometre for each box of the pile"),
        Bound("velocity_error_max", 2e-6, "no body is thrown, braked or turned aside by a seam; a ball keeps what it rolls with"),
        Bound("stop_distance_error_max", 0.01, "v^2 / (2 mu g) to a ten-thousandth, as on one piece"),
        Bound("stop_direction_error_max", 0.01, "a seam across the way at any angle pushes no body aside"),
        Bound("energy_gain_max", 1e-9, "a seam adds no energy"),
    ),
    regions=(Region((*SLIDERS, *ROLLERS), (-INFINITE, -INFINITE, 0.0), (INFINITE,) * 3, "nothing falls between the stones"),),
    expects={
        "courses": (*map(sliding, SLIDERS), *map(rolling, ROLLERS)),
        "stops": tuple(
            Stop(name, stop_distance(SPEED, FRICTION, GRAVITY), direction(it.way), stop_time(SPEED, FRICTION, GRAVITY))
            for name, it in SLIDERS.items()
        ),
        "alone": (PILE, *((name,) for name in (*SLIDERS, *ROLLERS) if name not in PILE)),
    },
)
