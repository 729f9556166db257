"""Cyclic coordinate descent (Wang and Chen 1991): turns one joint after the other, from tip to root, towards the goal.

Forward kinematics of one link from its parent's pose, for CCD, without transforming vertices.

Angle of one CCD step (Schmidl and Lin 2004, eqs 4 and 5): effector and goal projected into the plane of a joint.

End effector and goal of a link that overlaps (Schmidl and Lin 2004, eqs 2 and 3).

Overlap removal of one link by its joints (Schmidl and Lin 2004, eqs 2 to 5): contacts, end effector, goal, CCD.
"""

from math import atan2, inf
from typing import Final

import numpy as np
from numpy.typing import NDArray

from avatarsim.collision.broad_phase import boxes_meet
from avatarsim.collision.scratch import PIECES_CAP, Scratch
from avatarsim.collision.signed_distance import signed_distance_up_to
from avatarsim.collision.status import CONVERGED, NOT_FINITE, OUT_OF_ROOM
from avatarsim.jit.kernel import kernel
from avatarsim.model.geometry import Geometry, Poses, allowed_depth, may_meet
from avatarsim.model.joint_limits import has_cone, inside_cone
from avatarsim.model.skeleton import BALL, FREE, HINGES, Posture, Skeleton
from avatarsim.paper.push_apart import global_penetration_depth
from avatarsim.settings import PaperSettings
from avatarsim.spatial.tangent import (
    Columns,
    about,
    columns,
    product,
    put_columns,
    step_between,
    stepped,
    straightened,
    turned,
    turned_back,
)
from avatarsim.spatial.vec3 import Rows, Vec3, add, along, cross, dot, neg, norm, put_row, row, scale, sub
from avatarsim.tolerances import NOTHING, SAME_DIRECTION


@kernel
def pose_link(skel: Skeleton, posture: Posture, link: int, poses_out: Poses, axes_out: Rows) -> None:
    """Compute position and rotation of ``link`` in ``poses_out``, and its world axes in ``axes_out``, from its parent's pose.

    A ball's axes are the columns of its own frame: three hinges that share a centre. A free root has no joint to turn.
    """
    d, kind, parent, body = skel.first_dof[link], skel.kind[link], skel.parent[link], skel.first + link
    if kind == FREE:
        put_row(poses_out.position, body, row(posture.root, link))
        put_columns(poses_out.rotation, body, columns(posture.turn, link))
        return
    origin, frame = row(skel.anchor, link), columns(skel.rest, link)
    if parent >= 0:
        carrier = columns(poses_out.rotation, skel.first + parent)
        origin = add(row(poses_out.position, skel.first + parent), turned(carrier, origin))
        frame = product(carrier, frame)
    if kind == BALL:
        frame = product(frame, columns(posture.turn, link))
        for k in range(3):
            put_row(axes_out, d + k, frame[k])
    elif kind == HINGES:
        for j in range(d, skel.first_dof[link + 1]):
            axis, angle = turned(frame, row(skel.axis, j)), posture.angle[j]
            put_row(axes_out, j, axis)
            frame = (about(axis, angle, frame[0]), about(axis, angle, frame[1]), about(axis, angle, frame[2]))
    put_row(poses_out.position, body, origin)
    put_columns(poses_out.rotation, body, frame)


ON_AXIS = NOTHING
"""Relative to the longer of the two arms: an effector or a goal nearer than this to the joint's axis has no direction in
the joint's plane. Larger: hands close to an axis are not turned; smaller: rounding decides which way they turn."""


@kernel
def projected(p: Vec3, origin: Vec3, axis: Vec3) -> Vec3:
    """Return p' = p - (a_h . (p - o_h)) a_h (eq. 4), with o_h ``origin`` [m] and a_h ``axis``, a unit vector.

    (The printed equation calls the axis n in one of its two places.)
    """
    return along(p, -dot(axis, sub(p, origin)), axis)


@kernel
def joint_turn(origin: Vec3, axis: Vec3, effector: Vec3, goal: Vec3) -> float:
    """Return the angle phi_h [rad] (eq. 5), in [-pi, pi], about ``axis`` that brings the effector nearest to the goal.

    The printed acos has no sign, and wants unit vectors from the joint's origin. Here phi = atan2(a . (e x g), e . g) of the
    projected arms e and g. 0 if either has no direction in the joint's plane: then no turn of this joint brings them closer.
    """
    e = sub(projected(effector, origin, axis), origin)
    g = sub(projected(goal, origin, axis), origin)
    to_e, to_g = sub(effector, origin), sub(goal, origin)
    least = ON_AXIS * ON_AXIS * max(dot(to_e, to_e), dot(to_g, to_g))
    if not (dot(e, e) > least and dot(g, g) > least):
        return 0.0
    return atan2(dot(axis, cross(e, g)), dot(e, g))


@kernel
def end_effector(contacts: Rows, count: int) -> Vec3:
    """Return ee_i = sum_l c_il / k (eq. 2), the mean of the first ``count`` >= 1 contacts (n, 3) on link i [m]."""
    total = (0.0, 0.0, 0.0)
    for k in range(count):
        total = along(total, 1.0, row(contacts, k))
    return scale(total, 1.0 / count)


@kernel
def goal_of(effector: Vec3, depth: Vec3, link_is_a: bool) -> Vec3:
    """Return goal_i = ee_i + PD_gi (eq. 3) if link i is A of its pair, ee_i - PD_gi if it is B [m]; PD_g points out of B."""
    return along(effector, 1.0 if link_is_a else -1.0, depth)


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
"""Text to print for each status."""

STRAIGHT: Final = SAME_DIRECTION
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
    """Turn a ball as three hinges about its own z, y and x, within its limits; return effector and largest turn [rad]."""
    origin, frame = row(poses.position, skel.first + link), columns(poses.rotation, skel.first + link)
    before = columns(posture_out.turn, link)
    rest_frame, in_tip = frame, turned_back(frame, sub(effector, origin))
    turn = before
    for k in range(2, -1, -1):
        axis = frame[k]
        angle = joint_turn(origin, axis, effector, goal)
        effector = add(origin, about(axis, angle, sub(effector, origin)))
        frame = (about(axis, angle, frame[0]), about(axis, angle, frame[1]), about(axis, angle, frame[2]))
        turn = stepped(turn, (angle if k == 0 else 0.0, angle if k == 1 else 0.0, angle if k == 2 else 0.0))
    turn = straightened(turn)
    if has_cone(skel.balls, link):
        turn = inside_cone(skel.balls, link, turn)
    put_columns(posture_out.turn, link, turn)
    # into the axes of the joint at rest, and from there into the world
    effector = add(origin, turned(rest_frame, turned_back(before, turned(turn, in_tip))))
    return effector, norm(step_between(before, turn))


@kernel
def sweep(
    skel: Skeleton, links: Index, first: int, last: int, effector: Vec3, goal: Vec3, posture_out: Posture, poses: Poses,
    axes: Rows,
) -> tuple[Vec3, float]:
    """Turn the joints of links[last] to links[first] once each; return effector and largest turn [rad]. Poses stay as they were:
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
    """Return the unit joints of links[first .. last]: a ball counts as three."""
    count = 0
    for k in range(first, last + 1):
        if skel.kind[links[k]] == HINGES or skel.kind[links[k]] == BALL:
            count += skel.first_dof[links[k] + 1] - skel.first_dof[links[k]]
    return count


@kernel
def on_one_line(
    skel: Skeleton, links: Index, first: int, last: int, effector: Vec3, goal: Vec3, tolerance: float, poses: Poses
) -> bool:
    """Return True if effector and goal are in one line with every joint while the goal is within reach of the bent chain."""
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
    in_tip = turned_back(columns(poses_out.rotation, tip), sub(effector, row(poses_out.position, tip)))
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
        effector = add(row(poses_out.position, tip), turned(columns(poses_out.rotation, tip), in_tip))
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
    in_tip = turned_back(columns(poses_out.rotation, tip), sub(effector, row(poses_out.position, tip)))
    for k in range(first + 1, last + 1):
        link = links[k]
        if skel.kind[link] == HINGES:
            for j in range(skel.first_dof[link], skel.first_dof[link + 1]):
                before, low, high = posture_out.angle[j], skel.limits[j, 0], skel.limits[j, 1]
                side = angle if high - before >= before - low else -angle
                posture_out.angle[j] = min(max(before + side, low), high)
        elif skel.kind[link] == BALL:
            turn = straightened(stepped(columns(posture_out.turn, link), (angle, angle, angle)))
            put_columns(posture_out.turn, link, inside_cone(skel.balls, link, turn) if has_cone(skel.balls, link) else turn)
    for again in range(2):
        for k in range(first, last + 1):
            pose_link(skel, posture_out, links[k], poses_out, axes_out)
        effector = add(row(poses_out.position, tip), turned(columns(poses_out.rotation, tip), in_tip))
        if again == 0:
            sweep(skel, links, first, last - 1, effector, goal, posture_out, poses_out, axes_out)
    return effector


@kernel
def reach_goal(
    skel: Skeleton, links: Index, first: int, last: int, effector: Vec3, goal: Vec3, settings: PaperSettings,
    posture_out: Posture, poses_out: Poses, axes_out: Rows,
) -> tuple[int, int, float, bool]:
    """Run `descend`, and once more from a bent chain if it ends SINGULAR; the last value returned marks that."""
    tip = skel.first + links[last]
    in_tip = turned_back(columns(poses_out.rotation, tip), sub(effector, row(poses_out.position, tip)))
    status, sweeps, left = descend(
        skel, links, first, last, effector, goal, settings, posture_out, poses_out, axes_out
    )
    if status != SINGULAR or settings.bend == 0.0:
        return status, sweeps, left, False
    effector = add(row(poses_out.position, tip), turned(columns(poses_out.rotation, tip), in_tip))
    effector = bend(skel, links, first, last, settings.bend, effector, goal, posture_out, poses_out, axes_out)
    status, more, left = descend(skel, links, first, last, effector, goal, settings, posture_out, poses_out, axes_out)
    return status, sweeps + more, left, True


ANY_DIRECTION = (0.0, 0.0, 0.0)


@kernel
def link_contacts(geo: Geometry, poses: Poses, body: int, points_out: Rows, scratch: Scratch) -> tuple[int, int, int]:
    """Return all contacts c_il of a link (given as a body) with all pieces of other bodies that it overlaps.

    Points on the link's surface go to ``points_out``, depths and normals into the scratch, as input of eq. 1. Pairs are tested
    in the order of the bodies, so the link is A or B; normals are turned to point into the link.
    Returns (status, contacts, queries); OUT_OF_ROOM and NOT_FINITE: use none of them.
    """
    worst, count, queries = CONVERGED, 0, 0
    for other in range(poses.hulls.shape[0]):
        if other == body or not boxes_meet(poses.hulls, body, other) or not may_meet(geo.wanted, body, other):
            continue
        link_is_a = body < other
        for s in range(geo.first_shape[body], geo.first_shape[body + 1]):
            for t in range(geo.first_shape[other], geo.first_shape[other + 1]):
                if not boxes_meet(poses.boxes, s, t):
                    continue
                a, b = (s, t) if link_is_a else (t, s)
                status, gap, n, on_a, on_b = signed_distance_up_to(
                    poses.vertices, geo.shapes, a, b, ANY_DIRECTION, 0.0, scratch
                )
                queries += 1
                gap += allowed_depth(geo, a, b)
                if status == NOT_FINITE:
                    return status, 0, queries
                if status != CONVERGED:
                    worst = status
                if gap < 0.0:
                    if count == PIECES_CAP:
                        return OUT_OF_ROOM, 0, queries
                    scratch.depth[count] = -gap
                    put_row(scratch.direction, count, n if link_is_a else neg(n))
                    put_row(points_out, count, on_a if link_is_a else on_b)
                    count += 1
    return worst, count, queries


@kernel
def keep_heading(skel: Skeleton, link: int, heading: Columns, posture_out: Posture, poses_out: Poses, axes_out: Rows) -> None:
    """Turn a ball so that its link has the rotation ``heading`` again, or the nearest one inside its limits."""
    # R = B turn with B the frame at zero; B turn' = heading gives turn' = turn R^T heading
    now, turn = columns(poses_out.rotation, skel.first + link), columns(posture_out.turn, link)
    there = (turned_back(now, heading[0]), turned_back(now, heading[1]), turned_back(now, heading[2]))
    turn = straightened(product(turn, there))
    put_columns(posture_out.turn, link, inside_cone(skel.balls, link, turn) if has_cone(skel.balls, link) else turn)
    pose_link(skel, posture_out, link, poses_out, axes_out)


@kernel
def is_parallel(poses: Poses, skel: Skeleton, link: int, limb: Vec3, depth: Vec3, most_sine: float) -> bool:
    """Return True if the limb lies almost in the obstacle's surface, whose normal is that of PD_g."""
    direction = turned(columns(poses.rotation, skel.first + link), limb)
    return abs(dot(direction, depth)) < most_sine * norm(direction) * norm(depth)


@kernel
def shift_parallel_link(
    skel: Skeleton, links: NDArray[np.int64], first: int, at: int, limb: Vec3, depth: Vec3, settings: PaperSettings,
    posture_out: Posture, poses_out: Poses, axes_out: Rows,
) -> tuple[int, int, float]:
    """Shift the nearly parallel link: links[at] is moved by ``depth`` without turning, links[first .. at - 1] follow by CCD.

    The goal of the inner chain is the joint of links[at], moved; then that joint undoes the turns of the others: a ball exactly,
    hinges as far as they can. As printed but for one thing: the chain never comes apart; where the inner joints cannot reach the
    goal the link moves less. Returns CCD's (status, sweeps, gap that was left [m]).
    """
    link = links[at]
    joint, heading = row(poses_out.position, skel.first + link), columns(poses_out.rotation, skel.first + link)
    status, sweeps, left = descend(
        skel, links, first, at - 1, joint, add(joint, depth), settings, posture_out, poses_out, axes_out
    )
    pose_link(skel, posture_out, link, poses_out, axes_out)
    if skel.kind[link] == BALL:
        keep_heading(skel, link, heading, posture_out, poses_out, axes_out)
    elif skel.kind[link] == HINGES:
        moved = row(poses_out.position, skel.first + link)
        tip = add(moved, turned(columns(poses_out.rotation, skel.first + link), limb))
        _, more, _ = descend(
            skel, links, at, at, tip, add(moved, turned(heading, limb)), settings, posture_out, poses_out, axes_out
        )
        sweeps += more
    return status, sweeps, left


@kernel
def free_link(
    skel: Skeleton, links: NDArray[np.int64], first: int, at: int, limb: Vec3, points: Rows, contacts: int,
    settings: PaperSettings, posture_out: Posture, poses_out: Poses, axes_out: Rows, scratch: Scratch,
) -> tuple[int, int, int, bool, bool]:
    """Move links[at] out of its ``contacts`` (from `link_contacts`) by the joints of links[first .. at].

    Poses and axes are right afterwards for these links only. Returns (status of eq. 1, status of CCD, sweeps, whether the
    link was parallel, whether the chain had to be bent first).
    """
    status, depth = global_penetration_depth(scratch.depth, scratch.direction, contacts)
    length = norm(depth)
    if status != CONVERGED or not (length > 0.0):
        return status, NO_GOAL, 0, False, False
    depth = scale(depth, 1.0 + settings.stand_off / length)
    if at > first and is_parallel(poses_out, skel, links[at], limb, depth, settings.parallel):
        outcome, sweeps, _ = shift_parallel_link(
            skel, links, first, at, limb, depth, settings, posture_out, poses_out, axes_out
        )
        return status, outcome, sweeps, True, False
    effector = end_effector(points, contacts)
    # the contacts' normals all point into the link, which is therefore A
    goal = goal_of(effector, depth, True)
    outcome, sweeps, _, bent = reach_goal(
        skel, links, first, at, effector, goal, settings, posture_out, poses_out, axes_out
    )
    return status, outcome, sweeps, False, bent
