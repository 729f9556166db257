"""Following a path: pure pursuit (Coulter 1992) of the farthest node in sight, as ordinary tracking within the motion budget.

In sight is a node to which the straight motion from the shown posture is certified. On that way joints and root go on by one
factor, as far as the frame's budget lets them, so that what is shown is a part of what was certified, and no corner is cut that
is not free.
"""

from avatarsim.ik.broad_phase import sweep_boxes
from avatarsim.ik.kinematics import take_step, tangent_error
from avatarsim.ik.motion_budget import budgets_of, time_of
from avatarsim.ik.objective import locate
from avatarsim.ik.solve import activate
from avatarsim.ik.sqp_step import copy_poses, scale_step
from avatarsim.ik.state import Avatars, Budget, IkScratch, IkState, Mode
from avatarsim.ik.target import copy_posture
from avatarsim.jit.kernel import kernel
from avatarsim.planner.sight import is_in_sight
from avatarsim.planner.state import Plan
from avatarsim.planner.tree import get_node
from avatarsim.settings import PostureSettings
from avatarsim.tolerances import least_gap
from avatarsim.world.geometry import Geometry, Poses
from avatarsim.world.skeleton import Posture, Skeleton

FOLLOW_PATH = int(Mode.FOLLOW_PATH)

AHEAD = 3.0
"""Budgets of a frame within which nodes are looked at. 1: kinks of the path are shown as shaking limbs; more costs work."""

AT = 0.1
"""Budgets of a frame within which an avatar is at a node, and goes on whether it sees the next one or not: along its edge."""


@kernel
def aim_along_paths(
    geo: Geometry, skel: Skeleton, avatars: Avatars, settings: PostureSettings, dt: float, posture: Posture, poses: Poses,
    plan_out: Plan, state_out: IkState, scratch_out: IkScratch,
) -> None:
    """The target of avatars that follow a path: a point of the straight way to the farthest of its nodes that is in sight; with
    none in sight the next node. dt = 0: again in the same frame, the same node."""
    t, s = state_out.tracking, scratch_out
    for m in range(avatars.first_link.shape[0] - 1):
        avatar = s.members[m]
        if t.mode[avatar] != FOLLOW_PATH:
            continue
        sees = look_ahead(geo, skel, avatars, settings, m, dt, posture, poses, plan_out, state_out, s)
        # what moves meanwhile is certified against this avatar where it is shown
        copy_poses(geo, skel, avatars, avatar, poses, s.trial)
        sweep_boxes(geo, skel, avatars, avatar, poses, least_gap(settings.stand_off), s)
        for j in range(avatars.first_dof[avatar], avatars.first_dof[avatar + 1]):
            s.step[j] = 0.0
        if sees:
            go_straight(skel, avatars, avatar, posture, state_out.budget, s)
        t.is_legal[avatar], t.is_located[avatar] = 1, 0
        locate(skel, avatars, avatar, s.target, t, s.objective)
        # what the target moves by in this frame, in place of the tracker's own motion
        for j in range(avatars.first_dof[avatar], avatars.first_dof[avatar + 1]):
            s.objective.own[j] = s.step[j]


@kernel
def look_ahead(
    geo: Geometry, skel: Skeleton, avatars: Avatars, settings: PostureSettings, m: int, dt: float, posture: Posture, poses: Poses,
    plan_out: Plan, state_out: IkState, scratch_out: IkScratch,
) -> bool:
    """Make the node that member m goes to the target: the farthest in sight, as halving finds it between the first that is not
    near and the one it went to before. Whether it is in sight."""
    s, p = scratch_out, plan_out.searches
    avatar = s.members[m]
    place, last = p.place[avatar], p.length[avatar] - 1
    activate(m, m + 1, s)
    put_target(skel, avatars, avatar, place, plan_out, s)
    farthest, next_ = place, place
    if dt > 0.0:
        p.late[avatar] += dt
        if place < last and is_near(skel, avatars, avatar, AT, posture, state_out, s):
            farthest = place + 1
            put_target(skel, avatars, avatar, farthest, plan_out, s)
        next_ = farthest
        while farthest < last and is_near(skel, avatars, avatar, AHEAD, posture, state_out, s):
            farthest += 1
            put_target(skel, avatars, avatar, farthest, plan_out, s)
    sees = is_in_sight(geo, skel, avatars, settings, m, posture, poses, state_out, s)
    while not sees and farthest > next_:
        farthest = (next_ + farthest) // 2
        put_target(skel, avatars, avatar, farthest, plan_out, s)
        sees = is_in_sight(geo, skel, avatars, settings, m, posture, poses, state_out, s)
    if farthest > place:
        tangent_error(skel, avatars, avatar, posture, s.target, s.step)
        p.place[avatar], p.late[avatar] = farthest, -time_of(skel, avatars, settings, avatar, s.step)
    return sees


@kernel
def put_target(skel: Skeleton, avatars: Avatars, avatar: int, place: int, plan: Plan, scratch_out: IkScratch) -> None:
    """Make the node at a place of the path the target."""
    get_node(skel, avatars, avatar, plan.path[avatar, place], plan, scratch_out.target)


@kernel
def go_straight(
    skel: Skeleton, avatars: Avatars, avatar: int, posture: Posture, budget: Budget, scratch_out: IkScratch
) -> None:
    """The target: as far on the straight way to the node as the budget reaches, all joints and the root by one factor."""
    s = scratch_out
    tangent_error(skel, avatars, avatar, posture, s.target, s.step)
    frames = budgets_of(skel, avatars, avatar, s.step, budget)
    if frames > 1.0:
        scale_step(avatars, avatar, 1.0 / frames, s.step)
        copy_posture(skel, avatars, avatar, posture, s.target)
        take_step(skel, avatars, avatar, s.step, s.target)


@kernel
def is_near(
    skel: Skeleton, avatars: Avatars, avatar: int, ahead: float, posture: Posture, state: IkState, scratch_out: IkScratch
) -> bool:
    """Whether the target of an avatar is within so many budgets of a frame."""
    error = scratch_out.objective.error
    tangent_error(skel, avatars, avatar, posture, scratch_out.target, error)
    return budgets_of(skel, avatars, avatar, error, state.budget) <= ahead
