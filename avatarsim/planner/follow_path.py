"""Following a path: pure pursuit (Coulter 1992) of the farthest node in sight, as ordinary tracking within the motion budget.

A node is in sight if the straight motion to it from the shown posture is certified. On that way joints and root advance by one
factor, as far as the frame's budget lets them, so that the shown motion is a part of the certified one, and no corner is cut that
is not free.

Sight: is the straight motion from one posture to another certified, with all else where it is?

Random shortcuts: certified steps straight between two places of a path replace the path between them, if they take less time
(Geraerts and Overmars 2007).

A path is shortened from when it is found, and the part ahead of the avatar also while it is followed. Every other shortcut goes
to the target's present place, since targets move on while paths are searched, paid and followed.
"""

from avatarsim.ik.broad_phase import sweep_boxes
from avatarsim.ik.certify import certify
from avatarsim.ik.gaps import least_gap
from avatarsim.ik.inertia import SETTLING
from avatarsim.ik.kinematics import take_step, tangent_error, try_step
from avatarsim.ik.motion_budget import AT_REST, budgets_of, keep_budget, time_of
from avatarsim.ik.objective import locate
from avatarsim.ik.solve import ARRIVED, activate
from avatarsim.ik.sqp_step import copy_poses, scale_step, work_done
from avatarsim.ik.state import IkScratch, IkState, Mode, Rig
from avatarsim.ik.target import copy_posture, largest
from avatarsim.jit.kernel import kernel
from avatarsim.model.geometry import Array, Poses
from avatarsim.model.skeleton import Posture
from avatarsim.planner.state import NODES, NONE, Phase, Plan, PlanningAvatar
from avatarsim.planner.tree import AIM, drawn, get_node
from avatarsim.settings import PostureSettings
from avatarsim.tolerances import FINE


@kernel
def is_in_sight(
    rig: Rig, settings: PostureSettings, m: int, posture: Posture, poses: Poses, state_out: IkState, scratch_out: IkScratch
) -> bool:
    """Return True if the straight motion of member m, the only active one, to its target is certified; not so once the work of
    the frame is spent. The trial is left there."""
    s = scratch_out
    avatar = s.members[m]
    if work_done(s) >= settings.work:
        return False
    # data of the shown state are of the last step
    state_out.pairs.step[0] += 1
    tangent_error(rig, avatar, posture, s.target, s.step)
    try_step(rig, avatar, posture, s)
    state_out.tracking.is_certified[avatar] = 0
    return certify(rig, settings, posture, poses, m, m + 1, False, False, state_out, s) == 0


CUT, TRY_CUT, TRY_END = int(Phase.CUT), int(Phase.TRY_CUT), int(Phase.TRY_END)

SHORT = 1
"""Edges of a path, or of a part of one, that are not worth a shortcut; and how many ahead of the node that is followed are left
alone, since the avatar moves on meanwhile."""


@kernel
def begin_cut(rig: Rig, settings: PostureSettings, avatar: int, first: int, plan_out: Plan, planning_out: PlanningAvatar) -> bool:
    """Choose two places of the path, from `first` on, between which a straight way is tried; False if nothing is to gain."""
    s = plan_out.searches
    last = s.length[avatar] - 1
    if last - first <= SHORT or s.count[avatar] >= NODES:
        return False
    start = first + int(drawn(avatar, plan_out) * (last - first - SHORT))
    end = start + SHORT + 1 + int(drawn(avatar, plan_out) * (last - start - SHORT))
    s.cut_to[avatar] = min(end, last)
    begin_at(avatar, start, TRY_CUT, plan_out)
    aim_at = plan_out.path[avatar, s.cut_to[avatar]]
    for i in range(plan_out.node.shape[2]):
        plan_out.node[avatar, AIM, i] = plan_out.node[avatar, aim_at, i]
    spare(rig, settings, avatar, s.cut_to[avatar], plan_out, planning_out)
    return True


@kernel
def begin_end(rig: Rig, settings: PostureSettings, avatar: int, first: int, plan_out: Plan, planning_out: PlanningAvatar) -> None:
    """Leave the path for the present target, node AIM: from its end, if that is elsewhere, else from a place of it, from `first`
    on, for a shorter way."""
    avatars = rig.avatars
    g, s = planning_out, plan_out.searches
    last = s.length[avatar] - 1
    time_between(rig, settings, avatar, plan_out.path[avatar, last], AIM, plan_out, g)
    far = largest(g.scratch.objective.error, avatars.first_dof[avatar], avatars.first_dof[avatar + 1])
    start = last if far >= ARRIVED else first + int(drawn(avatar, plan_out) * (last - first))
    begin_at(avatar, start, TRY_END, plan_out)
    spare(rig, settings, avatar, last, plan_out, g)


@kernel
def spare(rig: Rig, settings: PostureSettings, avatar: int, end: int, plan_out: Plan, planning_out: PlanningAvatar) -> None:
    """Note how long the path takes from where the shortcut leaves it to place `end`."""
    s, path = plan_out.searches, plan_out.path
    s.spared[avatar] = 0.0
    for i in range(s.cut_from[avatar], end):
        s.spared[avatar] += time_between(rig, settings, avatar, path[avatar, i], path[avatar, i + 1], plan_out, planning_out)


@kernel
def begin_at(avatar: int, start: int, phase: int, plan_out: Plan) -> None:
    """Begin an extension at a place of the path."""
    s = plan_out.searches
    s.cut_from[avatar], s.begun[avatar] = start, s.count[avatar]
    s.at[avatar], s.phase[avatar] = plan_out.path[avatar, start], phase


@kernel
def end_cut(avatar: int, has_reached: bool, is_lost: bool, plan_out: Plan) -> None:
    """Finish a step of a shortcut: if it has arrived its nodes are put into the path; it is dropped if it is trapped or takes
    longer than the part that it spares, or if the avatar has gone past its start."""
    s, path = plan_out.searches, plan_out.path
    start, begun, to_end = s.cut_from[avatar], s.begun[avatar], s.phase[avatar] == TRY_END
    end = s.length[avatar] if to_end else s.cut_to[avatar]
    steps = s.count[avatar] - begun
    is_lost = is_lost or start < s.place[avatar]
    if has_reached and not is_lost:
        # nodes after it move up; a new end may be farther than the old one
        shift, length = start + 1 + steps - end, s.length[avatar]
        for k in range(length - end):
            j = end + k if shift <= 0 else length - 1 - k
            path[avatar, j + shift] = path[avatar, j]
        for k in range(steps):
            path[avatar, start + 1 + k] = begun + k
        s.length[avatar] += shift
        s.phase[avatar] = CUT
    elif is_lost:
        s.count[avatar], s.phase[avatar] = begun, CUT
    if s.phase[avatar] == CUT:
        s.at[avatar], s.cut_from[avatar], s.cut_to[avatar] = NONE, 0, 0


@kernel
def spares_time(rig: Rig, settings: PostureSettings, avatar: int, plan: Plan, planning_out: PlanningAvatar) -> bool:
    """Return True if a shortcut, and a straight way from its present end to its goal, takes less time than the part that it is to
    replace. From the end of the path there is no other way."""
    s, total, last = plan.searches, 0.0, plan.path[avatar, plan.searches.cut_from[avatar]]
    if s.cut_from[avatar] == s.length[avatar] - 1:
        return True
    for k in range(s.begun[avatar], s.count[avatar]):
        total += time_between(rig, settings, avatar, last, k, plan, planning_out)
        last = k
    total += time_between(rig, settings, avatar, last, AIM, plan, planning_out)
    return bool(total < s.spared[avatar])


@kernel
def time_between(
    rig: Rig, settings: PostureSettings, avatar: int, k: int, m: int, plan: Plan, planning_out: PlanningAvatar
) -> float:
    """Return the time [s] that the catch-up speeds take from node k to node m; sets posture and aim of the planning avatar."""
    g = planning_out
    get_node(rig, avatar, k, plan, g.posture)
    get_node(rig, avatar, m, plan, g.aim)
    tangent_error(rig, avatar, g.posture, g.aim, g.scratch.objective.error)
    return time_of(rig, settings, avatar, g.scratch.objective.error)


FOLLOW_PATH = int(Mode.FOLLOW_PATH)

AHEAD = 3.0
"""Budgets of a frame within which nodes are looked at. 1: kinks of the path are shown as shaking limbs; more costs work."""

AT = FINE
"""Budgets of a frame within which an avatar is at a node, and continues whether it sees the next one or not: along its edge.
Larger: it leaves that edge; smaller: it stops at nodes."""


@kernel
def aim_along_paths(
    rig: Rig, settings: PostureSettings, dt: float, posture: Posture, poses: Poses, plan_out: Plan, state_out: IkState,
    scratch_out: IkScratch,
) -> None:
    """Set the target of avatars that follow a path: a point of the straight way to the farthest of its nodes that is in sight;
    with none in sight the next node. dt = 0: again in the same frame, the same node."""
    avatars = rig.avatars
    t, s = state_out.tracking, scratch_out
    for m in range(avatars.first_link.shape[0] - 1):
        avatar = s.members[m]
        if t.mode[avatar] != FOLLOW_PATH:
            continue
        sees = look_ahead(rig, settings, m, dt, posture, poses, plan_out, state_out, s)
        t.is_led[avatar] = 1
        # a body that moves meanwhile is certified against this avatar where it is shown
        copy_poses(rig, avatar, poses, s.trial)
        sweep_boxes(rig, avatar, poses, least_gap(settings.stand_off), s)
        for j in range(avatars.first_dof[avatar], avatars.first_dof[avatar + 1]):
            s.step[j] = 0.0
            state_out.inertia.momentum[j] = 0.0 if sees else state_out.inertia.walk[j]
        if sees and dt > 0.0:
            is_last = plan_out.searches.place[avatar] == plan_out.searches.length[avatar] - 1
            go_straight(rig, avatar, is_last, posture, state_out, s)
        elif sees:
            # it has already moved along the path in this frame
            copy_posture(rig, avatar, posture, s.target)
        t.is_legal[avatar], t.is_located[avatar] = 1, 0
        locate(rig, avatar, s.target, t, s.objective)
        # the target's motion in this frame, in place of the tracker's own motion
        for j in range(avatars.first_dof[avatar], avatars.first_dof[avatar + 1]):
            s.objective.target_motion[j] = s.step[j]


@kernel
def look_ahead(
    rig: Rig, settings: PostureSettings, m: int, dt: float, posture: Posture, poses: Poses, plan_out: Plan, state_out: IkState,
    scratch_out: IkScratch,
) -> bool:
    """Make the node that member m goes to the target: the farthest in sight, as halving finds it between the first that is not
    near and the one it went to before. Return whether it is in sight."""
    s, p = scratch_out, plan_out.searches
    avatar = s.members[m]
    place, last = p.place[avatar], p.length[avatar] - 1
    activate(m, m + 1, s)
    put_target(rig, avatar, place, plan_out, s)
    farthest, next_ = place, place
    if dt > 0.0:
        p.late[avatar] += dt
        if place < last and is_near(rig, avatar, AT, posture, state_out, s):
            farthest = place + 1
            put_target(rig, avatar, farthest, plan_out, s)
        next_ = farthest
        while farthest < last and is_near(rig, avatar, AHEAD, posture, state_out, s):
            farthest += 1
            put_target(rig, avatar, farthest, plan_out, s)
    sees = is_in_sight(rig, settings, m, posture, poses, state_out, s)
    while not sees and farthest > next_:
        farthest = (next_ + farthest) // 2
        put_target(rig, avatar, farthest, plan_out, s)
        sees = is_in_sight(rig, settings, m, posture, poses, state_out, s)
    if farthest > place:
        tangent_error(rig, avatar, posture, s.target, s.step)
        p.place[avatar], p.late[avatar] = farthest, -arrival_time(rig, settings, avatar, s.step)
    return sees


@kernel
def arrival_time(rig: Rig, settings: PostureSettings, avatar: int, step: Array) -> float:
    """Return the time [s] within which an avatar that sets out from rest arrives at the end of a step (nd)."""
    return time_of(rig, settings, avatar, step) + SETTLING / settings.natural_frequency


@kernel
def put_target(rig: Rig, avatar: int, place: int, plan: Plan, scratch_out: IkScratch) -> None:
    """Make the node at a place of the path the target."""
    get_node(rig, avatar, plan.path[avatar, place], plan, scratch_out.target)


@kernel
def go_straight(rig: Rig, avatar: int, is_last: bool, posture: Posture, state: IkState, scratch_out: IkScratch) -> None:
    """Move the target towards the node as far as the budget reaches, all joints and the root by one factor.

    Its speed is low-passed by the spring, so that it begins with that of the avatar; it slows down towards the path's end."""
    avatars = rig.avatars
    s, keep = scratch_out, state.tracking.keep[avatar]
    most = state.tracking.share[avatar] / (1.0 - keep) if is_last else 1.0
    tangent_error(rig, avatar, posture, s.target, s.step)
    frames = budgets_of(rig, avatar, s.step, state.budget)
    first, last = avatars.first_dof[avatar], avatars.first_dof[avatar + 1]
    if largest(s.step, first, last) <= AT_REST * state.tracking.frame_time[avatar]:
        return
    scale_step(avatars, avatar, min(most, 1.0 / frames), s.step)
    for j in range(first, last):
        s.step[j] = keep * state.inertia.walk[j] + (1.0 - keep) * s.step[j]
    keep_budget(rig, avatar, state.budget, False, s.step)
    copy_posture(rig, avatar, posture, s.target)
    take_step(rig, avatar, s.step, s.target)


@kernel
def is_near(rig: Rig, avatar: int, ahead: float, posture: Posture, state: IkState, scratch_out: IkScratch) -> bool:
    """Return True if the target of an avatar is within so many budgets of a frame."""
    error = scratch_out.objective.error
    tangent_error(rig, avatar, posture, scratch_out.target, error)
    return budgets_of(rig, avatar, error, state.budget) <= ahead
