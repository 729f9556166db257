"""Rings, channels and angles of convex pieces are hollow for bodies that fall through them, and on those on which they fall.

A ball falls through a fixed ring, one to the bottom of a channel, one into the notch of an angle; a ring falls over a post, a
channel over a bar. None of these touches a convex hull's inside; closed forms: free fall, and the bounces of `bounce_ladder`. A
ring, a channel and an angle are dropped tumbling onto the floor: they add no energy, and nothing goes through anything.
"""

from collections.abc import Iterator
from math import pi

import numpy as np

from avatarsim.scene.body import Body
from avatarsim.scene.checks import Vector
from avatarsim.scene.shape import Box, ConvexHull, Piece, Sphere
from reference.closed_form import bounce_state
from scenarios.building.cases import fixture, laws, loose, slab, turned_by
from scenarios.building.expected import Course, OfTime
from scenarios.building.promises import NO_ENERGY, SOUND
from scenarios.building.scenes import above, each_alone, undriven
from scenarios.scenario import Bound

BALL = 0.1
"""Radius of the balls [m]."""
OUTER, INNER, SEGMENTS = 0.3, 0.18, 16
"""Radii of the ring's segments [m], which run straight, and how many there are; their hole still lets 0.176 m through."""
BAR, WIDE, LONG = 0.06, 0.4, 0.5
"""Thickness of rings, channels and angles, inner width of a channel, and length of channel and angle [m]."""
HEIGHT, RESTITUTION, HIGH = 0.5, 0.5, 1.2
"""Fall of all that bounce or land [m], restitution of balls on the bottoms that they meet, height of the fixed ring [m]."""


def ring() -> tuple[Piece, ...]:
    """Return sixteen straight segments about z."""
    angles = 2.0 * pi * np.arange(SEGMENTS + 1) / SEGMENTS
    corners = [[r * np.cos(a), r * np.sin(a), z] for a in angles for r in (INNER, OUTER) for z in (-0.5 * BAR, 0.5 * BAR)]
    return tuple(Piece(ConvexHull(np.array(corners[4 * k : 4 * k + 8]))) for k in range(SEGMENTS))


def channel() -> tuple[Piece, ...]:
    """Return a U that is open above, its bottom's upper face at z = 0, along y."""
    sides = (Piece(Box((BAR, LONG, WIDE)), (side * 0.5 * (WIDE + BAR), 0.0, 0.5 * WIDE)) for side in (-1.0, 1.0))
    return (Piece(Box((WIDE + 2.0 * BAR, LONG, BAR)), (0.0, 0.0, -0.5 * BAR)), *sides)


def angle() -> tuple[Piece, ...]:
    """Return an L, its lower arm's upper face at z = 0."""
    return (
        Piece(Box((WIDE, LONG, BAR)), (0.0, 0.0, -0.5 * BAR)),
        Piece(Box((BAR, LONG, WIDE)), (-0.5 * (WIDE - BAR), 0.0, 0.5 * WIDE)),
    )


LANDS: dict[str, tuple[Vector, float, float]] = {
    "through_ring": ((-6.0, 0.0, HIGH + HEIGHT), HIGH + HEIGHT - BALL, RESTITUTION),
    "in_channel": ((-4.05, 0.0, HIGH + BALL + HEIGHT), HEIGHT, RESTITUTION),
    "in_angle": ((-1.98, 0.0, HIGH + BALL + HEIGHT), HEIGHT, RESTITUTION),
    "hoop": ((0.01, 0.0, 0.5 * BAR + HEIGHT), HEIGHT, 0.0), "staple": ((2.02, 0.0, WIDE + HEIGHT), HEIGHT, 0.0),
}
"""Bodies that meet nothing on the way, and land: first place, way down [m] and restitution."""
PROFILES = {"ring": ring(), "channel": channel(), "angle": angle()}
TUMBLING = tuple(f"tumbling_{name}" for name in PROFILES)


def bodies() -> Iterator[Body]:
    """Yield eight stations along x, two metres apart, on one floor."""
    places = {name: place for name, (place, _, _) in LANDS.items()}
    yield slab(30.0, 6.0)
    for k, (name, ball) in enumerate(zip(PROFILES, ("through_ring", "in_channel", "in_angle"), strict=True)):
        yield fixture(name, PROFILES[name], "fixed", (2.0 * k - 6.0, 0.0, HIGH))
        yield loose(ball, Sphere(BALL), "ball", 1.0, places[ball])
    yield fixture("post", Box((0.2, 0.2, 0.4)), "fixed", (0.0, 0.0, 0.2))
    yield loose("hoop", PROFILES["ring"], "ring", 1.0, places["hoop"])
    yield fixture("beam", Box((0.3, 2.0, 0.2)), "fixed", (2.0, 0.0, 0.1))
    yield loose("staple", PROFILES["channel"], "channel", 1.0, places["staple"], turned_by((1.0, 0.0, 0.0), pi))
    for k, (name, pieces) in enumerate(PROFILES.items()):
        yield loose(f"tumbling_{name}", pieces, name, 1.0, (4.0 + 2.0 * k, 0.0, 1.0), turned_by((1.0, 2.0 - k, 0.5), 0.7))


def falls(start: Vector, way: float, restitution: float) -> OfTime:
    """Return a fall from rest by `way` [m], and the bounces or rest after it."""
    return lambda time: (start[0], start[1], start[2] - way + bounce_state(way, restitution, 9.81, time)[0])


SCENARIO = undriven(
    "non_convex",
    "Balls fall through a ring, into a channel and an angle; a ring falls over a post, a staple over a bar; three tumble.",
    "Whether what is hollow is hollow; energy of those that tumble.", bodies,
    laws({
        **{("ball", ground): (RESTITUTION, 0.0) for ground in ("fixed", "floor")},
        **{(name, ground): (0.0, 0.5) for name in PROFILES for ground in ("floor", "fixed")},
    }),
    frames=120,
    bounds=(
        *SOUND, Bound("course_error_max", 1e-6, "none of these touches anything before landing; apexes are 2e-8 m off"),
        NO_ENERGY, Bound("travel_missing", 0.0, "those that tumble come down"),
    ),
    regions=(above(-0.1, "through_ring", "in_*", "hoop", "staple", "tumbling_*"),),
    expects={
        "courses": tuple(Course(name, falls(*fall)) for name, fall in LANDS.items()), "alone": each_alone((*LANDS, *TUMBLING)),
        "travel": dict.fromkeys(TUMBLING, 0.5),
    },
)
