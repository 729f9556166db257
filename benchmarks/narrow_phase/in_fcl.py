"""Signed distance by python-fcl, which has nothing for coherence."""

from functools import lru_cache

import fcl

from benchmarks.narrow_phase.contender import Contender, Trial
from reference.judging.in_fcl import fcl_geometry

geometry = lru_cache(maxsize=128)(fcl_geometry)


class Fcl(Contender):
    """`fcl.distance` on prepared objects."""

    def load(self, trial: Trial) -> None:
        self._trial = trial
        self._objects = [fcl.CollisionObject(geometry(shape)) for shape in trial.shapes]
        self._pairs = list(zip(self._objects[::2], self._objects[1::2], strict=True))
        # the default solver; with the other one depths of hulls are wrong in sign and size
        self._request = fcl.DistanceRequest(enable_signed_distance=True, gjk_solver_type=fcl.GJKSolverType.GST_LIBCCD)
        self._result = fcl.DistanceResult()

    def pose(self, frame: int) -> None:
        for placed, turn, at in zip(self._objects, self._trial.turns[frame], self._trial.at[frame], strict=True):
            placed.setTransform(fcl.Transform(turn, at))

    def query(self) -> None:
        distance, request, result = fcl.distance, self._request, self._result
        self.found = [distance(a, b, request, result) for a, b in self._pairs]


def contenders() -> tuple[Contender, ...]:
    """Return the one there is."""
    return (Fcl("fcl", "python-fcl", True),)
