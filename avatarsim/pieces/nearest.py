"""Distance of points from a triangle mesh, as close upper and lower bounds, by the triangles with the nearest middles."""

import numpy as np

from avatarsim.pieces.mesh import Array

FINENESS = 40.0
"""Triangles are cut until they are this many times smaller than the surface. Coarser: the two bounds lie further
apart; finer: more triangles to search."""

CANDIDATES = (8, 32, 128)
"""Triangles measured per point, by nearest middle, until no other can be nearer. A shorter list: looser bounds."""

PAIRS_AT_ONCE = 400_000
"""Pairs of point and triangle measured in one go; memory grows by about 300 bytes for each."""


def point_triangle(points: Array, corners: Array) -> Array:
    """Distances (n,) of points (n, 3) from triangles (n, 3, 3), one by one; flat triangles are segments or points."""
    a, b, c = corners[:, 0], corners[:, 1], corners[:, 2]
    normal = np.cross(b - a, c - a)
    squared = np.einsum("ni,ni->n", normal, normal)
    over = squared > 0.0
    best = np.full(len(points), np.inf)
    for start, end in ((a, b), (b, c), (c, a)):
        along, to = end - start, points - start
        length = np.einsum("ni,ni->n", along, along)
        share = np.einsum("ni,ni->n", to, along) / np.where(length > 0.0, length, 1.0)
        off = to - np.clip(share, 0.0, 1.0)[:, None] * along
        best = np.minimum(best, np.einsum("ni,ni->n", off, off))
        over &= np.einsum("ni,ni->n", np.cross(along, to), normal) >= 0.0
    height = np.einsum("ni,ni->n", points - a, normal) ** 2 / np.where(squared > 0.0, squared, 1.0)
    return np.sqrt(np.where(over, np.minimum(height, best), best))


def finer(corners: Array, radius: float) -> Array:
    """The same surface in triangles (k, 3, 3), none of which reaches further than `radius` from its middle."""
    done = []
    while len(corners):
        reach = np.linalg.norm(corners - corners.mean(axis=1, keepdims=True), axis=2).max(axis=1)
        small = reach <= radius
        done.append(corners[small])
        corners = halves(corners[~small])
    return np.concatenate(done) if done else corners


def halves(corners: Array) -> Array:
    """Each triangle (n, 3, 3) cut in two across its longest edge: (2 n, 3, 3)."""
    lengths = np.linalg.norm(np.roll(corners, -1, axis=1) - corners, axis=2)
    # rotate the corners so that the longest edge comes first
    turn = (lengths.argmax(axis=1)[:, None] + np.arange(3)) % 3
    a, b, c = np.moveaxis(np.take_along_axis(corners, turn[:, :, None], axis=1), 1, 0)
    middle = 0.5 * (a + b)
    return np.concatenate([np.stack([a, middle, c], axis=1), np.stack([middle, b, c], axis=1)])


class Surface:
    """A surface of triangles `corners` (t, 3, 3), made ready for many questions of distance."""

    def __init__(self, corners: Array) -> None:
        from scipy.spatial import cKDTree

        size = float(np.linalg.norm(np.ptp(corners.reshape(-1, 3), axis=0)))
        self.radius = size / FINENESS
        self.corners = finer(corners, self.radius)
        self._tree = cKDTree(self.corners.mean(axis=1))

    def distances(self, points: Array, threshold: Array | float = np.inf) -> tuple[Array, Array]:
        """Bounds (n,) from above and from below of the distances of points (n, 3) from the surface.

        The bound from below is only refined for points that may be nearer than their `threshold` or not.
        """
        above, below = np.full(len(points), np.inf), np.zeros(len(points))
        limit = np.broadcast_to(threshold, (len(points),))
        pending = np.arange(len(points))
        for wanted in CANDIDATES:
            count = min(wanted, len(self.corners))
            step = PAIRS_AT_ONCE // count
            for first in range(0, len(pending), step):
                some = pending[first : first + step]
                above[some], below[some] = self._measured(points[some], count)
            pending = pending[(below[pending] <= limit[pending]) & (limit[pending] < above[pending])]
        return above, below

    def exact(self, point: Array) -> float:
        """Distance of one point (3,) from the surface, every triangle measured."""
        return float(point_triangle(np.broadcast_to(point, (len(self.corners), 3)), self.corners).min())

    def _measured(self, points: Array, count: int) -> tuple[Array, Array]:
        """The bounds from the `count` triangles with the nearest middles."""
        middles, chosen = self._tree.query(points, k=[*range(1, count + 1)])
        pairs = np.asarray(chosen, dtype=np.int64)
        measured = point_triangle(np.repeat(points, count, axis=0), self.corners[pairs.ravel()])
        above = measured.reshape(-1, count).min(axis=1)
        # a triangle that was not measured has its middle beyond the last one that was
        unseen = np.inf if count == len(self.corners) else middles[:, -1] - self.radius
        return above, np.clip(np.minimum(above, unseen), 0.0, None)
