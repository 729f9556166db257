"""PyBullet's getClosestPoints, a call per pair, and performCollisionDetection, one call for a world of the pairs alone."""

import numpy as np
import pybullet
from scipy.spatial.transform import Rotation

from avatarsim.scene.shape import Piece
from benchmarks.narrow_phase.contender import Array, Contender, Trial
from reference.in_pybullet.shapes import collision_shape, placed

CLOSEST_DEFAULT, CLOSEST, DETECTION = "pb closest default", "pb closest", "pb detection"
"""The last includes a broad phase and gives no answer for pairs further apart than BREAKING; in mode `cold` all pairs were
apart before, in mode `coherent` it has its own persistent manifolds."""
SPACING = 20.0
"""Metres between pairs, so that the broad phase passes exactly the pairs of the trial."""
FARTHEST = 10.0
"""Distance [m] up to which getClosestPoints looks; beyond any pair of the benchmark."""
DISTANCE = 8
"""Field of a contact point with the distance."""
MARGIN = 1e-6
"""Margin [m] of all but the default: its 1 mm round every hull is 1 to 2 mm in every answer."""
BREAKING = 0.02
"""contactBreakingThreshold [m]: the default, set because it outlives every reset of the process."""


class PyBullet(Contender):
    """All of them, by name."""

    def __init__(self, name: str, library: str, per_call: bool) -> None:
        super().__init__(name, library, per_call)
        self._client = pybullet.connect(pybullet.DIRECT)

    def load(self, trial: Trial) -> None:
        self._cold, client = trial.mode == "cold", self._client
        pybullet.resetSimulation(physicsClientId=client)
        pybullet.setPhysicsEngineParameter(contactBreakingThreshold=BREAKING, physicsClientId=client)
        upright = np.array([1.0, 0.0, 0.0, 0.0])
        self._bodies = []
        for shape in trial.shapes:
            made = collision_shape(placed((Piece(shape),), upright, np.zeros(3)), client)
            body = pybullet.createMultiBody(baseMass=1.0, baseCollisionShapeIndex=made, physicsClientId=client)
            if self.name != CLOSEST_DEFAULT:
                pybullet.changeDynamics(body, -1, collisionMargin=MARGIN, physicsClientId=client)
            self._bodies.append(body)
        self._pairs = list(zip(self._bodies[::2], self._bodies[1::2], strict=True))
        shift = SPACING * np.repeat(np.arange(trial.pairs), 2)[:, None] * np.array([1.0, 0.0, 0.0])
        self._at = (trial.at + shift).tolist()
        turns = Rotation.from_matrix(trial.turns.reshape(-1, 3, 3)).as_quat()
        self._turns = turns.reshape(*trial.at.shape[:2], 4).tolist()

    def begin(self) -> None:
        if not self.per_call:
            self._scatter()

    def _scatter(self) -> None:
        """Move every body far from every other: no pair is left, and no manifold."""
        for k, body in enumerate(self._bodies):
            far = [SPACING * k, SPACING, 0.0]
            pybullet.resetBasePositionAndOrientation(body, far, [0.0, 0.0, 0.0, 1.0], physicsClientId=self._client)
        pybullet.performCollisionDetection(physicsClientId=self._client)

    def pose(self, frame: int) -> None:
        if self._cold and not self.per_call:
            self._scatter()
        put, client = pybullet.resetBasePositionAndOrientation, self._client
        for body, at, turn in zip(self._bodies, self._at[frame], self._turns[frame], strict=True):
            put(body, at, turn, client)

    def query(self) -> None:
        client = self._client
        if not self.per_call:
            pybullet.performCollisionDetection(client)
            return
        closest = pybullet.getClosestPoints
        self.found = [closest(a, b, FARTHEST, -1, -1, -1, -1, None, None, None, None, client) for a, b in self._pairs]

    def answers(self) -> Array:
        if not self.per_call:
            self.found = [pybullet.getContactPoints(a, b, physicsClientId=self._client) for a, b in self._pairs]
        return np.array([min((point[DISTANCE] for point in points), default=np.inf) for points in self.found])


def contenders() -> tuple[Contender, ...]:
    """Return all three."""
    return tuple(PyBullet(name, "pybullet", name != DETECTION) for name in (CLOSEST_DEFAULT, CLOSEST, DETECTION))
