"""Limits of a human's joints: one table of ranges of motion, and the limits constructed from it.

The numbers in RANGES are goniometer values in degrees from range-of-motion tables (AAOS, AMA, Kurz); the limits are our own.
Tables state ends of motion in four directions, ball joints have a circular cone and a twist: the cone's axis is tilted half-way
between opposite ends, and its opening reaches the furthest of the four. The reach cone inside it, a polygon, follows the four
ends on quarters of ellipses. Of the recorded clips ankles go furthest beyond: crouches bend a loaded ankle forward by 30 to 60
degrees, where the table's 20 are those of a hanging foot.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from avatarsim.errors import UnknownName
from avatarsim.scene.checks import Vector
from avatarsim.scene.joint import ReachCone, SwingTwist

DOWN, UP = (0.0, 0.0, -1.0), (0.0, 0.0, 1.0)


@dataclass(frozen=True)
class Range:
    """Ends of motion [degrees] of a ball joint whose limb points along `axis` when it is at zero.

    Forward and backward, outward (away from the middle of the body) and inward are swings of that direction,
    `turn_out` and `turn_in` turns about it: the left limb's `turn_out` turns its front to the left.
    """

    axis: Vector
    forward: float
    backward: float
    outward: float
    inward: float
    turn_out: float
    turn_in: float


RANGES = {
    #                 axis   forward       backward      outward       inward        turn out  turn in
    # flexion, extension, abduction, adduction, lateral and medial rotation
    "shoulder": Range(DOWN, 180.0, 60.0, 180.0, 45.0, 90.0, 80.0),
    "hip": Range(DOWN, 125.0, 30.0, 45.0, 25.0, 60.0, 40.0),
    # of the sole: dorsiflexion, plantarflexion, eversion, inversion
    "ankle": Range(DOWN, 20.0, 50.0, 25.0, 35.0, 25.0, 35.0),
    # flexion, extension, to either side, turn to either side
    "chest": Range(UP, 75.0, 30.0, 35.0, 35.0, 45.0, 45.0),
    "neck": Range(UP, 90.0, 55.0, 35.0, 35.0, 70.0, 70.0),
}

CORNERS = 16
"""Corners of a reach cone: the arcs between them stay within 2 % of the ellipses."""

WIDEST_REACH = 165.0
"""Furthest [degrees] that a corner is from where the limb points at zero: arms lifted by 180 degrees forward and sideways point
the same way, and a polygon cannot have all those corners in one point."""

HINGES = {
    # flexion only; the signs are those of the humanoid's file: elbows bend by positive angles, knees by negative ones
    "elbow": (0.0, 150.0),
    "knee": (-140.0, 0.0),
}


def hinge_limits(link: str) -> tuple[float, float]:
    """Return the lower and upper limit [rad] of the hinge of `link`, such as "left_knee"."""
    joint = _side_and_joint(link)[1]
    if joint not in HINGES:
        raise UnknownName("joint with hinge limits", link, HINGES)
    low, high = np.radians(HINGES[joint])
    return float(low), float(high)


def ball_limits(link: str) -> SwingTwist:
    """Return cone and twist of the ball joint of `link`, such as "left_hip" or "neck"."""
    range_, side, centre = _ball(link)
    swing = max(_angle(np.array(centre), end) for end in ends(range_, side))
    # turning the left limb outwards is a positive turn about up
    out = side * (1.0 if range_.axis == UP else -1.0)
    low, high = sorted((out * range_.turn_out, -out * range_.turn_in))
    return SwingTwist(range_.axis, centre, swing, (float(np.radians(low)), float(np.radians(high))))


def reach_cone(link: str) -> ReachCone:
    """Return the reach cone of the ball joint of `link`: quarters of ellipses, in angles, between neighbours of the four ends."""
    range_, side, seen = _ball(link)
    corners = []
    for bearing in 2.0 * np.pi * np.arange(CORNERS) / CORNERS:
        forward = np.cos(bearing) * (range_.forward if np.cos(bearing) > 0.0 else range_.backward)
        outward = np.sin(bearing) * (range_.outward if np.sin(bearing) > 0.0 else range_.inward)
        shorter = min(1.0, WIDEST_REACH / float(np.hypot(forward, outward)))
        corners.append(tilted(range_, side, shorter * forward, shorter * outward))
    # counter-clockwise seen from outside: that depends on where the limb points, and on the side
    around = 1 if (range_.axis == UP) == (side > 0.0) else -1
    return ReachCone(np.array(corners[::around]), seen)


def _ball(link: str) -> tuple[Range, float, Vector]:
    """Return ranges of a ball joint, its side, and the middle of its cone."""
    side, joint = _side_and_joint(link)
    if joint not in RANGES:
        raise UnknownName("joint with ball limits", link, RANGES)
    range_ = RANGES[joint]
    x, y, z = tilted(range_, side, 0.5 * (range_.forward - range_.backward), 0.5 * (range_.outward - range_.inward)).tolist()
    return range_, side, (x, y, z)


def tilted(range_: Range, side: float, forward: float, outward: float) -> NDArray[np.float64]:
    """Return the direction of the limb swung by `forward` and `outward` degrees at once; side is 1 for left, -1 for right."""
    towards = np.array([forward, side * outward, 0.0])
    angle = float(np.linalg.norm(towards))
    if angle == 0.0:
        return np.array(range_.axis)
    tilt = np.radians(angle)
    return np.asarray(np.cos(tilt) * np.array(range_.axis) + np.sin(tilt) * towards / angle)


def ends(range_: Range, side: float) -> tuple[NDArray[np.float64], ...]:
    """Return the four directions at which motion ends by the table."""
    reached = ((range_.forward, 0.0), (-range_.backward, 0.0), (0.0, range_.outward), (0.0, -range_.inward))
    return tuple(tilted(range_, side, forward, outward) for forward, outward in reached)


def _side_and_joint(link: str) -> tuple[float, str]:
    """Return (1, "hip") of "left_hip", (-1, "hip") of "right_hip", (1, "neck") of "neck"."""
    side, _, joint = link.partition("_")
    if joint:
        return (-1.0 if side == "right" else 1.0), joint
    return 1.0, link


def _angle(a: NDArray[np.float64], b: NDArray[np.float64]) -> float:
    """Return the angle [rad] between two directions."""
    return float(np.arctan2(np.linalg.norm(np.cross(a, b)), np.dot(a, b)))
