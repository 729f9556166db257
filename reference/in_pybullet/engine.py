"""PyBullet behind the Engine protocol."""

from collections.abc import Iterator, Mapping
from importlib.metadata import version
from time import perf_counter_ns

import numpy as np
import pybullet
from numpy.typing import NDArray

from avatarsim.engine import ADAPTER, FrameRecord, Settings
from avatarsim.scene.body import Role
from avatarsim.scene.scene import Scene
from avatarsim.scene.tracker import TrackerSample, checked
from avatarsim.spatial import rotation
from reference.in_pybullet.calls import Name, call, grouped
from reference.in_pybullet.drive import DRIVES, Drive
from reference.in_pybullet.presets import BETTER_ELSEWHERE, OPTIMISES, presets
from reference.in_pybullet.reading import STATED, Reading
from reference.in_pybullet.unsupported import unsupported
from reference.in_pybullet.world import World, build_world
from reference.pair_factors import coefficients, fit, weights
from reference.presets import in_force, kind_of
from reference.targets import Targets

Array = NDArray[np.float64]

INSTALLED = version("pybullet")
"""Version of the package; read once, since the look-up goes through the files of every package."""


class PybulletEngine:
    """PyBullet's DIRECT server; one world per engine, in a fresh server each time."""

    name = "pybullet"
    presets = ("default", "tuned")

    def __init__(self) -> None:
        self._client = -1

    @property
    def version(self) -> str:
        """Version of the package."""
        return INSTALLED

    def unsupported(self, scene: Scene) -> Mapping[str, str]:
        """Return the features that PyBullet does not support: feature -> consequence."""
        return unsupported(scene)

    def settings_as_run(self) -> Mapping[str, object]:
        """Every setting in force after `load`: name -> (value, reason)."""
        run = self._chosen.as_run(self._settings.preset, OPTIMISES, BETTER_ELSEWHERE, self._step, self._count)
        run["bodies outside the multibody solver"] = (len(self._world.maximal), "those whose inertia Bullet "
                                                                                "finds by itself")
        return run

    def load(self, scene: Scene, settings: Settings, dt: float) -> FrameRecord:
        """Open a server, build the world, put everything at its first pose, show it."""
        self.close()
        self._chosen = in_force(self.name, presets(kind_of(scene), scene.name), settings)
        self._chosen.word(self.name, "drive", DRIVES)
        self._chosen.step_count(self.name, dt)
        self._settings, self._scene = settings, scene
        self._client = int(pybullet.connect(pybullet.DIRECT))
        self._targets = Targets(scene, clamp=self._chosen.flag("clamp_targets"))
        self._last = self._targets.within_limits(scene.first_sample)
        self._set_engine()
        self._world: World = build_world(
            scene, self._client, maximal=self._chosen.flag("maximal"), limits=scene.effects.limits,
            ball_limits=self._chosen.flag("ball_limits"),
            hulls=self._chosen.flag("boxes_as_hulls"), apart=self._chosen.flag("pieces_as_links"),
        )
        self._set_bodies()
        up = -np.array(scene.gravity)
        held = zip(self._world.parts[len(scene.bodies) :], scene.links, strict=True) if self._lifts else ()
        self._reading = Reading(self._world, scene)
        self._lifting = [
            (STATED * self._reading.read.index(row), part, (link.mass.mass * up).tolist())
            for row, (part, link) in enumerate(held, start=len(scene.bodies))
        ]
        self._drive = Drive(self._world, scene, self._chosen)
        self._drive.start(rotation.normalised(scene.first_sample.rotations), scene.first_sample.angles)
        self._step, self._count, self._elapsed = 0.0, 0, 0.0
        self._cut(dt)
        self._now = self._reading.raw()
        return FrameRecord(self._reading.snapshots([0.0], [self._now])[0], self._reading.angles())

    def advance(self, sample: TrackerSample, dt: float) -> FrameRecord:
        """Follow the motion from the last sample to this one in equal steps."""
        began = perf_counter_ns()
        self._cut(dt)
        goal = self._targets.within_limits(checked(sample, self._scene.avatars))
        goals = self._targets.between(self._last, goal, np.arange(self._count + 1) / self._count)
        self._last = goal
        self._drive.plan(goals, self._step)
        stepping, raw, times = 0, [], []
        for k in range(self._count):
            self._drive.aim(k + 1)
            self._lift()
            before = perf_counter_ns()
            pybullet.stepSimulation(physicsClientId=self._client)
            stepping += perf_counter_ns() - before
            self._elapsed += self._step
            if self._lifting or self._settings.record_inside or k == self._count - 1:
                self._now = self._reading.raw()
            if self._settings.record_inside or k == self._count - 1:
                raw.append(self._now)
                times.append(self._elapsed)
        inside = self._reading.snapshots(times, raw)
        shown, angles = inside[-1], self._reading.angles()
        counts = {"steps": self._count}
        if self._settings.record_inside:
            counts["contacts"] = len(pybullet.getContactPoints(physicsClientId=self._client) or ())
        stages = {}
        if self._settings.time_stages:
            stages = {"step": stepping, ADAPTER: perf_counter_ns() - began - stepping}
        finite = np.isfinite(shown.positions).all() and np.isfinite(shown.orientations).all()
        statuses = {} if finite else {"not_finite": 1}
        return FrameRecord(shown, angles, counts, statuses, stages, inside if self._settings.record_inside else ())

    def close(self) -> None:
        """Shut the server down."""
        if self._client >= 0:
            pybullet.disconnect(physicsClientId=self._client)
            self._client = -1

    def _cut(self, dt: float) -> None:
        """Cut a frame of `dt` into the whole number of steps nearest to the step that was set."""
        self._count = self._chosen.step_count(self.name, dt)
        if dt / self._count != self._step:
            self._step = dt / self._count
            pybullet.setPhysicsEngineParameter(fixedTimeStep=self._step, physicsClientId=self._client)

    def _set_engine(self) -> None:
        client = self._client
        pybullet.setGravity(*self._gravity(), physicsClientId=client)
        self._lifts = self._falls() and not self._chosen["gravity_on_links"].value
        for parameters in self._parameters():
            pybullet.setPhysicsEngineParameter(**parameters, physicsClientId=client)

    def _falls(self) -> bool:
        """Return True if gravity acts at all: without simulated bodies it acts on nothing that is not held by its user."""
        return any(role is Role.SIMULATED for role in self._scene.roles) or self._chosen.flag("gravity_on_links")

    def _gravity(self) -> tuple[float, ...]:
        return tuple(float(g) for g in self._scene.gravity) if self._falls() else (0.0, 0.0, 0.0)

    def _parameters(self) -> list[dict[str, float]]:
        """Return the parameters of the engine, call by call."""
        calls: list[dict[str, float]] = [{
            "numSolverIterations": int(self._chosen.number("solver_iterations")),
            "contactSlop": self._chosen.number("contact_slop"),
            "contactBreakingThreshold": self._chosen.number("breaking_threshold"),
            "restitutionVelocityThreshold": self._chosen.number("restitution_threshold"), "deterministicOverlappingPairs": 1,
        }]
        if self._chosen["set_contact_erp"].value:
            calls.append({"contactERP": self._chosen.number("contact_erp")})
        if self._chosen["split_impulse"].value:
            calls.append({"useSplitImpulse": 1, "splitImpulsePenetrationThreshold": 0.0})
        return calls

    def _set_bodies(self) -> None:
        for body, link, arguments in self._dynamics():
            pybullet.changeDynamics(body, link, **arguments, physicsClientId=self._client)

    def _dynamics(self) -> Iterator[tuple[int, int, dict[str, float]]]:
        """Yield factors of Table 1, damping, margins and contact prediction of every body and link: (body, link, settings)."""
        scene = self._scene
        bounces, slides = coefficients(scene)
        bounce_matters, slide_matters = weights(scene)
        restitution = fit(scene, bounces, bounce_matters).values
        friction = fit(scene, slides, slide_matters).values
        if not scene.effects.restitution:
            restitution = np.zeros(len(scene.names))
        damping, margin = self._chosen.number("damping"), self._chosen.number("collision_margin")
        for k, part in enumerate(self._world.parts):
            for body, link in sorted({(part.body, part.link), *part.carriers}):
                # apart: of a link Bullet silently drops friction and restitution if set together with damping or margin
                yield body, link, {
                    "restitution": float(restitution[k]), "lateralFriction": float(friction[k]), "rollingFriction": 0.0,
                    "spinningFriction": 0.0,
                }
                yield body, link, {"linearDamping": damping, "angularDamping": damping}
                yield body, link, {"collisionMargin": margin}
            if self._chosen["sleep"].value and scene.roles[k] is Role.SIMULATED:
                yield part.body, part.link, {"activationState": pybullet.ACTIVATION_STATE_ENABLE_SLEEPING}
            # the smaller threshold of a pair counts: set on bouncing bodies, it leaves a hand on a table its prediction
            if self._chosen.number("processing_threshold") <= 0.0 and scene.roles[k] is Role.SIMULATED:
                yield part.body, part.link, {"contactProcessingThreshold": 0.0}

    def native(self) -> tuple[str, str]:
        """Return the calls that set engine, bodies, motors and constraints after `load`, as Python."""
        places = {(body, link): f"({body}, {link})" for body, link, _ in self._dynamics()}
        parts = zip(self._scene.names, self._world.parts, strict=True)
        lines = [
            f"# {self._scene.name} as pybullet/{self._settings.preset} ran it, PyBullet {self.version}",
            f"# Steps per frame: {self._count}. Bodies are made by createMultiBody, avatars with limits of balls by loadURDF;",
            "# which pairs do not meet is said by setCollisionFilterPair.",
            *(f"# {name}: body {part.body}, link {part.link}" for name, part in parts),
            "import pybullet", "", f"step = {self._step!r}",
            call("setGravity", *self._gravity()), call("setPhysicsEngineParameter", fixedTimeStep=Name("step")),
            *(call("setPhysicsEngineParameter", **parameters) for parameters in self._parameters()),
            *grouped((places[body, link], arguments) for body, link, arguments in self._dynamics()), *self._drive.calls(),
        ]
        return "py", "\n".join([*lines, ""])

    def _lift(self) -> None:
        """Hold driven links against gravity, by their mass centres: Bullet has no gravity per body.

        The force is given in the world, for Bullet turns one that is given in the link's frame along with the link."""
        for place, part, force in self._lifting:
            pybullet.applyExternalForce(
                part.body, part.link, force, self._now[place : place + 3], pybullet.WORLD_FRAME, physicsClientId=self._client
            )
