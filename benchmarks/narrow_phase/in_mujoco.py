"""MuJoCo's mj_geomDistance, a call per pair, and mj_collision, one call for all pairs of a model that has only those."""

import mujoco
import numpy as np
from scipy.spatial.transform import Rotation

from avatarsim.scene.shape import Box, Capsule, Shape, Sphere
from benchmarks.narrow_phase.contender import Array, Contender, Trial
from benchmarks.narrow_phase.pairs import GAPS

GEOM_DEFAULT, GEOM, COLLISION_DEFAULT, COLLISION = "mj geomDist default", "mj geomDist", "mj collision default", "mj collision"
FARTHEST = 10.0
"""Distance [m] up to which mj_geomDistance looks; beyond any pair of the benchmark."""
CCD_TOLERANCE, CCD_ITERATIONS = 1e-10, 200
"""Of all but the defaults: those of 1e-6 and 35 leave up to a micrometre, and on deep hulls up to a millimetre."""


def _geom(spec: mujoco.MjSpec, shape: Shape, name: str) -> dict[str, object]:
    """Return arguments of one geom; hulls vertex for vertex."""
    if isinstance(shape, Sphere):
        return {"type": mujoco.mjtGeom.mjGEOM_SPHERE, "size": [shape.radius, 0.0, 0.0]}
    if isinstance(shape, Capsule):
        return {"type": mujoco.mjtGeom.mjGEOM_CAPSULE, "size": [shape.radius, 0.5 * shape.length, 0.0]}
    if isinstance(shape, Box):
        return {"type": mujoco.mjtGeom.mjGEOM_BOX, "size": [0.5 * edge for edge in shape.size]}
    spec.add_mesh(name=name, uservert=np.asarray(shape.vertices).ravel())  # type: ignore[union-attr]  # no ellipsoid is drawn
    return {"type": mujoco.mjtGeom.mjGEOM_MESH, "meshname": name}


def model_of(shapes: tuple[Shape, ...]) -> mujoco.MjModel:
    """Return a free body per shape and an explicit contact pair for each two in a row, and no other pairs."""
    spec = mujoco.MjSpec()
    for k, shape in enumerate(shapes):
        body = spec.worldbody.add_body(name=f"b{k}")
        # bodies without joints never meet each other
        body.add_freejoint()
        body.add_geom(name=f"g{k}", contype=0, conaffinity=0, **_geom(spec, shape, f"m{k}"))
    for k in range(0, len(shapes), 2):
        spec.add_pair(geomname1=f"g{k}", geomname2=f"g{k + 1}", condim=1)
    return spec.compile()


class MuJoCo(Contender):
    """Both functions, by name; neither has anything for coherence."""

    def load(self, trial: Trial) -> None:
        self._model = model_of(trial.shapes)
        self._data = mujoco.MjData(self._model)
        if self.name in (GEOM, COLLISION):
            self._model.opt.ccd_tolerance, self._model.opt.ccd_iterations = CCD_TOLERANCE, CCD_ITERATIONS
        if self.name == COLLISION:
            # one depth is wanted; the search for more contacts moves it and costs time
            self._model.opt.disableflags |= int(mujoco.mjtDisableBit.mjDSBL_MULTICCD)
        # without a margin, pairs that are apart get no contact
        self._model.pair_margin[:] = 2.0 * GAPS[1] if trial.cell.regime == "apart" else 0.0
        self._fromto = np.zeros(6)
        flat = Rotation.from_matrix(trial.turns.reshape(-1, 3, 3)).as_quat(scalar_first=True)
        self._qpos = np.concatenate([trial.at, flat.reshape(*trial.at.shape[:2], 4)], axis=2)

    def pose(self, frame: int) -> None:
        self._data.qpos[:] = self._qpos[frame].ravel()
        mujoco.mj_kinematics(self._model, self._data)
        mujoco.mj_comPos(self._model, self._data)

    def query(self) -> None:
        if not self.per_call:
            mujoco.mj_collision(self._model, self._data)
            return
        distance, model, data, fromto = mujoco.mj_geomDistance, self._model, self._data, self._fromto
        self.found = [distance(model, data, k, k + 1, FARTHEST, fromto) for k in range(0, model.ngeom, 2)]

    def answers(self) -> Array:
        if self.per_call:
            return super().answers()
        distances = np.full(self._model.npair, np.inf)
        np.minimum.at(distances, self._data.contact.geom[:, 0] // 2, self._data.contact.dist)
        return distances


def contenders() -> tuple[Contender, ...]:
    """Return all four."""
    return tuple(
        MuJoCo(name, "mujoco", name in (GEOM_DEFAULT, GEOM)) for name in (GEOM_DEFAULT, GEOM, COLLISION_DEFAULT, COLLISION)
    )
