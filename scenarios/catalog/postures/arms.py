"""Arms at the edge of their range: around and outside of reach cones, and stretched at a wall along their own axis.

Two upper arms hang on balls whose directions are limited by a spherical polygon each (Wilhelms and Van Gelder), one of them
concave; the user circles outside the edge and points straight away. A straight arm of three hinges has to fold to give way, but
every hinge sees its goal and its tip in one line: the fixed point of cyclic coordinate descent.
"""

import numpy as np
from numpy.typing import NDArray

from avatarsim.scene.avatar import Avatar, Link
from avatarsim.scene.body import solid
from avatarsim.scene.joint import Ball, Free, Hinge, Hinges, ReachCone, SwingTwist
from avatarsim.scene.scene import Scene
from avatarsim.scene.shape import Capsule, Piece, Sphere
from avatarsim.scene.tracker import TrackerSample
from avatarsim.spatial import rotation
from scenarios.building.cases import turned_by
from scenarios.building.promises import AVATAR, FINITE, MOVES, NO_OVERLAP, WITHIN_CONES, WITHIN_LIMITS
from scenarios.building.scenes import before
from scenarios.building.stage import THICK, wall_ahead
from scenarios.motion.keyframes import Key
from scenarios.motion.rigid_hands import keyed
from scenarios.scenario import RENDERED, Motion, Scenario

LENGTH, RADIUS, APART = 0.35, 0.04, 0.3
"""Length and radius of an arm in a cone, and the distance of the two sockets [m]."""
CONES = (("left_arm", 0.5, (55.0, 40.0, 70.0, 45.0, 60.0)), ("right_arm", -0.5, (70.0, 30.0, 65.0, 25.0, 70.0, 35.0)))
"""Arm, its side, and angle [degrees] of each corner from the middle of its cone, corners evenly around it."""
DOWN = (0.0, 0.0, -1.0)
LIMITS = SwingTwist(DOWN, DOWN, float(np.radians(75.0)), (-0.5, 0.5))
"""The circular cone and the twist around both [rad]; every corner is inside it."""
SMALL_TWIST = 0.45
"""Target twist [rad] of the second arm, within its limits: with both arms in a corner of their cones and their twist at its end
the nearest posture does not move although the user does."""
ASKED = float(np.radians(110.0))
"""Angle from the middle of the cone to which the user points [rad]."""

BONE, THIN, BEND, UP = 0.3, 0.04, float(np.radians(150.0)), 1.5
"""Length and radius of a link of the chain [m], how far each hinge turns either way [rad], and height of the chain [m]."""
FACE = 3.0 * BONE + THIN - 0.12
"""Where the wall begins along x [m]: the straight arm reaches 0.12 m into it."""


def cone(corners: tuple[float, ...]) -> ReachCone:
    """Return the polygon about -z with corners at these angles from it, counter-clockwise seen from outside."""
    tilt = np.radians(corners)
    around = -2.0 * np.pi * np.arange(len(corners)) / len(corners)
    vertices = np.stack([np.sin(tilt) * np.cos(around), np.sin(tilt) * np.sin(around), -np.cos(tilt)], axis=1)
    return ReachCone(vertices, DOWN)


def in_cones() -> Scene:
    """Return a ball for a trunk and two arms that hang from it."""
    trunk = (Piece(Sphere(0.05)),)
    links = [Link("trunk", None, Free(), trunk, solid(trunk, 10.0))]
    arm = (Piece(Capsule(RADIUS, LENGTH), (0.0, 0.0, -0.5 * LENGTH - RADIUS)),)
    for name, side, corners in CONES:
        links.append(Link(name, "trunk", Ball(LIMITS, cone(corners)), arm, solid(arm, 2.0), anchor=(0.0, side * APART, 0.0)))
    positions = np.array([(0.0, 0.0, 1.5), (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)])
    start = TrackerSample(0.0, positions, np.tile(rotation.IDENTITY, (3, 1)), np.zeros(0))
    return Scene("reach_cone_edges", (), (Avatar("arms", tuple(links), ("left_arm", "right_arm")),), start=start)


def circling(scene: Scene, seed: int) -> Motion:
    """Return a motion: each arm circles outside its cone, in and out and past the far side, twisting all the while."""
    start = scene.first_sample
    phase = float(np.random.default_rng(seed).uniform(0.0, 2.0 * np.pi))

    def pointing(away: float, around: float, twist: float) -> NDArray[np.float64]:
        swing = rotation.from_axis_angle((-np.sin(around), np.cos(around), 0.0), away)
        return rotation.multiply(swing, rotation.from_axis_angle((0.0, 0.0, 1.0), twist))

    def sample(frame: int) -> TrackerSample:
        time = (frame + 1) * RENDERED
        away = ASKED * np.sin(0.7 * np.pi * time) ** 2
        rotations = start.rotations.copy()
        rotations[1] = pointing(away, 2.0 * time + phase, np.sin(1.7 * time))
        rotations[2] = pointing(0.9 * away, -1.6 * time, SMALL_TWIST * np.sin(2.3 * time))
        return TrackerSample(time, start.positions, rotations, start.angles)

    return sample


def chain() -> Scene:
    """Return three capsules along x, one hinge about y each, the first anchored to the world, folded aside before a wall."""
    # shorter than the link by a radius at each end, so that folded neighbours of neighbours stay apart
    shape, along = Capsule(THIN, BONE - 2.0 * THIN), turned_by((0.0, 1.0, 0.0), np.pi / 2.0)
    piece, hinge = (Piece(shape, (0.5 * BONE, 0.0, 0.0), along),), Hinges((Hinge((0.0, 1.0, 0.0), -BEND, BEND),))
    links = [Link("upper", None, hinge, piece, solid(piece, 2.0), anchor=(0.0, 0.0, UP))]
    for name, parent in (("fore", "upper"), ("hand", "fore")):
        links.append(Link(name, parent, hinge, piece, solid(piece, 1.0), anchor=(BONE, 0.0, 0.0)))
    return Scene("singular_chain", (wall_ahead(FACE),), (Avatar("arm", tuple(links), ("hand",)),), start=bent(60.0))


def bent(degrees: float) -> TrackerSample:
    """Return a chain folded like Z: the shoulder down, the elbow up, the wrist down, so that the hand stays near the middle."""
    angle = np.radians(degrees)
    return TrackerSample(0.0, np.zeros((3, 3)), np.tile(rotation.IDENTITY, (3, 1)), np.array([angle, -1.6 * angle, angle]))


def folds() -> list[Key]:
    """Return keys: stretched from one side, swayed, let go to the other side, stretched again, and so on."""
    keys: list[Key] = []
    for k in range(4):
        begin, side = 2.0 * k, 1.0 if k % 2 == 0 else -1.0
        keys += [
            (begin + 0.5, bent(0.0)), (begin + 0.7, bent(-side)), (begin + 0.9, bent(side)),
            (begin + 1.1, bent(0.0)), (begin + 1.6, bent(-60.0 * side)), (begin + 2.0, bent(-50.0 * side)),
        ]
    return keys


SCENARIOS = (
    Scenario(
        "reach_cone_edges", "Two arms are led around and far outside their reach cones, one of them concave.",
        "Excess over the reach cones, exactly zero; limits of swing and twist; overlap of the arms.", in_cones, circling,
        600, 240, bounds=(NO_OVERLAP, FINITE, WITHIN_LIMITS, *MOVES, WITHIN_CONES),
    ),
    Scenario(
        "singular_chain", "A straight arm of three hinges is stretched at a wall along its own axis.",
        "Overlap; whether the arm finds a way to fold; jumps; that it is straight again once there is room.", chain,
        keyed(folds(), 480), 480, 240, bounds=AVATAR, regions=(before(FACE + 0.5 * THICK, "arm/*"),),
    ),
)
