"""Distance of points from a triangle mesh, as close upper and lower bounds, by the triangles with the nearest middles.

Point-in-mesh test: ray crossings for closed surfaces, generalised winding number for open ones (Jacobson et al. 2013).
"""

import numpy as np
from numpy.typing import NDArray

from avatarsim.assets.meshes.mesh import Array, Indices
from avatarsim.spatial import rotation

FINENESS = 40.0
"""Triangles are cut until they are this many times smaller than the surface. Coarser: the two bounds lie further
apart; finer: more triangles to search."""

CANDIDATES = (8, 32, 128)
"""Triangles measured per point, by nearest middle, until no other can be nearer. A shorter list: looser bounds."""

PAIRS_AT_ONCE = 400_000
"""Pairs of point and triangle measured in one go; memory grows by about 300 bytes for each."""


def point_triangle(points: Array, corners: Array) -> Array:
    """Return distances (n,) of points (n, 3) from triangles (n, 3, 3), one by one; flat triangles are segments or points."""
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
    """Return the surface in triangles (k, 3, 3), none of which reaches further than `radius` from its middle."""
    done = []
    while len(corners):
        reach = np.linalg.norm(corners - corners.mean(axis=1, keepdims=True), axis=2).max(axis=1)
        small = reach <= radius
        done.append(corners[small])
        corners = halves(corners[~small])
    return np.concatenate(done) if done else corners


def halves(corners: Array) -> Array:
    """Return each triangle (n, 3, 3) cut in two across its longest edge: (2 n, 3, 3)."""
    lengths = np.linalg.norm(np.roll(corners, -1, axis=1) - corners, axis=2)
    # rotate the corners so that the longest edge comes first
    turn = (lengths.argmax(axis=1)[:, None] + np.arange(3)) % 3
    a, b, c = np.moveaxis(np.take_along_axis(corners, turn[:, :, None], axis=1), 1, 0)
    middle = 0.5 * (a + b)
    return np.concatenate([np.stack([a, middle, c], axis=1), np.stack([middle, b, c], axis=1)])


class Surface:
    """A surface of triangles `corners` (t, 3, 3), prepared for many distance queries."""

    def __init__(self, corners: Array) -> None:
        from scipy.spatial import cKDTree

        size = float(np.linalg.norm(np.ptp(corners.reshape(-1, 3), axis=0)))
        self.radius = size / FINENESS
        self.corners = finer(corners, self.radius)
        self._tree = cKDTree(self.corners.mean(axis=1))

    def distances(self, points: Array, threshold: Array | float = np.inf) -> tuple[Array, Array]:
        """Return bounds (n,) from above and from below of the distances of points (n, 3) from the surface.

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
        """Return the distance of one point (3,) from the surface, every triangle measured."""
        return float(point_triangle(np.broadcast_to(point, (len(self.corners), 3)), self.corners).min())

    def _measured(self, points: Array, count: int) -> tuple[Array, Array]:
        """Return the bounds from the `count` triangles with the nearest middles."""
        middles, chosen = self._tree.query(points, k=[*range(1, count + 1)])
        pairs = np.asarray(chosen, dtype=np.int64)
        measured = point_triangle(np.repeat(points, count, axis=0), self.corners[pairs.ravel()])
        above = measured.reshape(-1, count).min(axis=1)
        # an unmeasured triangle has its middle beyond the last measured one
        unseen = np.inf if count == len(self.corners) else middles[:, -1] - self.radius
        return above, np.clip(np.minimum(above, unseen), 0.0, None)


SKEW = rotation.to_matrix(rotation.normalised(np.array([1.0, 2.0**0.5, 3.0**0.5, 5.0**0.5])))
"""Rotation after which the rays run along (2 (10^0.5 - 3^0.5), 2 (15^0.5 + 2^0.5), 1): no fractions relate these numbers,
so a ray from a point of a grid never meets an edge between points of a grid, where a crossing would be up to rounding."""

BUCKETS = 128
"""Most squares along each side of the grid that finds the triangles above a point. Fewer: more triangles per point."""

AT_ONCE = 20_000
"""Most points tested in one batch, to bound the memory."""


def inside_closed(points: Array, corners: Array) -> NDArray[np.bool_]:
    """Return True if points (n, 3) lie inside a closed, outward surface (t, 3, 3): it winds around them at least once."""
    triangles = corners @ SKEW.T
    flat = triangles[:, :, :2]
    low, high = flat.min(axis=(0, 1)), flat.max(axis=(0, 1))
    side = int(np.clip(np.sqrt(len(corners)), 1, BUCKETS))
    width = np.maximum((high - low) / side, 1e-300)
    first = np.clip((flat.min(axis=1) - low) // width, 0, side - 1).astype(np.int64)
    last = np.clip((flat.max(axis=1) - low) // width, 0, side - 1).astype(np.int64)
    wide = last - first + 1
    owner, step = ragged(wide[:, 0] * wide[:, 1])
    bucket = (first[owner, 0] + step // wide[owner, 1]) * side + first[owner, 1] + step % wide[owner, 1]
    order = np.argsort(bucket, kind="stable")
    listed, starts = owner[order], np.searchsorted(bucket[order], np.arange(side * side + 1))
    found = np.zeros(len(points), dtype=bool)
    for begin in range(0, len(points), AT_ONCE):
        some = points[begin : begin + AT_ONCE] @ SKEW.T
        place = ((some[:, :2] - low) // width).astype(np.int64)
        over = ((place >= 0) & (place < side)).all(axis=1)
        at = np.where(over, place[:, 0] * side + place[:, 1], 0)
        chosen, step = ragged(np.where(over, starts[at + 1] - starts[at], 0))
        turns = _crossings(some[chosen], triangles[listed[starts[at[chosen]] + step]])
        found[begin : begin + AT_ONCE] = np.bincount(chosen, turns, minlength=len(some)) > 0.5
    return found


def inside_open(points: Array, corners: Array) -> NDArray[np.bool_]:
    """Return True if a surface with holes fills more than half of the view from each point (its generalised winding number)."""
    found = np.zeros(len(points), dtype=bool)
    step = max(1, 2_000_000 // max(1, len(corners)))
    for begin in range(0, len(points), step):
        a, b, c = np.moveaxis(corners[None] - points[begin : begin + step, None, None], 2, 0)
        la, lb, lc = (np.linalg.norm(corner, axis=2) for corner in (a, b, c))
        top = np.einsum("nti,nti->nt", a, np.cross(b, c))
        below = la * lb * lc
        for one, two, length in ((a, b, lc), (b, c, la), (c, a, lb)):
            below += np.einsum("nti,nti->nt", one, two) * length
        # solid angle of a triangle seen from a point: tan(angle / 2) = top / below (van Oosterom and Strackee)
        found[begin : begin + step] = 2.0 * np.arctan2(top, below).sum(axis=1) > 2.0 * np.pi
    return found


def ragged(counts: Indices) -> tuple[Indices, Indices]:
    """Return for counts (n,) the owner of each of their sum, and its number within its owner."""
    owner = np.repeat(np.arange(len(counts)), counts)
    return owner, np.arange(len(owner)) - np.repeat(np.cumsum(counts) - counts, counts)


def _crossings(points: Array, corners: Array) -> Array:
    """Return +1 where the ray up from a point leaves through its triangle, -1 where it enters, 0 where it misses."""
    x, y = points[:, 0], points[:, 1]
    sides = []
    for k in range(3):
        p, q = corners[:, k], corners[:, (k + 1) % 3]
        sides.append((q[:, 0] - p[:, 0]) * (y - p[:, 1]) - (q[:, 1] - p[:, 1]) * (x - p[:, 0]))
    ab, bc, ca = sides
    area = ab + bc + ca
    met = ((ab > 0.0) & (bc > 0.0) & (ca > 0.0)) | ((ab < 0.0) & (bc < 0.0) & (ca < 0.0))
    safe = np.where(area != 0.0, area, 1.0)
    height = (bc * corners[:, 0, 2] + ca * corners[:, 1, 2] + ab * corners[:, 2, 2]) / safe
    return np.where(met & (height > points[:, 2]), np.sign(area), 0.0)
