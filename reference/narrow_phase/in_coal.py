"""Signed distance by coal, at its defaults, at its fastest, and at its most exact."""

from functools import lru_cache

import coal
import numpy as np
from numpy.typing import NDArray

from avatarsim.scene.shape import Box, Shape
from reference.judging.distances import EPA_ITERATIONS, TOLERANCE
from reference.judging.geometry import coal_geometry
from reference.narrow_phase.cells import Mode, Sequence
from reference.narrow_phase.contender import Identity

Array = NDArray[np.float64]

FAST_SETTINGS = {
    "call": ("ComputeDistance", "an object per pair keeps its solver and its memory: a tenth less than coal.distance"),
    "gjk_variant": ("NesterovAcceleration", "fewer iterations; a tenth less on hulls that are apart, level elsewhere"),
    "gjk_initial_guess": (
        "BoundingVolumeGuess; coherent: CachedGuess", "a quarter less when apart; coherent: the pair's own last answer, handed "
        "on by updateGuess within the time, which is what coal has for coherence (its EPA starts anew)"
    ),
}
DEFAULT = Identity("coal default", "coal", True, "coal.distance with a default request, signed; coherent: with CachedGuess", {
    "gjk_initial_guess": ("DefaultGuess; coherent: CachedGuess", "what coal has for coherence"),
})
FAST = Identity("coal fast", "coal", True, "ComputeDistance of the pair, signed, default tolerances of 1e-6", FAST_SETTINGS)
EXACT = Identity("coal exact", "coal", True, "ComputeDistance of the pair, signed, tolerances of 1e-9", {
    **FAST_SETTINGS,
    "gjk_tolerance, epa_tolerance": (f"{TOLERANCE:g}", "the default of 1e-6 leaves up to a micrometre on deep hulls"),
    "epa_max_iterations": (str(EPA_ITERATIONS), "at the default of 64, concentric hulls of a hundred triangles fail by 1 mm"),
})


@lru_cache(maxsize=128)
def geometry(shape: Shape) -> coal.CollisionGeometry:
    """`shape` as coal's own kind of it, boxes too: here the library's own choice is timed, exact or not."""
    made = coal.Box(*shape.size) if isinstance(shape, Box) else coal_geometry(shape)
    made.computeLocalAABB()
    return made


class Coal:
    """coal with the settings of its identity."""

    def __init__(self, identity: Identity) -> None:
        self.identity = identity

    def load(self, sequence: Sequence, mode: Mode) -> None:
        """See Contender."""
        self._sequence, self._coherent = sequence, mode == "coherent"
        shapes = [geometry(shape) for shape in sequence.shapes]
        self._places = [coal.Transform3s() for _ in shapes]
        self._results = [coal.DistanceResult() for _ in range(sequence.pairs)]
        pairs = list(zip(shapes[::2], shapes[1::2], strict=True))
        self._between = list(zip(self._places[::2], self._places[1::2], strict=True))
        self._functions = [coal.ComputeDistance(a, b) for a, b in pairs]
        self._pairs = pairs
        self.begin()

    def _request(self) -> coal.DistanceRequest:
        request = coal.DistanceRequest()
        request.enable_signed_distance = True
        if self.identity is not DEFAULT:
            request.gjk_variant = coal.GJKVariant.NesterovAcceleration
            request.gjk_initial_guess = coal.GJKInitialGuess.BoundingVolumeGuess
        if self._coherent:
            request.gjk_initial_guess = coal.GJKInitialGuess.CachedGuess
        if self.identity is EXACT:
            request.gjk_tolerance = request.epa_tolerance = TOLERANCE
            request.epa_max_iterations = EPA_ITERATIONS
        return request

    load_call = load

    def begin(self) -> None:
        """See Contender."""
        # a request carries the guess of its pair, so each pair has its own
        requests = [self._request() for _ in self._pairs]
        rest = zip(self._between, requests, self._results, strict=True)
        self._calls = [
            (function, a, at_a, b, at_b, request, result)
            for function, (a, b), ((at_a, at_b), request, result) in zip(self._functions, self._pairs, rest, strict=True)
        ]

    def pose(self, frame: int) -> None:
        """See Contender."""
        for place, turn, at in zip(self._places, self._sequence.turns[frame], self._sequence.at[frame], strict=True):
            place.setTransform(turn, at)
        # a result keeps the smaller of the old and the new distance unless told to forget
        for result in self._results:
            result.clear()

    def ask(self) -> None:
        """See Contender."""
        if self.identity is DEFAULT:
            distance = coal.distance
            if self._coherent:
                for _, a, at_a, b, at_b, request, result in self._calls:
                    distance(a, at_a, b, at_b, request, result)
                    request.updateGuess(result)
                return
            for _, a, at_a, b, at_b, request, result in self._calls:
                distance(a, at_a, b, at_b, request, result)
            return
        if self._coherent:
            for function, _, at_a, _, at_b, request, result in self._calls:
                function(at_a, at_b, request, result)
                request.updateGuess(result)
            return
        for function, _, at_a, _, at_b, request, result in self._calls:
            function(at_a, at_b, request, result)

    def answers(self) -> Array:
        """See Contender."""
        return np.array([result.min_distance for result in self._results])


def contenders() -> tuple[Coal, ...]:
    """All of them."""
    return Coal(DEFAULT), Coal(FAST), Coal(EXACT)
