"""Small worlds in which the nearest free posture is known, or can be found by trying all."""

import numpy as np

from avatarsim.scene.avatar import Avatar, Link
from avatarsim.scene.body import Mass, fixed
from avatarsim.scene.joint import Ball, Free, Hinge, Hinges, ReachCone, SwingTwist
from avatarsim.scene.scene import Scene
from avatarsim.scene.shape import Box, Capsule, Piece, Sphere
from avatarsim.scene.tracker import TrackerSample, rest
from avatarsim.spatial import rotation

WALL = 0.5
"""Where the wall begins along x [m]."""
RADIUS = 0.1


def wall_scene(*avatars: Avatar) -> Scene:
    """Return a wall whose near face is at x = WALL."""
    return Scene("wall", (fixed("wall", (Piece(Box((0.2, 4.0, 4.0))),), "wood", (WALL + 0.1, 0.0, 0.0)),), avatars)


def fist() -> Avatar:
    """Return a free ball of radius RADIUS."""
    return Avatar("fist", (Link("fist", None, Free(), (Piece(Sphere(RADIUS)),), Mass(1.0)),))


def planar_arm() -> Avatar:
    """Return two links of 0.3 m along x that turn about y, the first one fixed to the world at the origin."""
    bar = (Piece(Capsule(0.02, 0.2), (0.15, 0.0, 0.0), tuple(rotation.from_axis_angle([0.0, 1.0, 0.0], 0.5 * np.pi))),)
    hinge = Hinges((Hinge((0.0, 1.0, 0.0), -2.0, 2.0),))
    upper = Link("upper", None, hinge, bar, Mass(1.0))
    return Avatar("arm", (upper, Link("fore", "upper", hinge, bar, Mass(1.0), anchor=(0.3, 0.0, 0.0))))


def mixed() -> Avatar:
    """Return a free root, three hinges with one centre, a limited ball with a reach cone, an unlimited ball with one."""
    ball = (Piece(Sphere(0.03)),)
    three = Hinges((Hinge((1.0, 0.0, 0.0), -1.0, 1.0), Hinge((0.0, 1.0, 0.0), -0.7, 0.9), Hinge((0.0, 0.6, 0.8), -1.0, 2.0)))
    limits = SwingTwist((1.0, 0.0, 0.0), (0.8, 0.6, 0.0), 0.9, (-0.4, 0.6))
    corners = np.array([[1.0, 1.0, 1.0], [1.0, -1.0, 1.0], [1.0, -0.2, 0.1], [1.0, -1.0, -1.0], [1.0, 1.0, -1.0]])
    cone = ReachCone(corners, (0.95, 0.3122498999199199, 0.0))
    turned = tuple(rotation.from_axis_angle([0.0, 0.0, 1.0], 0.4))
    return Avatar("mixed", (
        Link("root", None, Free(), ball, Mass(1.0)),
        Link("hip", "root", three, ball, Mass(1.0), anchor=(0.2, 0.0, 0.1), orientation=turned),
        Link("arm", "hip", Ball(limits, cone), ball, Mass(1.0), anchor=(0.3, 0.1, 0.0), orientation=turned),
        Link("leg", "root", Ball(None, cone), ball, Mass(1.0), anchor=(-0.2, 0.0, 0.0), orientation=turned),
    ))


def posed(scene: Scene, random: np.random.Generator, spread: float = 0.3) -> TrackerSample:
    """Return some posture of all avatars."""
    at = rest(scene.avatars)
    count = len(at.positions)
    return TrackerSample(
        0.0, random.normal(0.0, spread, (count, 3)), rotation.from_rotation_vector(random.normal(0.0, spread, (count, 3))),
        random.normal(0.0, spread, len(at.angles)),
    )
