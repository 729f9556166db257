"""PyBullet's getClosestPoints, a call per pair, and performCollisionDetection, one call for a world of nothing but the pairs."""

import numpy as np
import pybullet
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from avatarsim.scene.shape import Piece
from reference.in_pybullet.shapes import collision_shape
from reference.narrow_phase.cells import Mode, Sequence
from reference.narrow_phase.contender import Identity

Array = NDArray[np.float64]

SPACING = 20.0
"""Metres between pairs, so that the broad phase hands over exactly the pairs asked for."""

FARTHEST = 10.0
"""Distance [m] up to which getClosestPoints looks; beyond any pair of the benchmark."""

DISTANCE_TO = 8
"""Where in a contact point PyBullet puts the distance."""

MARGIN = {"collisionMargin": ("1e-6", "the default of 1 mm round every hull is 1 to 2 mm in every answer")}
BREAKING = {"contactBreakingThreshold": ("0.02", "the default, set because it outlives every reset of the process")}

CLOSEST_DEFAULT = Identity("pb closest default", "pybullet", True, "getClosestPoints; no coherence", BREAKING)
CLOSEST = Identity("pb closest", "pybullet", True, "getClosestPoints; no coherence", {**MARGIN, **BREAKING})
DETECTION = Identity(
    "pb detection", "pybullet", False, "performCollisionDetection of a world with nothing else in it, per pair, broad phase "
    "included; coherent: with its own persistent manifolds; cold: all pairs were apart before. Pairs further apart than "
    "contactBreakingThreshold get no answer", {**MARGIN, **BREAKING},
)


class PyBullet:
    """All of them, by identity."""

    def __init__(self, identity: Identity) -> None:
        self.identity = identity
        self._client = pybullet.connect(pybullet.DIRECT)

    def load(self, sequence: Sequence, mode: Mode) -> None:
        """See Contender."""
        self._sequence, self._cold, client = sequence, mode == "cold", self._client
        pybullet.resetSimulation(physicsClientId=client)
        pybullet.setPhysicsEngineParameter(contactBreakingThreshold=0.02, physicsClientId=client)
        upright = np.array([1.0, 0.0, 0.0, 0.0])
        self._bodies = []
        for shape in sequence.shapes:
            made = collision_shape((Piece(shape),), upright, np.zeros(3), client)
            body = pybullet.createMultiBody(baseMass=1.0, baseCollisionShapeIndex=made, physicsClientId=client)
            if self.identity is not CLOSEST_DEFAULT:
                pybullet.changeDynamics(body, -1, collisionMargin=1e-6, physicsClientId=client)
            self._bodies.append(body)
        self._pairs = list(zip(self._bodies[::2], self._bodies[1::2], strict=True))
        shift = SPACING * np.repeat(np.arange(sequence.pairs), 2)[:, None] * np.array([1.0, 0.0, 0.0])
        self._at = (sequence.at + shift).tolist()
        turns = Rotation.from_matrix(sequence.turns.reshape(-1, 3, 3)).as_quat()
        self._turns = turns.reshape(*sequence.at.shape[:2], 4).tolist()
        self._found: list[tuple[tuple[float, ...], ...]] = []

    load_call = load

    def begin(self) -> None:
        """See Contender."""
        if not self.identity.per_call:
            self._scatter()

    def _scatter(self) -> None:
        """Every body far from every other: no pair is left, and no manifold."""
        for k, body in enumerate(self._bodies):
            far = [SPACING * k, SPACING, 0.0]
            pybullet.resetBasePositionAndOrientation(body, far, [0.0, 0.0, 0.0, 1.0], physicsClientId=self._client)
        pybullet.performCollisionDetection(physicsClientId=self._client)

    def pose(self, frame: int) -> None:
        """See Contender."""
        if self._cold and not self.identity.per_call:
            self._scatter()
        put, client = pybullet.resetBasePositionAndOrientation, self._client
        for body, at, turn in zip(self._bodies, self._at[frame], self._turns[frame], strict=True):
            put(body, at, turn, client)

    def ask(self) -> None:
        """See Contender."""
        client = self._client
        if not self.identity.per_call:
            pybullet.performCollisionDetection(client)
            return
        closest = pybullet.getClosestPoints
        self._found = [closest(a, b, FARTHEST, -1, -1, -1, -1, None, None, None, None, client) for a, b in self._pairs]

    def answers(self) -> Array:
        """See Contender."""
        found = self._found
        if not self.identity.per_call:
            found = [pybullet.getContactPoints(a, b, physicsClientId=self._client) for a, b in self._pairs]
        return np.array([min((point[DISTANCE_TO] for point in points), default=np.inf) for points in found])


def contenders() -> tuple[PyBullet, ...]:
    """All of them."""
    return PyBullet(CLOSEST_DEFAULT), PyBullet(CLOSEST), PyBullet(DETECTION)
