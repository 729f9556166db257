"""Couplings of joints in the arrays of the kernels: followers set from their leaders, and the pattern of a reduced matrix.

A follower is no degree of freedom: x = G x', where x' has no followers. So gradients become G^T g, matrices G^T M G, rows J G. A
leader then moves the links of several branches, and a factor M = L^T L has entries beyond those of the tree of links; those of
any such matrix lie on the paths of its elimination tree (Davis 2006, section 4.1).
"""

import numpy as np
from numpy.typing import NDArray

from avatarsim.jit.kernel import kernel
from avatarsim.model.skeleton import Posture, Skeleton
from avatarsim.tolerances import ROUNDING

Index = NDArray[np.int64]


@kernel
def followed(skel: Skeleton, f: int, posture: Posture) -> float:
    """Return the angle or way that the leader of follower number f gives it."""
    return float(skel.ratio[f, 0] * posture.angle[skel.follow[f, 1]] + skel.ratio[f, 1])


@kernel
def set_followers(skel: Skeleton, first: int, end: int, least: float, posture_out: Posture) -> float:
    """Set the followers among the degrees first .. end that are off by more than `least` [rad, m] from their leaders; return how
    far the farthest was off, 0 where that is no more than rounding."""
    most = 0.0
    for f in range(skel.follow.shape[0]):
        b = skel.follow[f, 0]
        if first <= b < end:
            angle = followed(skel, f, posture_out)
            off = abs(angle - posture_out.angle[b])
            most = max(most, off)
            if off > least:
                posture_out.angle[b] = angle
    return most if most > ROUNDING else 0.0


@kernel
def follow_leaders(skel: Skeleton, first: int, end: int, step_out: NDArray[np.float64]) -> None:
    """Give the followers among the degrees first .. end their leaders' part of a step or of rates (nd)."""
    for f in range(skel.follow.shape[0]):
        if first <= skel.follow[f, 0] < end:
            step_out[skel.follow[f, 0]] = skel.ratio[f, 0] * step_out[skel.follow[f, 1]]


@kernel
def fold(skel: Skeleton, first: int, end: int, gradient_out: NDArray[np.float64]) -> None:
    """Add the forces on the followers among the degrees first .. end to their leaders (nd): G^T of a gradient or of momenta."""
    for f in range(skel.follow.shape[0]):
        b = skel.follow[f, 0]
        if first <= b < end:
            gradient_out[skel.follow[f, 1]] += skel.ratio[f, 0] * gradient_out[b]
            gradient_out[b] = 0.0


def elimination_parents(skel: Skeleton) -> Index:
    """Return the parent (nd) of each degree in the elimination tree of the reduced mass matrix, -1 at a root.

    Without couplings it is the degree before it on the way to the root. Followers keep their places: their rows are read while
    the matrix is reduced."""
    joint_of = np.repeat(np.arange(len(skel.kind)), np.diff(skel.first_dof))
    nd = len(joint_of)
    moved = np.tril(skel.related[np.ix_(joint_of, joint_of)])
    leader = {int(b): int(a) for b, a in skel.follow}
    columns = [set(np.flatnonzero(moved[j, :j]).tolist()) for j in range(nd)]
    if leader:
        for j, i in np.argwhere(moved):
            for one in {int(j), leader.get(int(j), int(j))}:
                for other in {int(i), leader.get(int(i), int(i))}:
                    if one != other:
                        columns[max(one, other)].add(min(one, other))
    parents = np.full(nd, -1, dtype=np.int64)
    for k in range(nd - 1, -1, -1):
        if columns[k]:
            parents[k] = max(columns[k])
            columns[parents[k]] |= columns[k] - {int(parents[k])}
    return parents
