"""Goal test: is there a free posture near the target's, and near enough to be worth a path?

Candidates, tested one after the other: the target's posture, the target's root with the joints of the shown posture and of the
travel posture, and the same three with the root drawn aside. The first that is free and has at most half of the shown posture's
objective is the goal. A hand that presses on a table is half as near nowhere, so it is led nowhere.

Rent or buy (ski rental: Karlin, Manasse, Rudolph and Sleator 1988): a path that leads away from the target first is followed
once waiting has cost as much as it would.

It is not known how long a trap lasts. Waiting costs the objective of the shown postures, summed over the time for which the
avatar has been stalled; so a trap that opens as the path is begun has cost twice the waiting at most. Until then the path is kept
and shortened, and its end follows the target.
"""

from avatarsim.ik.certify import certify
from avatarsim.ik.kinematics import carry_avatar, tangent_error
from avatarsim.ik.motion_budget import time_of
from avatarsim.ik.objective import LOSS_RADIUS, locate, value_of
from avatarsim.ik.state import FORWARDS, Rig
from avatarsim.ik.target import copy_posture
from avatarsim.jit.kernel import kernel
from avatarsim.model.skeleton import FREE, Posture
from avatarsim.planner.planning_avatar import place_planning_avatar
from avatarsim.planner.state import GOAL_NODE, Outcome, Phase, Plan, PlanningAvatar
from avatarsim.planner.tree import get_node
from avatarsim.settings import PostureSettings
from avatarsim.spatial.vec3 import norm, put_row, row, scale, sub

CLOSER = 0.5
"""Share of the shown posture's objective that a goal has at most. Larger: avatars walk for little gain."""

JOINTS, DIRECTIONS, RINGS = 3, 7, 4
"""Postures of the joints; directions in which the root is drawn aside, six along the axes and one back to where it is shown; and
distances: half a loss radius, doubled each time. More: farther goals are found, and looking for them takes longer."""

CANDIDATES = JOINTS * (1 + DIRECTIONS * RINGS)


@kernel
def place_candidate(rig: Rig, avatar: int, number: int, shown: Posture, target: Posture, planning_out: PlanningAvatar) -> bool:
    """Put the planning avatar at a candidate; False without one of this number: without a free root, or at the target already."""
    skel = rig.skel
    g, root = planning_out, rig.avatars.first_link[avatar]
    joints, place = number % JOINTS, number // JOINTS
    if number > 0 and skel.kind[root] != FREE:
        return False
    copy_posture(rig, avatar, target if joints == 0 else shown if joints == 1 else g.travel, g.posture)
    if skel.kind[root] == FREE:
        for i in range(3):
            g.posture.root[root, i] = target.root[root, i]
            for k in range(3):
                g.posture.turn[root, i, k] = target.turn[root, i, k]
    if place > 0:
        ring, direction = (place - 1) // DIRECTIONS, (place - 1) % DIRECTIONS
        aside = 0.5 * LOSS_RADIUS * g.state.tracking.reach[avatar] * 2**ring
        if direction < DIRECTIONS - 1:
            g.posture.root[root, direction // 2] += aside if direction % 2 == 0 else -aside
        else:
            back = sub(row(shown.root, root), row(target.root, root))
            far = norm(back)
            if far < aside:
                return False
            put_row(g.posture.root, root, sub(row(target.root, root), scale(back, -aside / far)))
    place_planning_avatar(rig, avatar, g)
    return True


@kernel
def is_goal(
    rig: Rig, settings: PostureSettings, avatar: int, target: Posture, value: float, planning_out: PlanningAvatar
) -> bool:
    """Return True if the planning avatar is free where a path may end: the shown posture's objective is `value` [m^2].

    The planning avatar's own objective holds the link origins of the target."""
    g = planning_out
    tangent_error(rig, avatar, g.posture, target, g.scratch.objective.error)
    there, _ = value_of(rig, avatar, g.state, g.poses, g.scratch.objective)
    if not there <= CLOSER * value:
        return False
    return is_free(rig, settings, g)


@kernel
def is_free(rig: Rig, settings: PostureSettings, planning_out: PlanningAvatar) -> bool:
    """Return True if the planning avatar overlaps nothing and keeps its limits: then standing still is certified."""
    g = planning_out
    g.scratch.step[:] = 0.0
    g.state.tracking.is_certified[g.scratch.members[0]] = 0
    return certify(rig, settings, g.posture, g.poses, 0, 1, False, False, g.state, g.scratch) == 0


CUT = int(Phase.CUT)
SEARCHING, FOUND, STALE = int(Outcome.SEARCHING), int(Outcome.FOUND), int(Outcome.STALE)


@kernel
def buy(
    rig: Rig, settings: PostureSettings, avatar: int, tracker: Posture, target: Posture, shown: Posture, value: float,
    plan_out: Plan, planning_out: PlanningAvatar,
) -> int:
    """Return the state before a slice. STALE if the goal, or the present end of the path, is no nearer to the target as it is
    than the avatar; FOUND if the path ends at a goal, is paid, and has been shortened for a frame. Else it is kept, and shortened
    on."""
    s, has_path = plan_out.searches, plan_out.searches.phase[avatar] >= CUT
    end = plan_out.path[avatar, s.length[avatar] - 1] if has_path else GOAL_NODE
    aim_at_tracker(rig, avatar, tracker, planning_out)
    there = value_at(rig, avatar, end, target, plan_out, planning_out)
    if not there < value:
        return STALE
    if not has_path:
        return SEARCHING
    before = s.lasts[avatar]
    s.lasts[avatar], price = cost_of(rig, settings, avatar, target, shown, value, plan_out, planning_out)
    return FOUND if before > 0.0 and there <= CLOSER * value and price <= s.paid[avatar] else SEARCHING


@kernel
def aim_at_tracker(rig: Rig, avatar: int, tracker: Posture, planning_out: PlanningAvatar) -> None:
    """Compute the link origins of the tracker's posture for the planning avatar."""
    planning_out.state.tracking.is_located[avatar] = 0
    locate(rig, avatar, tracker, planning_out.state.tracking, planning_out.scratch.objective)


@kernel
def value_at(rig: Rig, avatar: int, k: int, target: Posture, plan: Plan, planning_out: PlanningAvatar) -> float:
    """Return the objective [m^2] at node k. The planning avatar has its posture and link origins then, and no shapes."""
    g = planning_out
    get_node(rig, avatar, k, plan, g.posture)
    carry_avatar(rig, avatar, g.posture, g.scratch.still, g.poses, g.state.axes)
    g.scratch.counts[FORWARDS] += 1
    tangent_error(rig, avatar, g.posture, target, g.scratch.objective.error)
    there, _ = value_of(rig, avatar, g.state, g.poses, g.scratch.objective)
    return there


@kernel
def cost_of(
    rig: Rig, settings: PostureSettings, avatar: int, target: Posture, shown: Posture, value: float, plan: Plan,
    planning_out: PlanningAvatar,
) -> tuple[float, float]:
    """Return the time [s] of a path and its price [m^2 s]: the objective beyond the shown posture's, summed over that time.

    The planning avatar's objective holds the link origins of the tracker."""
    g, total, price, before = planning_out, 0.0, 0.0, value
    copy_posture(rig, avatar, shown, g.aim)
    for i in range(plan.searches.length[avatar]):
        there = value_at(rig, avatar, plan.path[avatar, i], target, plan, g)
        tangent_error(rig, avatar, g.posture, g.aim, g.scratch.objective.error)
        lasts = time_of(rig, settings, avatar, g.scratch.objective.error)
        copy_posture(rig, avatar, g.posture, g.aim)
        total += lasts
        price += lasts * max(0.0, 0.5 * (before + there) - value)
        before = there
    return total, price
