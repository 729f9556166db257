"""The one judge of overlap for all engines: from exported poses alone, with a library that no engine uses."""

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from avatarsim.errors import InvalidInput
from avatarsim.scene.scene import Scene
from avatarsim.spatial import rotation
from reference.judging.distances import Distances
from reference.judging.geometry import Pieces
from reference.judging.motion import Moves, where_deep
from reference.judging.near import Near, near_pairs

Array = NDArray[np.float64]
Indices = NDArray[np.int64]
Flags = NDArray[np.bool_]
World = tuple[Array, Array]
"""Positions (F, p, 3) [m] and turns (F, p, 3, 3) of all pieces in F states."""

LENGTH_OF_A_ROTATION = 1e-6
"""Largest deviation from 1 of a quaternion's length. Beyond, the pose is no rotation and its verdict is not a number."""

FARTHEST = 1e7
"""Largest coordinate [m] that is judged. Beyond, neighbouring numbers are further apart than the promised accuracy, and a
body that got there was thrown out of the world."""


PLACED_AT_ONCE = 50_000
"""Pieces times states that are placed in one go: some 10 MB."""


@dataclass(frozen=True)
class Verdict:
    """Result of the judge for one state of the world.

    deepest  [m] largest depth over all pairs that must not overlap, of a pair that overlaps at home beyond that; 0 when free, nan
             when the poses are no poses
    pair     names of that pair, or None
    pairs    (name, name, depth [m]) of every overlapping pair of bodies, deepest first
    gap      [m] smallest distance over the pairs measured, negative when they overlap; inf when none was near
    faults   why `deepest` is nan: one sentence per body whose pose is not finite, absurdly far, or not a rotation
    decided  number of pairs of pieces whose fast answer did not hold and that brute force decided
    """

    deepest: float
    pair: tuple[str, str] | None
    pairs: tuple[tuple[str, str, float], ...] = ()
    gap: float = np.inf
    faults: tuple[str, ...] = ()
    decided: int = 0


FREE = Verdict(0.0, None)
"""Placeholder of a state until it is judged."""


class Judge:
    """Measures how deep the bodies and links of `scene` are in one another, given their poses."""

    def __init__(self, scene: Scene) -> None:
        self.scene = scene
        self.pieces = Pieces(scene)
        self._may_meet = scene.pair_filter[self.pieces.owner[:, None], self.pieces.owner[None, :]]
        self._allowed = np.zeros((len(scene.names), len(scene.names)))
        for a, b, depth in scene.resting:
            self._allowed[a, b] = self._allowed[b, a] = depth
        self.between = Distances(self.pieces)

    def overlaps(self, positions: Array, orientations: Array, reach: float = 0.0) -> Verdict:
        """Return the verdict on body frames at positions (n, 3) [m] and orientations (n, 4), in the scene's canonical order.

        Pairs whose boxes are further apart than `reach` [m] are not measured. Poses that are not finite or not
        rotations give a depth of nan, never an exception. Raises InvalidInput when the shapes do not fit the scene.
        """
        return self.each(np.asarray(positions)[None], np.asarray(orientations)[None], reach)[0]

    def each(self, positions: Array, orientations: Array, reach: float = 0.0) -> list[Verdict]:
        """Return verdicts on F states (F, n, 3) [m], (F, n, 4) at once, each as if it were judged alone."""
        verdicts = self._all_faults(positions, orientations)
        for sound, world, near in self._blocks(positions, orientations, reach):
            distances, decided = self._beyond_rest(world, near)
            ends = np.searchsorted(near.state, np.arange(len(sound) + 1))
            for k, start, end in zip(sound, ends[:-1], ends[1:], strict=True):
                some = slice(start, end)
                verdicts[k] = self._verdict(near.first[some], near.second[some], distances[some], int(decided[some].sum()))
        return verdicts

    def over_time(self, positions: Array, orientations: Array) -> list[Verdict]:
        """Return the same of states that follow one another, but for the gap: pairs that a measured state and the motion since
        prove apart are not measured."""
        verdicts = self._all_faults(positions, orientations)
        for sound, world, near in self._blocks(positions, orientations):
            distances = self._where_deep(world, near, False)
            deep = np.flatnonzero(~(distances >= 0.0))
            state = near.state[deep]
            for some in np.split(deep, np.flatnonzero(np.diff(state)) + 1) if len(deep) else ():
                verdict = self._verdict(near.first[some], near.second[some], distances[some], 0)
                verdicts[sound[near.state[some[0]]]] = replace(verdict, gap=np.nan)
        return verdicts

    def depths(self, positions: Array, orientations: Array) -> Array:
        """Return (F,) deepest overlap [m] of F states (F, n, 3), (F, n, 4): 0 when free, nan when the poses are no poses."""
        return np.array([verdict.deepest for verdict in self.over_time(positions, orientations)], dtype=np.float64)

    def deepest(self, positions: Array, orientations: Array) -> float:
        """Return the deepest overlap [m] of all these states together; nan when one of them has no pose or a pair no distance."""
        depth = 0.0 if self._sound(positions, orientations).all() else np.nan
        for _, world, near in self._blocks(positions, orientations):
            # a pair without a distance stays nan
            depth = np.maximum(depth, 0.0 - np.min(self._where_deep(world, near, True), initial=0.0))
        return float(depth)

    def link_depths(self, positions: Array, orientations: Array) -> Array:
        """Return (F,) the deepest overlap over pairs in which a link takes part."""
        link = self.pieces.owner >= len(self.scene.bodies)
        depths = np.where(self._sound(positions, orientations).all(axis=1), 0.0, np.nan)
        for sound, world, near in self._blocks(positions, orientations):
            linked = near.at(link[near.first] | link[near.second])
            np.maximum.at(depths, sound[linked.state], -self._where_deep(world, linked, False))
        return depths

    def link_gaps(self, positions: Array, orientations: Array, reach: float) -> Array:
        """Return (F,) the smallest distance [m] of a pair in which a link takes part, negative where it overlaps; inf where the
        boxes of no such pair are within `reach` [m] of each other, nan where the poses are no poses or a pair has no distance."""
        link = self.pieces.owner >= len(self.scene.bodies)
        gaps = np.where(self._sound(positions, orientations).all(axis=1), np.inf, np.nan)
        for sound, world, near in self._blocks(positions, orientations, reach):
            linked = near.at(link[near.first] | link[near.second])
            np.minimum.at(gaps, sound[linked.state], self._beyond_rest(world, linked)[0])
        return gaps

    def _all_faults(self, positions: Array, orientations: Array) -> list[Verdict]:
        """Return FREE for every state whose poses are poses, and why not for the others."""
        verdicts = [FREE] * len(positions)
        for k in np.flatnonzero(~self._sound(positions, orientations).all(axis=1)):
            verdicts[k] = Verdict(np.nan, None, faults=self.faults(positions[k], orientations[k]), gap=np.nan)
        return verdicts

    def _blocks(self, positions: Array, orientations: Array, reach: float = 0.0) -> Iterator[tuple[Indices, World, Near]]:
        """Yield the sound states, some at a time: their places in the whole, where all pieces are in them, and which are near."""
        sound = np.flatnonzero(self._sound(positions, orientations).all(axis=1))
        # all at once would fill memory, one by one costs more in calls than in distances
        block = max(1, PLACED_AT_ONCE // len(self.pieces.shapes))
        for start in range(0, len(sound), block):
            some = sound[start : start + block]
            world = self._placed(positions[some], orientations[some])
            yield some, world, near_pairs(self._may_meet, *self.pieces.boxes(*world), reach)

    def _where_deep(self, world: World, near: Near, deepest_only: bool) -> Array:
        """Return signed distances (k,) [m] of near pairs, right where they overlap."""
        return where_deep(near, Moves(self.pieces, *world), lambda some: self._beyond_rest(world, some)[0], deepest_only)

    def _beyond_rest(self, world: World, near: Near) -> tuple[Array, Flags]:
        """Return `Distances.each`, larger by the depth that the pair may have, which overlaps at home (`Scene.at_rest`)."""
        distances, decided = self.between.each(*world, near)
        if self.scene.resting:
            distances = distances + self._allowed[self.pieces.owner[near.first], self.pieces.owner[near.second]]
        return distances, decided

    def _verdict(self, first: Indices, second: Indices, distances: Array, decided: int) -> Verdict:
        """Return the verdict on the bodies from the distances (k,) [m] of pairs of pieces."""
        names, owner = self.scene.names, self.pieces.owner
        gap = float(distances.min()) if len(distances) else np.inf
        if gap >= 0.0:
            return Verdict(0.0, None, gap=gap, decided=decided)
        if np.isnan(gap):
            lost = int(np.flatnonzero(np.isnan(distances))[0])
            a, b = names[owner[first[lost]]], names[owner[second[lost]]]
            return Verdict(np.nan, None, gap=np.nan, faults=(f"no distance was found for {a} and {b}",), decided=decided)
        depths: dict[tuple[int, int], float] = {}
        for k in np.flatnonzero(distances < 0.0):
            one, other = int(owner[first[k]]), int(owner[second[k]])
            key = (min(one, other), max(one, other))
            depths[key] = max(depths.get(key, 0.0), -float(distances[k]))
        pairs = sorted(((names[one], names[other], depth) for (one, other), depth in depths.items()), key=lambda pair: -pair[2])
        return Verdict(pairs[0][2], pairs[0][:2], tuple(pairs), gap, decided=decided)

    def distances(self, positions: Array, orientations: Array, reach: float = 0.0) -> tuple[Indices, Indices, Array]:
        """Return indices (k,), (k,) of the pieces of all near pairs and their signed distance (k,) [m]; poses must be sound."""
        world = self._placed(np.asarray(positions)[None], np.asarray(orientations)[None])
        near = near_pairs(self._may_meet, *self.pieces.boxes(*world), reach)
        return near.first, near.second, self._beyond_rest(world, near)[0]

    def _placed(self, positions: Array, orientations: Array) -> World:
        """Return positions (F, p, 3) [m] and turns (F, p, 3, 3) of all pieces in the world."""
        return self.pieces.placed(positions.astype(np.float64), rotation.to_matrix(rotation.normalised(orientations)))

    def faults(self, positions: Array, orientations: Array) -> tuple[str, ...]:
        """Return one sentence per body whose pose is not finite or whose quaternion is not of length 1."""
        lengths = np.linalg.norm(orientations, axis=1)
        return tuple(
            f"{self.scene.names[k]} is at {np.asarray(positions[k]).tolist()}, its quaternion has length {float(lengths[k])!r}"
            for k in np.flatnonzero(~self._sound(positions, orientations))
        )

    def _sound(self, positions: Array, orientations: Array) -> Flags:
        """Return (..., n) True where a pose is finite, not absurdly far, and a rotation. Raises InvalidInput for other shapes."""
        n = len(self.scene.names)
        for thing, value, width in (("positions", positions, 3), ("orientations", orientations, 4)):
            if np.shape(value)[-2:] != (n, width):
                raise InvalidInput(f"shape of {thing}", np.shape(value)[-2:], f"{(n, width)}, one row per body of the scene")
        lengths = np.linalg.norm(orientations, axis=-1)
        return np.asarray((np.abs(positions) <= FARTHEST).all(axis=-1) & (np.abs(lengths - 1.0) <= LENGTH_OF_A_ROTATION))
