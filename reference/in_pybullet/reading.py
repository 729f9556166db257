"""Poses and velocities that PyBullet shows, of all bodies and links: read step by step, turned into body frames once a frame."""

from collections.abc import Sequence

import numpy as np
import pybullet
from numpy.typing import NDArray

from avatarsim.engine import Snapshot
from avatarsim.scene.body import Role
from avatarsim.scene.scene import Scene
from avatarsim.spatial import rotation
from reference.in_pybullet.world import World
from reference.reading_kernels import body_frames

Array = NDArray[np.float64]
STATED = 13
"""Numbers that Bullet states of a mass centre: place [m], turn (x, y, z, w), velocity [m/s] and spin [rad/s]."""


class Reading:
    """Reads one world. Its mass centres, which Bullet keeps in double precision: link frames come in single precision."""

    def __init__(self, world: World, scene: Scene) -> None:
        self._client = world.client
        self._frames = rotation.conjugate(np.array([part.frame for part in world.parts]))
        self._centres = np.array([part.centre for part in world.parts])
        self._still = np.zeros((len(world.parts), STATED))
        self._bases: list[int] = []
        self._links: dict[int, list[int]] = {}
        bases: list[int] = []
        linked: dict[int, list[int]] = {}
        for k, part in enumerate(world.parts):
            if part.link >= 0:
                linked.setdefault(part.body, []).append(k)
                self._links.setdefault(part.body, []).append(part.link)
            elif scene.roles[k] is Role.FIXED:
                # fixed bodies are read once; many scenes have more of them than of anything else
                self._still[k] = self._base(part.body)
            else:
                bases.append(k)
                self._bases.append(part.body)
        self.read = [*bases, *(k for rows in linked.values() for k in rows)]
        self._moving = np.array(self.read, dtype=np.int64)
        self._hinges: dict[int, list[int]] = {}
        for body, joint in world.hinges:
            self._hinges.setdefault(body, []).append(joint)

    def raw(self) -> list[float]:
        """Return the state of the moving bodies, in the order of `read`, as Bullet has it now: STATED numbers each, one after the
        other, since numpy takes three times as long over tuples of tuples."""
        values: list[float] = []
        for body in self._bases:
            values += self._base(body)
        for body, links in self._links.items():
            states = pybullet.getLinkStates(
                body, links, computeLinkVelocity=1, computeForwardKinematics=1, physicsClientId=self._client
            )
            for state in states:
                values += state[0] + state[1] + state[6] + state[7]
        return values

    def snapshots(self, times: Sequence[float], raw: Sequence[list[float]]) -> tuple[Snapshot, ...]:
        """Return the states read at `times` [s] since load, as body frames."""
        rows = np.empty((len(raw), *self._still.shape))
        rows[:] = self._still
        if self.read:
            rows[:, self._moving] = np.array(raw, dtype=np.float64).reshape(len(raw), -1, STATED)
        shape = rows.shape[:2]
        positions, orientations = np.empty((*shape, 3)), np.empty((*shape, 4))
        velocities, spins = np.empty((*shape, 3)), np.empty((*shape, 3))
        body_frames(rows, self._frames, self._centres, positions, orientations, velocities, spins)
        return tuple(
            Snapshot(time, positions[k], orientations[k], velocities[k], spins[k]) for k, time in enumerate(times)
        )

    def angles(self) -> Array:
        """Return hinge angles (hinges,) [rad] in the order of tracker samples."""
        angles: list[float] = []
        for body, joints in self._hinges.items():
            states = pybullet.getJointStates(body, joints, physicsClientId=self._client)
            angles += [state[0] for state in states]
        return np.array(angles, dtype=np.float64)

    def _base(self, body: int) -> tuple[float, ...]:
        at, turn = pybullet.getBasePositionAndOrientation(body, physicsClientId=self._client)
        velocity, spin = pybullet.getBaseVelocity(body, physicsClientId=self._client)
        return (*at, *turn, *velocity, *spin)
