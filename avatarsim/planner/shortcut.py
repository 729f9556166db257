"""Random shortcuts: certified steps straight between two places of a path take the place of what lies between (Geraerts,
Overmars 2007).

A path is improved before it is followed, and what is ahead of the avatar also while it is: there every other shortcut goes to
where the target is by now, since targets move on while paths are searched and followed.
"""

from avatarsim.kernel import kernel
from avatarsim.planner.sample import drawn
from avatarsim.planner.state import NODES, NONE, Phase, Plan
from avatarsim.planner.tree import AIM

CUT, TRY_CUT, TRY_END = int(Phase.CUT), int(Phase.TRY_CUT), int(Phase.TRY_END)

SHORT = 1
"""Edges of a path, or of a part of one, that are not worth a shortcut; and how many ahead of the node that is followed are left
alone, since the avatar goes on meanwhile."""


@kernel
def begin_cut(avatar: int, first: int, plan_out: Plan) -> bool:
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
    return True


@kernel
def choose_leaving(avatar: int, first: int, plan_out: Plan) -> int:
    """A place of the path, from `first` on, from which it is left for the target."""
    return int(first + int(drawn(avatar, plan_out) * (plan_out.searches.length[avatar] - first)))


@kernel
def begin_at(avatar: int, start: int, phase: int, plan_out: Plan) -> None:
    """Begin an extension at a place of the path."""
    s = plan_out.searches
    s.cut_from[avatar], s.begun[avatar] = start, s.count[avatar]
    s.at[avatar], s.phase[avatar] = plan_out.path[avatar, start], phase


@kernel
def end_cut(avatar: int, has_reached: bool, is_trapped: bool, plan_out: Plan) -> None:
    """After a step of a shortcut: if it has arrived its nodes are put into the path; it is dropped if it is trapped or longer
    than what it spares, or if the avatar has gone past where it leaves."""
    s, path = plan_out.searches, plan_out.path
    start, begun, to_end = s.cut_from[avatar], s.begun[avatar], s.phase[avatar] == TRY_END
    end = s.length[avatar] if to_end else s.cut_to[avatar]
    steps = s.count[avatar] - begun
    is_late = start < s.place[avatar] or (not to_end and steps >= end - start)
    if has_reached and not is_late:
        # what comes after it moves up; a new end may be farther than the old one
        for k in range(end, s.length[avatar]):
            path[avatar, start + 1 + steps + k - end] = path[avatar, k]
        for k in range(steps):
            path[avatar, start + 1 + k] = begun + k
        s.length[avatar] += start + 1 + steps - end
        s.phase[avatar] = CUT
    elif has_reached or is_trapped or is_late:
        s.count[avatar], s.phase[avatar] = begun, CUT
    if s.phase[avatar] == CUT:
        s.at[avatar] = NONE
