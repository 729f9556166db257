"""Avatars led by motors in their joints instead of by welds: position servos in hinges, orientation servos in balls.

A servo's force is kp times the error of its joint's position minus kv times its speed, up to its largest force. The root has no
joint to the world and stays welded.
"""

from dataclasses import dataclass

import mujoco
import numpy as np
from numpy.typing import NDArray

from avatarsim.scene.scene import Scene
from avatarsim.scene.tracker import TrackerSample
from avatarsim.spatial import rotation
from reference.targets import Goals, Targets

Array = NDArray[np.float64]
Indices = NDArray[np.int64]

DRIVES = ("welds", "motors")
"""The drives of the links: a weld of each to its tracked pose, or motors in the joints and a weld of the root."""


@dataclass(frozen=True)
class Servo:
    """Stiffness [N m/rad], damping over critical damping at the first posture, largest torque [N m] (0: as much as it takes)."""

    stiffness: float
    damping_ratio: float
    most: float


def add_motor(spec: mujoco.MjSpec, joint: str, ball: bool, servo: Servo) -> None:
    """Add a servo in the joint of that name; the target of a ball's is a quaternion."""
    motor = spec.add_actuator(name=joint, target=joint, trntype=mujoco.mjtTrn.mjTRN_JOINT)
    if ball:
        quaternion = int(mujoco.mjtCtrlChart.mjCHART_QUAT)
        motor.set_to_orientation(kp=servo.stiffness, dampratio=servo.damping_ratio, ctrlspec=quaternion)
    else:
        motor.set_to_position(kp=servo.stiffness, dampratio=servo.damping_ratio)
    if servo.most > 0.0:
        motor.forcelimited = True
        # of a ball the length of the torque is bounded
        motor.forcerange = [0.0 if ball else -servo.most, servo.most]


class Motors:
    """Sets the targets of the servos of one world."""

    def __init__(self, model: mujoco.MjModel, scene: Scene, targets: Targets, lead: float, stop: bool) -> None:
        """`lead`: how far ahead of the tracker, as a share of how late a servo is; `stop`: no joint is led beyond a limit."""
        names = [model.actuator(k).name for k in range(model.nactuator)]
        place = {name: int(model.actuator_ctrladr[k]) for k, name in enumerate(names)}
        # in steady motion a servo is kv / kp late
        late = {name: float(model.actuator_biasprm[k, 2] / model.actuator_biasprm[k, 1]) for k, name in enumerate(names)}
        first = len(scene.bodies)
        hinges = [f"h{hinge}" for hinge in range(sum(avatar.hinge_count for avatar in scene.avatars))]
        balls = [k for k in range(len(scene.links)) if f"b{first + k}" in place]
        self._hinges, self._hinges_late = _ints([place[name] for name in hinges]), np.array([late[name] for name in hinges])
        self._balls, self._turned = _ints(balls), _ints([place[f"b{first + k}"] for k in balls])
        self._balls_late = np.array([late[f"b{first + k}"] for k in balls])
        self._targets, self._lead, self._stop, self._size = targets, lead, stop, int(model.nu)

    def controls(self, goals: Goals, step: float) -> Array:
        """Return controls (n - 1, nu) of the steps [s] to each posture but the first, ahead of it at that step's velocity."""
        angles = goals.angles[1:] + self._lead * self._hinges_late / step * np.diff(goals.angles, axis=0)
        turns = goals.turns[1:].copy()
        before, after = goals.turns[:-1, self._balls], goals.turns[1:, self._balls]
        turned = rotation.to_rotation_vector(rotation.multiply(rotation.conjugate(before), after))
        further = rotation.from_rotation_vector(self._lead * self._balls_late[:, None] / step * turned)
        turns[:, self._balls] = rotation.multiply(after, further)
        controls = np.zeros((len(angles), self._size))
        for k in range(len(angles)):
            if self._stop:
                nearest = self._targets.within_limits(TrackerSample(0.0, goals.roots[k + 1], turns[k], angles[k]))
                angles[k], turns[k] = nearest.angles, nearest.rotations
        controls[:, self._hinges] = angles
        controls[:, self._turned[:, None] + np.arange(4)] = turns[:, self._balls]
        return controls


def damp_swings(model: mujoco.MjModel, servo: Servo) -> None:
    """Damp each ball by the largest of its inertias. MuJoCo takes a mean, which is near that of the twist: a limb swings on."""
    for k in np.flatnonzero(model.actuator_biastype == int(mujoco.mjtBias.mjBIAS_SO3)):
        dofs = model.jnt_dofadr[model.actuator_trnid[k, 0]] + np.arange(3)
        critical = 2.0 * np.sqrt(servo.stiffness * model.dof_M0[dofs].max())
        model.actuator_biasprm[k, 2] = -servo.damping_ratio * critical


def _ints(values: list[int]) -> Indices:
    return np.array(values, dtype=np.int64)
