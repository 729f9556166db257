"""Signed distance by coal, at its defaults, at its fastest, and at its most exact."""

from functools import lru_cache
from typing import Any

import coal
import numpy as np

from avatarsim.scene.shape import Box, Shape
from benchmarks.narrow_phase.contender import Array, Contender, Trial
from reference.judging.distances import EPA_ITERATIONS, TOLERANCE
from reference.judging.geometry import coal_geometry

DEFAULT, FAST, EXACT = "coal default", "coal fast", "coal exact"
"""`coal.distance` with a default request; `ComputeDistance` of the pair, which keeps solver and memory, at the default
tolerances of 1e-6; and at 1e-9, since the default leaves up to a micrometre on deep hulls."""


@lru_cache(maxsize=128)
def geometry(shape: Shape) -> coal.CollisionGeometry:
    """Return `shape` as coal's own kind of it, boxes too: here the library's own choice is timed, exact or not."""
    made = coal.Box(*shape.size) if isinstance(shape, Box) else coal_geometry(shape)
    made.computeLocalAABB()
    return made


class Coal(Contender):
    """coal with the settings of its name."""

    def load(self, trial: Trial) -> None:
        self._trial = trial
        shapes = [geometry(shape) for shape in trial.shapes]
        self._places = [coal.Transform3s() for _ in shapes]
        self._results = [coal.DistanceResult() for _ in range(trial.pairs)]
        places = list(zip(self._places[::2], self._places[1::2], strict=True))
        pairs = list(zip(shapes[::2], shapes[1::2], strict=True))
        self._functions, self._placed = [coal.ComputeDistance(a, b) for a, b in pairs], list[tuple[Any, ...]](places)
        if self.name == DEFAULT:
            self._functions = [coal.distance] * trial.pairs
            self._placed = [(a, at_a, b, at_b) for (a, b), (at_a, at_b) in zip(pairs, places, strict=True)]
        self.begin()

    def _request(self) -> coal.DistanceRequest:
        request = coal.DistanceRequest()
        request.enable_signed_distance = True
        if self.name != DEFAULT:
            # a tenth less time on hulls that are apart, and a quarter less with the guess
            request.gjk_variant = coal.GJKVariant.NesterovAcceleration
            request.gjk_initial_guess = coal.GJKInitialGuess.BoundingVolumeGuess
        if self._trial.mode == "coherent":
            # coal's own means for coherence; its EPA starts anew
            request.gjk_initial_guess = coal.GJKInitialGuess.CachedGuess
        if self.name == EXACT:
            # at the default of 64 iterations, concentric hulls of a hundred triangles are off by 1 mm
            request.gjk_tolerance = request.epa_tolerance = TOLERANCE
            request.epa_max_iterations = EPA_ITERATIONS
        return request

    def begin(self) -> None:
        # a request carries the guess of its pair, so each pair has its own
        requests = [self._request() for _ in self._functions]
        self._calls = [
            (function, (*placed, request, result), request, result)
            for function, placed, request, result in zip(self._functions, self._placed, requests, self._results, strict=True)
        ]

    def pose(self, frame: int) -> None:
        for place, turn, at in zip(self._places, self._trial.turns[frame], self._trial.at[frame], strict=True):
            place.setTransform(turn, at)
        # a result keeps the smaller of the old and the new distance unless the old one is reset
        for result in self._results:
            result.clear()

    def query(self) -> None:
        if self._trial.mode == "coherent":
            for function, arguments, request, result in self._calls:
                function(*arguments)
                request.updateGuess(result)
            return
        for function, arguments, _, _ in self._calls:
            function(*arguments)

    def answers(self) -> Array:
        return np.array([result.min_distance for result in self._results])


def contenders() -> tuple[Contender, ...]:
    """Return all three."""
    return tuple(Coal(name, "coal", True) for name in (DEFAULT, FAST, EXACT))
