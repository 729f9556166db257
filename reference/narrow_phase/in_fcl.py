"""Signed distance by python-fcl."""

from functools import lru_cache

import fcl
import numpy as np
from numpy.typing import NDArray

from reference.judging.in_fcl import fcl_geometry
from reference.narrow_phase.cells import Mode, Sequence
from reference.narrow_phase.contender import Identity

Array = NDArray[np.float64]

geometry = lru_cache(maxsize=128)(fcl_geometry)

DISTANCE = Identity("fcl", "python-fcl", True, "fcl.distance, signed; fcl has nothing for coherence", {
    "gjk_solver_type": ("GST_LIBCCD", "the default; with the other one depths of hulls are wrong in sign and size"),
})


class Fcl:
    """fcl.distance on prepared objects."""

    identity = DISTANCE

    def load(self, sequence: Sequence, mode: Mode) -> None:
        """See Contender."""
        self._sequence = sequence
        self._objects = [fcl.CollisionObject(geometry(shape)) for shape in sequence.shapes]
        self._pairs = list(zip(self._objects[::2], self._objects[1::2], strict=True))
        self._request = fcl.DistanceRequest(enable_signed_distance=True, gjk_solver_type=fcl.GJKSolverType.GST_LIBCCD)
        self._result = fcl.DistanceResult()
        self._found = [0.0] * sequence.pairs

    def load_call(self, spheres: Sequence, mode: Mode) -> None:
        """See Contender. Without a sign: with one, fcl iterates on spheres too, and the call would seem dear."""
        self.load(spheres, mode)
        self._request = fcl.DistanceRequest(enable_signed_distance=False, gjk_solver_type=fcl.GJKSolverType.GST_LIBCCD)

    def begin(self) -> None:
        """See Contender."""

    def pose(self, frame: int) -> None:
        """See Contender."""
        for placed, turn, at in zip(self._objects, self._sequence.turns[frame], self._sequence.at[frame], strict=True):
            placed.setTransform(fcl.Transform(turn, at))

    def ask(self) -> None:
        """See Contender."""
        distance, request, result = fcl.distance, self._request, self._result
        self._found = [distance(a, b, request, result) for a, b in self._pairs]

    def answers(self) -> Array:
        """See Contender."""
        return np.array(self._found)


def contenders() -> tuple[Fcl, ...]:
    """The one there is."""
    return (Fcl(),)
