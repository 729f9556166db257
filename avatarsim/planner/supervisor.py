"""Supervisor: which target an avatar follows. TRACK until stalled; then PLAN, and FOLLOW_PATH if there is one, else WAIT.

Each avatar for itself. While it plans it continues tracking, so a search costs it nothing but its slice of work.

Progress monitor: does the objective of an avatar that is far from its target still fall?
"""

from avatarsim.ik.inertia import terminal_speed
from avatarsim.ik.kinematics import tangent_error
from avatarsim.ik.motion_budget import AT_REST
from avatarsim.ik.objective import LOSS_RADIUS, locate, value_of
from avatarsim.ik.sqp_step import work_done
from avatarsim.ik.state import FOLLOWING, PLAN_WORK, PLANNING, WAITING, IkScratch, IkState, Mode, Rig
from avatarsim.jit.kernel import kernel
from avatarsim.model.geometry import Poses
from avatarsim.model.skeleton import Posture
from avatarsim.planner.follow_path import AT, arrival_time, is_near, put_target
from avatarsim.planner.planning_avatar import place_at_node
from avatarsim.planner.rrt_connect import begin_search, search
from avatarsim.planner.state import Outcome, Plan, PlanningAvatar
from avatarsim.settings import PostureSettings

SLOWEST = 0.25
"""Share of the catch-up speed with which all link origins come nearer where an avatar makes progress. Larger: paths are sought
for avatars that come free by themselves; smaller: those that creep along a trap are left to it."""

FALLEN = 1.0 / 3.0
"""Or share of itself by which the objective falls within the stall time: near the target most origins are there already."""


@kernel
def measure(
    rig: Rig, avatar: int, settings: PostureSettings, dt: float, poses: Poses, state_out: IkState, scratch: IkScratch
) -> float:
    """Measure progress after the steps of a frame of dt [s], with the error to the target at hand: how far the avatar is from it,
    and for how long the objective has not fallen as it must; return the objective.

    It is compared with its value a stall time before at most, at the ends of frames: a gain that is lost again to a moving target
    is no progress."""
    avatars = rig.avatars
    t = state_out.tracking
    value, far = value_of(rig, avatar, state_out, poses, scratch.objective)
    t.distance[avatar] = far
    t.since[avatar] += dt
    links = avatars.first_link[avatar + 1] - avatars.first_link[avatar]
    # the part of the objective that origins beyond the loss radius lose when they come nearer with this speed
    radius = LOSS_RADIUS * t.reach[avatar]
    least = SLOWEST * min(settings.catch_up_move, terminal_speed(settings, radius, dt)) * links * radius
    least = min(least, FALLEN * t.objective[avatar] / settings.stall_time) * t.since[avatar]
    if far <= settings.near or t.objective[avatar] - value >= least:
        t.stalled[avatar], t.since[avatar], t.objective[avatar] = 0.0, 0.0, value
    elif t.since[avatar] >= settings.stall_time:
        t.stalled[avatar] += t.since[avatar]
        t.since[avatar], t.objective[avatar] = 0.0, value
    return value


TRACK, WAIT, PLAN, FOLLOW_PATH = int(Mode.TRACK), int(Mode.WAIT), int(Mode.PLAN), int(Mode.FOLLOW_PATH)

FOUND, FAILED, NO_GOAL, STALE = int(Outcome.FOUND), int(Outcome.FAILED), int(Outcome.NO_GOAL), int(Outcome.STALE)

LONGEST_REST = 4.0
"""[s] that an avatar rests at most between two searches in vain. Longer: a way that opens is found late; shorter: work in
vain."""

LEAST_SLICE = 100
"""Least work of a slice: some two steps. Less: slices end before a step does; more: longer frames. Where there are more searches
than slices they take turns."""

NEVER, JOINTED = 0, 1
"""Values of the setting `around`."""


@kernel
def supervise(
    rig: Rig, settings: PostureSettings, tracker: Posture, dt: float, posture: Posture, poses: Poses, plan_out: Plan,
    planning_out: PlanningAvatar, state_out: IkState, scratch_out: IkScratch,
) -> None:
    """Run progress, modes, and a slice of each search after the steps of a frame of dt [s]."""
    avatars = rig.avatars
    t, counts = state_out.tracking, scratch_out.counts
    for avatar in range(avatars.first_link.shape[0] - 1):
        if t.has_arrived[avatar] > 0 and t.mode[avatar] != FOLLOW_PATH:
            t.distance[avatar], t.stalled[avatar], t.since[avatar], t.mode[avatar] = 0.0, 0.0, 0.0, TRACK
            continue
        if t.mode[avatar] == FOLLOW_PATH:
            # the located target is the path's
            t.is_located[avatar] = 0
        locate(rig, avatar, tracker, t, scratch_out.objective)
        # the clipped target, not the target that was followed
        tangent_error(rig, avatar, posture, state_out.target_before, scratch_out.objective.error)
        value = measure(rig, avatar, settings, dt, poses, state_out, scratch_out)
        choose_mode(rig, settings, avatar, dt, value, posture, plan_out, state_out)
        if t.mode[avatar] == FOLLOW_PATH:
            follow_on(rig, settings, avatar, value, posture, plan_out, state_out, scratch_out)
    search_all(rig, settings, tracker, posture, poses, plan_out, planning_out, state_out, scratch_out)
    for avatar in range(avatars.first_link.shape[0] - 1):
        counts[WAITING] += 1 if t.mode[avatar] == WAIT else 0
        counts[PLANNING] += 1 if t.mode[avatar] == PLAN else 0
        counts[FOLLOWING] += 1 if t.mode[avatar] == FOLLOW_PATH else 0


@kernel
def may_plan(rig: Rig, settings: PostureSettings, avatar: int) -> bool:
    """Return True if paths are sought for an avatar: one without joints lies on the obstacle and waits."""
    avatars = rig.avatars
    if settings.around == NEVER:
        return False
    root = avatars.first_link[avatar]
    has_joints = avatars.first_dof[avatar + 1] > rig.skel.first_dof[root + 1]
    return bool(has_joints or settings.around > JOINTED)


@kernel
def choose_mode(
    rig: Rig, settings: PostureSettings, avatar: int, dt: float, value: float, posture: Posture, plan_out: Plan,
    state_out: IkState,
) -> None:
    """Choose the mode of an avatar without the results of searches and paths."""
    t, s = state_out.tracking, plan_out.searches
    mode, is_stalled = t.mode[avatar], t.stalled[avatar] >= settings.stall_time
    if mode == FOLLOW_PATH:
        return
    if t.distance[avatar] <= settings.near or not (is_stalled or mode == PLAN):
        t.mode[avatar], s.rest[avatar], s.pause[avatar], s.paid[avatar] = TRACK, 0.0, settings.stall_time, 0.0
        return
    s.paid[avatar] += dt * value
    if mode == PLAN:
        return
    s.rest[avatar] -= dt
    t.mode[avatar] = WAIT
    if s.rest[avatar] <= 0.0 and may_plan(rig, settings, avatar):
        t.mode[avatar] = PLAN
        begin_search(rig, avatar, posture, plan_out)


@kernel
def follow_on(
    rig: Rig, settings: PostureSettings, avatar: int, value: float, posture: Posture, plan_out: Plan, state_out: IkState,
    scratch_out: IkScratch,
) -> None:
    """Update an avatar after a frame along a path: at its end the tracker is followed again; a blocked avatar searches anew.
    Along a path catch-up speeds hold in full."""
    t, s = state_out.tracking, plan_out.searches
    t.speed[avatar] = max(t.speed[avatar], AT_REST)
    last = s.length[avatar] - 1
    put_target(rig, avatar, last, plan_out, scratch_out)
    is_at_end = s.place[avatar] == last and is_near(rig, avatar, AT, posture, state_out, scratch_out)
    if is_at_end:
        set_free(avatar, value, state_out)
    elif s.late[avatar] >= settings.stall_time:
        t.mode[avatar] = PLAN
        begin_search(rig, avatar, posture, plan_out)


@kernel
def drop_paths(
    rig: Rig, tracker: Posture, posture: Posture, poses: Poses, plan: Plan, planning_out: PlanningAvatar, state_out: IkState,
    scratch_out: IkScratch,
) -> None:
    """Drop paths, as a frame begins, whose end is no nearer to the target than the avatar is."""
    t, c, g = state_out.tracking, scratch_out.objective, planning_out
    for avatar in range(rig.avatars.first_link.shape[0] - 1):
        if t.mode[avatar] != FOLLOW_PATH:
            continue
        locate(rig, avatar, tracker, t, c)
        tangent_error(rig, avatar, posture, scratch_out.target, c.error)
        here, _ = value_of(rig, avatar, state_out, poses, c)
        place_at_node(rig, avatar, plan.path[avatar, plan.searches.length[avatar] - 1], plan, g)
        tangent_error(rig, avatar, g.posture, scratch_out.target, c.error)
        there, _ = value_of(rig, avatar, state_out, g.poses, c)
        if not there < here:
            set_free(avatar, here, state_out)


@kernel
def set_free(avatar: int, value: float, state_out: IkState) -> None:
    """Let an avatar follow its tracker again; its progress is measured from here on."""
    t = state_out.tracking
    t.mode[avatar], t.stalled[avatar], t.since[avatar], t.objective[avatar] = TRACK, 0.0, 0.0, value


@kernel
def search_all(
    rig: Rig, settings: PostureSettings, tracker: Posture, posture: Posture, poses: Poses, plan_out: Plan,
    planning_out: PlanningAvatar, state_out: IkState, scratch_out: IkScratch,
) -> None:
    """Deal out the work of searches, and of improving followed paths, in turns, within the rest of the frame's budget."""
    t, count, waiting = state_out.tracking, rig.avatars.first_link.shape[0] - 1, 0
    for avatar in range(count):
        waiting += 1 if t.mode[avatar] == PLAN or t.mode[avatar] == FOLLOW_PATH else 0
    left = min(settings.work * 2 // 3, settings.work - work_done(scratch_out))
    first = plan_out.turn[0]
    for k in range(count):
        avatar = (first + k) % count
        is_followed = t.mode[avatar] == FOLLOW_PATH
        if t.mode[avatar] != PLAN and not is_followed:
            continue
        if left <= 0:
            break
        slice_ = max(LEAST_SLICE, left // waiting)
        tangent_error(rig, avatar, posture, state_out.target_before, scratch_out.objective.error)
        value, _ = value_of(rig, avatar, state_out, poses, scratch_out.objective)
        found = search(
            rig, settings, avatar, tracker, state_out.target_before, posture, poses, value, is_followed, slice_, plan_out,
            planning_out
        )
        spent = work_done(planning_out.scratch)
        left -= spent
        scratch_out.counts[PLAN_WORK] += spent
        waiting -= 1
        plan_out.turn[0] = (avatar + 1) % count
        if found == STALE:
            begin_search(rig, avatar, posture, plan_out)
        if found == FOUND:
            set_out(rig, settings, avatar, posture, plan_out, scratch_out)
        note_outcome(avatar, found, settings, plan_out, state_out)


@kernel
def set_out(rig: Rig, settings: PostureSettings, avatar: int, posture: Posture, plan_out: Plan, scratch_out: IkScratch) -> None:
    """Go from the present place of the avatar to the begin of its path."""
    s, step = plan_out.searches, scratch_out.objective.error
    put_target(rig, avatar, 0, plan_out, scratch_out)
    tangent_error(rig, avatar, posture, scratch_out.target, step)
    s.place[avatar], s.late[avatar] = 0, -arrival_time(rig, settings, avatar, step)


@kernel
def note_outcome(avatar: int, found: int, settings: PostureSettings, plan_out: Plan, state_out: IkState) -> None:
    """Act on the result of a slice. Where no goal is free it is looked for again soon, since targets move; after a search in vain
    each rest is twice as long."""
    t, s = state_out.tracking, plan_out.searches
    if found == FOUND:
        t.mode[avatar] = FOLLOW_PATH
    elif found == NO_GOAL:
        t.mode[avatar], s.rest[avatar] = WAIT, settings.stall_time
    elif found == FAILED:
        t.mode[avatar], s.rest[avatar] = WAIT, s.pause[avatar]
        s.pause[avatar] = min(2.0 * s.pause[avatar], LONGEST_REST)
