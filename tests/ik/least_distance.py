"""Least-distance problems by non-negative least squares (Lawson and Hanson 1974, chapter 23), as the dumb twin of the QP."""

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import nnls

Array = NDArray[np.float64]


def least_distance(rows: Array, bound: Array) -> tuple[Array, Array]:
    """The shortest y with rows @ y >= bound, and the multipliers with which y = rows^T multipliers."""
    system = np.vstack([rows.T, bound])
    wanted = np.zeros(len(system))
    wanted[-1] = 1.0
    found, _ = nnls(system, wanted)
    left = system @ found - wanted
    assert left[-1] < -1e-9, "the conditions contradict each other"
    return left[:-1] / -left[-1], found / -left[-1]


def nearest_step(metric: Array, step: Array, rows: Array, bound: Array) -> Array:
    """The x nearest to `step` in `metric` (n, n) with rows @ x >= bound."""
    root = np.linalg.cholesky(metric).T
    moved = np.linalg.solve(root.T, rows.T).T
    y, _ = least_distance(moved, bound - rows @ step)
    return np.asarray(step + np.linalg.solve(root, y))
