"""PhysX behind the Engine protocol."""

from collections.abc import Mapping
from time import perf_counter_ns

import numpy as np
from numpy.typing import NDArray

from avatarsim.engine import ADAPTER, FrameRecord, Settings, Snapshot
from avatarsim.scene.scene import Scene
from avatarsim.scene.tracker import TrackerSample, checked
from reference.in_physx.presets import BETTER_ELSEWHERE, OPTIMISES, presets
from reference.in_physx.unsupported import unsupported
from reference.in_physx.world import PLACE, SPIN, STATED, TURN, VELOCITY, VERSION, Pose, World
from reference.joint_angles import JointAngles
from reference.presets import in_force, kind_of
from reference.targets import Targets

Array = NDArray[np.float64]


class PhysxEngine:
    """PhysX on the processor, driven through one kinematic target per link and a critically damped spring from the link to it."""

    name = "physx"
    presets = ("default", "tuned")
    version = VERSION

    def unsupported(self, scene: Scene) -> Mapping[str, str]:
        """Return unsupported features: feature -> consequence."""
        return unsupported(scene)

    def settings_as_run(self) -> Mapping[str, object]:
        """Return every setting in force after `load`: name -> (value, reason)."""
        return self._chosen.as_run(self._settings.preset, OPTIMISES, BETTER_ELSEWHERE, self._step, self._count)

    def load(self, scene: Scene, settings: Settings, dt: float) -> FrameRecord:
        """Build the world, put everything at its first pose, show it."""
        self._settings, self._scene = settings, scene
        self._chosen = in_force(self.name, presets(kind_of(scene)), settings)
        self._chosen.step_count(self.name, dt)
        self._targets = Targets(scene, clamp=self._chosen.flag("clamp_targets"))
        self._last = self._targets.within_limits(scene.first_sample)
        self._world: World = World(scene, self._chosen)
        self._angles = JointAngles(self._world.joined, scene.first_sample.angles)
        self._still = np.zeros((len(scene.names), STATED))
        for k, body in enumerate(scene.bodies):
            self._still[k, PLACE], self._still[k, TURN] = body.position, body.orientation
        self._step, self._count, self._elapsed = 0.0, 0, 0.0
        self._cut(dt)
        state = self._world.read()
        return FrameRecord(self._snapshot(0.0, state), self._angles.measured(state[:, PLACE], state[:, TURN]))

    def advance(self, sample: TrackerSample, dt: float) -> FrameRecord:
        """Follow the motion from the last sample to this one in equal steps."""
        began = perf_counter_ns()
        self._cut(dt)
        world, lead, stepping, inside = self._world, self._chosen.number("lead_steps"), 0, list[Snapshot]()
        goal = self._targets.within_limits(checked(sample, self._scene.avatars))
        goals = self._targets.between(self._last, goal, np.arange(self._count + 1) / self._count)
        self._last = goal
        positions, orientations = goals.positions[1:], goals.orientations[1:]
        if world.targets and lead > 0.0:
            positions, orientations = self._targets.ahead(goals, lead, True)
        for k in range(self._count):
            for link, target in enumerate(world.targets):
                target.set_kinematic_target(Pose(positions[k, link], orientations[k, link]))
            before = perf_counter_ns()
            world.system.step()
            stepping += perf_counter_ns() - before
            self._elapsed += self._step
            if self._settings.record_inside or k == self._count - 1:
                state = world.read()
                inside.append(self._snapshot(self._elapsed, state))
        angles = self._angles.measured(state[:, PLACE], state[:, TURN])
        stages = {"step": stepping, ADAPTER: perf_counter_ns() - began - stepping} if self._settings.time_stages else {}
        statuses = {} if np.isfinite(state).all() else {"not_finite": 1}
        snapshots = inside if self._settings.record_inside else ()
        return FrameRecord(inside[-1], angles, {"steps": self._count}, statuses, stages, tuple(snapshots))

    def close(self) -> None:
        """Drop the world; its actors are freed with it."""
        self.__dict__.pop("_world", None)

    def _cut(self, dt: float) -> None:
        """Cut a frame of `dt` into the whole number of steps nearest to the step that was set."""
        self._count = self._chosen.step_count(self.name, dt)
        self._step = self._world.system.timestep = dt / self._count

    def _snapshot(self, time: float, state: Array) -> Snapshot:
        rows = self._still.copy()
        rows[self._world.moving] = state[self._world.rows]
        return Snapshot(time, rows[:, PLACE], rows[:, TURN], rows[:, VELOCITY], rows[:, SPIN])
