"""Signed distance by avatarsim: in one compiled call, as the engine does it, and in a call from Python per query.

Nothing is kept from one query of a pair to the next, in either mode.
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from avatarsim.collision.scratch import Scratch, make_scratch
from avatarsim.collision.signed_distance import signed_distance
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


@kernel
def place_pairs(words: Index, first: int, last: int) -> None:
    """World vertices of the shapes of pairs first .. last - 1."""
    t = view_arena(words, Table)
    for b in range(2 * first, 2 * last):
        place(t.geometry, t.poses, b)


@kernel
def queries(words: Index, first: int, last: int) -> None:
    """Signed distances of pairs first .. last - 1, with nothing known about them."""
    t = view_arena(words, Table)
    vertices, shapes = t.poses.vertices, t.geometry.shapes
    for k in range(first, last):
        _, gap, _, _, _ = signed_distance(vertices, shapes, 2 * k, 2 * k + 1, (0.0, 0.0, 0.0), t.scratch)
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
        table = Table(made, rest, np.zeros(self.count), make_scratch())
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
        queries(self.words, 0, self.count)
        return np.array(self.table.gaps)


class Avatarsim(Contender):
    """All three, by name."""

    def load(self, trial: Trial) -> None:
        self._trial, self._pairs = trial, CompiledPairs(trial.shapes)

    def pose(self, frame: int) -> None:
        place = self._pairs.pose if self.name == PLACED else self._pairs.place
        place(self._trial.turns[frame], self._trial.at[frame])

    def query(self) -> None:
        words, count = self._pairs.words, self._pairs.count
        if self.per_call:
            for k in range(count):
                queries(words, k, k + 1)
            return
        if self.name == PLACED:
            place_pairs(words, 0, count)
        queries(words, 0, count)

    def answers(self) -> Array:
        return np.array(self._pairs.table.gaps)


def contenders() -> tuple[Contender, ...]:
    """Return all three."""
    return tuple(Avatarsim(name, "avatarsim", name == CALLED) for name in (WITHIN, PLACED, CALLED))
