"""Self-intersections of a mesh: edges against triangles by signed volumes, for pairs from sweep and prune over their boxes."""

import numpy as np

from avatarsim.pieces.inside import ragged
from avatarsim.pieces.mesh import Array, Indices

TOUCH = 1e-9
"""Share of an edge or a triangle by which a crossing must lie inside both. At 0, triangles that only touch count."""

PAIRS_AT_ONCE = 2_000_000
"""Pairs of triangles whose boxes are compared in one go, for the memory."""


def crossing_pairs(vertices: Array, triangles: Indices) -> Indices:
    """Pairs (k, 2) of triangles without a common vertex, of which an edge of one goes through the other.

    Vertices must be merged, else neighbours have no common vertex. Not found: triangles that overlap within one plane,
    and neighbours folded onto each other.
    """
    corners = vertices[triangles]
    low, high = corners.min(axis=1), corners.max(axis=1)
    axis = int(np.argmax(low.std(axis=0)))
    order = np.argsort(low[:, axis], kind="stable")
    # in this order, the boxes that overlap box k along the axis are the next ones, up to `last`
    last = np.searchsorted(low[order, axis], high[order, axis], side="right")
    counts = np.maximum(last - np.arange(len(order)) - 1, 0)
    found = []
    begin, total = 0, np.concatenate([[0], np.cumsum(counts)])
    while begin < len(order):
        end = max(begin + 1, int(np.searchsorted(total, total[begin] + PAIRS_AT_ONCE, side="right")) - 1)
        owner, step = ragged(counts[begin:end])
        a, b = order[begin + owner], order[begin + owner + 1 + step]
        near = ((low[a] <= high[b]) & (low[b] <= high[a])).all(axis=1)
        a, b = a[near], b[near]
        strangers = ~(triangles[a][:, :, None] == triangles[b][:, None, :]).any(axis=(1, 2))
        a, b = a[strangers], b[strangers]
        met = _pierced(corners[a], corners[b]) | _pierced(corners[b], corners[a])
        found.append(np.stack([a[met], b[met]], axis=1))
        begin = end
    return np.concatenate(found) if found else np.zeros((0, 2), dtype=np.int64)


def _pierced(one: Array, other: Array) -> "np.ndarray[tuple[int, ...], np.dtype[np.bool_]]":
    """Whether an edge of triangle `one` (n, 3, 3) goes through the inside of `other` (n, 3, 3), by volumes of tetrahedra."""
    a, b, c = other[:, 0], other[:, 1], other[:, 2]
    normal = np.cross(b - a, c - a)
    scale = np.einsum("ni,ni->n", normal, normal)
    met = np.zeros(len(one), dtype=bool)
    for k in range(3):
        p, q = one[:, k], one[:, (k + 1) % 3]
        from_p, from_q = np.einsum("ni,ni->n", normal, p - a), np.einsum("ni,ni->n", normal, q - a)
        across = from_p - from_q
        share = from_p / np.where(across != 0.0, across, 1.0)
        point = p + share[:, None] * (q - p)
        inside = (across != 0.0) & (share > TOUCH) & (share < 1.0 - TOUCH)
        for start, end in ((a, b), (b, c), (c, a)):
            inside &= np.einsum("ni,ni->n", np.cross(end - start, point - start), normal) > TOUCH * scale
        met |= inside
    return met
