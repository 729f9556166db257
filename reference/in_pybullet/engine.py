"""PyBullet behind the Engine protocol."""

from collections.abc import Mapping
from importlib.metadata import version
from time import perf_counter_ns

import numpy as np
import pybullet
from numpy.typing import NDArray

from avatarsim.engine import FrameRecord, Settings, Snapshot
from avatarsim.errors import InvalidInput, UnknownName
from avatarsim.scene.body import Role
from avatarsim.scene.scene import Scene
from avatarsim.scene.tracker import TrackerSample, checked
from avatarsim.spatial import rotation
from reference.in_pybullet.cannot_say import cannot_say
from reference.in_pybullet.drive import DRIVES, Drive
from reference.in_pybullet.factors import coefficients, fit, weights
from reference.in_pybullet.presets import presets
from reference.in_pybullet.world import World, build_world
from reference.presets import Chosen, in_force, kind_of
from reference.targets import Targets

Array = NDArray[np.float64]


class PybulletEngine:
    """PyBullet's DIRECT server; one world per engine, in a fresh server each time."""

    name = "pybullet"
    presets = ("default", "tuned")

    def __init__(self) -> None:
        self._client = -1

    @property
    def version(self) -> str:
        """Version of the package."""
        return version("pybullet")

    def cannot_say(self, scene: Scene) -> Mapping[str, str]:
        """What PyBullet has no words for: feature -> consequence."""
        return cannot_say(scene)

    def settings_as_run(self) -> Mapping[str, object]:
        """Every setting in force after `load`: name -> (value, reason)."""
        run: dict[str, object] = {name: (chosen.value, chosen.reason) for name, chosen in self._chosen.items()}
        run["dt as run"] = (self._step, f"{self._count} steps per frame: the nearest whole number")
        run["bodies outside the multibody solver"] = (len(self._world.maximal), "those whose inertia Bullet "
                                                                                "finds by itself")
        return run

    def load(self, scene: Scene, settings: Settings, dt: float) -> FrameRecord:
        """Open a server, build the world, put everything at its first pose, show it."""
        self.close()
        self._chosen: dict[str, Chosen] = in_force(self.name, presets(kind_of(scene), scene.name), settings)
        if self._chosen["drive"].value not in DRIVES:
            raise UnknownName("option drive of pybullet", str(self._chosen["drive"].value), DRIVES)
        if not self._number("dt") > 0.0:
            raise InvalidInput("option dt of pybullet", self._chosen["dt"].value, "seconds above 0")
        self._settings, self._scene = settings, scene
        self._client = int(pybullet.connect(pybullet.DIRECT))
        self._targets = Targets(scene, clamp=bool(self._chosen["clamp_targets"].value))
        self._last = self._targets.within_limits(scene.first_sample)
        self._set_engine()
        self._world: World = build_world(
            scene, self._client, maximal=bool(self._chosen["maximal"].value), limits=scene.effects.limits
        )
        self._set_bodies()
        self._drive = Drive(self._world, scene, self._chosen)
        self._drive.start(rotation.normalised(scene.first_sample.rotations), scene.first_sample.angles)
        self._step, self._count, self._elapsed = 0.0, 0, 0.0
        self._cut(dt)
        return FrameRecord(self._snapshot(), self._angles())

    def advance(self, sample: TrackerSample, dt: float) -> FrameRecord:
        """Follow the motion from the last sample to this one in equal steps."""
        began = perf_counter_ns()
        self._cut(dt)
        goal = self._targets.within_limits(checked(sample, self._scene.avatars))
        goals = self._targets.between(self._last, goal, np.arange(self._count + 1) / self._count)
        self._last = goal
        stepping, inside = 0, []
        for k in range(self._count):
            self._drive.aim(goals, k + 1, self._step)
            self._lift()
            before = perf_counter_ns()
            pybullet.stepSimulation(physicsClientId=self._client)
            stepping += perf_counter_ns() - before
            self._elapsed += self._step
            if self._settings.record_inside:
                inside.append(self._snapshot())
        shown, angles = inside[-1] if inside else self._snapshot(), self._angles()
        counts = {"steps": self._count}
        if self._settings.record_inside:
            counts["contacts"] = len(pybullet.getContactPoints(physicsClientId=self._client) or ())
        stages = {}
        if self._settings.time_stages:
            stages = {"step": stepping, "adapter": perf_counter_ns() - began - stepping}
        finite = np.isfinite(shown.positions).all() and np.isfinite(shown.orientations).all()
        return FrameRecord(shown, angles, counts, {} if finite else {"not_finite": 1}, stages, tuple(inside))

    def close(self) -> None:
        """Shut the server down."""
        if self._client >= 0:
            pybullet.disconnect(physicsClientId=self._client)
            self._client = -1

    def _cut(self, dt: float) -> None:
        """Cut a frame of `dt` into the whole number of steps nearest to the step that was set."""
        if not (np.isfinite(dt) and dt > 0.0):
            raise InvalidInput("frame time [s]", dt, "finite and above 0")
        count = max(1, round(dt / self._number("dt")))
        self._count = count
        if dt / count != self._step:
            self._step = dt / count
            pybullet.setPhysicsEngineParameter(fixedTimeStep=self._step, physicsClientId=self._client)

    def _set_engine(self) -> None:
        client, weightless = self._client, not self._chosen["gravity_on_links"].value
        # without simulated bodies gravity acts on nothing that is not held by its user
        falls = any(role is Role.SIMULATED for role in self._scene.roles) or not weightless
        pybullet.setGravity(*(self._scene.gravity if falls else (0.0, 0.0, 0.0)), physicsClientId=client)
        self._lifts = falls and weightless
        pybullet.setPhysicsEngineParameter(
            numSolverIterations=int(self._number("solver_iterations")), contactSlop=self._number("contact_slop"),
            contactBreakingThreshold=self._number("breaking_threshold"),
            restitutionVelocityThreshold=self._number("restitution_threshold"), deterministicOverlappingPairs=1,
            physicsClientId=client,
        )
        if self._chosen["set_contact_erp"].value:
            pybullet.setPhysicsEngineParameter(contactERP=self._number("contact_erp"), physicsClientId=client)
        if self._chosen["split_impulse"].value:
            pybullet.setPhysicsEngineParameter(
                useSplitImpulse=1, splitImpulsePenetrationThreshold=0.0, physicsClientId=client
            )

    def _set_bodies(self) -> None:
        """Factors of Table 1, damping, margins and contact prediction of every body and link."""
        scene, client = self._scene, self._client
        bounces, slides = coefficients(scene)
        bounce_matters, slide_matters = weights(scene)
        restitution = fit(scene, bounces, bounce_matters).values
        friction = fit(scene, slides, slide_matters).values
        if not scene.effects.restitution:
            restitution = np.zeros(len(scene.names))
        damping, margin = self._number("damping"), self._number("collision_margin")
        for k, part in enumerate(self._world.parts):
            pybullet.changeDynamics(
                part.body, part.link, restitution=float(restitution[k]), lateralFriction=float(friction[k]),
                rollingFriction=0.0, spinningFriction=0.0, linearDamping=damping, angularDamping=damping,
                collisionMargin=margin, physicsClientId=client,
            )
            if self._chosen["sleep"].value and scene.roles[k] is Role.SIMULATED:
                pybullet.changeDynamics(
                    part.body, part.link, activationState=pybullet.ACTIVATION_STATE_ENABLE_SLEEPING, physicsClientId=client
                )
            # the smaller threshold of a pair counts: set on what bounces, it leaves a hand on a table its prediction
            if self._number("processing_threshold") <= 0.0 and scene.roles[k] is Role.SIMULATED:
                pybullet.changeDynamics(part.body, part.link, contactProcessingThreshold=0.0, physicsClientId=client)

    def _lift(self) -> None:
        """Hold driven links against gravity: Bullet has no gravity per body."""
        if self._lifts:
            up = -np.array(self._scene.gravity)
            for part, link in zip(self._world.parts[len(self._scene.bodies) :], self._scene.links, strict=True):
                pybullet.applyExternalForce(
                    part.body, part.link, (link.mass.mass * up).tolist(), [0.0, 0.0, 0.0], pybullet.LINK_FRAME,
                    physicsClientId=self._client,
                )

    def _snapshot(self) -> Snapshot:
        """Poses and velocities of the mass centres, which Bullet keeps in double precision, turned into body
        frames.

        Its link frames come in single precision.
        """
        n, client = len(self._world.parts), self._client
        rows = np.empty((n, 13))
        done: dict[int, tuple[tuple[float, ...], ...]] = {}
        for k, part in enumerate(self._world.parts):
            if part.link < 0:
                at, turn = pybullet.getBasePositionAndOrientation(part.body, physicsClientId=client)
                velocity, spin = pybullet.getBaseVelocity(part.body, physicsClientId=client)
            else:
                if part.body not in done:
                    links = list(range(pybullet.getNumJoints(part.body, physicsClientId=client)))
                    done[part.body] = pybullet.getLinkStates(
                        part.body, links, computeLinkVelocity=1, computeForwardKinematics=1, physicsClientId=client
                    )
                at, turn, _, _, _, _, velocity, spin = done[part.body][part.link]
            rows[k, :3], rows[k, 3:7], rows[k, 7:10], rows[k, 10:] = at, turn, velocity, spin
        frames = np.array([part.frame for part in self._world.parts])
        centres = np.array([part.centre for part in self._world.parts])
        orientations = rotation.multiply(rows[:, [6, 3, 4, 5]], rotation.conjugate(frames))
        positions = rows[:, :3] - rotation.rotate(orientations, centres)
        return Snapshot(self._elapsed, positions, orientations, rows[:, 7:10].copy(), rows[:, 10:].copy())

    def _angles(self) -> Array:
        """Hinge angles (hinges,) [rad] in the order of tracker samples."""
        angles: list[float] = []
        by_body: dict[int, list[int]] = {}
        for body, joint in self._world.hinges:
            by_body.setdefault(body, []).append(joint)
        for body, joints in by_body.items():
            states = pybullet.getJointStates(body, joints, physicsClientId=self._client)
            angles += [state[0] for state in states]
        return np.array(angles, dtype=np.float64)

    def _number(self, name: str) -> float:
        return float(np.asarray(self._chosen[name].value, dtype=np.float64))
