"""Limits of ball joints as arrays: swing cone, twist interval and reach cone, with what their tests need computed ahead."""

from itertools import pairwise
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from avatarsim.jit.layout import FlagLine, Grid, IndexLine, Line, Matrices, Vectors
from avatarsim.scene.joint import PI, WIDEST_SWING, Ball, ReachCone, SwingTwist
from avatarsim.scene.scene import Scene
from avatarsim.spatial import rotation

Array = NDArray[np.float64]


class BallLimits(NamedTuple):
    """Limits of the balls of nl links; rows of other links, and of balls without limits, are not read.

    is_limited    (nl) True where the link has a ball with limits
    axis          (nl, 3) direction of the limb in the link's frame
    centre        (nl, 3) middle of its swing in the link's frame at zero
    untwist       (nl, 3, 3) inverse of the shortest turn that takes axis onto centre in the parent's frame, after `Skeleton.rest`
    swing_cosine  (nl) of the largest swing
    swing_sine    (nl) of the largest swing
    twist         (nl, 2) interval of the twist [rad]
    probe         (nl, 3) a unit vector at right angles to the centre
    untwisted     (nl, 3) the same through `untwist`
    twist_low     (nl, 2) cosine and sine of the lower end of the twist, zeros where an end is beyond half a turn
    twist_high    (nl, 2) the same of the upper end
    first_corner  (nl + 1) corners of the reach cone of link i are first_corner[i] .. first_corner[i + 1]; none: it has no cone
    corner        (nc, 3) unit corners in the link's frame at zero, counter-clockwise seen from outside
    side          (nc, 3) normals of the planes through `sight` and a corner, which bound the triangle of an edge with it
    sight         (nl, 3) a unit direction inside the reach cone that sees every edge of it
    """

    is_limited: FlagLine
    axis: Vectors
    centre: Vectors
    untwist: Matrices
    swing_cosine: Line
    swing_sine: Line
    twist: Grid
    probe: Vectors
    untwisted: Vectors
    twist_low: Grid
    twist_high: Grid
    first_corner: IndexLine
    corner: Vectors
    side: Vectors
    sight: Vectors


def ball_limits(scene: Scene) -> BallLimits:
    """Return the limits of the balls of a scene's links, of those that its effects ask for."""
    links, nl = scene.links, len(scene.links)
    corners = [np.zeros((0, 3))] * nl
    made = BallLimits(
        np.zeros(nl, dtype=np.bool_), np.zeros((nl, 3)), np.zeros((nl, 3)), np.tile(np.eye(3), (nl, 1, 1)), np.zeros(nl),
        np.zeros(nl), np.zeros((nl, 2)), np.zeros((nl, 3)), np.zeros((nl, 3)), np.zeros((nl, 2)), np.zeros((nl, 2)),
        np.zeros(nl + 1, dtype=np.int64), np.zeros((0, 3)), np.zeros((0, 3)), np.zeros((nl, 3)),
    )
    for i, link in enumerate(links):
        if not isinstance(link.joint, Ball):
            continue
        # limits are stated in the parent's frame; the kernels see the turn from the link's frame at zero
        rest = rotation.to_matrix(link.orientation)
        polygon = link.joint.cone if scene.effects.reach_cones else None
        swing = link.joint.limits if scene.effects.limits else None
        if polygon is not None:
            made.sight[i], corners[i] = polygon.visible_point @ rest, polygon.vertices @ rest
            swing = swing or wide_open(link.joint, polygon, rest)
        if swing is not None:
            put_swing_twist(i, swing, rest, made)
    made.first_corner[1:] = np.cumsum([len(one) for one in corners])
    every = np.concatenate([*corners, np.zeros((0, 3))])
    sides = [np.cross(made.sight[i], every[first:last]) for i, (first, last) in enumerate(pairwise(made.first_corner))]
    return made._replace(corner=every, side=np.concatenate([*sides, np.zeros((0, 3))]))


def put_swing_twist(i: int, swing: SwingTwist, rest: Array, limits_out: BallLimits) -> None:
    """Write swing and twist of link i, whose frame at zero is ``rest`` (3, 3) in its parent's."""
    made, (low, high) = limits_out, swing.twist
    made.is_limited[i], made.axis[i], made.centre[i] = True, swing.axis, swing.centre @ rest
    made.untwist[i] = rotation.to_matrix(rotation.between(swing.axis, swing.centre)).T @ rest
    made.swing_cosine[i], made.swing_sine[i], made.twist[i] = np.cos(swing.swing), np.sin(swing.swing), swing.twist
    probe = np.cross(made.centre[i], np.eye(3)[np.argmin(np.abs(made.centre[i]))])
    made.probe[i] = probe / np.linalg.norm(probe)
    made.untwisted[i] = made.untwist[i] @ made.probe[i]
    if -PI <= low <= high <= PI:
        made.twist_low[i], made.twist_high[i] = (np.cos(low), np.sin(low)), (np.cos(high), np.sin(high))


def wide_open(joint: Ball, polygon: ReachCone, rest: Array) -> SwingTwist:
    """Return swing and twist without limits around a polygon: its limb is that of the joint's own limits, if it has any, else
    the axis that points to the polygon's visible point at zero, with the link's frame ``rest`` (3, 3) in the parent's."""
    if joint.limits is not None:
        axis, centre = joint.limits.axis, joint.limits.centre
    else:
        centre = polygon.visible_point
        x, y, z = centre @ rest
        axis = (float(x), float(y), float(z))
    return SwingTwist(axis, centre, WIDEST_SWING, (-PI, PI))
