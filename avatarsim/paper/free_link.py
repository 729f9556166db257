"""Overlap removal of one link by its joints (Schmidl and Lin 2004, eqs 2 to 5): contacts, end effector, goal, CCD."""

import numpy as np
from numpy.typing import NDArray

from avatarsim.collide.global_depth import global_penetration_depth
from avatarsim.collide.scratch import PIECES_CAP, Scratch
from avatarsim.collide.signed_distance import signed_distance_up_to
from avatarsim.collide.status import CONVERGED, NOT_FINITE, OUT_OF_ROOM
from avatarsim.collide.sweep import boxes_meet
from avatarsim.jit.kernel import kernel
from avatarsim.paper.cyclic_coordinate_descent import NO_GOAL, descend, reach_goal
from avatarsim.paper.end_effector import end_effector, goal_of
from avatarsim.paper.link_pose import pose_link
from avatarsim.settings import PaperSettings
from avatarsim.spatial.tangent import Columns, columns, product, put_columns, straightened, turned, turned_back
from avatarsim.spatial.vec3 import Rows, Vec3, add, dot, neg, norm, put_row, row, scale
from avatarsim.world.geometry import Geometry, Poses
from avatarsim.world.limits import has_cone, inside_cone
from avatarsim.world.pair_filter import may_meet
from avatarsim.world.skeleton import BALL, HINGES, Posture, Skeleton

ANY_DIRECTION = (0.0, 0.0, 0.0)


@kernel
def link_contacts(geo: Geometry, poses: Poses, body: int, points_out: Rows, scratch: Scratch) -> tuple[int, int, int]:
    """All contacts c_il of a link (given as a body) with all pieces of other bodies that it overlaps.

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
    put_columns(posture_out.turn, link, inside_cone(skel, link, turn) if has_cone(skel, link) else turn)
    pose_link(skel, posture_out, link, poses_out, axes_out)


@kernel
def is_parallel(poses: Poses, skel: Skeleton, link: int, limb: Vec3, depth: Vec3, most_sine: float) -> bool:
    """Whether the limb lies almost in the obstacle's surface, whose normal is that of PD_g."""
    direction = turned(columns(poses.rotation, skel.first + link), limb)
    return abs(dot(direction, depth)) < most_sine * norm(direction) * norm(depth)


@kernel
def shift_parallel_link(
    skel: Skeleton, links: NDArray[np.int64], first: int, at: int, limb: Vec3, depth: Vec3, settings: PaperSettings,
    posture_out: Posture, poses_out: Poses, axes_out: Rows,
) -> tuple[int, int, float]:
    """The nearly parallel link: links[at] is moved by ``depth`` without turning, links[first .. at - 1] follow by CCD.

    The goal of the inner chain is the joint of links[at], moved; then that joint turns back what the others turned it: a ball
    exactly, hinges as far as they can. As printed but for one thing: the chain never comes apart; where the inner joints
    cannot reach the goal the link moves less. Returns CCD's (status, sweeps, gap that was left [m]).
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
    # the contacts' normals all point into the link, which therefore stands as A
    goal = goal_of(effector, depth, True)
    outcome, sweeps, _, bent = reach_goal(
        skel, links, first, at, effector, goal, settings, posture_out, poses_out, axes_out
    )
    return status, outcome, sweeps, False, bent
