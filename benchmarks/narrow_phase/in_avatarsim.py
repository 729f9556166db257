"""Signed distance by avatarsim: in one compiled call, as the engine does it, and in a call from Python per query."""

from collections.abc import Sequence
from math import inf
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from avatarsim.collision.scratch import Scratch, make_scratch
from avatarsim.collision.signed_distance import signed_distance
from avatarsim.collision.warm_query import signed_distance_coherent
from avatarsim.collision.warm_start import PairMemory, make_pair_memory
from avatarsim.jit.arena import pack, view_arena
from avatarsim.jit.kernel import kernel
from avatarsim.jit.layout import Line
from avatarsim.model.geometry import Geometry, Poses, geometry, place, poses
from avatarsim.scene.body import fixed
from avatarsim.scene.scene import Scene
from avatarsim.scene.shape import Piece, Shape
from avatarsim.spatial.rotation import IDENTITY
from benchmarks.narrow_phase.contender import Array, Contender, Trial

Index = NDArray[np.int64]

WITHIN, PLACED, CALLED = "avatarsim", "avatarsim+place", "avatarsim/call"
"""World vertices given; computed within the time (the engine does so once per body and frame, however many pairs the body is
in); given, and a call from Python per query."""


class Table(NamedTuple):
    """n pairs: bodies 2 k and 2 k + 1, of one shape each, are a pair; gaps (n) [m] are the answers."""

    geometry: Geometry
    poses: Poses
    gaps: Line
    scratch: Scratch
    memory: PairMemory


@kernel
def place_pairs(words: Index, first: int, last: int) -> None:
    """World vertices of the shapes of pairs first .. last - 1."""
    t = view_arena(words, Table)
    for b in range(2 * first, 2 * last):
        place(t.geometry, t.poses, b)


@kernel
def cold_queries(words: Index, first: int, last: int) -> None:
    """Signed distances of pairs first .. last - 1, with nothing known about them."""
    t = view_arena(words, Table)
    vertices, shapes = t.poses.vertices, t.geometry.shapes
    for k in range(first, last):
        _, gap, _, _, _ = signed_distance(vertices, shapes, 2 * k, 2 * k + 1, (0.0, 0.0, 0.0), t.scratch)
        t.gaps[k] = gap


@kernel
def coherent_queries(words: Index, first: int, last: int) -> None:
    """Signed distances of pairs first .. last - 1, each begun from the result of its last query."""
    t = view_arena(words, Table)
    vertices, shapes = t.poses.vertices, t.geometry.shapes
    for k in range(first, last):
        _, gap, _, _, _ = signed_distance_coherent(vertices, shapes, 2 * k, 2 * k + 1, inf, t.scratch, t.memory, k)
        t.gaps[k] = gap


class CompiledPairs:
    """n pairs of shapes, packed for the kernels."""

    def __init__(self, shapes: Sequence[Shape]) -> None:
        n = len(shapes)
        made = geometry(Scene("pairs", tuple(fixed(f"b{k}", (Piece(shape),), "wood") for k, shape in enumerate(shapes))))
        rest = poses(made, np.zeros((n, 3)), np.tile(IDENTITY, (n, 1)))
        self.count = n // 2
        # a bound of the gap's zero along any ray: two radii about the centres, and the largest gap wanted
        self.reach = 1.0 + 2.0 * float(np.linalg.norm(rest.hulls.reshape(-1, 3), axis=1).max())
        table = Table(made, rest, np.zeros(self.count), make_scratch(), make_pair_memory(self.count))
        self.words, self.table = pack(table)

    def pose(self, turns: Array, at: Array) -> None:
        """Set poses (2 n, 3, 3) and (2 n, 3) [m] without moving the vertices yet."""
        self.table.poses.rotation[:], self.table.poses.position[:] = turns, at

    def place(self, turns: Array, at: Array) -> None:
        """Set poses and move all vertices there."""
        self.pose(turns, at)
        place_pairs(self.words, 0, self.count)

    def cold(self) -> Array:
        """Return signed distances (n,) [m] of all pairs."""
        cold_queries(self.words, 0, self.count)
        return np.array(self.table.gaps)


class Avatarsim(Contender):
    """All three, by name."""

    def load(self, trial: Trial) -> None:
        self._trial, self._pairs = trial, CompiledPairs(trial.shapes)
        self._query = cold_queries if trial.mode == "cold" else coherent_queries

    def begin(self) -> None:
        self._pairs.table.memory.view(np.int64)[...] = 0

    def pose(self, frame: int) -> None:
        place = self._pairs.pose if self.name == PLACED else self._pairs.place
        place(self._trial.turns[frame], self._trial.at[frame])

    def query(self) -> None:
        words, count, query = self._pairs.words, self._pairs.count, self._query
        if self.per_call:
            for k in range(count):
                query(words, k, k + 1)
            return
        if self.name == PLACED:
            place_pairs(words, 0, count)
        query(words, 0, count)

    def answers(self) -> Array:
        return np.array(self._pairs.table.gaps)


def contenders() -> tuple[Contender, ...]:
    """Return all three."""
    return tuple(Avatarsim(name, "avatarsim", name == CALLED) for name in (WITHIN, PLACED, CALLED))
