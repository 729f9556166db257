"""Bodies to collide in the tests, and exact or brute-force answers to compare with."""

from dataclasses import dataclass
from itertools import product

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import ConvexHull
from scipy.spatial.transform import Rotation

from avatarsim.collision.scratch import make_scratch
from avatarsim.collision.signed_distance import signed_distance
from avatarsim.model.geometry import ELLIPSOID, POINTS, Shapes, make_shapes

Array = NDArray[np.float64]
SCRATCH = make_scratch()
NO_SEED = (0.0, 0.0, 0.0)


@dataclass(frozen=True)
class Solid:
    """A convex shape in world coordinates: points, or the centre and three semi-axes of an ellipsoid."""

    rows: Array
    radius: float = 0.0
    kind: int = POINTS

    @property
    def size(self) -> float:
        """Largest extent [m]."""
        if self.kind == ELLIPSOID:
            return float(2.0 * np.linalg.norm(self.rows[1:], axis=1).max())
        return float(np.linalg.norm(np.ptp(self.rows, axis=0)) + 2.0 * self.radius)

    def moved(
        self, turn: Rotation | None = None, shift: object = (0.0, 0.0, 0.0), scale: float = 1.0
    ) -> "Solid":
        """Scale, turn about the origin, then shift."""
        rows = self.rows * scale
        rows = rows if turn is None else turn.apply(rows)
        rows[slice(None) if self.kind == POINTS else slice(0, 1)] += np.asarray(shift)
        return Solid(np.ascontiguousarray(rows), self.radius * scale, self.kind)


def ball(radius: float) -> Solid:
    """Return a sphere about the origin."""
    return Solid(np.zeros((1, 3)), radius)


def capsule(radius: float, half_length: float) -> Solid:
    """Return a capsule along x."""
    return Solid(np.array([[-half_length, 0.0, 0.0], [half_length, 0.0, 0.0]]), radius)


def box(*half: float) -> Solid:
    """Return a box about the origin."""
    return Solid(np.array(list(product(*((-h, h) for h in half)))))


def ellipsoid(*axes: float) -> Solid:
    """Return a smooth ellipsoid about the origin."""
    return Solid(np.vstack([np.zeros(3), np.diag(axes)]), 0.0, ELLIPSOID)


def hull_of_ellipsoid(axes: tuple[float, float, float], turns: int = 10, rings: int = 5) -> Solid:
    """Return a polytope with 52 corners on an ellipsoid, as the links of an avatar are."""
    points = [(0.0, 0.0, 1.0), (0.0, 0.0, -1.0)]
    for ring in range(1, rings + 1):
        polar = np.pi * ring / (rings + 1)
        for k in range(turns):
            turn = 2 * np.pi * k / turns
            points.append((np.sin(polar) * np.cos(turn), np.sin(polar) * np.sin(turn), np.cos(polar)))
    return Solid(np.array(points) * np.array(axes))


def random_hull(rng: np.random.Generator, count: int = 30) -> Solid:
    """Return corners of the hull of random points in a stretched ball of about 1 m."""
    points = rng.normal(size=(count, 3))
    points *= rng.uniform(0.3, 1.0, 3) * 0.5 / np.linalg.norm(points, axis=1, keepdims=True)
    return Solid(np.ascontiguousarray(points[np.unique(ConvexHull(points).simplices)]))


def as_arrays(*solids: Solid) -> tuple[Array, Shapes]:
    """Return vertex rows and shape arrays of several solids."""
    starts = np.cumsum([0, *(len(s.rows) for s in solids)]).astype(np.int64)
    rows = np.ascontiguousarray(np.vstack([s.rows for s in solids]))
    return rows, make_shapes([s.kind for s in solids], starts, [s.radius for s in solids], [s.size for s in solids])


def ask(
    a: Solid, b: Solid, seed: tuple[float, float, float] = NO_SEED
) -> tuple[int, float, Array, Array, Array]:
    """Return `signed_distance` of two solids, vectors as arrays."""
    vertices, shapes = as_arrays(a, b)
    status, gap, n, on_a, on_b = signed_distance(vertices, shapes, 0, 1, seed, SCRATCH)
    return status, gap, np.array(n), np.array(on_a), np.array(on_b)
