"""Small avatars, rooms and motions for the tests of cleaning."""

import numpy as np

from avatarsim.assets.models.coordinates import Coordinates, Slot
from avatarsim.assets.models.model import Model
from avatarsim.scene.avatar import Avatar, Link
from avatarsim.scene.body import Body, fixed, solid
from avatarsim.scene.joint import Ball, Free, Hinge, Hinges
from avatarsim.scene.motion import Motion
from avatarsim.scene.shape import Box, Capsule, Piece, Sphere
from avatarsim.spatial import rotation

RATE = 30.0
FLOOR = fixed("floor", (Piece(Box((20.0, 20.0, 0.2))),), "stone", (0.0, 0.0, -0.1))


def walker() -> Avatar:
    """Return a ball on two legs: one by a ball joint, one by a hinge with limits."""
    trunk, leg = (Piece(Sphere(0.1)),), (Piece(Capsule(0.03, 0.3), (0.0, 0.0, -0.2)),)
    return Avatar(
        "walker",
        (
            Link("trunk", None, Free(), trunk, solid(trunk, 5.0)),
            Link("left", "trunk", Ball(), leg, solid(leg, 1.0), anchor=(0.0, 0.12, 0.0)),
            Link("right", "trunk", Hinges((Hinge((0.0, 1.0, 0.0), -1.2, 1.2),)), leg, solid(leg, 1.0), anchor=(0.0, -0.12, 0.0)),
        ),
    )


def model() -> Model:
    """Return the walker, with coordinates in the order free joint, hinge, ball."""
    slots = Slot("trunk", "free", 0), Slot("right", "hinge", 2, 0), Slot("left", "ball", 1)
    return Model(walker(), Coordinates(slots, 3, 1), (), ())


def swinging(frames: int, height: float, along: float = 0.0, swing: float = 0.6) -> Motion:
    """Return the walker with its trunk at a height [m], going `along` [m] in all, legs to and fro once a second."""
    times = np.arange(frames) / RATE
    angle = swing * np.sin(2.0 * np.pi * times)
    positions, rotations = np.zeros((frames, 3, 3)), np.tile(rotation.IDENTITY, (frames, 3, 1))
    positions[:, 0, 0], positions[:, 0, 2] = np.linspace(0.0, along, frames), height
    rotations[:, 1] = rotation.from_axis_angle((0.0, 1.0, 0.0), -angle)
    return Motion(times, positions, rotations, angle[:, None])


def lowered(motion: Motion, heights: np.ndarray) -> Motion:
    """Return the motion with its root moved by heights (F,) [m]."""
    positions = motion.positions.copy()
    positions[:, 0, 2] += heights
    return Motion(motion.times, positions, motion.rotations, motion.angles)


def dipping(frames: int = 90, lowest: int = 45) -> Motion:
    """Return a motion that is free, into the floor for half a second about a frame, and free again."""
    return lowered(swinging(frames, 0.5), -0.2 * np.exp(-(((np.arange(frames) - lowest) / 8.0) ** 2)))


def part(motion: Motion, first: int, end: int) -> Motion:
    """Return the frames from `first` to before `end`."""
    some = slice(first, end)
    return Motion(motion.times[some], motion.positions[some], motion.rotations[some], motion.angles[some])


def wall(x: float, thickness: float = 0.2) -> Body:
    """Return a wall across the way."""
    return fixed("wall", (Piece(Box((thickness, 8.0, 8.0))),), "wood", (x, 0.0, 0.0))
