"""The native engine: a scene in, one record per frame out."""

from collections.abc import Mapping
from typing import TypeVar, get_type_hints

import numpy as np

import avatarsim
from avatarsim.engine import FrameRecord, Settings, Snapshot
from avatarsim.errors import AvatarsimError, InvalidInput, UnknownName
from avatarsim.frame import Frames
from avatarsim.scene.scene import Scene
from avatarsim.scene.tracker import TrackerSample
from avatarsim.settings import CouplingSettings, PostureSettings
from avatarsim.start_check import require_free
from avatarsim.world.world import build, shown_poses

PRESETS = ("default",)


Chosen = TypeVar("Chosen", PostureSettings, CouplingSettings)


def override(defaults: Chosen, options: Mapping[str, object]) -> Chosen:
    """`defaults` with those fields replaced that `options` names, checked for type and finiteness."""
    chosen = {}
    for name, kind in get_type_hints(type(defaults)).items():
        if name in options:
            value = options[name]
            if not isinstance(value, (int, float)) or isinstance(value, bool) or not np.isfinite(value) or value < 0:
                raise InvalidInput(f"option {name}", value, "a finite number, 0 or more")
            chosen[name] = kind(value)
    return defaults._replace(**chosen)


class AvatarsimEngine:
    """Implements `avatarsim.engine.Engine`."""

    name = "avatarsim"
    version = avatarsim.__version__
    presets = PRESETS

    def __init__(self) -> None:
        self._frames: Frames | None = None
        self._settings = Settings()

    def cannot_say(self, scene: Scene) -> Mapping[str, str]:
        """What this engine leaves out of `scene`."""
        said: dict[str, str] = {}
        if scene.avatars:
            said["avatar dynamics"] = "avatars are kinematic with a coupled mass, not full articulated dynamics"
        if scene.effects.reach_cones:
            said["reach cones"] = "spherical polygons are kept as data; of ball joints swing and twist are enforced"
        return said

    def settings_as_run(self) -> Mapping[str, object]:
        """Every setting in force."""
        frames = self._running()
        return {"method": self._settings.preset, **frames.posture_settings._asdict(), **frames.coupling_settings._asdict()}

    def load(self, scene: Scene, settings: Settings, dt: float) -> FrameRecord:
        """Build the world; the first pose must be free of overlap."""
        if settings.preset not in PRESETS:
            raise UnknownName("preset of avatarsim", settings.preset, PRESETS)
        if not (np.isfinite(dt) and 0.0 < dt <= 1.0):
            raise InvalidInput("frame time [s]", dt, "above 0 and at most 1")
        known = (*PostureSettings._fields, *CouplingSettings._fields)
        for name in settings.options:
            if name not in known:
                raise UnknownName("option of avatarsim", name, known)
        world = build(scene)
        require_free(world)
        self._settings = settings
        self._frames = Frames(
            world,
            override(PostureSettings(), settings.options),
            override(CouplingSettings(), settings.options),
            record_inside=settings.record_inside, time_stages=settings.time_stages,
        )
        return self._record({}, {}, ())

    def advance(self, sample: TrackerSample, dt: float) -> FrameRecord:
        """One rendered frame."""
        frames = self._running()
        frames.frame(sample, dt)
        return self._record(frames.counts(), frames.statuses(), frames.inside())

    def close(self) -> None:
        """Forget the world."""
        self._frames = None

    def stage_calls(self) -> Mapping[str, int]:
        """How often each stage ran since load; a stage that the scene does not call for has zero."""
        return dict(self._running().clock.calls)

    def _running(self) -> Frames:
        if self._frames is None:
            raise AvatarsimError("no scene is loaded: call load(scene, settings, dt) first")
        return self._frames

    def _record(self, counts: Mapping[str, int], statuses: Mapping[str, int], inside: tuple[Snapshot, ...]) -> FrameRecord:
        frames = self._running()
        world = frames.world
        position, orientation = shown_poses(world)
        shown = Snapshot(frames.time, position, orientation, world.velocities.linear.copy(), world.velocities.angular.copy())
        # the state at the end is itself the frame's last sub-step; before it stand the events of the upper loop
        steps = (*inside, shown) if self._settings.record_inside else ()
        return FrameRecord(shown, world.posture.angle[world.hinges], counts, statuses, dict(frames.clock.ns), steps)
