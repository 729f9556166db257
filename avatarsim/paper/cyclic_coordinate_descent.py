"""Cyclic coordinate descent (Wang and Chen 1991): turns one joint after the other, from tip to root, towards the goal."""

from math import inf
from typing import Final

import numpy as np
from numpy.typing import NDArray

from avatarsim.jit.kernel import kernel
from avatarsim.paper.joint_plane import joint_turn
from avatarsim.paper.link_pose import pose_link
from avatarsim.settings import PaperSettings
from avatarsim.spatial.tangent import (
    about,
    columns,
    put_columns,
    step_between,
    stepped,
    straightened,
    turned,
    turned_back,
)
from avatarsim.spatial.vec3 import Rows, Vec3, add, cross, norm, row, sub
from avatarsim.world.geometry import Poses
from avatarsim.world.limits import has_cone, inside_cone
from avatarsim.world.skeleton import BALL, HINGES, Posture, Skeleton

Index = NDArray[np.int64]

REACHED: Final = 0
"""The effector is within the tolerance of its goal."""

OUT_OF_SWEEPS: Final = 1
"""Still coming closer when the cap was reached."""

STUCK: Final = 2
"""No joint turns any more: limits block it, or the goal is out of reach. The effector is as near as CCD brings it."""

SINGULAR: Final = 3
"""No joint turns although the goal is within reach: chain, effector and goal are on one line (CCD's own fixed point)."""

NO_GOAL: Final = 4
"""Effector or goal is not finite; nothing was changed."""

NO_JOINT: Final = 5
"""The links given have no joint that turns; nothing was changed."""

CCD_NAMES: Final = {
    REACHED: "reached", OUT_OF_SWEEPS: "out of sweeps", STUCK: "stuck", SINGULAR: "singular", NO_GOAL: "no goal",
    NO_JOINT: "no joint",
}
"""What to print for each status."""

STRAIGHT: Final = 1e-6
"""Sine of the angle below which two directions count as one. Larger: bent chains are called singular; smaller: CCD leaves
near-singular ones only slowly."""


@kernel
def turn_hinges(
    skel: Skeleton, link: int, effector: Vec3, goal: Vec3, posture_out: Posture, poses: Poses, axes: Rows
) -> tuple[Vec3, float]:
    """Turn the hinges of one link, the outermost first, each clipped to its limits; return effector and largest turn [rad]."""
    origin, most = row(poses.position, skel.first + link), 0.0
    for j in range(skel.first_dof[link + 1] - 1, skel.first_dof[link] - 1, -1):
        axis, before = row(axes, j), posture_out.angle[j]
        wanted = before + joint_turn(origin, axis, effector, goal)
        posture_out.angle[j] = min(max(wanted, skel.limits[j, 0]), skel.limits[j, 1])
        turn = posture_out.angle[j] - before
        effector = add(origin, about(axis, turn, sub(effector, origin)))
        most = max(most, abs(turn))
    return effector, most


@kernel
def turn_ball(
    skel: Skeleton, link: int, effector: Vec3, goal: Vec3, posture_out: Posture, poses: Poses
) -> tuple[Vec3, float]:
    """Turn a ball as three hinges about its own z, y and x, then project it into its limits; effector and turn [rad]."""
    origin, frame = row(poses.position, skel.first + link), columns(poses.rotation, skel.first + link)
    before = columns(posture_out.turn, link)
    rest_frame, held = frame, turned_back(frame, sub(effector, origin))
    turn = before
    for k in range(2, -1, -1):
        axis = frame[k]
        angle = joint_turn(origin, axis, effector, goal)
        effector = add(origin, about(axis, angle, sub(effector, origin)))
        frame = (about(axis, angle, frame[0]), about(axis, angle, frame[1]), about(axis, angle, frame[2]))
        turn = stepped(turn, (angle if k == 0 else 0.0, angle if k == 1 else 0.0, angle if k == 2 else 0.0))
    turn = straightened(turn)
    if has_cone(skel, link):
        turn = inside_cone(skel, link, turn)
    put_columns(posture_out.turn, link, turn)
    # into the axes of the joint at rest, and from there into the world
    effector = add(origin, turned(rest_frame, turned_back(before, turned(turn, held))))
    return effector, norm(step_between(before, turn))


@kernel
def sweep(
    skel: Skeleton, links: Index, first: int, last: int, effector: Vec3, goal: Vec3, posture_out: Posture, poses: Poses,
    axes: Rows,
) -> tuple[Vec3, float]:
    """Turn the joints of links[last] to links[first] once each; effector and largest turn [rad]. Poses stay as they were:
    a joint further in is not moved by those further out."""
    most = 0.0
    for k in range(last, first - 1, -1):
        turn = 0.0
        if skel.kind[links[k]] == HINGES:
            effector, turn = turn_hinges(skel, links[k], effector, goal, posture_out, poses, axes)
        elif skel.kind[links[k]] == BALL:
            effector, turn = turn_ball(skel, links[k], effector, goal, posture_out, poses)
        most = max(most, turn)
    return effector, most


@kernel
def joints_of(skel: Skeleton, links: Index, first: int, last: int) -> int:
    """Unit joints of links[first .. last]: a ball counts as three."""
    count = 0
    for k in range(first, last + 1):
        if skel.kind[links[k]] == HINGES or skel.kind[links[k]] == BALL:
            count += skel.first_dof[links[k] + 1] - skel.first_dof[links[k]]
    return count


@kernel
def on_one_line(
    skel: Skeleton, links: Index, first: int, last: int, effector: Vec3, goal: Vec3, tolerance: float, poses: Poses
) -> bool:
    """Whether effector and goal are in one line with every joint while the goal is at a distance that the bent chain has."""
    total, longest, base, before = 0.0, 0.0, effector, effector
    for k in range(last, first - 1, -1):
        if skel.kind[links[k]] == HINGES or skel.kind[links[k]] == BALL:
            base = row(poses.position, skel.first + links[k])
            e, g = sub(effector, base), sub(goal, base)
            if norm(cross(e, g)) > STRAIGHT * norm(e) * norm(g):
                return False
            length = norm(sub(before, base))
            total, longest, before = total + length, max(longest, length), base
    away = norm(sub(goal, base))
    return 2.0 * longest - total - tolerance <= away <= total + tolerance


@kernel
def descend(
    skel: Skeleton, links: Index, first: int, last: int, effector: Vec3, goal: Vec3, settings: PaperSettings,
    posture_out: Posture, poses_out: Poses, axes_out: Rows,
) -> tuple[int, int, float]:
    """Bring ``effector`` [m], a point on the link links[last], to ``goal`` by the joints of links[first .. last], root first.

    Poses and axes of those links must be right on entry, and are on return (vertices are not carried along). Hinges stay
    within their limits exactly, balls inside their cones. Returns (status, sweeps, distance left [m]).
    """
    tip = skel.first + links[last]
    held = turned_back(columns(poses_out.rotation, tip), sub(effector, row(poses_out.position, tip)))
    distance = norm(sub(goal, effector))
    if not (distance < inf):
        return NO_GOAL, 0, distance
    if distance <= settings.tolerance:
        return REACHED, 0, distance
    if joints_of(skel, links, first, last) == 0:
        return NO_JOINT, 0, distance
    for done in range(settings.sweeps):
        _, most = sweep(skel, links, first, last, effector, goal, posture_out, poses_out, axes_out)
        for k in range(first, last + 1):
            pose_link(skel, posture_out, links[k], poses_out, axes_out)
        # from the posture, so that no rounding gathers over the sweeps
        effector = add(row(poses_out.position, tip), turned(columns(poses_out.rotation, tip), held))
        distance = norm(sub(goal, effector))
        if distance <= settings.tolerance:
            return REACHED, done + 1, distance
        if most <= settings.still:
            straight = on_one_line(skel, links, first, last, effector, goal, settings.tolerance, poses_out)
            return (SINGULAR if straight else STUCK), done + 1, distance
    return OUT_OF_SWEEPS, settings.sweeps, distance


@kernel
def bend(
    skel: Skeleton, links: Index, first: int, last: int, angle: float, effector: Vec3, goal: Vec3, posture_out: Posture,
    poses_out: Poses, axes_out: Rows,
) -> Vec3:
    """Leave a SINGULAR posture: bend every joint but those of links[first] by ``angle`` [rad], to the side where the limits leave
    more room, then point the chain at the goal again without links[last]. Returns the effector.

    With all joints on one line to the goal the gradient of every joint is zero. Bent, and turned from further in, the chain has
    its outer joints off the line to the goal and on the side to which they can bend; from there every sweep makes progress.
    """
    tip = skel.first + links[last]
    held = turned_back(columns(poses_out.rotation, tip), sub(effector, row(poses_out.position, tip)))
    for k in range(first + 1, last + 1):
        link = links[k]
        if skel.kind[link] == HINGES:
            for j in range(skel.first_dof[link], skel.first_dof[link + 1]):
                before, low, high = posture_out.angle[j], skel.limits[j, 0], skel.limits[j, 1]
                side = angle if high - before >= before - low else -angle
                posture_out.angle[j] = min(max(before + side, low), high)
        elif skel.kind[link] == BALL:
            turn = straightened(stepped(columns(posture_out.turn, link), (angle, angle, angle)))
            put_columns(posture_out.turn, link, inside_cone(skel, link, turn) if has_cone(skel, link) else turn)
    for again in range(2):
        for k in range(first, last + 1):
            pose_link(skel, posture_out, links[k], poses_out, axes_out)
        effector = add(row(poses_out.position, tip), turned(columns(poses_out.rotation, tip), held))
        if again == 0:
            sweep(skel, links, first, last - 1, effector, goal, posture_out, poses_out, axes_out)
    return effector


@kernel
def reach_goal(
    skel: Skeleton, links: Index, first: int, last: int, effector: Vec3, goal: Vec3, settings: PaperSettings,
    posture_out: Posture, poses_out: Poses, axes_out: Rows,
) -> tuple[int, int, float, bool]:
    """`descend`, and once more from a bent chain if it ends SINGULAR; the last value returned says so."""
    tip = skel.first + links[last]
    held = turned_back(columns(poses_out.rotation, tip), sub(effector, row(poses_out.position, tip)))
    status, sweeps, left = descend(
        skel, links, first, last, effector, goal, settings, posture_out, poses_out, axes_out
    )
    if status != SINGULAR or settings.bend == 0.0:
        return status, sweeps, left, False
    effector = add(row(poses_out.position, tip), turned(columns(poses_out.rotation, tip), held))
    effector = bend(skel, links, first, last, settings.bend, effector, goal, posture_out, poses_out, axes_out)
    status, more, left = descend(skel, links, first, last, effector, goal, settings, posture_out, poses_out, axes_out)
    return status, sweeps + more, left, True
