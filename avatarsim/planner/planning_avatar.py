"""The planning avatar: certified steps of an unseen avatar, the local planner of RRT-Connect (LaValle 2006, section 5.4).

A step is one of the posture solver, towards any posture, so it slides along obstacles; all else is where it is shown.
"""

from avatarsim.ik.broad_phase import forget_near, sweep_boxes
from avatarsim.ik.gaps import least_gap
from avatarsim.ik.kinematics import carry_avatar, place_avatar, take_step, tangent_error
from avatarsim.ik.motion_budget import SLACK, keep_budget
from avatarsim.ik.objective import LOSS_RADIUS, locate, value_of
from avatarsim.ik.solve import ARRIVED
from avatarsim.ik.sqp_step import copy_poses, forget_forces, sqp_step
from avatarsim.ik.state import FORWARDS, Rig, forget_pairs
from avatarsim.ik.target import copy_posture, largest
from avatarsim.jit.kernel import kernel
from avatarsim.model.geometry import Geometry, Poses
from avatarsim.planner.state import Plan, PlanningAvatar
from avatarsim.planner.tree import get_node
from avatarsim.settings import PostureSettings

STRIDE = LOSS_RADIUS
"""[rad, and mean reaches of a link] how far a step goes at most: as far as the objective still is a square."""

LONGEST = 4.0
"""Strides that a step is long at most: each doubles the one before, until something is in the way. Longer: more
steps are refused; shorter: more nodes."""

SLOWEST = 0.1
"""Share of a stride by which the farthest link origin comes nearer where a step makes progress. Larger: extensions end where they
slide along something; smaller: they creep."""

TRAPPED, ADVANCED, REACHED = range(3)
"""Result of a step, in the words of Kuffner and LaValle (2000)."""


@kernel
def has_moved(poses: Poses, b: int, planning_avatar: PlanningAvatar) -> bool:
    """Return True if body b is shown elsewhere than the planning avatar has it."""
    for i in range(3):
        if poses.position[b, i] != planning_avatar.poses.position[b, i]:
            return True
        for k in range(3):
            if poses.rotation[b, i, k] != planning_avatar.poses.rotation[b, i, k]:
                return True
    return False


@kernel
def copy_body(geo: Geometry, b: int, poses: Poses, poses_out: Poses) -> None:
    """Copy the pose of one body, shapes and all."""
    for i in range(3):
        poses_out.position[b, i] = poses.position[b, i]
        for k in range(3):
            poses_out.rotation[b, i, k] = poses.rotation[b, i, k]
    for i in range(6):
        poses_out.hulls[b, i] = poses.hulls[b, i]
    for piece in range(geo.first_shape[b], geo.first_shape[b + 1]):
        for i in range(6):
            poses_out.boxes[piece, i] = poses.boxes[piece, i]
        for v in range(geo.shapes.start[piece], geo.shapes.start[piece + 1]):
            for i in range(3):
                poses_out.vertices[v, i] = poses.vertices[v, i]


@kernel
def notice_world(rig: Rig, settings: PostureSettings, avatar: int, poses: Poses, planning_out: PlanningAvatar) -> None:
    """Reset its world as a slice begins: all but the avatar as it is shown, and nothing remembered of earlier slices."""
    geo, skel, avatars = rig.geo, rig.skel, rig.avatars
    g, s = planning_out, planning_out.scratch
    for b in range(skel.first):
        if has_moved(poses, b, g):
            copy_body(geo, b, poses, g.poses)
            copy_body(geo, b, poses, s.trial)
        for i in range(6):
            s.swept_links[b, i] = poses.hulls[b, i]
        for piece in range(geo.first_shape[b], geo.first_shape[b + 1]):
            for i in range(6):
                s.swept[piece, i] = poses.boxes[piece, i]
    for other in range(avatars.first_link.shape[0] - 1):
        if other == avatar:
            continue
        for b in range(skel.first + avatars.first_link[other], skel.first + avatars.first_link[other + 1]):
            if has_moved(poses, b, g):
                copy_poses(rig, other, poses, g.poses)
                copy_poses(rig, other, poses, s.trial)
                break
        sweep_boxes(rig, other, g.poses, least_gap(settings.stand_off), s)
    forget_pairs(g.state.pairs)
    forget_near(g.state)
    g.state.pairs.step[0] = 0
    s.counts[:] = 0
    s.is_active[:] = 0
    s.is_active[avatar], s.members[0] = 1, avatar


@kernel
def place_planning_avatar(rig: Rig, avatar: int, planning_out: PlanningAvatar) -> None:
    """Put the planning avatar where its posture places it; its contacts from elsewhere are forgotten."""
    g = planning_out
    carry_avatar(rig, avatar, g.posture, g.scratch.still, g.poses, g.state.axes)
    place_avatar(rig, avatar, g.poses)
    copy_poses(rig, avatar, g.poses, g.scratch.trial)
    g.state.touching.used[0], g.state.contacts.used[0] = 0, 0
    g.state.pairs.step[0] += 1
    forget_forces(rig.avatars, avatar, g.state)
    g.scratch.counts[FORWARDS] += 1


@kernel
def place_at_node(rig: Rig, avatar: int, k: int, plan: Plan, planning_out: PlanningAvatar) -> None:
    """Put the planning avatar at node k."""
    get_node(rig, avatar, k, plan, planning_out.posture)
    place_planning_avatar(rig, avatar, planning_out)


@kernel
def aim_at_node(rig: Rig, avatar: int, k: int, plan: Plan, planning_out: PlanningAvatar) -> None:
    """Make node k the aim of the planning avatar."""
    get_node(rig, avatar, k, plan, planning_out.aim)


@kernel
def value_to_aim(rig: Rig, avatar: int, planning_out: PlanningAvatar) -> tuple[float, float]:
    """Return its objective [m^2] towards its aim, and the distance [m] of its farthest origin; keeps the tangent error."""
    g = planning_out
    g.state.tracking.is_located[avatar] = 0
    locate(rig, avatar, g.aim, g.state.tracking, g.scratch.objective)
    tangent_error(rig, avatar, g.posture, g.aim, g.scratch.objective.error)
    return value_of(rig, avatar, g.state, g.poses, g.scratch.objective)


@kernel
def set_carrot(rig: Rig, avatar: int, strides: float, planning_out: PlanningAvatar) -> None:
    """Set the target of the next step: on the straight way to the aim, as far as a step goes. A farther one would break the bound
    of every joint, each of them a row of the QP."""
    avatars = rig.avatars
    g, s, b, t = planning_out, planning_out.scratch, planning_out.state.budget, planning_out.state.tracking
    turn, move = strides * STRIDE, strides * STRIDE * t.reach[avatar]
    b.slack[0], b.slack[1] = SLACK * move, SLACK * turn
    for link in range(avatars.first_link[avatar], avatars.first_link[avatar + 1]):
        b.turn[link], b.move[link], b.turned[link], b.moved[link] = turn, move, 0.0, 0.0
    tangent_error(rig, avatar, g.posture, g.aim, s.step)
    keep_budget(rig, avatar, b, False, s.step)
    copy_posture(rig, avatar, g.posture, s.target)
    take_step(rig, avatar, s.step, s.target)
    t.is_located[avatar] = 0
    locate(rig, avatar, s.target, t, s.objective)
    # a whole Newton step: nothing that the planning avatar does is shown
    t.is_legal[avatar], t.share[avatar], t.keep[avatar] = 1, 1.0, 0.0


@kernel
def take_planning_step(
    rig: Rig, settings: PostureSettings, avatar: int, strides: float, most_work: int, value: float, planning_out: PlanningAvatar
) -> tuple[int, float, float]:
    """Take one step towards the aim of so many strides, where the objective was `value` before; return its result, the objective
    after it, and how long the next step may be."""
    avatars = rig.avatars
    g, reach = planning_out, planning_out.state.tracking.reach[avatar]
    set_carrot(rig, avatar, strides, g)
    moved = sqp_step(rig, settings, g.posture, g.poses, 0, 1, most_work, g.state, g.scratch)
    now, far = value_to_aim(rig, avatar, g)
    following = min(2.0 * strides, LONGEST) if g.scratch.rows.used[0] == 0 else 1.0
    if largest(g.scratch.objective.error, avatars.first_dof[avatar], avatars.first_dof[avatar + 1]) < ARRIVED:
        return REACHED, now, following
    # the measure of the progress monitor, for a step in place of a frame
    least = SLOWEST * STRIDE * reach * min(far, LOSS_RADIUS * reach)
    return (TRAPPED if moved == 0.0 or not value - now >= least else ADVANCED), now, following
