"""Rent or buy (ski rental: Karlin, Manasse, Rudolph and Sleator 1988): a path that leads away from the target first is followed
once waiting has cost as much as it would.

Nothing says how long a trap lasts. Waiting costs the objective of the shown postures, summed over the time for which the avatar
has been stalled; so a trap that opens as the path is begun has cost twice the waiting at most. Until then the path is kept and
shortened, and its end follows the target.
"""

from avatarsim.ik.kinematics import carry_avatar, tangent_error
from avatarsim.ik.motion_budget import time_of
from avatarsim.ik.objective import locate, value_of
from avatarsim.ik.state import FORWARDS, Avatars
from avatarsim.ik.target import copy_posture
from avatarsim.jit.kernel import kernel
from avatarsim.planner.goal_test import CLOSER
from avatarsim.planner.state import GOAL_NODE, Ghost, Outcome, Phase, Plan
from avatarsim.planner.tree import get_node
from avatarsim.settings import PostureSettings
from avatarsim.world.skeleton import Posture, Skeleton

CUT = int(Phase.CUT)
SEARCHING, FOUND, STALE = int(Outcome.SEARCHING), int(Outcome.FOUND), int(Outcome.STALE)


@kernel
def buy(
    skel: Skeleton, avatars: Avatars, settings: PostureSettings, avatar: int, tracker: Posture, target: Posture,
    shown: Posture, value: float, plan_out: Plan, ghost_out: Ghost,
) -> int:
    """What there is before a slice. STALE if the goal, or where the path ends by now, is no nearer to the target as it is than
    the avatar; FOUND if the path ends at a goal, is paid, and has been shortened for a frame. Else it is kept,
    and shortened on."""
    s, has_path = plan_out.searches, plan_out.searches.phase[avatar] >= CUT
    end = plan_out.path[avatar, s.length[avatar] - 1] if has_path else GOAL_NODE
    aim_at_tracker(skel, avatars, avatar, tracker, ghost_out)
    there = value_at(skel, avatars, avatar, end, target, plan_out, ghost_out)
    if not there < value:
        return STALE
    if not has_path:
        return SEARCHING
    before = s.lasts[avatar]
    s.lasts[avatar], price = cost_of(skel, avatars, settings, avatar, target, shown, value, plan_out, ghost_out)
    return FOUND if before > 0.0 and there <= CLOSER * value and price <= s.paid[avatar] else SEARCHING


@kernel
def aim_at_tracker(skel: Skeleton, avatars: Avatars, avatar: int, tracker: Posture, ghost_out: Ghost) -> None:
    """Link origins of the tracker."""
    ghost_out.state.tracking.is_located[avatar] = 0
    locate(skel, avatars, avatar, tracker, ghost_out.state.tracking, ghost_out.scratch.objective)


@kernel
def value_at(
    skel: Skeleton, avatars: Avatars, avatar: int, k: int, target: Posture, plan: Plan, ghost_out: Ghost
) -> float:
    """Objective [m^2] at node k. The ghost has its posture and link origins then, and no shapes."""
    g = ghost_out
    get_node(skel, avatars, avatar, k, plan, g.posture)
    carry_avatar(skel, avatars, avatar, g.posture, g.scratch.still, g.poses, g.state.axes)
    g.scratch.counts[FORWARDS] += 1
    tangent_error(skel, avatars, avatar, g.posture, target, g.scratch.objective.error)
    there, _ = value_of(skel, avatars, avatar, g.state, g.poses, g.scratch.objective)
    return there


@kernel
def cost_of(
    skel: Skeleton, avatars: Avatars, settings: PostureSettings, avatar: int, target: Posture, shown: Posture, value: float,
    plan: Plan, ghost_out: Ghost,
) -> tuple[float, float]:
    """The time [s] that a path takes, and its price [m^2 s]: the objective beyond the shown posture's, summed over that time.

    The ghost's objective holds the link origins of the tracker."""
    g, total, price, before = ghost_out, 0.0, 0.0, value
    copy_posture(skel, avatars, avatar, shown, g.aim)
    for i in range(plan.searches.length[avatar]):
        there = value_at(skel, avatars, avatar, plan.path[avatar, i], target, plan, g)
        tangent_error(skel, avatars, avatar, g.posture, g.aim, g.scratch.objective.error)
        lasts = time_of(skel, avatars, settings, avatar, g.scratch.objective.error)
        copy_posture(skel, avatars, avatar, g.posture, g.aim)
        total += lasts
        price += lasts * max(0.0, 0.5 * (before + there) - value)
        before = there
    return total, price
