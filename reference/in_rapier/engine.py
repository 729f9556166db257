"""Rapier behind the Engine protocol."""

from collections.abc import Mapping, Sequence
from importlib import metadata
from time import perf_counter_ns

import numpy as np
import rapier3d as rapier
from numpy.typing import NDArray

from avatarsim.engine import ADAPTER, FrameRecord, Settings, Snapshot
from avatarsim.scene.joint import Ball
from avatarsim.scene.scene import Scene
from avatarsim.scene.tracker import TrackerSample, checked
from avatarsim.spatial import rotation
from reference.in_rapier.presets import BETTER_ELSEWHERE, OPTIMISES, SWINGS, presets
from reference.in_rapier.world import build_world
from reference.joint_angles import JointAngles
from reference.length_unit import length_unit
from reference.narrowing import alike_in_game_engines
from reference.presets import in_force, kind_of
from reference.targets import Targets

Array = NDArray[np.float64]
State = list[tuple[float, ...]]


class RapierEngine:
    """Rapier, driven through one kinematic target per link and a critically damped spring from the link to it."""

    name = "rapier"
    presets = ("default", "tuned")
    version = metadata.version("rapier3d")

    def unsupported(self, scene: Scene) -> Mapping[str, str]:
        """Return unsupported features: feature -> consequence."""
        lacks = alike_in_game_engines(scene)
        if any(isinstance(link.joint, Ball) and link.joint.limits for link in scene.links):
            lacks["swing cones"] = "by default limits about two axes, a pyramid with corners a third wider; tuned, ropes: a cone"
        return lacks

    def settings_as_run(self) -> Mapping[str, object]:
        """Return every setting in force after `load`: name -> (value, reason)."""
        run = self._chosen.as_run(self._settings.preset, OPTIMISES, BETTER_ELSEWHERE, self._step, self._count)
        run["length unit as run"] = (self._unit, "[m]")
        return run | {"threads": (self._world.physics.num_threads, "RAYON_NUM_THREADS")}

    def native(self) -> tuple[str, str]:
        """Return the world as Rapier writes it."""
        return "json", str(self._world.physics.snapshot_json())

    def load(self, scene: Scene, settings: Settings, dt: float) -> FrameRecord:
        """Build the world, put everything at its first pose, show it."""
        self._settings, self._scene = settings, scene
        chosen = self._chosen = in_force(self.name, presets(kind_of(scene)), settings)
        chosen.word(self.name, "swing_limits", SWINGS)
        self._targets = Targets(scene, clamp=self._chosen.flag("clamp_targets"))
        self._last = self._targets.within_limits(scene.first_sample)
        self._unit = chosen.number("length_unit") or length_unit(scene)
        self._world = build_world(scene, chosen, self._unit)
        bodies = self._world.physics.rigid_bodies
        self._held = [(bodies[target], link) for target, link in self._world.held]
        self._views = [bodies[handle] for handle in self._world.handles]
        self._states, self._moving = np.zeros((len(self._views), 13)), np.arange(len(self._views))
        self._step, self._count, self._elapsed = 0.0, 0, 0.0
        self._cut(dt)
        self._angles = JointAngles(self._world.joined, scene.first_sample.angles)
        [shown], poses = self._snapshots([0.0], [self._read()])
        # fixed bodies are read once
        self._moving = np.flatnonzero([not view.is_fixed for view in self._views])
        self._views = [self._views[k] for k in self._moving]
        return FrameRecord(shown, self._angles.measured(*poses))

    def advance(self, sample: TrackerSample, dt: float) -> FrameRecord:
        """Follow the motion from the last sample to this one in equal steps."""
        began = perf_counter_ns()
        self._cut(dt)
        goal = self._targets.within_limits(checked(sample, self._scene.avatars))
        goals, self._last = self._targets.between(self._last, goal, np.arange(self._count + 1) / self._count), goal
        stepping, lost, times, read = 0, 0, list[float](), list[State]()
        places, turns = goals.positions.tolist(), goals.orientations.tolist()
        for k in range(self._count):
            for target, link in self._held:
                target.set_next_kinematic_position(rapier.Isometry3(places[k + 1][link], rapier.Rotation3(*turns[k + 1][link])))
            before = perf_counter_ns()
            self._world.physics.step()
            stepping += perf_counter_ns() - before
            self._elapsed += self._step
            quarantine = self._world.physics.quarantine
            lost += 0 if quarantine.is_empty() else len(quarantine.bodies) + len(quarantine.colliders)
            if self._settings.record_inside or k == self._count - 1:
                times.append(self._elapsed)
                read.append(self._read())
        inside, poses = self._snapshots(times, read)
        stages = {"step": stepping, ADAPTER: perf_counter_ns() - began - stepping} if self._settings.time_stages else {}
        statuses = {"quarantined": lost} if lost else {}
        angles, snapshots = self._angles.measured(*poses), tuple(inside) if self._settings.record_inside else ()
        return FrameRecord(inside[-1], angles, {"steps": self._count}, statuses, stages, snapshots)

    def close(self) -> None:
        """Drop the world."""
        for name in ("_world", "_views", "_held"):
            self.__dict__.pop(name, None)

    def _cut(self, dt: float) -> None:
        """Cut a frame of `dt` into the whole number of steps nearest to the step that was set."""
        self._count = self._chosen.step_count(self.name, dt)
        if dt / self._count != self._step:
            self._step = dt / self._count
            self._world.physics.integration_parameters = self._parameters()

    def _parameters(self) -> rapier.IntegrationParameters:
        """Return all settings of the solver as one object: an assignment to a part of the world's would change a copy."""
        made, number = rapier.IntegrationParameters(), self._chosen.number
        made.dt, made.length_unit = self._step, self._unit
        made.num_solver_iterations = int(number("solver_iterations"))
        made.num_internal_pgs_iterations = int(number("pgs_iterations"))
        loose, static, damping = (number(name) for name in ("contact_frequency", "static_frequency", "contact_damping_ratio"))
        made.contact_softness = rapier.SpringCoefficients(loose, damping)
        made.static_contact_softness = rapier.SpringCoefficients(static, damping)
        made.normalized_prediction_distance = number("prediction")
        made.contact_recycling = self._chosen.flag("contact_recycling")
        made.friction_in_bias_pass = self._chosen.flag("friction_in_bias_pass")
        return made

    def _read(self) -> State:
        """Return position, rotation (vector part first), velocity and angular velocity of each body that can move."""
        return [
            (*b.translation.to_tuple(), *b.rotation.to_tuple(), *b.linvel.to_tuple(), *b.angvel.to_tuple()) for b in self._views
        ]

    def _snapshots(self, times: Sequence[float], read: Sequence[State]) -> tuple[list[Snapshot], tuple[Array, Array]]:
        """Return snapshots of states that were read at these times, and the last poses of all bodies that hinges join:
        (m, 3) [m] and (m, 4)."""
        states, n = np.tile(self._states, (len(read), 1, 1)), len(self._scene.names)
        states[:, self._moving] = np.array(read).reshape(len(read), len(self._moving), 13)
        self._states = states[-1].copy()
        # Rapier's last part is the scalar one; single precision is unit to seven digits only
        places, turns = states[..., :3], rotation.normalised(states[..., (6, 3, 4, 5)])
        shown = [
            Snapshot(time, places[k, :n], turns[k, :n], states[k, :n, 7:10], states[k, :n, 10:]) for k, time in enumerate(times)
        ]
        return shown, (places[-1], turns[-1])
