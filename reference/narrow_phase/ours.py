"""Our own query in the benchmark: many pairs within one compiled call, or one call from Python for each pair."""

from collections.abc import Sequence as Many
from math import inf
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from avatarsim.collision.scratch import Scratch, make_scratch
from avatarsim.collision.signed_distance import signed_distance
from avatarsim.collision.warm_query import signed_distance_coherent
from avatarsim.collision.warm_start import PairMemory, make_pair_memory
from avatarsim.jit.arena import opened, packed
from avatarsim.jit.kernel import kernel
from avatarsim.jit.layout import Line, Matrices, Vectors
from avatarsim.model.geometry import Shapes, make_shapes, piece_points
from avatarsim.scene.shape import Piece, Shape
from avatarsim.spatial.vec3 import row

Array = NDArray[np.float64]
Index = NDArray[np.int64]


class Table(NamedTuple):
    """n pairs: shapes 2 k and 2 k + 1 are a pair. vertices and local (nv, 3) [m] in the world and in the frame of the shape;
    turns (2 n, 3, 3), at (2 n, 3) [m] of the shapes; gaps (n) [m], the answers; memory of the pairs."""

    shapes: Shapes
    vertices: Vectors
    local: Vectors
    turns: Matrices
    at: Vectors
    gaps: Line
    scratch: Scratch
    memory: PairMemory


@kernel
def place_pairs(words: Index, first: int, last: int) -> None:
    """World vertices of the shapes of pairs first .. last - 1: v = R x + p."""
    t = opened(words, Table)
    shapes, vertices, local, turns, at = t.shapes, t.vertices, t.local, t.turns, t.at
    for s in range(2 * first, 2 * last):
        R, p = turns[s], at[s]
        for i in range(shapes.start[s], shapes.start[s + 1]):
            x, y, z = row(local, i)
            for k in range(3):
                vertices[i, k] = R[k, 0] * x + R[k, 1] * y + R[k, 2] * z + p[k]


@kernel
def cold_queries(words: Index, first: int, last: int) -> None:
    """Signed distances of pairs first .. last - 1, with nothing known about them."""
    t = opened(words, Table)
    for k in range(first, last):
        _, gap, _, _, _ = signed_distance(t.vertices, t.shapes, 2 * k, 2 * k + 1, (0.0, 0.0, 0.0), t.scratch)
        t.gaps[k] = gap


@kernel
def coherent_queries(words: Index, first: int, last: int) -> None:
    """Signed distances of pairs first .. last - 1, each begun from what its last query left in the memory."""
    t = opened(words, Table)
    for k in range(first, last):
        _, gap, _, _, _ = signed_distance_coherent(t.vertices, t.shapes, 2 * k, 2 * k + 1, inf, t.scratch, t.memory, k)
        t.gaps[k] = gap


class Pairs:
    """n pairs of shapes, packed for the kernels."""

    def __init__(self, shapes: Many[Shape]) -> None:
        made = [piece_points(Piece(shape)) for shape in shapes]
        blocks = [points for _, points, _ in made]
        start = np.cumsum([0, *map(len, blocks)]).astype(np.int64)
        radii = np.array([radius for _, _, radius in made])
        sizes = np.array([np.ptp(points, axis=0).max() for points in blocks]) + 2.0 * radii
        n, local = len(shapes), np.vstack(blocks)
        arrays = make_shapes([kind for kind, _, _ in made], start, radii, sizes)
        table = Table(
            arrays, np.zeros_like(local), local, np.zeros((n, 3, 3)), np.zeros((n, 3)), np.zeros(n // 2), make_scratch(),
            make_pair_memory(n // 2),
        )
        self.count = n // 2
        # a bound of the gap's zero along any ray: two radii about the centres, and the largest gap wanted
        self.reach = 2.0 * float(max(np.linalg.norm(points, axis=1).max() + r for _, points, r in made)) + 1.0
        self.words, self.table = packed(table)

    def forget(self) -> None:
        """As if no pair had ever been asked about."""
        self.table.memory.view(np.int64)[...] = 0

    def pose(self, turns: Array, at: Array) -> None:
        """Set poses (2 n, 3, 3) and (2 n, 3) [m] without moving the vertices yet."""
        self.table.turns[:], self.table.at[:] = turns, at

    def place(self, turns: Array, at: Array) -> None:
        """Set poses and move all vertices there."""
        self.pose(turns, at)
        place_pairs(self.words, 0, self.count)

    def cold(self) -> Array:
        """Signed distances (n,) [m] of all pairs."""
        cold_queries(self.words, 0, self.count)
        return np.array(self.table.gaps)
