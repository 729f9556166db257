"""What MuJoCo shows: poses and velocities of all bodies and links, read step by step, turned into body frames once a frame."""

from collections.abc import Sequence

import mujoco
import numpy as np
from numpy.typing import NDArray

from avatarsim.engine import Snapshot
from reference.in_mujoco.world import World
from reference.reading_kernels import about_own_centres

Array = NDArray[np.float64]
Raw = tuple[Array, ...]
"""Poses, velocities and mass centres of all of MuJoCo's bodies at one instant, as it states them."""


class Reading:
    """Reads one world."""

    def __init__(self, world: World, data: mujoco.MjData) -> None:
        self._model, self._data, self._ids = world.model, data, world.body_ids
        self._trees = world.model.body_rootid[self._ids].astype(np.int64)
        # views of MuJoCo's own memory, which stays where it is
        self._seen = (data.xpos, data.xquat, data.cvel, data.xipos, data.subtree_com)

    def raw(self) -> Raw:
        """All bodies in MuJoCo's order: place [m], turn, spin [rad/s] and velocity [m/s], mass centre and that of the tree [m].

        From qpos: after a step xpos is one step old, so kinematics runs again first."""
        model, data = self._model, self._data
        mujoco.mj_kinematics(model, data)
        mujoco.mj_comPos(model, data)
        mujoco.mj_comVel(model, data)
        return tuple(array.copy() for array in self._seen)

    def snapshots(self, times: Sequence[float], raw: Sequence[Raw]) -> tuple[Snapshot, ...]:
        """What was read at `times` [s] since load, as body frames."""
        places, turns, motions, centres, trees = (np.array(states) for states in zip(*raw, strict=True))
        shape = (len(raw), len(self._ids))
        positions, orientations = np.empty((*shape, 3)), np.empty((*shape, 4))
        velocities, spins = np.empty((*shape, 3)), np.empty((*shape, 3))
        # MuJoCo states velocities about the centre of mass of the whole tree
        about_own_centres(
            places, turns, motions, centres, trees, self._ids, self._trees, positions, orientations, velocities, spins
        )
        return tuple(
            Snapshot(time, positions[k], orientations[k], velocities[k], spins[k]) for k, time in enumerate(times)
        )
