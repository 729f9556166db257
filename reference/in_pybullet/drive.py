"""How avatars follow the tracker in PyBullet: the root by constraint or velocity, joints by position motors."""

import numpy as np
import pybullet
from numpy.typing import NDArray

from avatarsim.scene.scene import Scene
from avatarsim.spatial import rotation
from reference.in_pybullet.shapes import wxyz, xyzw
from reference.in_pybullet.world import World
from reference.presets import Chosen
from reference.targets import Goals

Array = NDArray[np.float64]

DRIVES = ("constraint", "velocity")
"""A fixed constraint between root and tracked pose, or the velocity that reaches the pose within the step."""

MOTOR_ERP = 0.2
"""Share of the error that a spherical motor of gain 1 corrects per step: Bullet's erp, which it applies to
these motors. Measured: lag behind a steady turn falls as 1 / gain and is exactly 0 at gain 5. Target
velocities have no effect on them."""

CONSTRAINT_LAG = 4.0
"""Steps by which a fixed constraint follows a steady motion: it corrects a fifth of the error per step
(Bullet's erp of 0.2)."""


class Drive:
    """Aims roots and joints of one world at the goals of each step."""

    def __init__(self, world: World, scene: Scene, chosen: dict[str, Chosen]) -> None:
        self._world, self._chosen, self._client = world, chosen, world.client
        self._frames = {k: world.parts[len(scene.bodies) + k].frame for _, _, k in world.balls}
        self._constraints: list[int] = []
        by_body: dict[int, tuple[list[int], list[int]]] = {}
        for at, (body, joint) in enumerate(world.hinges):
            joints, places = by_body.setdefault(body, ([], []))
            joints.append(joint)
            places.append(at)
        self._hinges = by_body
        self._balls: dict[int, list[tuple[int, int]]] = {}
        for body, joint, k in world.balls:
            self._balls.setdefault(body, []).append((joint, k))

    def start(self, turns: Array, angles: Array) -> None:
        """Put all joints at the first posture, take away Bullet's own motors, tie the roots."""
        for (body, joint), angle in zip(self._world.hinges, angles, strict=True):
            pybullet.resetJointState(body, joint, float(angle), physicsClientId=self._client)
            pybullet.setJointMotorControl2(body, joint, pybullet.VELOCITY_CONTROL, force=0.0, physicsClientId=self._client)
        for body, joint, k in self._world.balls:
            turn = xyzw(self._turned(k, turns[k]))
            pybullet.resetJointStateMultiDof(body, joint, turn, physicsClientId=self._client)
            pybullet.setJointMotorControlMultiDof(
                body, joint, pybullet.POSITION_CONTROL, targetPosition=turn, positionGain=0.0, velocityGain=0.0,
                force=[0.0, 0.0, 0.0], physicsClientId=self._client,
            )
        if self._chosen["drive"].value == "constraint":
            for part, _ in self._world.roots:
                body = self._world.parts[part].body
                at, turn = pybullet.getBasePositionAndOrientation(body, physicsClientId=self._client)
                self._constraints.append(pybullet.createConstraint(
                    body, -1, -1, -1, pybullet.JOINT_FIXED, [0, 0, 0], [0, 0, 0], at, [0, 0, 0, 1], turn,
                    physicsClientId=self._client,
                ))

    def aim(self, goals: Goals, k: int, step: float) -> None:
        """Aim at posture k >= 1 of `goals`, one step [s] after posture k - 1."""
        lead = CONSTRAINT_LAG if self._constraints and self._chosen["feed_forward"].value else 0.0
        for index, (part, link) in enumerate(self._world.roots):
            found = self._world.parts[part]
            at = goals.positions[k, link] + lead * (goals.positions[k, link] - goals.positions[k - 1, link])
            turn = rotation.slerp(goals.orientations[k - 1, link], goals.orientations[k, link], 1.0 + lead)
            centre = at + rotation.rotate(turn, found.centre)
            turn = rotation.multiply(turn, found.frame)
            if self._constraints:
                pybullet.changeConstraint(
                    self._constraints[index], centre.tolist(), xyzw(turn), maxForce=self._number("root_force"),
                    physicsClientId=self._client,
                )
            else:
                self._chase(found.body, centre, turn, step)
        self._aim_hinges(goals, k, step)
        self._aim_balls(goals, k, step)

    def _chase(self, body: int, centre: Array, turn: Array, step: float) -> None:
        """The velocity that reaches a pose of the mass centre in one step, no faster than the cap."""
        at, now = pybullet.getBasePositionAndOrientation(body, physicsClientId=self._client)
        velocity = (centre - np.array(at)) / step
        spin = rotation.to_rotation_vector(rotation.multiply(turn, rotation.conjugate(wxyz(now)))) / step
        cap = self._number("root_speed")
        if cap > 0.0:
            velocity *= min(1.0, cap / max(float(np.linalg.norm(velocity)), 1e-12))
            spin *= min(1.0, 2.0 * cap / max(float(np.linalg.norm(spin)), 1e-12))
        pybullet.resetBaseVelocity(body, velocity.tolist(), spin.tolist(), physicsClientId=self._client)

    def _aim_hinges(self, goals: Goals, k: int, step: float) -> None:
        gain, damping, force = (self._number(name) for name in ("position_gain", "velocity_gain", "hinge_force"))
        forward = 1.0 / step if self._chosen["feed_forward"].value else 0.0
        for body, (joints, places) in self._hinges.items():
            wanted = goals.angles[k, places]
            speed = forward * (wanted - goals.angles[k - 1, places])
            n = len(joints)
            pybullet.setJointMotorControlArray(
                body, joints, pybullet.POSITION_CONTROL, targetPositions=wanted.tolist(), targetVelocities=speed.tolist(),
                positionGains=[gain] * n, velocityGains=[damping] * n, forces=[force] * n, physicsClientId=self._client,
            )

    def _aim_balls(self, goals: Goals, k: int, step: float) -> None:
        gain, force = self._number("ball_gain"), self._number("ball_force")
        # the motor corrects this share of the error in a step, whatever velocity it is told; leading it by what is left
        # over in steady motion is its feed-forward
        share = min(1.0, gain * MOTOR_ERP)
        ahead = 1.0 + (1.0 - share) / share if self._chosen["feed_forward"].value else 1.0
        for body, entries in self._balls.items():
            links = [link for _, link in entries]
            frames = np.array([self._frames[link] for link in links])
            turns = rotation.slerp(goals.turns[k - 1, links], goals.turns[k, links], np.full(len(links), ahead))
            aimed = rotation.multiply(rotation.conjugate(frames), rotation.multiply(turns, frames))
            n = len(entries)
            pybullet.setJointMotorControlMultiDofArray(
                body, [joint for joint, _ in entries], pybullet.POSITION_CONTROL,
                targetPositions=aimed[:, [1, 2, 3, 0]].tolist(), positionGains=[gain] * n,
                velocityGains=[self._number("velocity_gain")] * n, forces=[[force] * 3] * n, physicsClientId=self._client,
            )

    def _turned(self, k: int, turn: Array) -> Array:
        """A ball's rotation as Bullet's joint sees it: between principal frames."""
        frame = self._frames[k]
        return rotation.multiply(rotation.conjugate(frame), rotation.multiply(turn, frame))

    def _number(self, name: str) -> float:
        return float(np.asarray(self._chosen[name].value, dtype=np.float64))
