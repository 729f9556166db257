"""Contact filter of a model's parts: contype and conaffinity, excluded and stated pairs, bodies that are rigid with one another.

The rules are those of MuJoCo's collision filter (its documentation, "Collision detection: selection"), for whole bodies instead
of single geoms: two bodies may touch if any two of their geoms may. Parent and child never touch, also if the parent is fixed.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from avatarsim.assets.models.compiled import Compiled

BITS = 16
"""Number of bits by which MuJoCo shifts the first body of an excluded pair."""


@dataclass(frozen=True)
class Part:
    """Bodies with one name in the scene: `bodies` and their colliding `geoms`. `weld` is the body with whose frame it is rigid,
    0 the world; `above` the weld that this one is jointed to, -1 for none."""

    name: str
    bodies: tuple[int, ...]
    geoms: tuple[int, ...]
    weld: int
    above: int = -1


@dataclass(frozen=True, eq=False)
class Filter:
    """The file's rules on pairs; without `masks` contype and conaffinity are ignored."""

    model: Compiled
    masks: bool = True

    @cached_property
    def _stated(self) -> frozenset[tuple[int, int]]:
        """Return pairs of geoms that the file states, which touch regardless of its other rules."""
        pairs = zip(self.model.pair_geom1.tolist(), self.model.pair_geom2.tolist(), strict=True)
        return frozenset((min(pair), max(pair)) for pair in pairs)

    @cached_property
    def _excluded(self) -> frozenset[int]:
        return frozenset(self.model.exclude_signature.tolist())

    def excluded_pairs(self, parts: Sequence[Part]) -> Iterator[tuple[int, int]]:
        """Yield pairs i < j of parts, not both fixed, that the file keeps apart."""
        bits = np.array([self._bits(part.geoms) for part in parts], dtype=np.int64).reshape(-1, 2)
        named = self._named(parts)
        moves = [part.weld != 0 for part in parts]
        for i in [i for i, is_moving in enumerate(moves) if is_moving]:
            passing = (bits[i, 0] & bits[:, 1]) | (bits[i, 1] & bits[:, 0])
            candidates = named.get(i, set()) | ({int(j) for j in np.flatnonzero(passing == 0)} if self.masks else set())
            # of two moving ones, the pair is found from the first one
            for j in sorted(j for j in candidates if j != i and (j > i or not moves[j])):
                if not self.meet(parts[i], parts[j]):
                    yield min(i, j), max(i, j)

    def _named(self, parts: Sequence[Part]) -> dict[int, set[int]]:
        """Return for each part those with which it has bodies in an excluded pair."""
        carrying: dict[int, list[int]] = {}
        for i, part in enumerate(parts):
            for body in part.bodies:
                carrying.setdefault(body, []).append(i)
        found: dict[int, set[int]] = {}
        for signature in self._excluded:
            one, other = (carrying.get(body, []) for body in (signature >> BITS, signature & ((1 << BITS) - 1)))
            for i in one:
                for j in other:
                    found.setdefault(i, set()).add(j)
                    found.setdefault(j, set()).add(i)
        return found

    def apart(self, one: Part, other: Part) -> bool:
        """Return True if two parts never touch since they are rigid with one another, or one is jointed to the other."""
        return one.weld == other.weld or one.above == other.weld or other.above == one.weld

    def states(self, one: Part, other: Part) -> bool:
        """Return True if the file states a pair of geoms of two parts."""
        return bool(self._stated) and any((min(g, h), max(g, h)) in self._stated for g in one.geoms for h in other.geoms)

    def meet(self, one: Part, other: Part) -> bool:
        """Return True if the file lets any geom of one part touch any of the other."""
        if self.states(one, other):
            return True
        if self._excluded and all(
            (min(a, b) << BITS) + max(a, b) in self._excluded for a in one.bodies for b in other.bodies
        ):
            return False
        if not self.masks:
            return True
        # any pair of geoms passes where their combined bits do
        types, others = self._bits(one.geoms), self._bits(other.geoms)
        return bool(types[0] & others[1] or types[1] & others[0])

    def _bits(self, geoms: Sequence[int]) -> tuple[int, int]:
        chosen = list(geoms)
        types, affinities = self.model.geom_contype[chosen], self.model.geom_conaffinity[chosen]
        return int(np.bitwise_or.reduce(types)), int(np.bitwise_or.reduce(affinities))
