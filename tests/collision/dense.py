"""A brute-force twin of the contact search: exact motion sampled densely, separation by trying every axis, then bisection."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import solve_ivp
from scipy.spatial import ConvexHull
from scipy.spatial.transform import Rotation

Array = NDArray[np.float64]

PARALLEL = 1e-12
"""Edges whose cross product is shorter than this [m^2] give no axis; a face or another pair of edges does."""


@dataclass(frozen=True, eq=False)
class Flying:
    """Points (n, 3) of a convex polytope about its centre of mass, in free flight from `position` and `turn` at time 0.

    `inertia` (3, 3): it tumbles by Euler's equations; None: its angular velocity stays.
    """

    points: Array
    position: Array
    turn: Rotation
    velocity: Array
    spin: Array
    pull: Array
    inertia: Array | None = None

    def centres(self, t: Array) -> Array:
        """Return (T, 3) centres of mass."""
        return np.asarray(self.position + t[:, None] * self.velocity + 0.5 * t[:, None] ** 2 * self.pull)

    def turns(self, t: Array) -> Array:
        """Return (T, 3, 3) rotations."""
        if self.inertia is None:
            return np.asarray((Rotation.from_rotvec(t[:, None] * self.spin) * self.turn).as_matrix())
        inertia, start = self.inertia, self.turn.as_matrix()
        if t[-1] == 0.0:
            return np.repeat(start[None], len(t), axis=0)

        def rate(_: float, y: Array) -> Array:
            r, w = y[:9].reshape(3, 3), y[9:]
            hat = np.array([[0, -w[2], w[1]], [w[2], 0, -w[0]], [-w[1], w[0], 0]])
            return np.concatenate([(r @ hat).ravel(), np.linalg.solve(inertia, np.cross(inertia @ w, w))])

        first = np.concatenate([start.ravel(), start.T @ self.spin])
        done = solve_ivp(rate, (0.0, float(t[-1])), first, method="DOP853", rtol=1e-13, atol=1e-15, t_eval=t)
        return np.asarray(done.y[:9].T.reshape(-1, 3, 3))


class Pair:
    """Two polytopes in flight and every axis that can separate them: all facet normals, all pairs of edges."""

    def __init__(self, a: Flying, b: Flying) -> None:
        self._flying = (a, b)
        self._normals, self._edges = zip(*(_features(x.points) for x in (a, b)), strict=True)

    def separation(self, t: Array) -> Array:
        """Return (T,) largest gap over all axes: of the sign of the true gap, and equal to it except between corners."""
        turns, points = self._poses(t)
        return np.maximum(_gap(points, self._faces(turns)), _gap(points, self._crossed(turns)))

    def apart(self, t: Array) -> NDArray[np.bool_]:
        """Return (T,) whether the gap is positive; pairs of edges are tried only where no facet settles it."""
        turns, points = self._poses(t)
        settled = np.asarray(_gap(points, self._faces(turns)) > 0.0)
        rest = np.flatnonzero(~settled)
        settled[rest] = _gap([x[rest] for x in points], self._crossed([x[rest] for x in turns])) > 0.0
        return settled

    def _poses(self, t: Array) -> tuple[list[Array], list[Array]]:
        turns = [x.turns(t) for x in self._flying]
        return turns, [x.points @ r.swapaxes(1, 2) + x.centres(t)[:, None] for x, r in zip(self._flying, turns, strict=True)]

    def _faces(self, turns: list[Array]) -> Array:
        return np.concatenate([n @ r.swapaxes(1, 2) for n, r in zip(self._normals, turns, strict=True)], axis=1)

    def _crossed(self, turns: list[Array]) -> Array:
        first, second = (e @ r.swapaxes(1, 2) for e, r in zip(self._edges, turns, strict=True))
        crossed = np.cross(first[:, :, None], second[:, None])
        return np.asarray(crossed.reshape(len(first), first.shape[1] * second.shape[1], 3))


def _features(points: Array) -> tuple[Array, Array]:
    """Return facet normals (k, 3) and edges (m, 3) of the hull."""
    hull = ConvexHull(points)
    ends = np.unique(np.sort(np.concatenate([hull.simplices[:, [i, i - 1]] for i in range(3)]), axis=1), axis=0)
    return hull.equations[:, :3], points[ends[:, 1]] - points[ends[:, 0]]


def _gap(points: list[Array], axes: Array) -> Array:
    """Return (T,) largest gap between two sets of points (T, n, 3) along any of the axes (T, k, 3)."""
    size = np.linalg.norm(axes, axis=2)
    on_a, on_b = (axes @ x.swapaxes(1, 2) for x in points)
    gaps = np.maximum(on_a.min(axis=2) - on_b.max(axis=2), on_b.min(axis=2) - on_a.max(axis=2))
    return np.asarray(np.where(size > PARALLEL, gaps / np.maximum(size, PARALLEL), -np.inf).max(axis=1))


def first_touch(apart: Callable[[Array], NDArray[np.bool_]], end: float, samples: int = 400, within: float = 0.0) -> float | None:
    """Return first t in [0, end] at which they are not apart, late by ``within`` or rounding at most; None if no sample is."""
    t = np.linspace(0.0, end, samples)
    below = np.flatnonzero(~apart(t))
    if len(below) == 0:
        return None
    assert below[0] > 0
    low, high = float(t[below[0] - 1]), float(t[below[0]])
    while high - low > within and low < 0.5 * (low + high) < high:
        middle = 0.5 * (low + high)
        low, high = (middle, high) if apart(np.array([middle]))[0] else (low, middle)
    return high
