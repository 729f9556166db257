"""Deep overlap: a driven ball is led into the very centres of fixed bodies, and bodies or a hand begin in others.

An engine that divides by the distance of centres loses its numbers there. A start that overlaps begins at the nearest free
places, from the first state on, and without a velocity; an engine may refuse it as well, with the pairs and their depths.
"""

from collections.abc import Callable, Iterator

import numpy as np

from avatarsim.scene.body import Body
from avatarsim.scene.checks import Vector
from avatarsim.scene.scene import Scene
from avatarsim.scene.shape import Box, Capsule, ConvexHull, Ellipsoid, Shape, Sphere
from scenarios.building.avatars.hand import PALM, rigid_hand
from scenarios.building.cases import NOWHERE, driven, fixture, loose
from scenarios.building.promises import FINITE, FOLLOWS_WHEN_FREE, MOVES, NO_OVERLAP
from scenarios.building.scenes import undriven
from scenarios.motion.rigid_hands import hands_at, led, led_through
from scenarios.scenario import REFUSAL, Bound, Scenario

RADIUS, APART, FRAMES = 0.1, 0.7, 330
"""Radius of the user's ball and half the size of everything else, distance of the fixed bodies [m]."""
CORNERS = np.array([[x, y, z] for x in (-1.0, 1.0) for y in (-1.0, 1.0) for z in (-1.0, 1.0)])
SHAPES: dict[str, Shape] = {
    "sphere": Sphere(RADIUS), "capsule": Capsule(RADIUS, RADIUS), "box": Box((2.0 * RADIUS,) * 3),
    "ellipsoid": Ellipsoid((RADIUS, 0.8 * RADIUS, 1.2 * RADIUS)), "hull": ConvexHull(RADIUS * CORNERS),
}
SPARE = 5e-4
"""[m] beyond the nearest place: more than the gap that an engine keeps between bodies."""
EDGE, DEPTHS = 0.2, (0.01, 0.05, 0.1, 0.2)
"""Edge of the boxes, and by how much they overlap [m]; the last two are in the same place."""


def build() -> Scene:
    """Return five fixed bodies in a row along y, and a driven ball next to the first."""
    bodies = tuple(fixture(name, shape, "wood", (0.0, APART * k, 0.0)) for k, (name, shape) in enumerate(SHAPES.items()))
    return Scene("coincident_centres", bodies, (driven("ball", Sphere(RADIUS), 0.5),), start=hands_at(((0.5, 0.0, 0.0),)))


def keys() -> Iterator[tuple[float, Vector]]:
    """Yield keys into a centre, there for a third of a second, out again, along to the next."""
    for k in range(len(SHAPES)):
        y, begins = APART * k, 1.1 * k
        yield from (
            (begins + 0.3, (0.0, y, 0.0)), (begins + 0.6, (0.0, y, 0.0)), (begins + 0.85, (0.5, y, 0.0)),
            (begins + 1.1, (0.5, y + APART, 0.0)),
        )


def pairs() -> Iterator[Body]:
    """Yield five pairs in the same place each."""
    for k, (name, shape) in enumerate(SHAPES.items()):
        for which in ("one", "other"):
            yield loose(f"{name}_{which}", shape, "wood", 0.5, (0.0, APART * k, 0.0))


def boxes() -> Iterator[Body]:
    """Yield four pairs along y, each along x inside one another."""
    for k, depth in enumerate(DEPTHS):
        for side, sign in (("left", -0.5), ("right", 0.5)):
            yield loose(f"{side}_{k}", Box((EDGE, EDGE, EDGE)), "wood", 1.0, (sign * (EDGE - depth), 2.0 * k, 0.0))


def moved_at_most(limit: float) -> Bound:
    """Return the bound on the distance [m] that bodies are moved at the start, which is known in closed form."""
    return Bound("start_moved_max", limit + SPARE, "what overlaps begins at the nearest free place, and no farther away")


def start(name: str, title: str, judged: str, bodies: Callable[[], Iterator[Body]]) -> Scenario:
    """Return a scene of loose bodies that overlap at the start by at most an edge or a diameter: each of two moves by half."""
    return undriven(
        name, title, judged, bodies, gravity=NOWHERE, frames=60,
        bounds=(
            NO_OVERLAP, FINITE, Bound("energy_added_max", 0.0, "bodies at rest that are moved apart are still at rest"),
            moved_at_most(0.5 * EDGE),
        ),
        metrics=("energy_added_max",), expects={REFUSAL: True}, family="" if name == "deep_overlap" else "coincident_centres",
    )


SCENARIOS = (
    Scenario(
        "coincident_centres",
        "A driven ball is led into the very centres of a ball, a capsule, a cube, an ellipsoid and a hull.",
        "Overlap, numbers that stay numbers, and that it goes on when its user does.",
        build, led_through(tuple(keys()), FRAMES), FRAMES,
        bounds=(
            NO_OVERLAP, FINITE, FOLLOWS_WHEN_FREE,
            Bound("still_frames", 25.0, "led straight at a centre and straight out, it stands still: a fifth of all frames"),
        ),
    ),
    start(
        "coincident_start", "Balls, capsules, cubes, ellipsoids and hulls begin two by two in the same place.",
        "Overlap from the first state on, the distance that bodies are moved, and no energy.", pairs,
    ),
    Scenario(
        "start_inside", "The first pose overlaps: a hand begins inside a table.",
        "Overlap from the first state on, how far the hand is moved, and that it then follows its user over the table.",
        lambda: Scene("start_inside", (fixture("table", Box((1.0, 1.0, 0.05)), "wood", (0.0, 0.0, -0.025)),), (rigid_hand(),),
                      start=hands_at((NOWHERE,))),
        led(lambda time: ((0.2 * time, 0.0, 0.0),)), 60, bounds=(NO_OVERLAP, FINITE, *MOVES, moved_at_most(PALM[2])),
        expects={REFUSAL: True},
    ),
    start(
        "deep_overlap", "Pairs of boxes begin 1 to 20 cm inside each other.",
        "Overlap from the first state on, the distance that boxes are moved, and no energy.", boxes,
    ),
)
