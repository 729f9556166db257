"""The multipliers of the nearest step to the end: which conditions press is found row by row, and how hard by one solve.

Sweeps over the rows find at once which of few conditions press. Where several all but say the same, as the corners of a foot on
the floor do, they come no nearer for dozens of sweeps; a step that breaks its conditions is then refused and the limb is shown
behind. From where the sweeps have come this ends after a change or two (Lawson and Hanson's non-negative least squares).
"""

from math import sqrt

from avatarsim.kernel import kernel
from avatarsim.posture.workspace import Rows
from avatarsim.world.geometry import Array, Index

SOFTNESS = 1e-9
"""Share of its own by which the diagonal of the Gram matrix is raised: rows that say the same then share the load. 1e-6: the
certificate sees what they leave open of the conditions."""

CHANGES = 24
"""Rows that come or go at most; what is reached then is as good as more sweeps would be."""

MOST_PRESSED = 1e4
"""A multiplier beyond this says that the conditions cannot all be met: between two walls. Sweeps stop short of that."""

MET = 1e-3
"""Share of the sweeps' tolerance by which a condition may stay broken."""


@kernel
def settle(rows_out: Rows, count: int, tolerance: float) -> bool:
    """From multipliers and residuals of `count` rows to those of the nearest step, exactly; if it does not get there the
    multipliers are left as they were."""
    r = rows_out
    for k in range(count):
        r.before[k] = r.multiplier[k]
    if find_pressing(r, count, tolerance):
        return True
    for k in range(count):
        r.multiplier[k] = r.before[k]
    return False


@kernel
def find_pressing(rows_out: Rows, count: int, tolerance: float) -> bool:
    """The same, but that multipliers are anywhere if it does not get there."""
    r = rows_out
    multiplier, residual, pressing, change = r.multiplier, r.residual, r.pressing, r.change
    size, done = 0, 0
    for k in range(count):
        if multiplier[k] > 0.0:
            if size == pressing.shape[0]:
                return False
            pressing[size] = k
            size += 1
    for _ in range(CHANGES):
        if not extend(r.gram, pressing, done, size, r.factor):
            return False
        back_solve(residual, pressing, size, r.factor, change)
        share, first = 1.0, -1
        for i in range(size):
            here = multiplier[pressing[i]]
            if not (here + change[i] < MOST_PRESSED):
                return False
            if here + share * change[i] < 0.0:
                share, first = -here / change[i], i
        press(r, count, size, share)
        done = size
        if first >= 0:
            multiplier[pressing[first]] = 0.0
            size -= 1
            for i in range(first, size):
                pressing[i] = pressing[i + 1]
            done = first
            continue
        worst, found = -MET * tolerance, -1
        for k in range(count):
            if multiplier[k] == 0.0 and residual[k] < worst:
                worst, found = residual[k], k
        if found < 0:
            return True
        if size == pressing.shape[0]:
            return False
        pressing[size] = found
        size += 1
    return False


@kernel
def press(rows_out: Rows, count: int, size: int, share: float) -> None:
    """Go a share of the change, and bring the residuals of all rows up to date."""
    r = rows_out
    residual, gram = r.residual, r.gram
    for i in range(size):
        k, step = r.pressing[i], share * r.change[i]
        r.multiplier[k] = max(0.0, r.multiplier[k] + step)
        for q in range(count):
            residual[q] += gram[k, q] * step


@kernel
def extend(gram: Array, pressing: Index, done: int, size: int, factor_out: Array) -> bool:
    """Cholesky's factor of the pressing rows' Gram matrix from row `done` on, of its diagonal the inverse; whether it has one."""
    f = factor_out
    for i in range(done, size):
        k = pressing[i]
        rest = gram[k, k] * (1.0 + SOFTNESS)
        for j in range(i):
            t = gram[k, pressing[j]]
            for e in range(j):
                t -= f[i, e] * f[j, e]
            t *= f[j, j]
            f[i, j] = t
            rest -= t * t
        if not (rest > 0.0):
            return False
        f[i, i] = 1.0 / sqrt(rest)
    return True


@kernel
def back_solve(residual: Array, pressing: Index, size: int, factor: Array, change_out: Array) -> None:
    """The change of the pressing multipliers that takes their residuals to zero."""
    for i in range(size):
        t = -residual[pressing[i]]
        for e in range(i):
            t -= factor[i, e] * change_out[e]
        change_out[i] = t * factor[i, i]
    for i in range(size - 1, -1, -1):
        t = change_out[i] * factor[i, i]
        change_out[i] = t
        for e in range(i):
            change_out[e] -= factor[i, e] * t
