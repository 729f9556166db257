"""RRT-Connect (Kuffner and LaValle 2000): two trees of certified steps, from the shown posture and from the goal.

Each in turn is extended towards a sample, as far as it gets, and the other towards where that ended. The first extension of all
goes straight from the start to the goal. Anytime: `search` runs until a slice of work is spent, and finds all it needs in the
Plan.
"""

from avatarsim.ik.kinematics import longest_part, tangent_error
from avatarsim.ik.sqp_step import work_done
from avatarsim.ik.state import PRODUCTS, Rig
from avatarsim.ik.target import copy_posture
from avatarsim.jit.kernel import kernel
from avatarsim.model.geometry import Poses
from avatarsim.model.skeleton import Posture
from avatarsim.planner.follow_path import SHORT, begin_cut, begin_end, end_cut, is_in_sight, spares_time
from avatarsim.planner.goal_test import CANDIDATES, aim_at_tracker, buy, is_free, is_goal, place_candidate
from avatarsim.planner.planning_avatar import (
    ADVANCED,
    LONGEST,
    REACHED,
    STRIDE,
    TRAPPED,
    aim_at_node,
    notice_world,
    place_at_node,
    place_planning_avatar,
    take_planning_step,
    value_to_aim,
)
from avatarsim.planner.state import GOAL_NODE, NODES, NONE, Outcome, Phase, Plan, PlanningAvatar
from avatarsim.planner.tree import AIM, add_node, draw_sample, get_node, keep_path, nearest_node, put_node, trace_path
from avatarsim.settings import PostureSettings

GOAL, SAMPLE, EXTEND = int(Phase.GOAL), int(Phase.SAMPLE), int(Phase.EXTEND)
CONNECT, CUT, TRY_CUT, TRY_END = int(Phase.CONNECT), int(Phase.CUT), int(Phase.TRY_CUT), int(Phase.TRY_END)

MOST_SAMPLES = 60
"""Samples after which a search has been in vain; as a rule it has run out of nodes before."""

SEARCHING, FOUND, FAILED, NO_GOAL = int(Outcome.SEARCHING), int(Outcome.FOUND), int(Outcome.FAILED), int(Outcome.NO_GOAL)


@kernel
def begin_search(rig: Rig, avatar: int, posture: Posture, plan_out: Plan) -> None:
    """Begin anew, at the shown posture."""
    s = plan_out.searches
    s.phase[avatar], s.candidate[avatar], s.samples[avatar], s.count[avatar], s.length[avatar] = GOAL, 0, 0, 0, 0
    s.tree[avatar], s.cuts[avatar], s.at[avatar], s.begun[avatar], s.meeting[avatar] = 0, 0, NONE, 0, NONE
    s.place[avatar], s.late[avatar], s.cut_from[avatar], s.cut_to[avatar], s.here[avatar] = 0, 0.0, 0, 0, 0
    s.lasts[avatar] = 0.0
    add_node(rig, avatar, posture, NONE, 0, plan_out)


@kernel
def search(
    rig: Rig, settings: PostureSettings, avatar: int, tracker: Posture, target: Posture, shown: Posture, poses: Poses,
    value: float, is_followed: bool, most_work: int, plan_out: Plan, planning_out: PlanningAvatar,
) -> int:
    """Run a slice of a search: towards `target`, the tracker's posture within limits, while the avatar is at `shown` with
    objective `value` [m^2]. is_followed: the path is followed already, and improved."""
    g, s = planning_out, plan_out.searches
    notice_world(rig, settings, avatar, poses, g)
    found, is_going_on = SEARCHING, True
    if s.phase[avatar] != GOAL and not is_followed:
        found = buy(rig, settings, avatar, tracker, target, shown, value, plan_out, g)
    if s.phase[avatar] == GOAL:
        aim_at_tracker(rig, avatar, tracker, g)
    elif s.at[avatar] >= 0:
        resume(rig, avatar, plan_out, g)
    while found == SEARCHING and is_going_on and work_done(g.scratch) < most_work:
        phase = s.phase[avatar]
        if phase == GOAL:
            found = find_goal(rig, settings, avatar, shown, target, value, plan_out, g)
        elif phase == SAMPLE:
            found = begin_extension(rig, avatar, shown, plan_out, g)
        elif phase == CUT:
            is_going_on = shorten(rig, settings, avatar, shown, target, is_followed, plan_out, g)
        else:
            extend(rig, settings, avatar, most_work, plan_out, g)
    return found


@kernel
def shorten(
    rig: Rig, settings: PostureSettings, avatar: int, shown: Posture, target: Posture, is_followed: bool, plan_out: Plan,
    planning_out: PlanningAvatar,
) -> bool:
    """Begin the next shortcut, if there is one to try: in turn within the path, and from it to the present target."""
    s = plan_out.searches
    if 2 * s.count[avatar] > NODES:
        keep_path(avatar, plan_out)
    if not is_followed:
        keep_up(rig, avatar, shown, plan_out, planning_out)
    first = s.place[avatar] + SHORT if is_followed else 0
    s.cuts[avatar] += 1
    if s.cuts[avatar] % 2 == 0 and first < s.length[avatar] and s.count[avatar] < NODES:
        copy_posture(rig, avatar, target, planning_out.posture)
        place_planning_avatar(rig, avatar, planning_out)
        if is_free(rig, settings, planning_out):
            put_node(rig, avatar, target, AIM, plan_out)
            begin_end(rig, settings, avatar, first, plan_out, planning_out)
            resume(rig, avatar, plan_out, planning_out)
            return True
    if not begin_cut(rig, settings, avatar, first, plan_out, planning_out):
        return False
    resume(rig, avatar, plan_out, planning_out)
    return True


@kernel
def keep_up(rig: Rig, avatar: int, shown: Posture, plan_out: Plan, planning_out: PlanningAvatar) -> None:
    """Add a node where the avatar is shown, once that is a stride away from the last: the path begins with its motion meanwhile,
    each step of it certified."""
    s, g, has_path = plan_out.searches, planning_out, plan_out.searches.phase[avatar] == CUT
    last = plan_out.path[avatar, 0] if has_path else s.here[avatar]
    get_node(rig, avatar, last, plan_out, g.posture)
    tangent_error(rig, avatar, g.posture, shown, g.scratch.objective.error)
    stride = STRIDE * g.state.tracking.reach[avatar]
    if longest_part(rig, avatar, g.scratch.objective.error, stride, STRIDE) <= 1.0:
        return
    k = add_node(rig, avatar, shown, last, 2 if has_path else 0, plan_out)
    if k == NONE:
        return
    if not has_path:
        s.here[avatar] = k
        return
    for i in range(s.length[avatar], 0, -1):
        plan_out.path[avatar, i] = plan_out.path[avatar, i - 1]
    plan_out.path[avatar, 0] = k
    s.length[avatar] += 1


@kernel
def resume(rig: Rig, avatar: int, plan: Plan, planning_out: PlanningAvatar) -> None:
    """Place the planning avatar at the end of the extension, with its aim."""
    place_at_node(rig, avatar, plan.searches.at[avatar], plan, planning_out)
    aim_at_node(rig, avatar, AIM, plan, planning_out)
    plan.searches.value[avatar], _ = value_to_aim(rig, avatar, planning_out)
    plan.searches.pace[avatar] = 1.0


@kernel
def find_goal(
    rig: Rig, settings: PostureSettings, avatar: int, shown: Posture, target: Posture, value: float, plan_out: Plan,
    planning_out: PlanningAvatar,
) -> int:
    """Test whether one candidate may be the goal; if so, the first extension goes straight to it."""
    s = plan_out.searches
    number = s.candidate[avatar]
    if number >= CANDIDATES:
        return NO_GOAL
    s.candidate[avatar] = number + 1
    if not place_candidate(rig, avatar, number, shown, target, planning_out):
        return SEARCHING
    if not is_goal(rig, settings, avatar, target, value, planning_out):
        return SEARCHING
    s.meeting[avatar] = add_node(rig, avatar, planning_out.posture, NONE, 1, plan_out)
    put_node(rig, avatar, planning_out.posture, AIM, plan_out)
    s.tree[avatar], s.at[avatar], s.begun[avatar], s.phase[avatar] = 0, 0, s.count[avatar], CONNECT
    resume(rig, avatar, plan_out, planning_out)
    return SEARCHING


@kernel
def begin_extension(rig: Rig, avatar: int, shown: Posture, plan_out: Plan, planning_out: PlanningAvatar) -> int:
    """Draw a sample, and go from the nearest node of the tree whose turn it is."""
    s = plan_out.searches
    keep_up(rig, avatar, shown, plan_out, planning_out)
    if s.samples[avatar] >= MOST_SAMPLES or s.count[avatar] >= NODES:
        return FAILED
    draw_sample(rig, avatar, GOAL_NODE, plan_out, planning_out)
    s.at[avatar] = nearest_node(rig, avatar, AIM, s.tree[avatar], plan_out)
    planning_out.scratch.counts[PRODUCTS] += s.count[avatar]
    s.begun[avatar], s.phase[avatar] = s.count[avatar], EXTEND
    resume(rig, avatar, plan_out, planning_out)
    return SEARCHING


@kernel
def extend(
    rig: Rig, settings: PostureSettings, avatar: int, most_work: int, plan_out: Plan, planning_out: PlanningAvatar
) -> None:
    """Take one step of the extension that is under way, and begin the next phase if it was the last."""
    s, phase = plan_out.searches, plan_out.searches.phase[avatar]
    pace = s.pace[avatar]
    outcome, s.value[avatar], s.pace[avatar] = take_planning_step(
        rig, settings, avatar, pace, most_work, s.value[avatar], planning_out
    )
    if outcome != TRAPPED and not keep_step(rig, settings, avatar, pace, plan_out, planning_out):
        outcome = TRAPPED
    if phase == TRY_CUT or phase == TRY_END:
        is_shorter = outcome != TRAPPED and spares_time(rig, settings, avatar, plan_out, planning_out)
        end_cut(avatar, outcome == REACHED, not is_shorter, plan_out)
        if s.phase[avatar] != CUT:
            aim_at_node(rig, avatar, AIM, plan_out, planning_out)
            get_node(rig, avatar, s.at[avatar], plan_out, planning_out.posture)
        return
    if outcome == ADVANCED:
        return
    if phase == CONNECT:
        end_connection(avatar, outcome == REACHED, plan_out)
    elif s.count[avatar] == s.begun[avatar]:
        s.phase[avatar], s.tree[avatar] = SAMPLE, 1 - s.tree[avatar]
    else:
        begin_connection(rig, avatar, plan_out, planning_out)


@kernel
def keep_step(
    rig: Rig, settings: PostureSettings, avatar: int, pace: float, plan_out: Plan, planning_out: PlanningAvatar
) -> bool:
    """Put a step of the extension into its last edge, or a new one if that would be longer than the longest step, or no straight
    motion that is certified; False without room.

    Short steps in contact would else fill the trees with nearly equal nodes."""
    s, g = plan_out.searches, planning_out
    s.edge[avatar] += pace
    if s.count[avatar] > s.begun[avatar] and s.edge[avatar] <= LONGEST:
        get_node(rig, avatar, plan_out.before[avatar, s.at[avatar]], plan_out, g.scratch.target)
        # back to where the edge begins, which is the same
        if is_in_sight(rig, settings, 0, g.posture, g.poses, g.state, g.scratch):
            put_node(rig, avatar, g.posture, s.at[avatar], plan_out)
            return True
    phase = s.phase[avatar]
    tree = 2 if phase == TRY_CUT or phase == TRY_END else s.tree[avatar]
    k = add_node(rig, avatar, g.posture, s.at[avatar], tree, plan_out)
    if k == NONE:
        return False
    s.at[avatar], s.edge[avatar] = k, pace
    return True


@kernel
def begin_connection(rig: Rig, avatar: int, plan_out: Plan, planning_out: PlanningAvatar) -> None:
    """Extend the other tree towards the node at which this extension ended."""
    s = plan_out.searches
    s.meeting[avatar] = s.at[avatar]
    get_node(rig, avatar, s.at[avatar], plan_out, planning_out.posture)
    put_node(rig, avatar, planning_out.posture, AIM, plan_out)
    s.tree[avatar] = 1 - s.tree[avatar]
    s.at[avatar] = nearest_node(rig, avatar, AIM, s.tree[avatar], plan_out)
    planning_out.scratch.counts[PRODUCTS] += s.count[avatar]
    s.begun[avatar], s.phase[avatar] = s.count[avatar], CONNECT
    resume(rig, avatar, plan_out, planning_out)


@kernel
def end_connection(avatar: int, has_met: bool, plan_out: Plan) -> None:
    """Join the trees if they meet, else draw the next sample, for the tree that was just extended."""
    s = plan_out.searches
    if not has_met:
        s.phase[avatar] = SAMPLE
        return
    one, other = s.at[avatar], s.meeting[avatar]
    if s.tree[avatar] == 0:
        trace_path(avatar, s.here[avatar], one, other, plan_out)
    else:
        trace_path(avatar, s.here[avatar], other, one, plan_out)
    s.phase[avatar], s.meeting[avatar], s.here[avatar] = CUT, NONE, 0
