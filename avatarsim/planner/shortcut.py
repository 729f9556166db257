"""Random shortcuts: straight certified steps between two places of a path take the place of what lies between (Geraerts and Overmars 2007)."""

from avatarsim.ik.state import Avatars
from avatarsim.kernel import kernel
from avatarsim.planner.sample import drawn
from avatarsim.planner.state import NODES, NONE, Phase, Plan
from avatarsim.planner.tree import AIM
from avatarsim.world.skeleton import Skeleton

CUT, TRY_CUT = int(Phase.CUT), int(Phase.TRY_CUT)

SHORTCUTS = 12
"""Shortcuts that are tried on a path. Fewer: limbs wave about; more: the search takes longer than they spare."""

SHORT = 4
"""Nodes of a path, or of a part of one, that is not worth a shortcut: as many steps as it takes to see that one fails."""


@kernel
def begin_cut(skel: Skeleton, avatars: Avatars, avatar: int, plan_out: Plan) -> bool:
    """Choose two places of the path between which a straight way is tried; False: it stays as it is."""
    s = plan_out.searches
    length = s.length[avatar]
    spare = length - 1 - SHORT
    if s.cuts[avatar] >= SHORTCUTS or spare < 1 or s.count[avatar] >= NODES:
        s.at[avatar] = NONE
        return False
    s.cuts[avatar] += 1
    start = int(drawn(avatar, plan_out) * spare)
    end = start + SHORT + 1 + int(drawn(avatar, plan_out) * (length - 1 - SHORT - start))
    s.cut_from[avatar], s.cut_to[avatar] = start, min(end, length - 1)
    s.begun[avatar], s.at[avatar], s.phase[avatar] = s.count[avatar], plan_out.path[avatar, start], TRY_CUT
    last = plan_out.path[avatar, s.cut_to[avatar]]
    for i in range(plan_out.node.shape[2]):
        plan_out.node[avatar, AIM, i] = plan_out.node[avatar, last, i]
    return True


@kernel
def end_cut(avatar: int, has_reached: bool, is_trapped: bool, plan_out: Plan) -> None:
    """After a step of a shortcut: if it has arrived its nodes are put into the path, if it is trapped or too long it is dropped."""
    s, path = plan_out.searches, plan_out.path
    start, end, begun = s.cut_from[avatar], s.cut_to[avatar], s.begun[avatar]
    steps = s.count[avatar] - begun
    if has_reached and steps < end - start:
        for k in range(steps):
            path[avatar, start + 1 + k] = begun + k
        spared = end - start - 1 - steps
        for k in range(end, s.length[avatar]):
            path[avatar, k - spared] = path[avatar, k]
        s.length[avatar] -= spared
        s.phase[avatar] = CUT
    elif has_reached or is_trapped or steps >= end - start:
        s.count[avatar], s.phase[avatar] = begun, CUT
    if s.phase[avatar] == CUT:
        s.at[avatar] = NONE
