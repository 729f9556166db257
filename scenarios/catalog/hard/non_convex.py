"""Non-convex bodies of convex pieces: rings, channels and angles are hollow for what falls through them and on what they fall.

A ball falls through a fixed ring, one to the bottom of a channel, one into the notch of an angle. A ring falls over a post, a
channel over a bar, as a staple does. None of these touches what its convex hull would hit; closed forms: free fall, and the
bounces of `bounce_ladder`. Beside them a ring, a channel and an angle are dropped tumbling onto the floor: they add no energy,
and nothing goes through anything.
"""

from math import pi

import numpy as np

from avatarsim.scene.body import Body, ContactLaw, fixed, simulated, solid
from avatarsim.scene.checks import Vector
from avatarsim.scene.scene import Scene
from avatarsim.scene.shape import Box, ConvexHull, Piece, Sphere
from reference.closed_form import bounce_state
from scenarios.building.cases import pair_table, turned_by
from scenarios.building.expected import Course, OfTime
from scenarios.building.promises import FINITE, NO_OVERLAP, RIGHT_SIDE
from scenarios.motion.untracked import untracked
from scenarios.scenario import INFINITE, Bound, Region, Scenario

GRAVITY, MASS, BALL = 9.81, 1.0, 0.1
"""[m/s^2], mass of all [kg], radius of the balls [m]."""
OUTER, INNER, SEGMENTS = 0.3, 0.18, 16
"""Radii of the ring's segments [m], which run straight, and how many there are; their hole still lets 0.176 m through."""
BAR = 0.06
"""Thickness of rings, channels and angles [m]."""
WIDE, LONG = 0.4, 0.5
"""Inner width of a channel and length of channel and angle [m]."""
HEIGHT, RESTITUTION = 0.5, 0.5
"""Fall of all that bounce, or land [m]; restitution of balls on the bottoms that they meet."""
HIGH = 1.2
"""Height of the fixed ring [m]."""


def ring() -> tuple[Piece, ...]:
    """Sixteen straight segments about z."""
    angles = 2.0 * pi * np.arange(SEGMENTS + 1) / SEGMENTS
    corners = [[r * np.cos(a), r * np.sin(a), z] for a in angles for r in (INNER, OUTER) for z in (-0.5 * BAR, 0.5 * BAR)]
    return tuple(Piece(ConvexHull(np.array(corners[4 * k : 4 * k + 8]))) for k in range(SEGMENTS))


def channel() -> tuple[Piece, ...]:
    """A U that is open above, its bottom's upper face at z = 0, along y."""
    sides = (Piece(Box((BAR, LONG, WIDE)), (side * 0.5 * (WIDE + BAR), 0.0, 0.5 * WIDE)) for side in (-1.0, 1.0))
    return (Piece(Box((WIDE + 2.0 * BAR, LONG, BAR)), (0.0, 0.0, -0.5 * BAR)), *sides)


def angle() -> tuple[Piece, ...]:
    """An L, its lower arm's upper face at z = 0."""
    return (
        Piece(Box((WIDE, LONG, BAR)), (0.0, 0.0, -0.5 * BAR)),
        Piece(Box((BAR, LONG, WIDE)), (-0.5 * (WIDE - BAR), 0.0, 0.5 * WIDE)),
    )


def build() -> Scene:
    """Eight stations along x, two metres apart, on one floor."""
    ball, mass = (Piece(Sphere(BALL)),), solid((Piece(Sphere(BALL)),), MASS)
    post, beam = (Piece(Box((0.2, 0.2, 0.4))),), (Piece(Box((0.3, 2.0, 0.2))),)
    hoop, staple = ring(), channel()
    over = turned_by((1.0, 0.0, 0.0), pi)
    bodies: list[Body] = [
        fixed("floor", (Piece(Box((30.0, 6.0, 0.2))),), "floor", (0.0, 0.0, -0.1)),
        fixed("ring", hoop, "fixed", (-6.0, 0.0, HIGH)),
        simulated("through_ring", ball, "ball", mass, (-6.0, 0.0, HIGH + HEIGHT)),
        fixed("channel", staple, "fixed", (-4.0, 0.0, HIGH)),
        simulated("in_channel", ball, "ball", mass, (-4.05, 0.0, HIGH + BALL + HEIGHT)),
        fixed("angle", angle(), "fixed", (-2.0, 0.0, HIGH)),
        simulated("in_angle", ball, "ball", mass, (-1.98, 0.0, HIGH + BALL + HEIGHT)),
        fixed("post", post, "fixed", (0.0, 0.0, 0.2)),
        simulated("hoop", hoop, "ring", solid(hoop, MASS), (0.01, 0.0, 0.5 * BAR + HEIGHT)),
        fixed("beam", beam, "fixed", (2.0, 0.0, 0.1)),
        simulated("staple", staple, "channel", solid(staple, MASS), (2.02, 0.0, WIDE + HEIGHT), over),
    ]
    for k, (name, pieces) in enumerate({"ring": hoop, "channel": staple, "angle": angle()}.items()):
        turn = turned_by((1.0, 2.0 - k, 0.5), 0.7)
        bodies.append(simulated(f"tumbling_{name}", pieces, name, solid(pieces, MASS), (4.0 + 2.0 * k, 0.0, 1.0), turn))
    names = ("floor", "fixed", "ball", "ring", "channel", "angle")
    stated = {("ball", "fixed"): ContactLaw(RESTITUTION, 0.0), ("ball", "floor"): ContactLaw(RESTITUTION, 0.0)}
    stated |= {(name, "floor"): ContactLaw(0.0, 0.5) for name in ("ring", "channel", "angle")}
    stated |= {(name, "fixed"): ContactLaw(0.0, 0.5) for name in ("ring", "channel", "angle")}
    return Scene("non_convex", tuple(bodies), materials=pair_table(names, stated))


def falls(start: Vector, way: float, restitution: float) -> OfTime:
    """From rest down by `way` [m], and what comes then."""
    return lambda time: (start[0], start[1], start[2] - way + bounce_state(way, restitution, GRAVITY, time)[0])


def courses() -> tuple[Course, ...]:
    """Bodies that meet nothing on the way, and land."""
    starts = {body.name: body.position for body in build().bodies}
    ways = {
        "through_ring": (HIGH + HEIGHT - BALL, RESTITUTION), "in_channel": (HEIGHT, RESTITUTION),
        "in_angle": (HEIGHT, RESTITUTION), "hoop": (HEIGHT, 0.0), "staple": (HEIGHT, 0.0),
    }
    return tuple(Course(name, falls(starts[name], *way)) for name, way in ways.items())


TUMBLING = ("tumbling_ring", "tumbling_channel", "tumbling_angle")

SCENARIO = Scenario(
    name="non_convex",
    title="Balls fall through a ring, into a channel and an angle; a ring falls over a post, a staple over a bar; three tumble.",
    judged="Whether what is hollow is hollow; energy of those that tumble.",
    build=build,
    motion=untracked(),
    frames=120,
    bounds=(
        NO_OVERLAP, RIGHT_SIDE, FINITE,
        Bound("course_error_max", 1e-6, "none of these touches anything before landing; apexes are 2e-8 m off"),
        Bound("energy_gain_max", 1e-9, "no bounce adds energy, whatever the shape"),
        Bound("travel_missing", 0.0, "those that tumble come down"),
    ),
    regions=(
        Region(
            ("through_ring", "in_*", "hoop", "staple", "tumbling_*"), (-INFINITE, -INFINITE, -0.1), (INFINITE,) * 3,
            "nothing falls through the floor",
        ),
    ),
    expects={
        "courses": courses(),
        "alone": tuple((name,) for name in ("through_ring", "in_channel", "in_angle", "hoop", "staple", *TUMBLING)),
        "travel": dict.fromkeys(TUMBLING, 0.5),
    },
)
