"""Poses and velocities that MuJoCo shows, of all bodies and links: read step by step, turned into body frames once a frame."""

from collections.abc import Sequence

import mujoco
import numpy as np
from numpy.typing import NDArray

from avatarsim.engine import Snapshot
from reference.in_mujoco.world import World
from reference.reading_kernels import about_own_centres

Array = NDArray[np.float64]


class Reading:
    """Reads one world."""

    def __init__(self, world: World, data: mujoco.MjData) -> None:
        self._model, self._data, self._ids = world.model, data, world.body_ids
        self._trees = world.model.body_rootid[self._ids].astype(np.int64)
        # views of MuJoCo's own memory, which stays where it is
        self._seen = (data.xpos, data.xquat, data.cvel, data.xipos, data.subtree_com)
        self._rows: tuple[Array, ...] = tuple(np.empty((0, *array.shape)) for array in self._seen)

    def read(self, k: int) -> None:
        """Keep, as the k-th since the last snapshots, all bodies in MuJoCo's order: place [m], turn, spin [rad/s] and velocity
        [m/s], mass centre and that of the tree [m].

        From qpos: after a step xpos is one step old, so kinematics runs again first."""
        model, data = self._model, self._data
        mujoco.mj_kinematics(model, data)
        mujoco.mj_comPos(model, data)
        mujoco.mj_comVel(model, data)
        if k >= len(self._rows[0]):
            self._rows = tuple(np.concatenate([rows, np.empty((k + 1, *rows.shape[1:]))]) for rows in self._rows)
        for rows, array in zip(self._rows, self._seen, strict=True):
            rows[k] = array

    def snapshots(self, times: Sequence[float]) -> tuple[Snapshot, ...]:
        """Return the states read at `times` [s] since load, as body frames."""
        places, turns, motions, centres, trees = (rows[: len(times)] for rows in self._rows)
        shape = (len(times), len(self._ids))
        positions, orientations = np.empty((*shape, 3)), np.empty((*shape, 4))
        velocities, spins = np.empty((*shape, 3)), np.empty((*shape, 3))
        # MuJoCo states velocities about the centre of mass of the whole tree
        about_own_centres(
            places, turns, motions, centres, trees, self._ids, self._trees, positions, orientations, velocities, spins
        )
        return tuple(
            Snapshot(time, positions[k], orientations[k], velocities[k], spins[k]) for k, time in enumerate(times)
        )
