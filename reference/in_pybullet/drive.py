"""Drives of avatars in PyBullet: the root follows the tracker by constraint or velocity, joints by position motors."""

from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np
import pybullet
from numpy.typing import NDArray

from avatarsim.scene.joint import Ball
from avatarsim.scene.scene import Scene
from avatarsim.spatial import rotation
from reference.in_pybullet.ball_stops import BallStops
from reference.in_pybullet.calls import Name, call
from reference.in_pybullet.shapes import wxyz, xyzw
from reference.in_pybullet.world import World
from reference.presets import Options
from reference.targets import Followed, Goals

Array = NDArray[np.float64]
Planned = tuple[Callable[..., None], list[dict[str, Any]]]
"""The call that moves the motors of one body, and the targets that it is given step by step."""

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

    def __init__(self, world: World, scene: Scene, chosen: Options) -> None:
        self._world, self._chosen, self._client = world, chosen, world.client
        names = ("root_force", "hand_force", "root_speed", "position_gain", "velocity_gain", "hinge_force", "ball_gain",
                 "ball_force", "limit_force")
        self._numbers = {name: chosen.number(name) for name in names}
        self._frames = {k: world.parts[len(scene.bodies) + k].frame for _, _, k in world.balls}
        self._constraints: list[int] = []
        by_body: dict[int, tuple[list[int], list[int]]] = {}
        for at, (body, joint) in enumerate(world.hinges):
            joints, places = by_body.setdefault(body, ([], []))
            joints.append(joint)
            places.append(at)
        self._hinges = by_body
        self._hinge_motors = {
            body: self._motors(pybullet.setJointMotorControlArray, body, joints, "position_gain",
                               [self._numbers["hinge_force"]] * len(joints))
            for body, (joints, _) in by_body.items()
        }
        balls: dict[int, list[tuple[int, int]]] = {}
        for body, joint, k in world.balls:
            balls.setdefault(body, []).append((joint, k))
        self._balls: list[tuple[int, list[int], Followed]] = []
        for body, entries in balls.items():
            frames = np.array([self._frames[k] for _, k in entries])
            followed = Followed([k for _, k in entries], [world.lefts[k] for _, k in entries], frames)
            self._balls.append((body, [joint for joint, _ in entries], followed))
        self._torques = {body: [[self._numbers["ball_force"]] * 3] * len(joints) for body, joints, _ in self._balls}
        self._ball_motors = {
            body: self._motors(pybullet.setJointMotorControlMultiDofArray, body, joints, "ball_gain", self._torques[body])
            for body, joints, _ in self._balls
        }
        holds = self._numbers["limit_force"] > 0.0 and scene.effects.limits
        self._stops = {body: stops for body in balls if (stops := self._ball_stops(scene, body, balls[body]))} if holds else {}
        roots = [world.parts[part] for part, _ in world.roots]
        others = [len(avatar.links) - 1 for avatar in scene.avatars for _ in avatar.links]
        self._most = [self._numbers["root_force" if others[link] else "hand_force"] for _, link in world.roots]
        self._rooted = [link for _, link in world.roots]
        self._held = np.array([part.centre for part in roots]).reshape(-1, 3)
        self._root = Followed(self._rooted, [rotation.IDENTITY] * len(roots), [rotation.IDENTITY] * len(roots))
        self._inertial = np.array([part.frame for part in roots]).reshape(-1, 4)

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

    def calls(self) -> list[str]:
        """Return a function `aim` that moves roots and joints in every step, as Python; its arguments are lists by body."""
        numbers, forward = self._numbers, bool(self._chosen["feed_forward"].value)
        lines = []
        for index, (part, _) in enumerate(self._world.roots):
            body = self._world.parts[part].body
            if self._constraints:
                place, turn = Name(f"centres[{body}]"), Name(f"turns[{body}]")
                lines.append(call("changeConstraint", self._constraints[index], place, turn, maxForce=self._most[index]))
            else:
                lines.append(f"# velocity that reaches the target within the step, at most {numbers['root_speed']} m/s")
                lines.append(call("resetBaseVelocity", body, Name(f"velocities[{body}]"), Name(f"spins[{body}]")))
        control = Name("pybullet.POSITION_CONTROL")

        def motors(function: str, body: int, joints: list[int], targets: str, gain: str, force: str, **more: object) -> str:
            gains, dampings = ([numbers[name]] * len(joints) for name in (gain, "velocity_gain"))
            return call(function, body, joints, control, targetPositions=Name(f"{targets}[{body}]"), **more,
                        positionGains=gains, velocityGains=dampings, forces=Name(f"[{force}] * {len(joints)}"))

        for body, (joints, _) in self._hinges.items():
            more = {"targetVelocities": Name(f"speeds[{body}]") if forward else [0.0] * len(joints)}
            lines.append(motors("setJointMotorControlArray", body, joints, "angles", "position_gain", "hinge_force", **more))
        for body, joints, _ in self._balls:
            lines.append(motors("setJointMotorControlMultiDofArray", body, joints, "balls", "ball_gain", "[ball_force] * 3"))
            if body in self._stops:
                lines.append(f"# a joint beyond its limits is moved with {numbers['limit_force']} N m instead")
        root, ahead = "centres, turns" if self._constraints else "velocities, spins", ", ahead by its own lag" if forward else ""
        return [
            "", f"hinge_force, ball_force = {numbers['hinge_force']!r}, {numbers['ball_force']!r}", "",
            f"def aim({root}, angles, speeds, balls):", f"    # targets of every step{ahead}, by number of the body",
            *(f"    {line}" for line in lines),
        ] if lines else []

    def plan(self, goals: Goals, step: float) -> None:
        """Compute the inputs of every step of a frame: postures 1 to n of `goals`, each one step [s] after the one before.

        All at once, since numpy costs as much per call as Bullet per step.
        """
        self._step, self._joints = step, self._plan_hinges(goals, step) + self._plan_balls(goals)
        if not self._rooted:
            return
        lead = CONSTRAINT_LAG if self._constraints and self._chosen["feed_forward"].value else 0.0
        before, after = goals.positions[:-1, self._rooted], goals.positions[1:, self._rooted]
        turns = self._root.aimed(goals.orientations, 1.0 + lead)
        self._centres = (after + lead * (after - before) + rotation.rotate(turns, self._held)).tolist()
        self._turns = rotation.multiply(turns, self._inertial)[..., [1, 2, 3, 0]].tolist()

    def aim(self, k: int) -> None:
        """Aim at posture k >= 1 of the goals last planned for."""
        for index, (part, _) in enumerate(self._world.roots):
            centre, turn = self._centres[k - 1][index], self._turns[k - 1][index]
            if self._constraints:
                pybullet.changeConstraint(
                    self._constraints[index], centre, turn, maxForce=self._most[index], physicsClientId=self._client,
                )
            else:
                self._chase(self._world.parts[part].body, centre, turn)
        for body, stops in self._stops.items():
            stops.harden(self._torques[body], [self._numbers["ball_force"]] * 3, [self._numbers["limit_force"]] * 3)
        for motor, steps in self._joints:
            motor(**steps[k - 1])

    def _chase(self, body: int, centre: list[float], turn: list[float]) -> None:
        """Set the velocity that reaches a pose of the mass centre in one step, no faster than the cap."""
        at, now = pybullet.getBasePositionAndOrientation(body, physicsClientId=self._client)
        velocity = (np.array(centre) - np.array(at)) / self._step
        spin = rotation.to_rotation_vector(rotation.multiply(wxyz(turn), rotation.conjugate(wxyz(now)))) / self._step
        cap = self._numbers["root_speed"]
        if cap > 0.0:
            velocity *= min(1.0, cap / max(float(np.linalg.norm(velocity)), 1e-12))
            spin *= min(1.0, 2.0 * cap / max(float(np.linalg.norm(spin)), 1e-12))
        pybullet.resetBaseVelocity(body, velocity.tolist(), spin.tolist(), physicsClientId=self._client)

    def _plan_hinges(self, goals: Goals, step: float) -> list[Planned]:
        forward = 1.0 / step if self._chosen["feed_forward"].value else 0.0
        planned: list[Planned] = []
        for body, (_, places) in self._hinges.items():
            wanted = goals.angles[1:, places]
            speed = forward * (wanted - goals.angles[:-1, places])
            steps = zip(wanted.tolist(), speed.tolist(), strict=True)
            planned.append((self._hinge_motors[body], [{"targetPositions": at, "targetVelocities": to} for at, to in steps]))
        return planned

    def _plan_balls(self, goals: Goals) -> list[Planned]:
        # the motor corrects this share of the error in a step, whatever its target velocity; leading it by the error that
        # is left in steady motion is its feed-forward
        share = min(1.0, self._numbers["ball_gain"] * MOTOR_ERP)
        ahead = 1.0 + (1.0 - share) / share if self._chosen["feed_forward"].value else 1.0
        planned: list[Planned] = []
        for body, _, followed in self._balls:
            steps = followed.aimed(goals.turns, ahead)[..., [1, 2, 3, 0]].tolist()
            planned.append((self._ball_motors[body], [{"targetPositions": turns} for turns in steps]))
        return planned

    def _motors(self, tell: Callable[..., None], body: int, joints: list[int], gain: str, forces: list[Any]
                ) -> Callable[..., None]:
        """Return the call that moves the motors of some joints to given targets: gains stay as they are."""
        gains, dampings = ([self._numbers[name]] * len(joints) for name in (gain, "velocity_gain"))
        return partial(tell, body, joints, pybullet.POSITION_CONTROL, positionGains=gains, velocityGains=dampings, forces=forces,
                       physicsClientId=self._client)

    def _ball_stops(self, scene: Scene, body: int, balls: list[tuple[int, int]]) -> BallStops | None:
        """Return limits of `balls`, (joint, link) each; None without any."""
        links = scene.links
        rows = [(row, joint, k, ball.limits) for row, (joint, k) in enumerate(balls)
                if isinstance(ball := links[k].joint, Ball) and ball.limits is not None]
        if not rows:
            return None
        _, joints, linked, limits = zip(*rows, strict=True)
        return BallStops(
            self._client, body, list(joints), [row for row, _, _, _ in rows], limits,
            np.array([links[k].orientation for k in linked], dtype=np.float64),
            np.array([self._world.lefts[k] for k in linked]), np.array([self._frames[k] for k in linked]),
        )

    def _turned(self, k: int, turn: Array) -> Array:
        """Return a ball's rotation as Bullet's joint sees it: between principal frames."""
        return rotation.multiply(self._world.lefts[k], rotation.multiply(turn, self._frames[k]))
