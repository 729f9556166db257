"""Signed distances of pieces: coal's answer where a proof comes with it, brute force where not, over many states at once."""

import coal
import numpy as np
from numpy.typing import NDArray

from avatarsim.scene.shape import Ellipsoid, Sphere
from reference.judging.geometry import Pieces
from reference.judging.minkowski import signed_distance
from reference.judging.near import Near
from reference.judging.proof import by_directions, hold, in_parts, largest_over_axes

Array = NDArray[np.float64]
Indices = NDArray[np.int64]
Flags = NDArray[np.bool_]

TOLERANCE = 1e-9
"""Error [m] that coal's two iterations may leave. Its default of 1e-6 costs micrometres on curved shapes; at 1e-12 they lose
their way on aligned boxes, by centimetres."""

SMOOTH_TOLERANCE = 1e-8
"""The same for pairs with an ellipsoid. At 1e-9, every fiftieth such pair came out deeper by centimetres, or endless."""

EPA_ITERATIONS = 512
"""Most faces that coal may open on its way to the surface. At its default of 64, two hulls of a hundred triangles with
one centre came out 1 mm too shallow."""


MAX_AXES = 4000
"""Axes that edges may span up to which all are tried; beyond, the hull of all differences is as fast."""


def _request(tolerance: float) -> coal.DistanceRequest:
    """Return the request to coal: signed distances, iterated to `tolerance` [m]."""
    request = coal.DistanceRequest()
    request.enable_signed_distance = True
    request.gjk_tolerance = request.epa_tolerance = tolerance
    request.epa_max_iterations = EPA_ITERATIONS
    return request


class Distances:
    """Signed distances between the p pieces of one scene."""

    def __init__(self, pieces: Pieces) -> None:
        self._pieces = pieces
        self._placements = tuple(coal.Transform3s() for _ in pieces.geometries)
        self._result = coal.DistanceResult()
        self._requests = _request(TOLERANCE), _request(SMOOTH_TOLERANCE)
        self._smooth = tuple(isinstance(shape, Ellipsoid) for shape in pieces.shapes)
        self._radii = np.array([shape.radius if isinstance(shape, Sphere) else np.nan for shape in pieces.shapes])

    def each(self, at: Array, turned: Array, near: Near) -> tuple[Array, Flags]:
        """Return signed distances (k,) [m] of near pairs in states placed at (F, p, 3) [m] and turned by (F, p, 3, 3), and True
        (k,) where brute force decided."""
        state, first, second = near
        offsets = at[state, first] - at[state, second]
        # two balls need no iteration, and so no proof; all others are nan here
        distances = np.linalg.norm(offsets, axis=1) - self._radii[first] - self._radii[second]
        undecided, decided = np.flatnonzero(np.isnan(distances)), np.zeros(len(distances), dtype=np.bool_)
        normals = self._ask(undecided, near, at, turned, distances)
        for rows in _alike(undecided, first * len(self._radii) + second):
            a, b = int(first[rows[0]]), int(second[rows[0]])
            turn_a, turn_b = turned[state[rows], a], turned[state[rows], b]
            one, other = self._pieces.outlines[a], self._pieces.outlines[b]
            sound = hold(distances[rows], normals[rows], one, turn_a, other, turn_b, offsets[rows])
            if sound.all():
                continue
            open_ = np.flatnonzero(~sound)
            decided[rows[open_]] = True
            distances[rows[open_]] = self._decided(a, turn_a[open_], b, turn_b[open_], offsets[rows[open_]])
        return distances, decided

    def _ask(self, undecided: Indices, near: Near, at: Array, turned: Array, distances: Array) -> Array:
        """Write coal's claims [m] for `undecided` into `distances` (k,); the normals (k, 3) out of the second into the first."""
        normals, geometries, placements = np.zeros((len(distances), 3)), self._pieces.geometries, self._placements
        smooth, result, before, placed = self._smooth, self._result, -1, set[int]()
        columns = (rows.tolist() for rows in (undecided, *near.at(undecided)))
        for row, k, a, b in zip(*columns, strict=True):
            if k != before:
                before = k
                placed.clear()
            for piece in (a, b):
                if piece not in placed:
                    placements[piece].setTransform(turned[k, piece], at[k, piece])
                    placed.add(piece)
            # coal keeps the smaller of the old and the new distance unless the old one is reset
            result.clear()
            request = self._requests[smooth[a] or smooth[b]]
            distances[row] = coal.distance(geometries[a], placements[a], geometries[b], placements[b], request, result)
            # coal's normal points from its first body into its second
            normals[row] = -result.normal
        return normals

    def _decided(self, a: int, turns_a: Array, b: int, turns_b: Array, offsets: Array) -> Array:
        """Return signed distances (k,) [m] of k placements of pieces a and b without iteration: all axes of overlapping polytopes
        in one pass, and the rest one by one."""
        one, other = self._pieces.outlines[a], self._pieces.outlines[b]
        distances, rows = np.full(len(offsets), np.nan), np.arange(len(offsets))
        axes = 2 * len(one.edges) * len(other.edges)
        if len(one.faces) and len(other.faces) and axes <= MAX_AXES:
            for some in in_parts(rows, axes * (len(one.points) + len(other.points))):
                distances[some] = largest_over_axes(one, turns_a[some], other, turns_b[some], offsets[some])
        for k in np.flatnonzero(~(distances < 0.0)):
            distances[k] = self.by_brute_force(a, turns_a[k], b, turns_b[k], offsets[k])
        return distances

    def by_brute_force(self, a: int, turn_a: Array, b: int, turn_b: Array, offset: Array) -> float:
        """Return the signed distance [m] of pieces a and b without iteration; `offset` (3,) [m] leads from b's origin to a's."""
        one, other = self._pieces.outlines[a], self._pieces.outlines[b]
        if self._smooth[a] or self._smooth[b]:
            return by_directions(one, turn_a, other, turn_b, offset)
        return signed_distance(one.points @ turn_a.T + offset, one.radius, other.points @ turn_b.T, other.radius)


def _alike(rows: Indices, key: Indices) -> list[Indices]:
    """Return `rows` in groups of one `key`: rows of the same two pieces are proven together."""
    if not len(rows):
        return []
    ordered = rows[np.argsort(key[rows], kind="stable")]
    return np.split(ordered, np.flatnonzero(np.diff(key[ordered])) + 1)
