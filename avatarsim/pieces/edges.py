"""Edge topology of a triangle mesh: closedness, orientation and connected components."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from avatarsim.pieces.mesh import Indices


@dataclass(frozen=True, eq=False)
class Edges:
    """How often each undirected edge occurs, and the pairs of triangles that share an edge of exactly two.

    counts  (e,) triangles at each edge; balance (e,) how many more run along it one way than the other
    pairs   (p, 2) triangles at the edges of two; alike (p,) whether both run along it the same way, so face apart
    """

    counts: Indices
    balance: Indices
    pairs: Indices
    alike: NDArray[np.bool_]

    @property
    def open(self) -> int:
        """Number of edges with an odd number of triangles: the surface has a border there, or a fin."""
        return int((self.counts % 2).sum())

    @property
    def unbalanced(self) -> int:
        """Number of edges along which neighbours face opposite sides."""
        return int((self.balance != 0).sum())


def edges_of(triangles: Indices) -> Edges:
    """Edges of triangles (t, 3)."""
    start, end = triangles.ravel(), np.roll(triangles, -1, axis=1).ravel()
    owner = np.repeat(np.arange(len(triangles)), 3)
    forward = start < end
    keys = np.stack([np.minimum(start, end), np.maximum(start, end)], axis=1)
    _, place, counts = np.unique(keys, axis=0, return_inverse=True, return_counts=True)
    place = place.ravel()
    balance = np.bincount(place, np.where(forward, 1.0, -1.0)).astype(np.int64)
    order = np.argsort(place, kind="stable")
    first = np.concatenate([[0], np.cumsum(counts)[:-1]]).astype(np.int64)[counts == 2]
    a, b = order[first], order[first + 1]
    return Edges(counts.astype(np.int64), balance, np.stack([owner[a], owner[b]], axis=1), forward[a] == forward[b])


def parts(count: int, edges: Edges) -> Indices:
    """Number (t,) of the connected part of each of `count` triangles."""
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    a, b = edges.pairs.T
    graph = coo_array((np.ones(len(a)), (a, b)), shape=(count, count))
    return np.asarray(connected_components(graph, directed=False)[1], dtype=np.int64)


def to_flip(count: int, edges: Edges) -> NDArray[np.bool_] | None:
    """Which of `count` triangles to turn over so that neighbours face the same side; None if no choice does that.

    Every triangle has two sheets, as it is and turned over. Sheets of neighbours that agree are joined; a surface
    with two sides falls into two halves, a Moebius band does not.
    """
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    a, b = edges.pairs.T
    turned = np.where(edges.alike, count, 0)
    rows, columns = np.concatenate([a, a + count]), np.concatenate([b + turned, b + count - turned])
    graph = coo_array((np.ones(len(rows)), (rows, columns)), shape=(2 * count, 2 * count))
    label = np.asarray(connected_components(graph, directed=False)[1])
    as_is, over = label[:count], label[count:]
    if (as_is == over).any():
        return None
    # labels count up from sheet 0 of the first triangle of each part
    return np.asarray(as_is > over)
