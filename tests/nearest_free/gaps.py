"""Gaps between links and everything else, and how a step changes them, from the judge's shapes and coal's witness points."""

import coal
import numpy as np
from numpy.typing import NDArray

from avatarsim.scene.scene import Scene
from avatarsim.spatial import rotation
from reference.judging.distances import EPA_ITERATIONS, TOLERANCE
from reference.judging.geometry import Pieces
from tests.nearest_free.tree import Placed, Tree

Array = NDArray[np.float64]

NEAR = 0.1
"""Pairs whose boxes are further apart [m] are left out of a step: no step moves a link further."""


class Gaps:
    """Signed distances of all pairs in which a link takes part; bodies stay at positions (b, 3), orientations (b, 4)."""

    def __init__(self, scene: Scene, tree: Tree, positions: Array, orientations: Array) -> None:
        self.tree, self.pieces = tree, Pieces(scene)
        self.bodies = len(scene.bodies)
        self._positions = np.array(positions, dtype=np.float64).reshape(-1, 3)
        self._turns = rotation.to_matrix(rotation.normalised(orientations)) if self.bodies else np.zeros((0, 3, 3))
        first, second = np.triu_indices(len(self.pieces.owner), 1)
        a, b = self.pieces.owner[first], self.pieces.owner[second]
        wanted = scene.pair_filter[a, b] & ((a >= self.bodies) | (b >= self.bodies))
        self._first, self._second = first[wanted], second[wanted]
        self._places = [coal.Transform3s() for _ in self.pieces.geometries]
        self._result, self._request = coal.DistanceResult(), coal.DistanceRequest()
        self._request.enable_signed_distance = True
        self._request.gjk_tolerance = self._request.epa_tolerance = TOLERANCE
        self._request.epa_max_iterations = EPA_ITERATIONS

    def near(self, placed: Placed, reach: float) -> list[tuple[int, int]]:
        """Return pairs of pieces whose boxes come within `reach`, every piece being placed for coal."""
        positions = np.vstack([self._positions, placed.positions])
        at, turned = self.pieces.placed(positions, np.concatenate([self._turns, placed.turns]))
        low, high = self.pieces.boxes(at, turned)
        a, b = self._first, self._second
        close = ((low[a] <= high[b] + reach) & (low[b] <= high[a] + reach)).all(axis=1)
        pairs = list(zip(a[close].tolist(), b[close].tolist(), strict=True))
        for k in {k for pair in pairs for k in pair}:
            self._places[k].setTransform(turned[k], at[k])
        return pairs

    def measured(self, a: int, b: int) -> float:
        """Return the signed distance [m] of two pieces as they were placed last; witness points and normal stay in the result."""
        self._result.clear()
        shapes, places = self.pieces.geometries, self._places
        return float(coal.distance(shapes[a], places[a], shapes[b], places[b], self._request, self._result))

    def values(self, placed: Placed) -> Array:
        """Return signed distances [m] of all pairs whose boxes meet; all others are apart."""
        return np.array([self.measured(a, b) for a, b in self.near(placed, 0.0)])

    def rows(self, placed: Placed) -> tuple[Array, Array]:
        """Return signed distances (m,) [m] of all near pairs and how each changes (m, n) with the degrees of freedom."""
        found, rows = [], []
        for a, b in self.near(placed, NEAR):
            gap = self.measured(a, b)
            # coal's normal points from its first body into its second, and from a point of one to a point of the other
            normal = np.array(self._result.normal)
            if not gap <= NEAR or not np.isfinite(normal).all():
                continue
            row = np.zeros(self.tree.n)
            for piece, point, sign in ((a, self._result.getNearestPoint1(), -1.0), (b, self._result.getNearestPoint2(), 1.0)):
                link = int(self.pieces.owner[piece]) - self.bodies
                if link >= 0:
                    row += sign * (normal @ self.tree.point_rates(placed, link, np.array(point)))
            found.append(gap)
            rows.append(row)
        return np.array(found), np.array(rows).reshape(-1, self.tree.n)
