"""One-sided Hausdorff distance from a mesh to its pieces: an upper bound by branch and bound over triangles."""

import numpy as np

from avatarsim.pieces.added import SHARP
from avatarsim.pieces.hulls import Hull
from avatarsim.pieces.mesh import Array
from avatarsim.pieces.nearest import halves

MOST_TRIANGLES = 200_000
"""Triangles at once beyond which refinement stops; the bound then is looser, never wrong. More: memory and seconds."""


def uncovered(hulls: list[Hull], corners: Array, tolerance: float) -> tuple[float, float]:
    """(above, below): no point of the surface (t, 3, 3) is farther than `above` from every hull, and one is `below` away.

    The distance from one convex hull, over a triangle, is largest at a corner. So a triangle is settled by the hull
    whose worst corner is nearest. What exceeds the farthest corner found by more than `tolerance`, or a share SHARP of
    it, is halved.
    """
    above = below = 0.0
    while len(corners):
        enough = below + max(tolerance, SHARP * below)
        worst, attained = _by_corners(hulls, corners, enough)
        below = max(below, attained)
        settled = worst <= enough
        if len(corners) > MOST_TRIANGLES:
            settled[:] = True
        above = max(above, float(worst[settled].max(initial=0.0)))
        corners = halves(corners[~settled])
    return max(above, below), below


def _by_corners(hulls: list[Hull], corners: Array, enough: float) -> tuple[Array, float]:
    """Bound (t,) of each triangle's distance from the hulls, and the distance of some corner that lies outside all."""
    points = corners.reshape(-1, 3)
    heights = np.stack([hull.heights(points) for hull in hulls])
    nearest = _corner_distances(hulls, points, heights)
    worst = np.full(len(corners), np.inf)
    for hull, height in zip(hulls, heights, strict=True):
        by_corner = height.reshape(-1, 3)
        # a height never exceeds the distance: a triangle with a higher corner cannot be settled by this hull
        hopeful = (by_corner <= enough).all(axis=1)
        inside = hopeful & (by_corner <= 0.0).all(axis=1)
        worst[inside] = 0.0
        rest = np.flatnonzero(hopeful & ~inside & (worst > enough))
        if len(rest):
            far = hull.distances(corners[rest].reshape(-1, 3)).reshape(-1, 3).max(axis=1)
            worst[rest] = np.minimum(worst[rest], far)
    # for the few that refinement leaves over: no point is farther from a corner than the longest edge
    edge = np.linalg.norm(np.roll(corners, -1, axis=1) - corners, axis=2).max(axis=1)
    return np.minimum(worst, nearest.reshape(-1, 3).min(axis=1) + edge), float(nearest.max())


def _corner_distances(hulls: list[Hull], points: Array, heights: Array) -> Array:
    """Distance (n,) of points (n, 3) from the nearest hull; `heights` (hulls, n) bound it from below."""
    lowest = heights.min(axis=0)
    found = np.where(lowest <= 0.0, 0.0, np.inf)
    outside = np.flatnonzero(lowest > 0.0)
    order = np.argsort(heights[:, outside], axis=0)
    for row in order:
        pending = heights[row, outside] < found[outside]
        if not pending.any():
            break
        for k in np.unique(row[pending]):
            chosen = outside[pending & (row == k)]
            found[chosen] = np.minimum(found[chosen], hulls[k].distances(points[chosen]))
    return found
