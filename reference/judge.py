"""The one judge of overlap for all engines: from exported poses alone, with a library that no engine uses."""

from dataclasses import dataclass

import coal
import numpy as np
from numpy.typing import NDArray

from avatarsim.errors import InvalidInput
from avatarsim.scene.scene import Scene
from avatarsim.scene.shape import Ellipsoid
from avatarsim.spatial import rotation
from reference.judge_geometry import Pieces, rounded_points
from reference.judge_proof import by_directions, holds
from reference.minkowski import signed_distance

Array = NDArray[np.float64]
Indices = NDArray[np.int64]

TOLERANCE = 1e-9
"""What coal's two iterations may leave [m]. Its default of 1e-6 costs micrometres on curved shapes; at 1e-12 they lose
their way on aligned boxes, by centimetres."""

SMOOTH_TOLERANCE = 1e-8
"""The same for pairs with an ellipsoid. At 1e-9, every fiftieth such pair came out deeper by centimetres, or endless."""

EPA_ITERATIONS = 512
"""Most faces that coal may open on its way to the surface. At its default of 64, two hulls of a hundred triangles with
one centre came out 1 mm too shallow."""

LENGTH_OF_A_ROTATION = 1e-6
"""How far from 1 the length of a quaternion may be. Beyond, the pose is no rotation and its verdict is not a number."""

FARTHEST = 1e7
"""Largest coordinate [m] that is judged. Beyond, neighbouring numbers are further apart than the promised accuracy, and a
body that got there was thrown out of the world."""


@dataclass(frozen=True)
class Verdict:
    """What the judge found in one state of the world.

    deepest  [m] largest depth over all pairs that must not overlap; 0 when free, nan when the poses are no poses
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


def _request(tolerance: float) -> coal.DistanceRequest:
    """What coal is asked for: signed distances, iterated to `tolerance` [m]."""
    request = coal.DistanceRequest()
    request.enable_signed_distance = True
    request.gjk_tolerance = request.epa_tolerance = tolerance
    request.epa_max_iterations = EPA_ITERATIONS
    return request


class Judge:
    """Measures how deep the bodies and links of `scene` are in one another, given their poses."""

    def __init__(self, scene: Scene) -> None:
        self.scene = scene
        self.pieces = Pieces(scene)
        self._placements = tuple(coal.Transform3s() for _ in self.pieces.geometries)
        self._result = coal.DistanceResult()
        self._requests = _request(TOLERANCE), _request(SMOOTH_TOLERANCE)
        self._smooth = tuple(isinstance(shape, Ellipsoid) for shape in self.pieces.shapes)
        self._decided = 0

    def overlaps(self, positions: Array, orientations: Array, reach: float = 0.0) -> Verdict:
        """Verdict on body frames at positions (n, 3) [m] and orientations (n, 4), in the scene's canonical order.

        Pairs whose boxes are further apart than `reach` [m] are not measured. Poses that are not finite or not
        rotations give a depth of nan, never an exception. Raises InvalidInput when the shapes do not fit the scene.
        """
        faults = self.faults(positions, orientations)
        if faults:
            return Verdict(np.nan, None, faults=faults, gap=np.nan)
        first, second, distances = self.distances(positions, orientations, reach)
        names = self.scene.names
        if np.isnan(distances).any():
            k = int(np.flatnonzero(np.isnan(distances))[0])
            a, b = names[self.pieces.owner[first[k]]], names[self.pieces.owner[second[k]]]
            return Verdict(np.nan, None, gap=np.nan, faults=(f"no distance was found for {a} and {b}",), decided=self._decided)
        depths: dict[tuple[int, int], float] = {}
        for a, b, distance in zip(self.pieces.owner[first], self.pieces.owner[second], distances, strict=True):
            if distance < 0.0:
                pair = (int(min(a, b)), int(max(a, b)))
                depths[pair] = max(depths.get(pair, 0.0), -float(distance))
        pairs = sorted(((names[a], names[b], depth) for (a, b), depth in depths.items()), key=lambda found: -found[2])
        gap = float(distances.min()) if len(distances) else np.inf
        if not pairs:
            return Verdict(0.0, None, gap=gap, decided=self._decided)
        return Verdict(pairs[0][2], pairs[0][:2], tuple(pairs), gap, decided=self._decided)

    def distances(self, positions: Array, orientations: Array, reach: float = 0.0) -> tuple[Indices, Indices, Array]:
        """Indices (k,), (k,) of the pieces of all near pairs and their signed distance (k,) [m]; poses must be sound."""
        turns = rotation.to_matrix(rotation.normalised(orientations))
        at, turned = self.pieces.placed(np.asarray(positions, dtype=np.float64), turns)
        first, second = self._near(*self.pieces.boxes(at, turned), reach)
        for k in np.unique(np.concatenate([first, second])):
            self._placements[k].setTransform(turned[k], at[k])
        geometries, outlines, placements = self.pieces.geometries, self.pieces.outlines, self._placements
        smooth, result = self._smooth, self._result
        found = np.zeros(len(first))
        self._decided = 0
        for k, (a, b) in enumerate(zip(first.tolist(), second.tolist(), strict=True)):
            # coal keeps the smaller of the old and the new distance unless told to forget
            result.clear()
            request = self._requests[smooth[a] or smooth[b]]
            claim = coal.distance(geometries[a], placements[a], geometries[b], placements[b], request, result)
            offset = at[a] - at[b]
            # coal's normal points from its first body into its second
            if not holds(claim, -result.normal, outlines[a], turned[a], outlines[b], turned[b], offset):
                self._decided += 1
                claim = self.by_brute_force(a, turned[a], b, turned[b], offset)
            found[k] = claim
        return first, second, found

    def by_brute_force(self, a: int, turn_a: Array, b: int, turn_b: Array, offset: Array) -> float:
        """Signed distance [m] of pieces a and b without iteration; `offset` (3,) [m] leads from b's origin to a's."""
        shape_a, shape_b = self.pieces.shapes[a], self.pieces.shapes[b]
        if isinstance(shape_a, Ellipsoid) or isinstance(shape_b, Ellipsoid):
            return by_directions(self.pieces.outlines[a], turn_a, self.pieces.outlines[b], turn_b, offset)
        (points_a, radius_a), (points_b, radius_b) = rounded_points(shape_a), rounded_points(shape_b)
        return signed_distance(points_a @ turn_a.T + offset, radius_a, points_b @ turn_b.T, radius_b)

    def _near(self, low: Array, high: Array, reach: float) -> tuple[Indices, Indices]:
        """Pairs of pieces that the scene filters in and whose boxes come within `reach`: sweep along one axis."""
        axis = int(np.argmax(np.ptp(low, axis=0)))
        order = np.argsort(low[:, axis], kind="stable")
        # in this order the partners of a piece are the next ones, up to the first that begins beyond its end
        ends = np.searchsorted(low[order, axis], high[order, axis] + reach, side="right")
        counts = np.maximum(ends - np.arange(len(order)) - 1, 0)
        first = np.repeat(np.arange(len(order)), counts)
        second = first + 1 + np.arange(len(first)) - np.repeat(np.cumsum(counts) - counts, counts)
        first, second = order[first], order[second]
        near = self.scene.pair_filter[self.pieces.owner[first], self.pieces.owner[second]]
        for k in range(3):
            near &= (low[first, k] <= high[second, k] + reach) & (low[second, k] <= high[first, k] + reach)
        return first[near], second[near]

    def faults(self, positions: Array, orientations: Array) -> tuple[str, ...]:
        """One sentence per body whose pose is not finite or whose quaternion is not of length 1."""
        n = len(self.scene.names)
        for thing, value, width in (("positions", positions, 3), ("orientations", orientations, 4)):
            if np.shape(value) != (n, width):
                raise InvalidInput(f"shape of {thing}", np.shape(value), f"{(n, width)}, one row per body of the scene")
        lengths = np.linalg.norm(orientations, axis=1)
        sound = (np.abs(positions) <= FARTHEST).all(axis=1) & (np.abs(lengths - 1.0) <= LENGTH_OF_A_ROTATION)
        if sound.all():
            return ()
        return tuple(
            f"{self.scene.names[k]} is at {np.asarray(positions[k]).tolist()}, its quaternion has length {float(lengths[k])!r}"
            for k in np.flatnonzero(~sound)
        )
