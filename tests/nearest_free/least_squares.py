"""Least squares under linear inequalities: a least distance problem, solved by non-negative least squares (Lawson and Hanson)."""

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import qr, solve_triangular
from scipy.optimize import nnls

Array = NDArray[np.float64]

INFEASIBLE = 1e-9
"""Residual of the dual problem, of a right-hand side of length 1, below which the inequalities contradict one another."""
BEND = 1e-9
"""Added to the diagonal: degrees of freedom that the error does not see stay where they are. Larger would pull on the others."""
GIVE = 1e3
"""Weight of a broken row, where rows contradict one another, against 1 for a metre of error."""


def least_squares(rates: Array, error: Array, rows: Array, least: Array) -> Array | None:
    """Return the x (n,) with the smallest |rates x + error| of those with rows x >= least; None when there are none.

    rates (k, n), error (k,), rows (m, n), least (m,).
    """
    n = rates.shape[1]
    stacked = np.vstack([rates, BEND * np.eye(n)])
    q, r = qr(stacked, mode="economic")
    free = -(q.T @ np.concatenate([error, np.zeros(n)]))
    if len(rows) == 0:
        return np.asarray(solve_triangular(r, free))
    turned = solve_triangular(r, rows.T, trans="T").T
    # with z = r x - free this is: the shortest z with turned z >= least - turned free
    short = least - turned @ free
    # rows are scaled to length 1: rows of a hand and of a body then weigh alike in the dual problem
    length = np.maximum(np.linalg.norm(turned, axis=1), 1e-12)
    system = np.vstack([(turned / length[:, None]).T, (short / length)[None]])
    wanted = np.zeros(n + 1)
    wanted[n] = 1.0
    try:
        dual, _ = nnls(system, wanted, maxiter=20 * system.shape[1])
    except RuntimeError:
        return None
    residual = system @ dual - wanted
    if not -residual[n] > INFEASIBLE:
        return None
    return np.asarray(solve_triangular(r, free - residual[:n] / residual[n]))


def giving_way(rates: Array, error: Array, rows: Array, least: Array, hard: int) -> Array | None:
    """Return the same where only the first `hard` rows must hold and all others may be broken at a price."""
    n, soft = rates.shape[1], len(rows) - hard
    wide = np.zeros((rates.shape[0] + soft, n + soft))
    wide[: rates.shape[0], :n] = rates
    wide[rates.shape[0] :, n:] = GIVE * np.eye(soft)
    broken = np.vstack([np.zeros((hard, soft)), np.eye(soft)])
    found = least_squares(wide, np.concatenate([error, np.zeros(soft)]), np.hstack([rows, broken]), least)
    return None if found is None else found[:n]
