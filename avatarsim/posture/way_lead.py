"""Lead the shown avatar along a way that was found: each step is certified again, for what stands around may have moved."""

from avatarsim.kernel import kernel
from avatarsim.posture.behind import keep_others
from avatarsim.posture.goal import aim
from avatarsim.posture.motion_budget import allow_what_is_left, share_within
from avatarsim.posture.step import adopt, check, step, try_step
from avatarsim.posture.way_memory import AT, LAST, REFUSED, Way, get_node
from avatarsim.posture.workspace import ADDING, Goal, Memory
from avatarsim.settings import PostureSettings
from avatarsim.world.geometry import Geometry, Poses
from avatarsim.world.skeleton import Posture, Skeleton

AHEAD = 6
"""Nodes that one step may reach ahead, if the straight way is certified and no longer than a step may be."""

REFUSALS = 4
"""Steps that reach no further node, after which a way is given up."""


@kernel
def go_to_node(skel: Skeleton, k: int, way: Way, posture: Posture, goal_out: Goal) -> None:
    """Make place k of the path the goal, for those who are led: all others stay where they are."""
    get_node(way, way.path[k], goal_out.tracker)
    keep_others(skel, posture, goal_out, goal_out.tracker)


@kernel
def straight_to(
    geo: Geometry, skel: Skeleton, settings: PostureSettings, k: int, way: Way, posture_out: Posture, poses_out: Poses,
    memory_out: Memory,
) -> float:
    """Go straight to place k of the path, if that is certified, no longer than a step, and within what the frame's motion budget
    still holds; return which share of it was gone, 0 if none.

    The next place was a step when it was found, astray or not, but the avatar may have moved on since; towards it the share goes
    that the budget holds.
    """
    goal = memory_out.goal
    go_to_node(skel, k, way, posture_out, goal)
    to_turn, to_move = aim(skel, posture_out, settings, goal)
    astray = 1.0 if k == way.state[AT] + 1 else 0.0
    if to_turn > settings.turn_cap + astray * settings.stray_turn or to_move > settings.move_cap + astray * settings.stray_move:
        return 0.0
    share = share_within(skel, settings, goal.full, goal)
    if share < 1.0 and astray == 0.0:
        return 0.0
    for j in range(memory_out.rows.x.shape[0]):
        memory_out.rows.x[j] = share * goal.full[j]
    try_step(geo, skel, posture_out, memory_out)
    memory_out.flags[ADDING] = 0.0
    if check(geo, skel, posture_out, poses_out, settings, False, memory_out) > 0:
        return 0.0
    adopt(geo, skel, posture_out, poses_out, memory_out)
    return share


@kernel
def lead(
    geo: Geometry, skel: Skeleton, settings: PostureSettings, way_out: Way, posture_out: Posture, poses_out: Poses,
    memory_out: Memory,
) -> None:
    """One step along the path: to the farthest node ahead that can be reached, or part of the way to the next one where the
    motion budget ends; else as far as the solver gets to the next one, with what is left of the budget."""
    s, goal = way_out, memory_out.goal
    at, last = s.state[AT], s.state[LAST]
    for k in range(min(at + AHEAD, last), at, -1):
        share = straight_to(geo, skel, settings, k, s, posture_out, poses_out, memory_out)
        if share > 0.0:
            s.state[AT], s.state[REFUSED] = k if share == 1.0 else at, 0
            return
    go_to_node(skel, min(at + 1, last), s, posture_out, goal)
    allow_what_is_left(skel, settings, goal, goal.allowed)
    step(geo, skel, posture_out, poses_out, settings, memory_out)
    goal.allowed[:] = 1.0
    s.state[REFUSED] += 1
