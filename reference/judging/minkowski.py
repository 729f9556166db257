"""Exact distance and depth of two convex pieces by brute force: the convex hull of all differences of their points.

Two convex sets overlap exactly when their Minkowski difference holds the origin, and the depth is how far the origin
is from its surface. Slow (milliseconds) and with nothing iterative in it: it decides where faster judges disagree.
"""

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import ConvexHull as QuickHull

from reference.judging.segments import segment_distance, triangle_distance

Array = NDArray[np.float64]


def signed_distance(points_a: Array, radius_a: float, points_b: Array, radius_b: float) -> float:
    """Return the gap (positive) or penetration depth (negative) [m] of two hulls of points, each swept by a ball.

    points (n, 3) [m] in one frame: a sphere is 1 point, a capsule 2, a box 8, a hull its vertices.
    Raises scipy's QhullError for three or more points of a flat hull, which no valid shape has.
    """
    if len(points_a) <= 2 and len(points_b) <= 2:
        core = float(segment_distance(points_a[0], points_a[-1], points_b[0], points_b[-1]))
    else:
        core = _origin_to_hull((points_a[:, None] - points_b[None]).reshape(-1, 3))
    return core - (radius_a + radius_b)


def _origin_to_hull(points: Array) -> float:
    """Return the signed distance [m] of the origin from the convex hull of `points` (n, 3); negative inside."""
    hull = QuickHull(points)
    offsets = hull.equations[:, 3]
    if (offsets <= 0.0).all():
        return float(offsets.max())
    facets = points[hull.simplices[offsets > 0.0]]
    return float(triangle_distance(np.zeros(3), facets[:, 0], facets[:, 1], facets[:, 2]).min())
