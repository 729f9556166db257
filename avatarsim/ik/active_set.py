"""Active set of a least-distance problem: non-negative least squares on the Gram matrix of the active rows (Lawson and Hanson
1974, chapter 23), from where projected Gauss-Seidel has come.

Sweeps find at once which of few rows press. Where several all but say the same, as the corners of a foot on the floor do, they
come no nearer for dozens of sweeps; a step that breaks its rows is then refused, and the limb is shown behind.
"""

from math import sqrt

from avatarsim.ik.state import MOST_PRESSED, ConstraintRows
from avatarsim.jit.kernel import kernel
from avatarsim.tolerances import REGULAR

CHANGES = 24
"""Rows that come or go at most; what is reached then is as good as more sweeps would be."""

MET = 1e-3
"""Share of the sweeps' tolerance by which a condition may stay broken."""


@kernel
def finish(tolerance: float, rows_out: ConstraintRows) -> bool:
    """From the present multipliers to those of the solution; if it does not get there they are left as they were."""
    r = rows_out
    for k in range(r.used[0]):
        r.before[k] = r.multiplier[k]
    if find_active(tolerance, r):
        return True
    for k in range(r.used[0]):
        r.multiplier[k] = r.before[k]
    return False


@kernel
def find_active(tolerance: float, rows_out: ConstraintRows) -> bool:
    """The same, but that multipliers and residuals are anywhere if it does not get there."""
    r, size, done = rows_out, 0, 0
    for k in range(r.used[0]):
        if r.multiplier[k] > 0.0:
            if size == r.active.shape[0]:
                return False
            r.active[size] = k
            size += 1
    for _ in range(CHANGES):
        if not extend(done, size, r):
            return False
        solve_change(size, r)
        share, first = 1.0, -1
        for i in range(size):
            here = r.multiplier[r.active[i]]
            if not (here + r.change[i] < MOST_PRESSED):
                return False
            if here + share * r.change[i] < 0.0:
                share, first = -here / r.change[i], i
        change_multipliers(size, share, r)
        done = size
        if first >= 0:
            r.multiplier[r.active[first]] = 0.0
            size -= 1
            for i in range(first, size):
                r.active[i] = r.active[i + 1]
            done = first
            continue
        worst, found = -MET * tolerance, -1
        for k in range(r.used[0]):
            if r.multiplier[k] == 0.0 and r.residual[k] < worst:
                worst, found = r.residual[k], k
        if found < 0:
            return True
        if size == r.active.shape[0]:
            return False
        r.active[size] = found
        size += 1
    return False


@kernel
def change_multipliers(size: int, share: float, rows_out: ConstraintRows) -> None:
    """Go a share of the change, and bring the residuals of all rows up to date."""
    r = rows_out
    for i in range(size):
        k, step = r.active[i], share * r.change[i]
        r.multiplier[k] = max(0.0, r.multiplier[k] + step)
        for q in range(r.used[0]):
            r.residual[q] += r.gram[k, q] * step


@kernel
def extend(done: int, size: int, rows_out: ConstraintRows) -> bool:
    """Cholesky's factor of the active rows' Gram matrix from row `done` on, of its diagonal the inverse; whether it has one."""
    f = rows_out.factor
    for i in range(done, size):
        k = rows_out.active[i]
        rest = rows_out.gram[k, k] * (1.0 + REGULAR)
        for j in range(i):
            t = rows_out.gram[k, rows_out.active[j]]
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
def solve_change(size: int, rows_out: ConstraintRows) -> None:
    """The change of the active multipliers that takes their residuals to zero."""
    f, change = rows_out.factor, rows_out.change
    for i in range(size):
        t = -rows_out.residual[rows_out.active[i]]
        for e in range(i):
            t -= f[i, e] * change[e]
        change[i] = t * f[i, i]
    for i in range(size - 1, -1, -1):
        t = change[i] * f[i, i]
        change[i] = t
        for e in range(i):
            change[e] -= f[i, e] * t

