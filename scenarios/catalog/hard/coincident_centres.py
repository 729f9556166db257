"""Centres that coincide, where a direction out has to be chosen and none is nearer than another.

A user's ball is led from the side into the very centres of a fixed ball, capsule, cube, ellipsoid and hull, one after the other,
stays there and goes on to the next: an engine that divides by the distance of centres loses its numbers there.
`coincident_start`: pairs of such bodies begin in the same place, which is to be refused with the pairs and their depths; a
ball in a ball is as deep as both radii together.

In the 330 frames of a quick comparison the raw motion is inside each of the five in 33 of them, up to 0.2 m deep.
"""

import numpy as np

from avatarsim.scene.avatar import rigid_avatar
from avatarsim.scene.body import Body, fixed, simulated, solid
from avatarsim.scene.scene import Scene
from avatarsim.scene.shape import Box, Capsule, ConvexHull, Ellipsoid, Piece, Shape, Sphere
from avatarsim.scene.tracker import TrackerSample
from avatarsim.spatial import rotation
from scenarios.building.cases import NOWHERE
from scenarios.building.promises import FINITE, FOLLOWS_WHEN_FREE, NO_OVERLAP
from scenarios.motion.keyframes import through
from scenarios.motion.untracked import untracked
from scenarios.scenario import REFUSAL, Bound, Motion, Scenario

RADIUS, MASS = 0.1, 0.5
"""Radius of the user's ball and half the size of everything else [m]; mass [kg]."""
APART = 0.7
"""Distance of the fixed bodies [m]."""
FRAMES = 330
CORNERS = np.array([[x, y, z] for x in (-1.0, 1.0) for y in (-1.0, 1.0) for z in (-1.0, 1.0)])
SHAPES: dict[str, Shape] = {
    "sphere": Sphere(RADIUS), "capsule": Capsule(RADIUS, RADIUS), "box": Box((2.0 * RADIUS,) * 3),
    "ellipsoid": Ellipsoid((RADIUS, 0.8 * RADIUS, 1.2 * RADIUS)), "hull": ConvexHull(RADIUS * CORNERS),
}


def build() -> Scene:
    """Five fixed bodies in a row along y, and a driven ball beside the first."""
    bodies = tuple(fixed(name, (Piece(shape),), "wood", (0.0, APART * k, 0.0)) for k, (name, shape) in enumerate(SHAPES.items()))
    pieces = (Piece(Sphere(RADIUS)),)
    ball = rigid_avatar("ball", pieces, solid(pieces, MASS))
    return Scene("coincident_centres", bodies, (ball,), start=_at(0.5, 0.0))


def motion(scene: Scene, seed: int) -> Motion:
    """Into a centre, there for a third of a second, out again, along to the next."""
    keys = []
    for k in range(len(SHAPES)):
        y, begins = APART * k, 1.1 * k
        keys += [
            (begins + 0.3, _at(0.0, y)), (begins + 0.6, _at(0.0, y)), (begins + 0.85, _at(0.5, y)),
            (begins + 1.1, _at(0.5, y + APART)),
        ]
    return through(scene.first_sample, keys, FRAMES).motion()


def _at(x: float, y: float) -> TrackerSample:
    return TrackerSample(0.0, np.array([[x, y, 0.0]]), np.array([rotation.IDENTITY]), np.zeros(0))


def start() -> Scene:
    """Five pairs in the same place each, without gravity."""
    bodies: list[Body] = []
    for k, (name, shape) in enumerate(SHAPES.items()):
        pieces = (Piece(shape),)
        for which in ("one", "other"):
            bodies.append(simulated(f"{name}_{which}", pieces, "wood", solid(pieces, MASS), (0.0, APART * k, 0.0)))
    return Scene("coincident_start", tuple(bodies), gravity=NOWHERE)


SCENARIOS = (
    Scenario(
        name="coincident_centres",
        title="A driven ball is led into the very centres of a ball, a capsule, a cube, an ellipsoid and a hull.",
        judged="Overlap, numbers that stay numbers, and that it goes on when its user does.",
        build=build,
        motion=motion,
        frames=FRAMES,
        bounds=(
            NO_OVERLAP, FINITE, FOLLOWS_WHEN_FREE,
            Bound("still_frames", 25.0, "led straight at a centre and straight out, it stands still: a fifth of all frames"),
        ),
    ),
    Scenario(
        name="coincident_start",
        title="Balls, capsules, cubes, ellipsoids and hulls begin two by two in the same place.",
        judged="Whether the engine refuses to begin and says which pairs overlap, and how deep.",
        build=start,
        motion=untracked(),
        frames=60,
        bounds=(
            NO_OVERLAP, FINITE,
            Bound("energy_added_max", 0.0, "bodies at rest that are moved apart are still at rest"),
        ),
        metrics=("energy_added_max",),
        expects={REFUSAL: True},
    ),
)
