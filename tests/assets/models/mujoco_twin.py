"""MuJoCo's own kinematics of a file, for rows of an avatar's coordinates: the reference for ours."""

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import mujoco
import numpy as np
from numpy.typing import NDArray

from avatarsim.assets.models.model import Model
from avatarsim.scene.joint import Rigid
from avatarsim.scene.tracker import poses_of_links
from avatarsim.spatial import rotation
from tests.assets.motions.robots import Driven, driven

Array = NDArray[np.float64]
FREE, BALL, SLIDE, HINGE = range(4)


@dataclass
class Twin:
    """A file as MuJoCo compiles it, links of URDF files apart."""

    path: Path

    def __post_init__(self) -> None:
        spec = mujoco.MjSpec.from_file(str(self.path))
        spec.compiler.fusestatic = False
        # compiled like ours: neither option moves a frame
        spec.compiler.balanceinertia, spec.compiler.boundmass, spec.compiler.boundinertia = True, 1e-12, 1e-12
        self.model: Any = spec.compile()
        self.data = mujoco.MjData(self.model)

    def joint(self, name: str) -> int:
        """Return the number of a joint by its name in coordinates; -1 for a root that MuJoCo has fixed."""
        found = mujoco.mj_name2id(self.model, mujoco.mjtObj.mjOBJ_JOINT, name)
        return found if found >= 0 or name == "root" else int(name.split()[1])

    def row(self, model: Driven, rng: np.random.Generator) -> Array:
        """Return a posture within the file's limits, in the avatar's coordinates; fixed joints are at the reference."""
        row: list[float] = []
        for slot in model.coordinates.slots:
            if slot.kind == "fixed":
                row.append(slot.rest)
            elif slot.kind in ("hinge", "slide"):
                j = self.joint(slot.name)
                low, high = self.model.jnt_range[j] if self.model.jnt_limited[j] else (-3.0, 3.0)
                row.append(rng.uniform(low, high))
            else:
                row += [*(rng.normal(size=3) if slot.kind == "free" else ()), *rotation.normalised(rng.normal(size=4))]
        return np.array(row)

    def poses(self, model: Driven, row: Array) -> tuple[dict[str, Array], dict[str, Array]]:
        """Return MuJoCo's position (3,) [m] and orientation (4,) of each body's link frame in the posture of a row."""
        self.data.qpos[:] = self.model.qpos0
        at, base = 0, (np.zeros(3), np.array(rotation.IDENTITY))
        for slot in model.coordinates.slots:
            width = {"free": 7, "ball": 4}.get(slot.kind, 1)
            if slot.kind == "free" and self.joint(slot.name) < 0:
                # all of MuJoCo's poses are moved by this root pose
                base = row[at : at + 3], row[at + 3 : at + 7]
            elif slot.kind != "fixed":
                address = self.model.jnt_qposadr[self.joint(slot.name)]
                self.data.qpos[address : address + width] = row[at : at + width]
            at += width
        mujoco.mj_kinematics(self.model, self.data)
        places, turns = {}, {}
        links = {link.name: link for link in model.avatar.links}
        for body in range(1, self.model.nbody):
            name = mujoco.mj_id2name(self.model, mujoco.mjtObj.mjOBJ_BODY, body) or f"body {body}"
            own = np.flatnonzero(self.model.jnt_bodyid == body)
            joints = [j for j in own if self.model.jnt_type[j] in (BALL, HINGE, SLIDE)]
            if name in links:
                turns_about = joints and not isinstance(links[name].joint, Rigid)
                # a slide has no centre
                is_centred = turns_about and self.model.jnt_type[joints[-1]] != SLIDE
                centre = self.model.jnt_pos[joints[-1]] if is_centred else np.zeros(3)
                there = self.data.xpos[body] + rotation.rotate(self.data.xquat[body], centre)
                places[name] = base[0] + rotation.rotate(base[1], there)
                turns[name] = rotation.multiply(base[1], self.data.xquat[body])
        return places, turns


def greatest_difference(twin: Twin, model: Model, postures: int, seed: int = 0) -> float:
    """Return the largest difference of a link [m], or in a component of a quaternion, from MuJoCo's body in random postures."""
    model, rng, worst = driven(model), np.random.default_rng(seed), 0.0
    for _ in range(postures):
        row = twin.row(model, rng)
        motion = model.coordinates.motion(row[None], np.zeros(1))
        np.testing.assert_allclose(model.coordinates.rows(motion)[0], row, rtol=0.0, atol=1e-14)
        ours = poses_of_links((model.avatar,), motion.positions[0], motion.rotations[0], motion.angles[0])
        places, turns = twin.poses(model, row)
        for k, link in enumerate(model.avatar.links):
            if link.name in places:
                worst = max(worst, float(np.abs(ours[0][k] - places[link.name]).max()))
                turn = turns[link.name] * np.sign(ours[1][k] @ turns[link.name])
                worst = max(worst, float(np.abs(ours[1][k] - turn).max()))
    return worst
