"""A gallery of objects at rest and one driven hand: idle above them, or pushing one object along."""

from math import ceil, sqrt

from avatarsim.scene.avatar import rigid_avatar
from avatarsim.scene.body import Body, fixed, simulated, solid
from avatarsim.scene.checks import Vector
from avatarsim.scene.scene import Scene
from avatarsim.scene.shape import Box, Piece, Sphere
from avatarsim.scene.tracker import TrackerSample, rest
from scenarios.scenario import RENDERED, Motion

MODES = ("idle", "pushed")
"""The hand hangs still; or it goes back and forth and pushes one object."""
APART = 0.3
"""Distance between adjacent objects [m]: none touches another unless it is pushed."""
SIDE, RADIUS, HAND = 0.1, 0.05, 0.06
"""Edge of a box, radius of a ball and of the hand [m]."""
FRAMES = 300
"""Five seconds: some engines put a body to sleep only after two of rest."""
WAY = 0.12
"""How far the hand goes in that time [m], less than half the way to the next object."""
ABOVE = 1.0
"""Height at which an idle hand hangs [m]."""


def objects(count: int) -> tuple[Body, ...]:
    """Boxes and balls in turn on a square grid, at rest on the floor."""
    side, box, ball = ceil(sqrt(count)), (Piece(Box((SIDE, SIDE, SIDE))),), (Piece(Sphere(RADIUS)),)
    found = []
    for k in range(count):
        shape, height = (ball, RADIUS) if k % 2 else (box, 0.5 * SIDE)
        place = (APART * (k % side - side // 2), APART * (k // side - side // 2), height)
        found.append(simulated(f"object_{k}", shape, "wood", solid(shape, 1.0), place))
    return tuple(found)


def gallery(count: int, mode: str) -> Scene:
    """`count` objects on a floor as large as they need, and a hand."""
    wide = APART * (ceil(sqrt(count)) + 4)
    ground = fixed("floor", (Piece(Box((wide, wide, 0.2))),), "wood", (0.0, 0.0, -0.1))
    palm = (Piece(Sphere(HAND)),)
    hand = rigid_avatar("hand", palm, solid(palm, 0.5))
    start = rest((hand,))
    start.positions[0] = begins(mode)
    return Scene(f"objects_{count}_{mode}", (ground, *objects(count)), (hand,), start=start)


def begins(mode: str) -> Vector:
    """Where the hand begins: high up, or a centimetre beside the object at the origin."""
    return (0.0, 0.0, ABOVE) if mode == "idle" else (-0.5 * SIDE - HAND - 0.01, 0.0, HAND)


def walk(scene: Scene, seed: int) -> Motion:
    """An idle hand stays; a pushing one goes its way slowly."""
    start, idle = scene.first_sample, scene.name.endswith(MODES[0])

    def sample(frame: int) -> TrackerSample:
        positions = start.positions.copy()
        positions[0, 0] += 0.0 if idle else WAY * (frame + 1) / FRAMES
        return TrackerSample((frame + 1) * RENDERED, positions, start.rotations, start.angles)

    return sample
