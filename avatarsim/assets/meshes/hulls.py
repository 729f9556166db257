"""Convex hulls by Qhull (Barber, Dobkin and Huhdanpaa 1996): planes, distances, depth of a surface in its hull."""

from dataclasses import dataclass

import numpy as np

from avatarsim.assets.meshes.mesh import Array, Indices
from avatarsim.assets.meshes.mesh_queries import point_triangle
from avatarsim.errors import InvalidShape
from avatarsim.scene.shape import FLATTEST_HULL

PAIRS_AT_ONCE = 400_000
"""Pairs of point and facet measured in one go, for the memory."""

PLANES_AT_ONCE = 1_000_000
"""Pairs of point and plane measured in one go, to fit into the processor's caches."""


@dataclass(frozen=True, eq=False)
class Hull:
    """Hull of `points` (n, 3): numbers `used` (k,) of those on it, outward `planes` (m, 4), `facets` (m, 3, 3) corners."""

    points: Array
    used: Indices
    planes: Array
    facets: Array

    def heights(self, points: Array) -> Array:
        """Return the signed height (n,) over the highest plane: negative inside; outside never more than the distance."""
        return highest(points, self.planes)[1]

    def distances(self, points: Array) -> Array:
        """Return the distance (n,) of points (n, 3) from the solid hull; 0 inside."""
        from scipy.spatial import KDTree

        found = np.zeros(len(points))
        outside = np.flatnonzero(self.heights(points) > 0.0)
        middles = self.facets.mean(axis=1)
        reach = np.linalg.norm(self.facets - middles[:, None], axis=2).max(axis=1)
        near = KDTree(middles)
        step = max(1, PAIRS_AT_ONCE // len(self.facets))
        for first in range(0, len(outside), step):
            some = points[outside[first : first + step]]
            # no farther than the nearest middle, so facets that begin beyond it are not measured
            away = near.query(some)[0]
            listed = near.query_ball_point(some, (away + reach.max()) * (1.0 + 1e-9))
            of = np.repeat(np.arange(len(some)), [len(some_facets) for some_facets in listed])
            facet = np.concatenate([np.array(some_facets, dtype=np.int64) for some_facets in listed])
            kept = np.linalg.norm(some[of] - middles[facet], axis=1) - reach[facet] <= away[of] * (1.0 + 1e-9)
            of, facet = of[kept], facet[kept]
            best = np.full(len(some), np.inf)
            np.minimum.at(best, of, point_triangle(some[of], self.facets[facet]))
            found[outside[first : first + step]] = best
        return found


def highest(points: Array, planes: Array) -> tuple[Indices, Array]:
    """Return for each of the points (n, 3) the plane (of m, 4) that it is highest over, and its signed height."""
    facets, heights = np.empty(len(points), dtype=np.int64), np.empty(len(points))
    step = max(1, PLANES_AT_ONCE // len(planes))
    for first in range(0, len(points), step):
        some = slice(first, first + step)
        over = points[some] @ planes[:, :3].T + planes[:, 3]
        facets[some] = over.argmax(axis=1)
        heights[some] = over[np.arange(len(over)), facets[some]]
    return facets, heights


def hull_of(points: Array, name: str) -> Hull:
    """Return the hull of points (n, 3); InvalidShape, which names `name`, when they have no volume."""
    from scipy.spatial import ConvexHull, QhullError

    centred = points - points.mean(axis=0)
    spread = np.linalg.svd(centred, compute_uv=False) if len(points) >= 4 else np.zeros(3)
    thickness = float(spread[2] / spread[0]) if spread[0] > 0.0 else 0.0
    valid = f"above {FLATTEST_HULL:g}: a flat mesh has no volume; give it thickness, or use a Box"
    if not thickness > FLATTEST_HULL:
        raise InvalidShape(f"thickness of {name} relative to its extent", thickness, valid)
    try:
        found = ConvexHull(points)
    except QhullError as error:
        raise InvalidShape(f"thickness of {name} relative to its extent", thickness, valid) from error
    used = np.sort(np.asarray(found.vertices, dtype=np.int64))
    return Hull(points, used, np.unique(found.equations, axis=0), points[found.simplices])


def depth_below(hull: Hull, corners: Array) -> float:
    """Return an upper bound of the depth of the surface (t, 3, 3), which lies in the hull, beneath the hull's faces.

    The depth below one plane is linear, so over a triangle it is largest at a corner; the depth below the hull is that
    below the nearest plane. A surface whose every triangle lies in a face has depth 0: it is convex.
    """
    deepest = 0.0
    step = max(1, PAIRS_AT_ONCE // len(hull.planes))
    for first in range(0, len(corners), step):
        some = corners[first : first + step]
        below = -(some @ hull.planes[:, :3].T + hull.planes[:, 3])
        deepest = max(deepest, float(below.max(axis=1).min(axis=1).max()))
    return deepest
