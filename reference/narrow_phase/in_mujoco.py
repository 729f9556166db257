"""MuJoCo's mj_geomDistance, a call per pair, and mj_collision, one call for all pairs of a model that has only those."""

import mujoco
import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from avatarsim.scene.shape import Box, Capsule, Shape, Sphere
from reference.narrow_phase.cells import GAPS, Mode, Sequence
from reference.narrow_phase.contender import Identity

Array = NDArray[np.float64]

FARTHEST = 10.0
"""Distance [m] up to which mj_geomDistance looks; beyond any pair of the benchmark."""

TIGHT = {
    "ccd_tolerance": ("1e-10", "the default of 1e-6 leaves up to a micrometre; 1e-10 costs little"),
    "ccd_iterations": ("200", "at the default of 35, deep hulls end too early, by up to a millimetre"),
}
ONE_CONTACT = {"disableflags": ("MULTICCD", "the question is one depth; the search for more contacts moves it and costs time")}
MARGIN = {"margin": (f"{2 * GAPS[1]:g} m where pairs are apart, else 0", "without it, pairs that are apart get no contact")}

GEOM_DEFAULT = Identity("mj geomDist default", "mujoco", True, "mj_geomDistance at default tolerances; no coherence")
GEOM = Identity("mj geomDist", "mujoco", True, "mj_geomDistance, tight; no coherence", TIGHT)
COLLISION_DEFAULT = Identity(
    "mj collision default", "mujoco", False, "mj_collision of a model with exactly these pairs, per pair; no coherence", MARGIN
)
COLLISION = Identity("mj collision", "mujoco", False, "the same, tight, one contact per pair", {**MARGIN, **ONE_CONTACT, **TIGHT})


def _geom(spec: mujoco.MjSpec, shape: Shape, name: str) -> dict[str, object]:
    """Words for one shape; hulls vertex for vertex."""
    if isinstance(shape, Sphere):
        return {"type": mujoco.mjtGeom.mjGEOM_SPHERE, "size": [shape.radius, 0.0, 0.0]}
    if isinstance(shape, Capsule):
        return {"type": mujoco.mjtGeom.mjGEOM_CAPSULE, "size": [shape.radius, 0.5 * shape.length, 0.0]}
    if isinstance(shape, Box):
        return {"type": mujoco.mjtGeom.mjGEOM_BOX, "size": [0.5 * edge for edge in shape.size]}
    spec.add_mesh(name=name, uservert=np.asarray(shape.vertices).ravel())  # type: ignore[union-attr]  # no ellipsoid is drawn
    return {"type": mujoco.mjtGeom.mjGEOM_MESH, "meshname": name}


def model_of(shapes: tuple[Shape, ...]) -> mujoco.MjModel:
    """A free body per shape and an explicit contact pair for each two in a row, and no other pairs."""
    spec = mujoco.MjSpec()
    for k, shape in enumerate(shapes):
        body = spec.worldbody.add_body(name=f"b{k}")
        # bodies without joints never meet each other
        body.add_freejoint()
        body.add_geom(name=f"g{k}", contype=0, conaffinity=0, **_geom(spec, shape, f"m{k}"))
    for k in range(0, len(shapes), 2):
        spec.add_pair(geomname1=f"g{k}", geomname2=f"g{k + 1}", condim=1)
    return spec.compile()


class MuJoCo:
    """Both functions, by identity."""

    def __init__(self, identity: Identity) -> None:
        self.identity = identity

    def load(self, sequence: Sequence, mode: Mode) -> None:
        """See Contender."""
        self._sequence = sequence
        self._model = model_of(sequence.shapes)
        self._data = mujoco.MjData(self._model)
        if self.identity in (GEOM, COLLISION):
            self._model.opt.ccd_tolerance, self._model.opt.ccd_iterations = 1e-10, 200
        if self.identity is COLLISION:
            self._model.opt.disableflags |= int(mujoco.mjtDisableBit.mjDSBL_MULTICCD)
        self._model.pair_margin[:] = 2.0 * GAPS[1] if sequence.cell.regime == "apart" else 0.0
        self._found: list[float] = []
        self._fromto = np.zeros(6)
        self._qpos = np.zeros((sequence.frames, len(sequence.shapes), 7))
        self._qpos[..., :3] = sequence.at
        flat = Rotation.from_matrix(sequence.turns.reshape(-1, 3, 3)).as_quat(scalar_first=True)
        self._qpos[..., 3:] = flat.reshape(*sequence.at.shape[:2], 4)

    load_call = load

    def begin(self) -> None:
        """See Contender."""

    def pose(self, frame: int) -> None:
        """See Contender."""
        self._data.qpos[:] = self._qpos[frame].ravel()
        mujoco.mj_kinematics(self._model, self._data)
        mujoco.mj_comPos(self._model, self._data)

    def ask(self) -> None:
        """See Contender."""
        if not self.identity.per_call:
            mujoco.mj_collision(self._model, self._data)
            return
        distance, model, data, fromto = mujoco.mj_geomDistance, self._model, self._data, self._fromto
        self._found = [distance(model, data, k, k + 1, FARTHEST, fromto) for k in range(0, model.ngeom, 2)]

    def answers(self) -> Array:
        """See Contender."""
        if self.identity.per_call:
            return np.array(self._found)
        found = np.full(self._sequence.pairs, np.inf)
        np.minimum.at(found, self._data.contact.geom[:, 0] // 2, self._data.contact.dist)
        return found


def contenders() -> tuple[MuJoCo, ...]:
    """All of them."""
    return tuple(MuJoCo(identity) for identity in (GEOM_DEFAULT, GEOM, COLLISION_DEFAULT, COLLISION))
