"""Random shortcuts: certified steps straight between two places of a path take the place of what lies between, if they take less
time (Geraerts and Overmars 2007).

A path is shortened from when it is found, and what is ahead of the avatar also while it is followed. Every other shortcut goes to
where the target is by now, since targets move on while paths are searched, paid and followed.
"""

from avatarsim.ik.kinematics import tangent_error
from avatarsim.ik.motion_budget import time_of
from avatarsim.ik.solve import ARRIVED
from avatarsim.ik.state import Avatars
from avatarsim.ik.target import largest
from avatarsim.jit.kernel import kernel
from avatarsim.planner.sample import drawn
from avatarsim.planner.state import NODES, NONE, Ghost, Phase, Plan
from avatarsim.planner.tree import AIM, get_node
from avatarsim.settings import PostureSettings
from avatarsim.world.skeleton import Skeleton

CUT, TRY_CUT, TRY_END = int(Phase.CUT), int(Phase.TRY_CUT), int(Phase.TRY_END)

SHORT = 1
"""Edges of a path, or of a part of one, that are not worth a shortcut; and how many ahead of the node that is followed are left
alone, since the avatar goes on meanwhile."""


@kernel
def begin_cut(
    skel: Skeleton, avatars: Avatars, settings: PostureSettings, avatar: int, first: int, plan_out: Plan, ghost_out: Ghost
) -> bool:
    """Choose two places of the path, from `first` on, between which a straight way is tried; False where there is nothing to
    gain."""
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
    spare(skel, avatars, settings, avatar, s.cut_to[avatar], plan_out, ghost_out)
    return True


@kernel
def begin_end(
    skel: Skeleton, avatars: Avatars, settings: PostureSettings, avatar: int, first: int, plan_out: Plan, ghost_out: Ghost
) -> None:
    """Leave the path for the target as it is by now, node AIM: from its end, if that is elsewhere, else from a place of it, from
    `first` on, for a shorter way."""
    g, s = ghost_out, plan_out.searches
    last = s.length[avatar] - 1
    time_between(skel, avatars, settings, avatar, plan_out.path[avatar, last], AIM, plan_out, g)
    far = largest(g.scratch.objective.error, avatars.first_dof[avatar], avatars.first_dof[avatar + 1])
    start = last if far >= ARRIVED else first + int(drawn(avatar, plan_out) * (last - first))
    begin_at(avatar, start, TRY_END, plan_out)
    spare(skel, avatars, settings, avatar, last, plan_out, g)


@kernel
def spare(
    skel: Skeleton, avatars: Avatars, settings: PostureSettings, avatar: int, end: int, plan_out: Plan, ghost_out: Ghost
) -> None:
    """Note how long the path takes from where the shortcut leaves it to place `end`."""
    s, path = plan_out.searches, plan_out.path
    s.spared[avatar] = 0.0
    for i in range(s.cut_from[avatar], end):
        s.spared[avatar] += time_between(
            skel, avatars, settings, avatar, path[avatar, i], path[avatar, i + 1], plan_out, ghost_out
        )


@kernel
def begin_at(avatar: int, start: int, phase: int, plan_out: Plan) -> None:
    """Begin an extension at a place of the path."""
    s = plan_out.searches
    s.cut_from[avatar], s.begun[avatar] = start, s.count[avatar]
    s.at[avatar], s.phase[avatar] = plan_out.path[avatar, start], phase


@kernel
def end_cut(avatar: int, has_reached: bool, is_lost: bool, plan_out: Plan) -> None:
    """After a step of a shortcut: if it has arrived its nodes are put into the path; it is dropped if it is trapped or takes
    longer than what it spares, or if the avatar has gone past where it leaves."""
    s, path = plan_out.searches, plan_out.path
    start, begun, to_end = s.cut_from[avatar], s.begun[avatar], s.phase[avatar] == TRY_END
    end = s.length[avatar] if to_end else s.cut_to[avatar]
    steps = s.count[avatar] - begun
    is_lost = is_lost or start < s.place[avatar]
    if has_reached and not is_lost:
        # what comes after it moves up; a new end may be farther than the old one
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
def spares_time(
    skel: Skeleton, avatars: Avatars, settings: PostureSettings, avatar: int, plan: Plan, ghost_out: Ghost
) -> bool:
    """Whether a shortcut, and a straight way from where it has come to on to where it goes, takes less time than what it is to
    take the place of. From the end of the path there is no other way."""
    s, total, last = plan.searches, 0.0, plan.path[avatar, plan.searches.cut_from[avatar]]
    if s.cut_from[avatar] == s.length[avatar] - 1:
        return True
    for k in range(s.begun[avatar], s.count[avatar]):
        total += time_between(skel, avatars, settings, avatar, last, k, plan, ghost_out)
        last = k
    total += time_between(skel, avatars, settings, avatar, last, AIM, plan, ghost_out)
    return bool(total < s.spared[avatar])


@kernel
def time_between(
    skel: Skeleton, avatars: Avatars, settings: PostureSettings, avatar: int, k: int, m: int, plan: Plan, ghost_out: Ghost
) -> float:
    """Time [s] that the catch-up speeds take from node k to node m. The ghost's posture and aim are these then."""
    g = ghost_out
    get_node(skel, avatars, avatar, k, plan, g.posture)
    get_node(skel, avatars, avatar, m, plan, g.aim)
    tangent_error(skel, avatars, avatar, g.posture, g.aim, g.scratch.objective.error)
    return time_of(skel, avatars, settings, avatar, g.scratch.objective.error)
