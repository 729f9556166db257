"""Couplings of joints in the mass matrix of an avatar under load: followers folded into their leaders, G^T M G."""

from math import inf

from avatarsim.jit.kernel import kernel
from avatarsim.model.dynamics import Linkage


@kernel
def fold_limits(linkage: Linkage, low: int, high: int) -> None:
    """Narrow the rates of leaders to those of their followers among the degrees low .. high, which then have no limits."""
    skel, bounds = linkage.skeleton, linkage.bounds
    for f in range(skel.follow.shape[0]):
        b, a, ratio = skel.follow[f, 0], skel.follow[f, 1], skel.ratio[f, 0]
        if low <= b < high:
            one, other = bounds[b, 0] / ratio, bounds[b, 1] / ratio
            bounds[a, 0], bounds[a, 1] = max(bounds[a, 0], min(one, other)), min(bounds[a, 1], max(one, other))
            bounds[b, 0], bounds[b, 1] = -inf, inf


@kernel
def fold_matrix(linkage: Linkage, low: int, high: int) -> None:
    """Replace the mass matrix of the degrees low .. high by that of those that move by themselves, with 1 for each follower."""
    skel, matrix = linkage.skeleton, linkage.matrix
    for f in range(skel.follow.shape[0]):
        b, a, ratio = skel.follow[f, 0], skel.follow[f, 1], skel.ratio[f, 0]
        if not low <= b < high:
            continue
        for j in range(low, high):
            matrix[j, a - low] += ratio * matrix[j, b - low]
        for j in range(low, high):
            matrix[a, j - low] += ratio * matrix[b, j - low]
        for j in range(low, high):
            matrix[b, j - low], matrix[j, b - low] = 0.0, 0.0
        matrix[b, b - low] = 1.0
