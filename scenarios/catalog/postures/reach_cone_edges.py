"""Along the edge of a reach cone, over it, around its corners and to the far side: a spherical polygon, and a concave one.

Two upper arms hang on balls whose directions are limited by a polygon each (Wilhelms and Van Gelder): one convex, made from
a shoulder's table of ranges, one concave. Both are our own construction. The user circles outside the edge, points
straight away from the cone and back, while the arms also pass through each other's place, so that contact and cone act
at once. Excess over the cone is exactly nothing.

In the 240 frames of a quick comparison the raw motion is inside itself in 24 of them (up to 0.075 m deep).
"""

import numpy as np
from numpy.typing import NDArray

from avatarsim.scene.avatar import Avatar, Link
from avatarsim.scene.body import solid
from avatarsim.scene.joint import Ball, Free, ReachCone, SwingTwist
from avatarsim.scene.scene import Scene
from avatarsim.scene.shape import Capsule, Piece, Sphere
from avatarsim.scene.tracker import TrackerSample
from avatarsim.spatial import rotation
from scenarios.building.promises import FINITE, MOVES, NO_OVERLAP, WITHIN_LIMITS
from scenarios.scenario import RENDERED, Bound, Motion, Scenario

FRAMES, SHORT = 600, 240
LENGTH, RADIUS, APART = 0.35, 0.04, 0.3
"""Length and radius of an arm, and the distance of the two sockets [m]."""
CONVEX = (55.0, 40.0, 70.0, 45.0, 60.0)
CONCAVE = (70.0, 30.0, 65.0, 25.0, 70.0, 35.0)
"""Angle [degrees] of each corner from the middle of the cone, corners evenly around it."""
SWING, TWIST = float(np.radians(75.0)), (-0.5, 0.5)
"""The circular cone and the twist around both [rad]; every corner is inside it."""
SMALL_TWIST = 0.45
"""Twist [rad] asked of the second arm: within its limits, so that one arm always has somewhere to go. Where both wait in a corner
of their cones with their twist at its end, the nearest posture does not move although the user does."""
ASKED = float(np.radians(110.0))
"""Angle from the middle of the cone to which the user points [rad]."""


def cone(corners: tuple[float, ...]) -> ReachCone:
    """The polygon about -z with corners at these angles from it, counter-clockwise seen from outside."""
    tilt = np.radians(corners)
    around = -2.0 * np.pi * np.arange(len(corners)) / len(corners)
    vertices = np.stack([np.sin(tilt) * np.cos(around), np.sin(tilt) * np.sin(around), -np.cos(tilt)], axis=1)
    return ReachCone(vertices, (0.0, 0.0, -1.0))


def arms() -> Avatar:
    """A ball for a trunk and two arms that hang from it."""
    trunk = (Piece(Sphere(0.05)),)
    links = [Link("trunk", None, Free(), trunk, solid(trunk, 10.0))]
    arm = (Piece(Capsule(RADIUS, LENGTH), (0.0, 0.0, -0.5 * LENGTH - RADIUS)),)
    limits = SwingTwist((0.0, 0.0, -1.0), (0.0, 0.0, -1.0), SWING, TWIST)
    for name, side, corners in (("left_arm", 0.5, CONVEX), ("right_arm", -0.5, CONCAVE)):
        links.append(Link(name, "trunk", Ball(limits, cone(corners)), arm, solid(arm, 2.0), anchor=(0.0, side * APART, 0.0)))
    return Avatar("arms", tuple(links), ("left_arm", "right_arm"))


def build() -> Scene:
    """Nothing but the avatar."""
    positions = np.zeros((3, 3))
    positions[0, 2] = 1.5
    start = TrackerSample(0.0, positions, np.tile(rotation.IDENTITY, (3, 1)), np.zeros(0))
    return Scene("reach_cone_edges", (), (arms(),), start=start)


def motion(scene: Scene, seed: int) -> Motion:
    """Each arm circles outside its cone, in and out and past the far side, twisting all the while."""
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


SCENARIO = Scenario(
    name="reach_cone_edges",
    title="Two arms are led around and far outside their reach cones, one of them concave.",
    judged="Excess over the reach cones, exactly zero; limits of swing and twist; overlap of the arms.",
    build=build,
    motion=motion,
    frames=FRAMES,
    short=SHORT,
    bounds=(
        NO_OVERLAP, FINITE, WITHIN_LIMITS, *MOVES,
        Bound("reach_cone_excess_max", 1e-9, "cones hold exactly; 1e-9 degrees is the rounding of poses turned into angles"),
    ),
)
