"""What MuJoCo shows: poses and velocities of all bodies and links, read step by step, turned into body frames once a frame."""

from collections.abc import Sequence

import mujoco
import numpy as np
from numpy.typing import NDArray

from avatarsim.engine import Snapshot
from avatarsim.spatial import rotation
from reference.in_mujoco.world import World

Array = NDArray[np.float64]


class Reading:
    """Reads one world."""

    def __init__(self, world: World, data: mujoco.MjData) -> None:
        self._model, self._data, self._ids = world.model, data, world.body_ids
        self._trees = world.model.body_rootid[self._ids]

    def raw(self) -> Array:
        """(n, 19) place [m], turn, spin [rad/s] and velocity [m/s] as MuJoCo states them, mass centres of body and tree [m].

        From qpos: after a step xpos is one step old, so kinematics runs again first."""
        model, data, ids = self._model, self._data, self._ids
        mujoco.mj_kinematics(model, data)
        mujoco.mj_comPos(model, data)
        mujoco.mj_comVel(model, data)
        parts = (data.xpos[ids], data.xquat[ids], data.cvel[ids], data.xipos[ids], data.subtree_com[self._trees])
        return np.concatenate(parts, axis=1)

    def snapshots(self, times: Sequence[float], raw: Sequence[Array]) -> tuple[Snapshot, ...]:
        """What was read at `times` [s] since load, as body frames. All at once, since numpy costs as much per call as a step."""
        rows = np.array(raw)
        positions, orientations, spins = rows[..., :3].copy(), rows[..., 3:7].copy(), rows[..., 7:10].copy()
        # MuJoCo states velocities about the centre of mass of the whole tree
        velocities = rows[..., 10:13] + rotation.cross(spins, rows[..., 13:16] - rows[..., 16:])
        return tuple(
            Snapshot(time, positions[k], orientations[k], velocities[k], spins[k]) for k, time in enumerate(times)
        )
