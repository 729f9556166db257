"""MuJoCo behind the Engine protocol."""

from collections.abc import Mapping
from pathlib import Path
from time import perf_counter_ns

import mujoco
import numpy as np
from numpy.typing import NDArray

from avatarsim.engine import ADAPTER, FrameRecord, Settings
from avatarsim.scene.joint import Ball
from avatarsim.scene.scene import Scene
from avatarsim.scene.tracker import TrackerSample, checked
from avatarsim.spatial import rotation
from reference.in_mujoco import three_hinges
from reference.in_mujoco.compiled import mjcf, resolved
from reference.in_mujoco.laws import contact_laws
from reference.in_mujoco.motors import Motors, Servo
from reference.in_mujoco.presets import BETTER_ELSEWHERE, EVERYWHERE, OPTIMISES, presets
from reference.in_mujoco.reading import Reading
from reference.in_mujoco.stiffness import Stiffness, check_words
from reference.in_mujoco.unsupported import unsupported
from reference.in_mujoco.world import build_world
from reference.presets import Options, in_force, kind_of
from reference.targets import Targets
from runfiles.naming import COMPILED

Array = NDArray[np.float64]

REPLAY = Path(__file__).with_name("replay.py")
"""The program that plays a run's steps; it is copied into the run's folder."""
PINNED = "what is installed; 4.0.0 is refused (2026-11-21: factors sparse Hessians wrongly), 4.0.1 is right: docs/engines.md"
"""Reason of the version; no upstream issue is known here. See docs/engines.md and avatarsim/assets/models/mujoco_versions.py."""


def _quiet(message: str) -> None:
    """Drop a message: warnings are counted in MjData and reported as statuses; MuJoCo would also write them to a file."""


class MujocoEngine:
    """MuJoCo, driven through one mocap body per link welded to the link, or through motors in its joints."""

    name = "mujoco"
    presets = ("default", "tuned")
    _hinged = False

    @property
    def version(self) -> str:
        """Version of the library."""
        return str(mujoco.__version__)

    def unsupported(self, scene: Scene) -> Mapping[str, str]:
        """Return the features that MuJoCo does not support: feature -> consequence; after `load`, for the joints made there."""
        return unsupported(scene, self._hinged)

    def settings_as_run(self) -> Mapping[str, object]:
        """Every setting in force after `load`: name -> (value, reason)."""
        run = self._chosen.as_run(self._settings.preset, OPTIMISES, BETTER_ELSEWHERE, self._step, self._count)
        run["version"] = (self.version, PINNED)
        run |= EVERYWHERE
        if self._motors is not None:
            run["welds"] = ("the root's", EVERYWHERE["welds"][1])
        run["explicit pairs"] = (len(self._world.pair_law), "pairs of geoms whose law priorities cannot say")
        return run | {f"{COMPILED}{name}": entry for name, entry in resolved(self._model).items()}

    def native(self) -> tuple[str, str]:
        """Return the MJCF of the model that `load` made, with the settings written after compilation."""
        head = (
            f"<!-- {self._scene.name} as mujoco/{self._settings.preset} ran it, MuJoCo {self.version}. A frame of "
            f"{self._count * self._step!r} s is cut into {self._count} equal steps of {self._step!r} s: error of the frame "
            "time: none. Numbers have 17 digits. The tracker moves mocap bodies and controls in every step: in everyday "
            "scenes the file .steps.npz beside this one has them, and replay_mujoco.py plays them. -->\n"
        )
        return "xml", head + mjcf(self._world.spec, self._model, self._data)

    def keep_steps(self) -> None:
        """From now on record the adapter's tracker inputs to MuJoCo in every step, for `steps_told`."""
        self._kept.clear()
        self._keeps = True

    def steps_told(self) -> tuple[Mapping[str, Array], str]:
        """Return the inputs since `keep_steps`, mocap_pos (S, m, 3) [m], mocap_quat (S, m, 4), ctrl (S, nu), and
        steps_per_frame, empty where nothing was led, and the program that plays it."""
        if not self._kept:
            return {}, ""
        places, turns, controls = (np.concatenate(part) for part in zip(*self._kept, strict=True))
        steps = {"mocap_pos": places, "mocap_quat": turns, "ctrl": controls, "steps_per_frame": np.array(float(self._count))}
        return steps, REPLAY.read_text(encoding="utf-8")

    def load(self, scene: Scene, settings: Settings, dt: float) -> FrameRecord:
        """Build the model, put everything at its first pose, show it."""
        mujoco.set_mju_user_warning(_quiet)
        self._kept: list[tuple[Array, Array, Array]] = []
        self._keeps = False
        self._settings, self._scene = settings, scene
        self._chosen = in_force(self.name, presets(kind_of(scene), scene.name), settings)
        chosen = self._chosen
        check_words(chosen)
        motors, self._hinged = chosen["drive"].value == "motors", chosen["ball_joints"].value == "hinges"
        self._world = build_world(
            scene, contact_laws(scene, bounce=chosen["contact"].value == "one_step"), limits=scene.effects.limits,
            swing=chosen.flag("swing_limits"), gravity_on_links=chosen.flag("gravity_on_links"),
            armature=chosen.number("armature"), servo=_servo(chosen) if motors else None,
            planes=chosen["floors"].value == "planes", hinged=self._hinged,
        )
        self._stiffness = Stiffness(self._world, chosen)
        self._stiffness.set_options()
        self._model, self._data = self._world.model, mujoco.MjData(self._world.model)
        self._targets = Targets(scene, clamp=chosen.flag("clamp_targets"))
        links, mocap = self._world.mocap
        self._aimed = links[np.argsort(mocap)]
        self._motors = Motors(
            self._model, scene, self._targets, chosen.number("lead"), chosen.flag("lead_stops"),
        ) if motors else None
        self._step, self._count = 0.0, 0
        self._cut(dt)
        self._origin = scene.first_sample.time
        self._last = self._targets.within_limits(scene.first_sample)
        # views of MuJoCo's own memory, which stays where it is: to get one costs as much as to read it
        self._warnings, self._iterations = self._data.warning.number, self._data.solver_niter
        self._led = self._data.mocap_pos, self._data.mocap_quat
        self._elapsed, self._warned = 0.0, self._warnings.tolist()
        self._first_state()
        self._reading = Reading(self._world, self._data)
        self._reading.read(0)
        return FrameRecord(self._reading.snapshots([0.0])[0], self._angles())

    def advance(self, sample: TrackerSample, dt: float) -> FrameRecord:
        """Follow the motion from the last sample to this one in equal steps."""
        began = perf_counter_ns()
        self._cut(dt)
        goal = self._targets.within_limits(checked(sample, self._scene.avatars))
        goals = self._targets.between(self._last, goal, np.arange(self._count + 1) / self._count)
        steps, stop = self._stiffness.lead(self._step) / self._step, self._chosen.flag("lead_stops")
        positions, orientations = self._targets.ahead(goals, steps, stop)
        # for all steps at once: a choice of rows costs numpy as much as a tenth of a step
        positions, orientations = positions[:, self._aimed], orientations[:, self._aimed]
        self._last = goal
        model, data, iterations = self._model, self._data, np.zeros_like(self._iterations)
        led, stepping, times = len(self._aimed) > 0, 0, list[float]()
        targets = None if self._motors is None else self._motors.controls(goals, self._step)
        if self._keeps and led:
            controls = np.zeros((self._count, model.nu)) if targets is None else targets
            self._kept.append((positions.copy(), orientations.copy(), controls.copy()))
        if led or targets is not None or self._settings.record_inside:
            for k in range(self._count):
                if led:
                    self._aim(positions[k], orientations[k])
                if targets is not None:
                    data.ctrl[:] = targets[k]
                before = perf_counter_ns()
                mujoco.mj_step(model, data)
                stepping += perf_counter_ns() - before
                iterations += self._iterations
                self._elapsed += self._step
                if self._settings.record_inside or k == self._count - 1:
                    self._reading.read(len(times))
                    times.append(self._elapsed)
            counts = {"steps": self._count, "iterations": int(iterations.sum()), "contacts": int(data.ncon)}
        else:
            # as its own user would: all steps of the frame in one call, with no access in between
            before = perf_counter_ns()
            mujoco.mj_step(model, data, self._count)
            stepping = perf_counter_ns() - before
            for _ in range(self._count):
                self._elapsed += self._step
            self._reading.read(0)
            times.append(self._elapsed)
            counts = {"steps": self._count, "contacts": int(data.ncon)}
        inside = self._reading.snapshots(times)
        shown, angles = inside[-1], self._angles()
        stages = {}
        if self._settings.time_stages:
            stages = {"step": stepping, ADAPTER: perf_counter_ns() - began - stepping}
        return FrameRecord(shown, angles, counts, self._statuses(), stages, inside if self._settings.record_inside else ())

    def close(self) -> None:
        """Drop the model; MuJoCo frees it."""
        for name in ("_data", "_model", "_world", "_stiffness", "_reading", "_motors", "_warnings", "_iterations", "_led"):
            self.__dict__.pop(name, None)

    def _cut(self, dt: float) -> None:
        """Cut a frame of `dt` into the whole number of steps nearest to the step that was set."""
        self._count = self._chosen.step_count(self.name, dt)
        if dt / self._count != self._step:
            self._step = dt / self._count
            self._stiffness.set_step(self._step)

    def _first_state(self) -> None:
        """Set all bodies and joints to their first pose, velocities as stated, mocap bodies where the links are."""
        data, world, start = self._data, self._world, self._scene.first_sample
        for k, q, v in zip(*world.free, strict=True):
            body = self._scene.bodies[k]
            turn = np.array(body.orientation)
            assert body.mass is not None
            arm = rotation.rotate(turn, body.mass.centre)
            data.qpos[q : q + 3], data.qpos[q + 3 : q + 7] = body.position, turn
            # a free joint moves the body's origin, and turns about body axes
            data.qvel[v : v + 3] = np.array(body.velocity) - np.cross(body.angular_velocity, arm)
            data.qvel[v + 3 : v + 6] = rotation.rotate(rotation.conjugate(turn), body.angular_velocity)
        for k, q in zip(*world.roots, strict=True):
            data.qpos[q : q + 3], data.qpos[q + 3 : q + 7] = start.positions[k], rotation.normalised(start.rotations[k])
        for k, q in zip(*world.balls, strict=True):
            data.qpos[q : q + 4] = rotation.normalised(start.rotations[k])
        for k, q in zip(*world.hinged, strict=True):
            link = self._scene.links[k]
            assert isinstance(link.joint, Ball) and link.joint.limits is not None
            turn = rotation.normalised(start.rotations[k])
            data.qpos[q : q + 3] = three_hinges.angles(link.joint.limits, link.orientation, turn)
        data.qpos[world.hinge_qpos] = start.angles
        goals = self._targets.between(self._last, self._last, np.zeros(1))
        self._aim(goals.positions[0, self._aimed], goals.orientations[0, self._aimed])

    def _aim(self, positions: Array, orientations: Array) -> None:
        """Put the mocap bodies at poses of the links that they lead, in their own order."""
        places, turns = self._led
        places[:], turns[:] = positions, orientations

    def _angles(self) -> Array:
        return np.array(self._data.qpos[self._world.hinge_qpos])

    def _statuses(self) -> dict[str, int]:
        """Return how often each kind of warning was raised in this frame, and the count of non-finite states."""
        # all at once: read one by one, the warnings cost as much as a step
        before, self._warned = self._warned, self._warnings.tolist()
        new = [] if before == self._warned else [now - then for now, then in zip(self._warned, before, strict=True)]
        statuses = {mujoco.mjtWarning(k).name.removeprefix("mjWARN_"): count for k, count in enumerate(new) if count}
        if not np.isfinite(self._data.qpos).all():
            statuses["not_finite"] = 1
        return statuses


def _servo(chosen: Options) -> Servo:
    """Return the servos of the settings."""
    return Servo(*(chosen.number(f"motor_{name}") for name in ("stiffness", "damping_ratio", "force")))
