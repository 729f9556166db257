"""Rapier behind the Engine protocol."""

from collections.abc import Mapping
from importlib.metadata import version
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
from reference.in_rapier.world import build_world, isometry
from reference.joint_angles import JointAngles
from reference.length_unit import length_unit
from reference.narrowing import alike_in_game_engines
from reference.presets import cut_into, in_force, kind_of, purpose
from reference.targets import Targets

Array = NDArray[np.float64]

INSTALLED = version("rapier3d")
"""Asked once: it is looked for among the files of every package."""


class RapierEngine:
    """Rapier, driven through one kinematic target per link and a critically damped spring from the link to it."""

    name = "rapier"
    presets = ("default", "tuned")

    @property
    def version(self) -> str:
        """Version of the package."""
        return INSTALLED

    def cannot_say(self, scene: Scene) -> Mapping[str, str]:
        """Return unsupported features: feature -> consequence."""
        found = alike_in_game_engines(scene)
        if any(isinstance(link.joint, Ball) and link.joint.limits for link in scene.links):
            found["swing cones"] = "by default limits about two axes, a pyramid with corners a third wider; tuned, ropes: a cone"
        return found

    def settings_as_run(self) -> Mapping[str, object]:
        """Return every setting in force after `load`: name -> (value, reason)."""
        run: dict[str, object] = {name: (chosen.value, chosen.reason) for name, chosen in self._chosen.items()}
        run |= purpose(self._settings.preset, OPTIMISES, BETTER_ELSEWHERE)
        run["dt as run"] = (self._step, cut_into(self._count))
        run["length unit as run"] = (self._unit, "[m]")
        return run

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
        self._bodies = self._world.physics.rigid_bodies
        self._step, self._count, self._elapsed = 0.0, 0, 0.0
        self._cut(dt)
        self._angles = JointAngles(self._world.joined, scene.first_sample.angles)
        shown, *poses = self._read()
        return FrameRecord(shown, self._angles.measured(*poses))

    def advance(self, sample: TrackerSample, dt: float) -> FrameRecord:
        """Follow the motion from the last sample to this one in equal steps."""
        began = perf_counter_ns()
        self._cut(dt)
        goal = self._targets.within_limits(checked(sample, self._scene.avatars))
        goals = self._targets.between(self._last, goal, np.arange(self._count + 1) / self._count)
        self._last = goal
        stepping, lost, inside = 0, 0, list[Snapshot]()
        for k in range(self._count):
            for target, link in self._world.held:
                pose = isometry(goals.positions[k + 1, link], goals.orientations[k + 1, link])
                self._bodies[target].set_next_kinematic_position(pose)
            before = perf_counter_ns()
            self._world.physics.step()
            stepping += perf_counter_ns() - before
            self._elapsed += self._step
            quarantine = self._world.physics.quarantine
            lost += len(quarantine.bodies) + len(quarantine.colliders)
            if self._settings.record_inside or k == self._count - 1:
                shown, *poses = self._read()
                inside.append(shown)
        stages = {"step": stepping, ADAPTER: perf_counter_ns() - began - stepping} if self._settings.time_stages else {}
        statuses = {"quarantined": lost} if lost else {}
        kept = tuple(inside) if self._settings.record_inside else ()
        return FrameRecord(inside[-1], self._angles.measured(*poses), {"steps": self._count}, statuses, stages, kept)

    def close(self) -> None:
        """Drop the world."""
        for name in ("_world", "_bodies"):
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

    def _read(self) -> tuple[Snapshot, Array, Array]:
        """Return what is shown, and poses of all bodies that hinges join: (m, 3) [m] and (m, 4)."""
        bodies, n = [self._bodies[handle] for handle in self._world.handles], len(self._scene.names)
        places = np.array([(b.translation.x, b.translation.y, b.translation.z) for b in bodies]).reshape(-1, 3)
        turns = np.array([(b.rotation.w, b.rotation.i, b.rotation.j, b.rotation.k) for b in bodies]).reshape(-1, 4)
        velocities = np.array([(b.linvel.x, b.linvel.y, b.linvel.z) for b in bodies[:n]]).reshape(-1, 3)
        spins = np.array([(b.angvel.x, b.angvel.y, b.angvel.z) for b in bodies[:n]]).reshape(-1, 3)
        # single precision is unit to seven digits only
        turns = rotation.normalised(turns)
        return Snapshot(self._elapsed, places[:n].copy(), turns[:n].copy(), velocities, spins), places, turns
