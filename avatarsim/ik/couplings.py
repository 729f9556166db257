"""Couplings in a step of the posture solver: metric, rows and bounds of followers, folded into their leaders."""

from math import inf

from avatarsim.ik.state import Avatars, ConstraintRows, IkScratch, Rig
from avatarsim.jit.kernel import kernel
from avatarsim.model.couplings import fold
from avatarsim.model.geometry import Array
from avatarsim.model.skeleton import Skeleton
from avatarsim.tolerances import ROUNDING


@kernel
def has_entry(avatars: Avatars, j: int, i: int) -> bool:
    """Return whether degree i is on the path of degree j: the factor then has an entry of both, at depth[i]."""
    return bool(avatars.depth[i] <= avatars.depth[j] and avatars.path[j, avatars.depth[i]] == i)


@kernel
def fold_metric(rig: Rig, avatar: int, factor_out: Array) -> None:
    """Replace the metric M of an avatar, before it is factored, by G^T M G, with 1 on the diagonal of followers."""
    skel, avatars = rig.skel, rig.avatars
    first, end, f = avatars.first_dof[avatar], avatars.first_dof[avatar + 1], factor_out
    found = False
    for k in range(skel.follow.shape[0]):
        found = found or first <= skel.follow[k, 0] < end
    if not found:
        return
    for j in range(first, end):
        for d in range(avatars.depth[j]):
            # entries that only the reduction fills in
            if not skel.related[avatars.joint_of[j], avatars.joint_of[avatars.path[j, d]]]:
                f[j, d] = 0.0
    for k in range(skel.follow.shape[0]):
        if first <= skel.follow[k, 0] < end:
            fold_degree(avatars, first, end, skel.follow[k, 0], skel.follow[k, 1], skel.ratio[k, 0], f)


@kernel
def fold_degree(avatars: Avatars, first: int, end: int, b: int, a: int, ratio: float, factor_out: Array) -> None:
    """Fold row and column of follower b into those of its leader a."""
    f, depth = factor_out, avatars.depth
    own, both = f[b, depth[b]], 0.0
    for j in range(first, end):
        high, low = max(j, b), min(j, b)
        if j == b or not has_entry(avatars, high, low):
            continue
        value = f[high, depth[low]]
        f[high, depth[low]] = 0.0
        if j == a:
            both = value
        elif value != 0.0:
            f[max(j, a), depth[min(j, a)]] += ratio * value
    f[a, depth[a]] += 2.0 * ratio * both + ratio * ratio * own
    f[b, depth[b]] = 1.0


@kernel
def fold_row(rig: Rig, k: int, rows_out: ConstraintRows) -> None:
    """Fold the followers' entries of row k into their leaders', over the degrees of the row's owners."""
    avatars = rig.avatars
    for side in range(2):
        avatar = rows_out.owner[k, side]
        if avatar >= 0:
            fold(rig.skel, avatars.first_dof[avatar], avatars.first_dof[avatar + 1], rows_out.jacobian[k])


@kernel
def fold_bounds(skel: Skeleton, first: int, end: int, scratch_out: IkScratch) -> None:
    """Narrow the bounds of leaders to those of their followers among the degrees first .. end, which then need none."""
    low, high = scratch_out.low, scratch_out.high
    for f in range(skel.follow.shape[0]):
        b, a, ratio = skel.follow[f, 0], skel.follow[f, 1], skel.ratio[f, 0]
        if first <= b < end:
            one, other = low[b] / ratio, high[b] / ratio
            low[a], high[a] = max(low[a], min(one, other)), min(high[a], max(one, other))
            low[b], high[b] = -inf, inf


@kernel
def share_budget(skel: Skeleton, first: int, end: int, step_out: Array) -> None:
    """Shorten a step (nd), whose followers' parts are within their own budgets, to a motion of all joints of a coupling.

    Differences of rounding are not due to budgets."""
    for f in range(skel.follow.shape[0]):
        b, a, ratio = skel.follow[f, 0], skel.follow[f, 1], skel.ratio[f, 0]
        if first <= b < end and abs(ratio * step_out[a]) - abs(step_out[b]) > ROUNDING:
            step_out[a] = step_out[b] / ratio
