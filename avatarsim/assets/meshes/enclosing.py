"""Polytopes of few vertices around a convex hull: a body that does not touch them does not touch the hull."""

from typing import Any

import numpy as np

from avatarsim.assets.meshes.hulls import PLANES_AT_ONCE, Hull, highest, hull_of
from avatarsim.assets.meshes.mesh import Array, Indices

ROUNDS = 30
"""Rounds in which facets are pushed out. Fewer: more is left to scaling, which adds all around; more: time without benefit."""

FLUSH = 1e-6
"""Share of the size up to which a point beyond a facet is ignored: scaling makes up for it."""

BATCH = 8
"""A round adds at most this part of the vertices that are still free. Larger: more hulls to make, hardly a better choice."""

SLIMMEST = 0.01
"""Least extent along a principal axis, as a share of the largest, that a hull is stretched to while facets are pushed out. Less:
the remaining scaling widens thin hulls all around; more: facets lie nearer across than along, and round hulls are no better."""

SEARCHED = 60_000_000
"""Planes times facets of a hull up to which `fit` is searched for: 20 s. More: a larger hull takes minutes; fewer: it stays
whole, with more vertices to query."""

ROUNDING = 1e-12
"""Relative scaling beyond the computed one, so that rounding leaves no vertex outside."""


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
    if len(points) <= most:
        return hull, 0.0
    stretch = _stretch(points)
    corners = _pushed_out(points @ stretch, _inscribed(points @ stretch, most)) @ np.linalg.inv(stretch)
    around, added = _measured(hull, corners, name)
    height = fit or 0.0
    while fit is not None and added > fit:
        corners = _cut_to(hull, height)
        if len(corners) >= len(points):
            return hull, 0.0
        around, added = _measured(hull, corners, name)
        # at a sharp edge a corner's distance exceeds its height over the facets
        height *= 0.8 * min(1.0, fit / max(added, fit))
    return around, added


def _measured(hull: Hull, corners: Array, name: str) -> tuple[Hull, float]:
    """Return the hull of corners that are scaled until it contains `hull`, and the largest distance that it adds."""
    around = hull_of(_around(hull.points[hull.used], corners), name)
    around = Hull(around.points[around.used], np.arange(len(around.used)), around.planes, around.facets)
    return around, float(hull.distances(around.points).max())


def _stretch(points: Array) -> Array:
    """Return the symmetric map (3, 3) that brings thin hulls to SLIMMEST; identity for others."""
    centred = points - points.mean(axis=0)
    axes = np.linalg.svd(centred, full_matrices=False)[2]
    extents = np.ptp(centred @ axes.T, axis=0)
    if extents.min() >= SLIMMEST * extents.max():
        return np.eye(3)
    return np.asarray(axes.T @ np.diag(np.maximum(1.0, SLIMMEST * extents.max() / extents)) @ axes)


def _cut_to(hull: Hull, height: float) -> Array:
    """Return corners of a polytope of planes of `hull`, none of them higher than `height` over the hull.

    Planes of the hull cut off the highest corners of the box around it, in rounds; the hull's own corners
    where that takes more than SEARCHED."""
    from scipy.spatial import HalfspaceIntersection

    points = hull.points[hull.used]
    middle = points.mean(axis=0)
    axes = np.linalg.svd(points - middle, full_matrices=False)[2]
    normals = np.concatenate([axes, -axes])
    planes = np.column_stack([normals, -(points @ normals.T).max(axis=0)])
    while True:
        corners = np.unique(HalfspaceIntersection(planes, middle).intersections, axis=0)
        facets, heights = highest(corners, hull.planes)
        chosen = np.zeros(0, dtype=np.int64)
        for corner in np.argsort(-heights, kind="stable"):
            cut = hull.planes[chosen] @ np.append(corners[corner], 1.0)
            if heights[corner] <= height:
                break
            if not (cut > 0.5 * height).any():
                chosen = np.append(chosen, facets[corner])
        if not len(chosen):
            return np.asarray(corners)
        planes = np.concatenate([planes, hull.planes[chosen]])
        if len(planes) * len(hull.planes) > SEARCHED:
            return points


def _inscribed(points: Array, most: int) -> Array:
    """Return at most `most` of the points: always those farthest beyond the facets of the hull so far, one of each facet."""
    chosen = _spread(points)
    while len(chosen) < most:
        facets, heights = highest(points, _qhull(points[chosen]).equations)
        order = np.argsort(-heights, kind="stable")
        order = order[heights[order] > FLUSH * np.ptp(points)]
        _, first = np.unique(facets[order], return_index=True)
        added = order[np.sort(first)][: max(1, (most - len(chosen)) // BATCH)]
        if not len(added):
            break
        chosen = np.concatenate([chosen, added])
    return np.asarray(points[chosen])


def _pushed_out(points: Array, corners: Array) -> Array:
    """Return corners of about the same hull, whose facets have hardly any of `points` beyond them."""
    for _ in range(ROUNDS):
        found = _qhull(corners)
        if len(found.vertices) < len(corners):
            corners = corners[found.vertices]
            found = _qhull(corners)
        facets, heights = highest(points, found.equations)
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
        # two facets that push a corner in one direction push it once
        moved[of] += np.maximum(0.0, step - moved[of] @ normal)[:, None] * normal
    return moved


def _around(points: Array, corners: Array) -> Array:
    """Return the corners scaled about their middle until their hull contains all points."""
    middle = corners.mean(axis=0)
    planes = _qhull(corners).equations
    reach = -(planes[:, 3] + planes[:, :3] @ middle)
    step = max(1, PLANES_AT_ONCE // len(planes))
    parts = (points[first : first + step] - middle for first in range(0, len(points), step))
    scale = max(float(((part @ planes[:, :3].T) / reach).max()) for part in parts)
    return np.asarray(middle + max(1.0, scale) * (1.0 + ROUNDING) * (corners - middle))


def _spread(points: Array) -> Indices:
    """Return four or more points that span a volume: the farthest along each axis of the cloud, in both directions."""
    centred = points - points.mean(axis=0)
    along = centred @ np.linalg.svd(centred, full_matrices=False)[2].T
    return np.unique(np.concatenate([along.argmin(axis=0), along.argmax(axis=0)])).astype(np.int64)


def _qhull(points: Array) -> Any:
    from scipy.spatial import ConvexHull

    return ConvexHull(points)


def _shares(triangles: Array, points: Array) -> Array:
    """Return barycentric coordinates (n, 3) of each point's foot on the plane of its triangle, cut to the triangle."""
    a, b, c = triangles[:, 0], triangles[:, 1], triangles[:, 2]
    normals = np.cross(b - a, c - a)
    areas = [np.cross(to - start, points - start) for start, to in ((b, c), (c, a), (a, b))]
    shares = np.clip(np.stack([(area * normals).sum(axis=1) for area in areas], axis=1), 0.0, None)
    return np.asarray(shares / shares.sum(axis=1, keepdims=True))
