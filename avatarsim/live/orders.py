"""Commands of a driven world, applied between two frames: by the loop while it runs, and by a replay in the same order.

Command pattern (Gamma et al. 1994): each action of the user other than moving is an object, so that it can be refused, recorded
and repeated. A refused command leaves the world unchanged.
"""

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from avatarsim.engine import Engine, FrameRecord, Settings
from avatarsim.errors import AvatarsimError, InvalidInput
from avatarsim.live.messages import RATES, Command, Order, Plan, Switch
from avatarsim.scene.body import Body, Role
from avatarsim.scene.checks import within
from avatarsim.scene.joint import Ball, Free
from avatarsim.scene.scene import Scene
from avatarsim.scene.tracker import TrackerSample, rest
from avatarsim.simulator import AvatarsimEngine
from avatarsim.spatial import rotation

COMING_BACK = "an engine that takes snapshots: avatarsim"
"""Engines that can restore a snapshot, as error messages name them."""


class World:
    """A loaded engine with its scene, both as changed by commands.

    `shown` is the record of the last frame or command. Raises the errors of the engine's `load`."""

    def __init__(self, plan: Plan, make: Callable[[], Engine] = AvatarsimEngine) -> None:
        within("frames a second of a loop [1/s]", plan.rate, *RATES, InvalidInput)
        self.plan, self._make, self.dt = plan, make, 1.0 / plan.rate
        self.scene, self.settings, self._saved = narrowed(plan.scene, plan.scene, plan.off), plan.settings, b""
        self.report, self.pinches, self._pinched, self._saved_pinched = "", False, set[str](), set[str]()
        self.engine = make()
        self.shown: FrameRecord = self.engine.load(self.scene, self.settings, self.dt)

    @property
    def begun(self) -> Plan:
        """Plan of a world that begins as this one would after a reset now."""
        author = self.plan.scene.narrow
        return replace(self.plan, settings=self.settings, off=tuple(name for name in self.scene.narrow if name not in author))

    def advance(self, sample: TrackerSample) -> FrameRecord:
        """Advance by one frame and return its record."""
        self.shown = self.engine.advance(sample, self.dt)
        if self.pinches and isinstance(self.engine, AvatarsimEngine):
            try:
                self._pinch(self.engine, True)
            except AvatarsimError:
                # after a switch to settings that support no attachment
                self.pinches = False
        return self.shown

    def apply(self, command: Command) -> str:
        """Apply a command. Return "", or the reason of a refusal; `report` holds the command's report. Commands for pauses, logs
        and STOP belong to the loop: they change no frame and do nothing here."""
        self.report = ""
        try:
            if command.order is Order.RESET:
                self._reset()
            elif command.order is Order.KEEP:
                self._saved, self._saved_pinched = self._require_avatarsim("to keep a state of").snapshot(), set(self._pinched)
            elif command.order is Order.BACK:
                self._back()
            elif command.order is Order.TAKE:
                self.report = self._attach_or_release(self._require_avatarsim("to take things with"))
            elif command.order is Order.PINCH:
                self._pinch(self._require_avatarsim("to pinch things with"), command.value is True)
                self.pinches = command.value is True
            elif command.order is Order.SWITCH:
                self._switch(command.value)
        except AvatarsimError as error:
            return str(error)
        return ""

    def _require_avatarsim(self, what: str) -> AvatarsimEngine:
        if not isinstance(self.engine, AvatarsimEngine):
            raise InvalidInput(f"engine {what}", self.plan.name, COMING_BACK)
        return self.engine

    def _attach_or_release(self, engine: AvatarsimEngine) -> str:
        """Release all bodies attached to the first avatar or, without any, attach those in contact with it; return a report."""
        avatar, attached = self.scene.avatars[0], engine.attached()
        first = len(self.scene.bodies)
        links = self.scene.names[first : first + len(avatar.links)]
        if attached_bodies := [body for body, link in attached.items() if link in links]:
            for body in attached_bodies:
                engine.detach(body)
            self._pinched.clear()
            return f"let go of {', '.join(attached_bodies)}"
        loose = {body.name for body in self.scene.bodies if body.role is Role.SIMULATED} - set(attached)
        touched: dict[str, str] = {}
        for contact in engine.contacts():
            for body, link in ((contact.a, contact.b), (contact.b, contact.a)):
                if body in loose and link in links:
                    touched.setdefault(body, link)
        if not touched:
            raise InvalidInput("what the avatar touches", "nothing loose", "a loose body, to be taken")
        for body, link in touched.items():
            engine.attach(body, link)
        return f"took {', '.join(touched)}"

    def _pinch(self, engine: AvatarsimEngine, on: bool) -> None:
        """Attach bodies that the first avatar grips and release bodies that it no longer grips; release all unless ``on``."""
        before = set(engine.attached())
        gripped = set(engine.grip(self.scene.avatars[0].name)) if on else set[str]()
        for body in self._pinched & (before - gripped):
            engine.detach(body)
        self._pinched = (self._pinched & gripped) | (gripped - before)

    def _reset(self) -> None:
        scene = replace(self.plan.scene, narrow=self.scene.narrow)
        self.shown, self._saved = self._loaded(scene, self.settings), b""

    def _back(self) -> None:
        engine = self._require_avatarsim("to come back to a state of")
        if self._saved:
            self.shown, self._pinched = engine.restore(self._saved), set(self._saved_pinched)
        else:
            self._reset()

    def _switch(self, value: object) -> None:
        if not isinstance(value, Switch):
            raise InvalidInput("switch of a loop", value, "a Switch(off, preset, options)")
        scene = narrowed(self.scene, self.plan.scene, value.off)
        settings = self.settings
        if isinstance(self.engine, AvatarsimEngine):
            # presets of other engines are not replaced
            settings = replace(settings, preset=value.preset, options=value.options)
        same = settings.preset == self.settings.preset and dict(settings.options) == dict(self.settings.options)
        if same and isinstance(self.engine, AvatarsimEngine):
            self.shown, self.scene = self.engine.change(scene), scene
        else:
            attached = tuple(self.engine.attached().items()) if isinstance(self.engine, AvatarsimEngine) else ()
            self.shown = self._loaded(replace(scene_at(scene, self.shown), attached=attached), settings)
        # a snapshot is of one scene and one set of settings
        self._saved = b""

    def _loaded(self, scene: Scene, settings: Settings) -> FrameRecord:
        """Load a scene into a fresh engine and return its first record; the old engine is closed after the new one has loaded."""
        engine = self._make()
        shown = engine.load(scene, settings, self.dt)
        self.engine.close()
        self.engine, self.scene, self.settings = engine, scene, settings
        return shown


def narrowed(scene: Scene, author: Scene, off: tuple[str, ...]) -> Scene:
    """Return the scene without the effects that are off in `author`, and without those in `off`."""
    return replace(scene, narrow=author.narrow + tuple(name for name in off if name not in author.narrow))


def scene_at(scene: Scene, shown: FrameRecord) -> Scene:
    """Return the scene with its start moved to `shown`: poses and velocities of bodies, joints of avatars."""
    state = shown.shown
    bodies = tuple(_body_at(body, shown, k) for k, body in enumerate(scene.bodies))
    if not scene.avatars:
        return replace(scene, bodies=bodies)
    first = len(scene.bodies)
    start = posture_of(scene, state.positions[first:], state.orientations[first:], shown.angles)
    return replace(scene, bodies=bodies, start=start)


def _body_at(body: Body, shown: FrameRecord, k: int) -> Body:
    if body.role is not Role.SIMULATED:
        return body
    state = shown.shown
    x, y, z = state.positions[k].tolist()
    a, b, c, d = rotation.normalised(state.orientations[k]).tolist()
    u, v, w = state.velocities[k].tolist()
    p, q, r = state.angular_velocities[k].tolist()
    return replace(body, position=(x, y, z), orientation=(a, b, c, d), velocity=(u, v, w), angular_velocity=(p, q, r))


def posture_of(scene: Scene, positions: np.ndarray, orientations: np.ndarray, angles: np.ndarray) -> TrackerSample:
    """Return the sample whose forward kinematics gives the links of all avatars these poses: positions (links, 3) [m],
    orientations (links, 4), and hinge angles [rad]. Inverse of `avatarsim.scene.tracker.link_poses`."""
    sample, first = rest(scene.avatars), 0
    for avatar in scene.avatars:
        index = {link.name: first + k for k, link in enumerate(avatar.links)}
        for k, link in enumerate(avatar.links, start=first):
            if isinstance(link.joint, Free):
                sample.positions[k], sample.rotations[k] = positions[k], rotation.normalised(orientations[k])
            elif isinstance(link.joint, Ball):
                frame = np.array(rotation.IDENTITY) if link.parent is None else orientations[index[link.parent]]
                resting = rotation.multiply(frame, np.asarray(link.orientation))
                sample.rotations[k] = rotation.normalised(rotation.multiply(rotation.conjugate(resting), orientations[k]))
        first += len(avatar.links)
    return replace(sample, angles=np.array(angles, dtype=np.float64))
