"""Polytopes of few vertices around a convex hull: what does not touch them does not touch the hull."""

from typing import Any

import numpy as np

from avatarsim.assets.meshes.hulls import Hull, hull_of
from avatarsim.assets.meshes.mesh import Array, Indices

ROUNDS = 30
"""Rounds in which facets are pushed out. Fewer: more is left to scaling, which adds all around; more: time, for nothing."""

FLUSH = 1e-6
"""Share of the size beyond a facet that counts as none: scaling makes up for it."""

BATCH = 8
"""A round adds at most this part of the vertices that are still free. Larger: more hulls to make, hardly a better choice."""

GROWTH = (1.2, 4.0)
"""Least and most factor by which the number of vertices grows when the hull sticks out too far."""

SEARCHED = 5_000_000
"""Vertices times points of a hull up to which `fit` is searched for: 20 s. More: a larger hull takes minutes; fewer: it stays
whole, with more vertices to query."""

ROUNDING = 1e-12
"""Relative scaling beyond what was computed, so that rounding leaves no vertex outside."""


def enclosing(hull: Hull, most: int, name: str, fit: float | None = None) -> tuple[Hull, float]:
    """Return a hull of at most `most` vertices around `hull`, and the largest distance of its points from `hull`.

    Facets of an inscribed polytope are pushed out to the points beyond them, all at once and in rounds (Cimmino 1938), each by
    the least motion of its three corners; scaling about the middle makes up for the rest. A hull with no more vertices than
    `most` is returned as it is.

    Args:
        fit: largest distance that may be added, in the hull's unit; where `most` vertices add more, there are more of them, up
            to all.
    """
    points = hull.points[hull.used]
    while len(points) > most:
        around = hull_of(_around(points, _pushed_out(points, _inscribed(points, most))), name)
        around = Hull(around.points[around.used], np.arange(len(around.used)), around.planes, around.facets)
        added = float(hull.distances(around.points).max())
        if fit is None or added <= fit:
            return around, added
        # the distance added falls about as the number of vertices grows
        most = int(most * np.clip(added / fit, *GROWTH)) + 1
        if most * len(points) > SEARCHED:
            break
    return hull, 0.0


def _inscribed(points: Array, most: int) -> Array:
    """Return at most `most` of the points: always those farthest beyond the facets of the hull so far, one of each facet."""
    chosen = _spread(points)
    while len(chosen) < most:
        facets, heights = _beyond(points, _qhull(points[chosen]))
        order = np.argsort(-heights, kind="stable")
        order = order[heights[order] > FLUSH * np.ptp(points)]
        _, first = np.unique(facets[order], return_index=True)
        added = order[np.sort(first)][: max(1, (most - len(chosen)) // BATCH)]
        if not len(added):
            break
        chosen = np.concatenate([chosen, added])
    return np.asarray(points[chosen])


def _pushed_out(points: Array, corners: Array) -> Array:
    """Return corners of about the same hull, whose facets have next to nothing of `points` beyond them."""
    for _ in range(ROUNDS):
        found = _qhull(corners)
        if len(found.vertices) < len(corners):
            corners = corners[found.vertices]
            found = _qhull(corners)
        facets, heights = _beyond(points, found)
        if heights.max() <= FLUSH * np.ptp(points):
            break
        corners = corners + _pushes(points, corners, found, facets, heights)
    return corners


def _pushes(points: Array, corners: Array, hull: Any, facets: Indices, heights: Array) -> Array:
    """Return the motion (n, 3) of corners that brings each facet to the farthest point beyond it."""
    order = np.argsort(-heights, kind="stable")
    order = order[heights[order] > 0.0]
    pushed, first = np.unique(facets[order], return_index=True)
    farthest = order[first]
    shares = _shares(corners[hull.simplices[pushed]], points[farthest])
    steps = heights[farthest, None] * shares / (shares * shares).sum(axis=1, keepdims=True)
    moved = np.zeros_like(corners)
    for normal, of, step in zip(hull.equations[pushed, :3], hull.simplices[pushed], steps, strict=True):
        # two facets that push a corner the same way push it once
        moved[of] += np.maximum(0.0, step - moved[of] @ normal)[:, None] * normal
    return moved


def _around(points: Array, corners: Array) -> Array:
    """Return the corners scaled about their middle until their hull holds all points."""
    middle = corners.mean(axis=0)
    planes = _qhull(corners).equations
    reach = -(planes[:, 3] + planes[:, :3] @ middle)
    scale = float((((points - middle) @ planes[:, :3].T) / reach).max())
    return np.asarray(middle + max(1.0, scale) * (1.0 + ROUNDING) * (corners - middle))


def _spread(points: Array) -> Indices:
    """Four or more points that span a volume: the farthest along each axis of the cloud, both ways."""
    centred = points - points.mean(axis=0)
    along = centred @ np.linalg.svd(centred, full_matrices=False)[2].T
    return np.unique(np.concatenate([along.argmin(axis=0), along.argmax(axis=0)])).astype(np.int64)


def _qhull(points: Array) -> Any:
    from scipy.spatial import ConvexHull

    return ConvexHull(points)


def _beyond(points: Array, hull: Any) -> tuple[Indices, Array]:
    """Return for each of the points the facet that it is highest over, and its signed height."""
    heights = points @ hull.equations[:, :3].T + hull.equations[:, 3]
    facets = heights.argmax(axis=1)
    return facets, heights[np.arange(len(points)), facets]


def _shares(triangles: Array, points: Array) -> Array:
    """Return barycentric coordinates (n, 3) of each point's foot on the plane of its triangle, cut to the triangle."""
    a, b, c = triangles[:, 0], triangles[:, 1], triangles[:, 2]
    normals = np.cross(b - a, c - a)
    areas = [np.cross(to - start, points - start) for start, to in ((b, c), (c, a), (a, b))]
    shares = np.clip(np.stack([(area * normals).sum(axis=1) for area in areas], axis=1), 0.0, None)
    return np.asarray(shares / shares.sum(axis=1, keepdims=True))
