"""Point-in-mesh test: ray crossings for closed surfaces, generalised winding number for open ones (Jacobson et al. 2013)."""

import numpy as np
from numpy.typing import NDArray

from avatarsim.pieces.mesh import Array, Indices
from avatarsim.spatial import rotation

SKEW = rotation.to_matrix(rotation.normalised(np.array([1.0, 2.0**0.5, 3.0**0.5, 5.0**0.5])))
"""A turn after which the rays run along (2 (10^0.5 - 3^0.5), 2 (15^0.5 + 2^0.5), 1): no fractions relate these numbers,
so a ray from a point of a grid never meets an edge between points of a grid, where a crossing would be up to rounding."""

BUCKETS = 128
"""Most squares along each side of the grid that finds the triangles above a point. Fewer: more triangles per point."""

AT_ONCE = 20_000
"""Most points tested in one batch, to bound the memory."""


def inside_closed(points: Array, corners: Array) -> NDArray[np.bool_]:
    """Whether points (n, 3) lie inside a closed, outward surface (t, 3, 3): it winds around them at least once."""
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
    """Whether a surface with holes fills more than half of the view from each point (its generalised winding number)."""
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
    """For counts (n,): the owner of each of their sum, and its number within its owner."""
    owner = np.repeat(np.arange(len(counts)), counts)
    return owner, np.arange(len(owner)) - np.repeat(np.cumsum(counts) - counts, counts)


def _crossings(points: Array, corners: Array) -> Array:
    """+1 where the ray up from a point leaves through its triangle, -1 where it enters, 0 where it misses."""
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
