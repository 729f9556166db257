"""Factors whose products miss a table of pairs by the least at worst.

How far a product may be off bounds the sum of two logarithms from both sides. Factors within a given miss are a convex set, so
halving finds the smallest miss there is, not just one near the first guess; of that set the point nearest to the guess is taken,
which is one point, and alike for bodies that are alike.
"""

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import nnls

Array = NDArray[np.float64]
Indices = NDArray[np.int64]

CLOSE = 1e-5
"""Between two misses [of a coefficient]: the search ends."""


def least_worst(first: Indices, second: Indices, wanted: Array, weight: Array, guess: Array) -> Array:
    """Return logarithms of factors (n,) for pairs (m,) of the factors `first` and `second`: the largest of weight |product -
    wanted| is smallest, and they are as near to `guess` (n,) as that allows.

    `wanted` (m,) and `weight` (m,) are above 0.
    """
    pairs = np.arange(len(wanted))
    sums = np.zeros((len(wanted), len(guess)))
    np.add.at(sums, (pairs, first), 1.0)
    np.add.at(sums, (pairs, second), 1.0)

    def missed(logs: Array) -> float:
        return float((weight * np.abs(np.exp(sums @ logs) - wanted)).max())

    best, low, high = guess, 0.0, missed(guess)
    while high - low > CLOSE:
        miss = 0.5 * (low + high)
        least = wanted - miss / weight
        bounded = least > 0.0
        most = np.concatenate([np.log(wanted + miss / weight), -np.log(least[bounded])])
        near = nearest_within(guess, np.vstack([sums, -sums[bounded]]), most)
        if near is not None and missed(near) < miss + CLOSE:
            best, high = near, miss
        else:
            low = miss
    return best


def nearest_within(guess: Array, rows: Array, most: Array) -> Array | None:
    """Return the point x (n,) nearest to `guess` (n,) with rows (k, n) x <= most (k,); None if there is none (Lawson and Hanson,
    Solving Least Squares Problems, chapter 23: least distance programming)."""
    lacks = rows @ guess - most
    if not (lacks > 0.0).any():
        return guess
    system = np.vstack([-rows.T, lacks])
    forces, _ = nnls(system, np.append(np.zeros(len(guess)), 1.0), maxiter=50 * len(rows))
    rest = system @ forces
    left = 1.0 - rest[-1]
    return guess + rest[:-1] / left if left > np.finfo(np.float64).eps ** 0.75 else None
