"""A brute-force twin of the contact search: exact motion sampled densely, separation by trying every axis, then bisection."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import solve_ivp
from scipy.spatial.transform import Rotation

from avatarsim.scene.shape import ConvexHull
from reference.judging.geometry import Outline
from reference.judging.proof import largest_over_axes, largest_over_faces

Array = NDArray[np.float64]


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
        self._flying, self._outlines = (a, b), [Outline(ConvexHull(x.points)) for x in (a, b)]

    def separation(self, t: Array) -> Array:
        """Return (T,) largest gap over all axes: of the sign of the true gap, and equal to it except between corners."""
        one, other, between = self._placed(t)
        return largest_over_axes(self._outlines[0], one, self._outlines[1], other, between)

    def apart(self, t: Array) -> NDArray[np.bool_]:
        """Return (T,) whether the gap is positive; pairs of edges are tried only where no facet settles it."""
        one, other, between = self._placed(t)
        settled = largest_over_faces(self._outlines[0], one, self._outlines[1], other, between) > 0.0
        rest = ~settled
        if rest.any():
            settled[rest] = largest_over_axes(self._outlines[0], one[rest], self._outlines[1], other[rest], between[rest]) > 0.0
        return settled

    def _placed(self, t: Array) -> tuple[Array, Array, Array]:
        """Return the turns of both (T, 3, 3), and the way from the second to the first (T, 3)."""
        a, b = self._flying
        return a.turns(t), b.turns(t), a.centres(t) - b.centres(t)


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
