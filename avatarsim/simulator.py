"""The native engine: a scene in, one record per frame out."""

import gc
from collections.abc import Mapping
from contextlib import suppress
from typing import get_type_hints

import numpy as np

import avatarsim
from avatarsim.engine import FrameRecord, Settings, Snapshot
from avatarsim.errors import AvatarsimError, InvalidInput, UnknownName
from avatarsim.frame import Frames
from avatarsim.linking import CalledKernel
from avatarsim.rehearsal import undone
from avatarsim.scene.checks import as_number
from avatarsim.scene.scene import Scene
from avatarsim.scene.tracker import TrackerSample
from avatarsim.settings import Chosen, meanings
from avatarsim.start_check import require_free, require_within_limits
from avatarsim.world.world import Array, build, shown_again, shown_poses

PRESETS = ("default", "paper")
"""`default`: every state certified; `paper`: the paper's equations as printed."""

METHODS_SAID = {
    "default": "every state is checked before it is shown; what holds an avatar back is found by quadratic programs",
    "paper": "equations 1 to 10 and Algorithm 1 as printed, with what makes them well-defined",
}
"""What each preset is, in words that stand beside its settings."""

MOST = 1e9
"""Largest value of any option: a billion of anything here is a slip of the hand."""

NOWHERE = np.zeros((0, 3))
"""What is shown before a scene is loaded."""

CHOICES = {"untie": 1, "around": 2, "couple": 1}
"""Largest value of the options that are a choice between 0 and this."""

LEAST = {
    "steps": 1, "corrections": 1, "attempts": 1, "sweeps": 1, "work": 1, "turn_cap": 1e-3, "move_cap": 1e-3, "stand_off": 1e-7,
    "turn_share": 1e-3, "turn_alone": 1e-3, "stuck_frames": 1, "search_after": 1, "trapped_frames": 1, "rounds": 1,
    "spring": 1e-3, "walk_back": 1e-12,
}
"""Smallest value of the options that are no switch: with 0 nobody moves, nothing comes back, or rounding is all that is left."""

METHOD_SETTINGS = {"default": ("posture", "coupling"), "paper": ("paper", "coupling", "attraction")}
"""The groups of settings that each method reads."""


def choose(method: str, options: Mapping[str, object]) -> Chosen:
    """The method's settings with those fields replaced that `options` names, checked for name, type and finiteness."""
    chosen, left = Chosen(), dict(options)
    known: list[str] = []
    for group in METHOD_SETTINGS[method]:
        defaults = getattr(chosen, group)
        fields = get_type_hints(type(defaults))
        known += fields
        replaced = {name: number(name, left.pop(name), kind) for name, kind in fields.items() if name in left}
        chosen = chosen._replace(**{group: defaults._replace(**replaced)})
    for name in left:
        raise UnknownName(f"option of avatarsim, preset {method}", name, known)
    require_order(chosen, method)
    return chosen


def at_rest(velocities: Array) -> Array:
    """Velocities of a scene in which nobody has one: shared by all its records, and therefore not to be written to."""
    shared = velocities.copy()
    shared.flags.writeable = False
    return shared


def frame_time(dt: float) -> None:
    """Refuse a frame time that no simulation can mean."""
    if not 0.0 < (dt if type(dt) is float else as_number(dt)) <= 1.0:
        raise InvalidInput("frame time [s]", dt, "a number above 0 and at most 1")


def same_poses(one: Snapshot, other: Snapshot) -> bool:
    """Whether all bodies are at the same places, to the last bit."""
    return np.array_equal(one.positions, other.positions) and np.array_equal(one.orientations, other.orientations)


def number(name: str, value: object, kind: type[float] | type[int]) -> float:
    """`value` as a number of `kind`, within the range of option `name`."""
    found, least, most = as_number(value), LEAST.get(name, 0.0), CHOICES.get(name, MOST)
    if not least <= found <= most:
        raise InvalidInput(f"option {name}", value, f"a number from {least:g} to {most:g}")
    if kind is int and found != int(found):
        raise InvalidInput(f"option {name}", value, f"a whole number from {least:g} to {most:g}")
    return kind(found)


def require_order(chosen: Chosen, method: str) -> None:
    """Refuse gaps that contradict each other: steps would aim at what is then not accepted."""
    if method == "paper":
        if chosen.paper.tolerance >= chosen.paper.stand_off:
            raise InvalidInput("option tolerance", chosen.paper.tolerance, f"below stand_off, {chosen.paper.stand_off:g} m")
    elif not chosen.posture.wedged_gap <= chosen.posture.least_gap < chosen.posture.stand_off:
        gaps = chosen.posture.wedged_gap, chosen.posture.least_gap, chosen.posture.stand_off
        raise InvalidInput("options wedged_gap, least_gap, stand_off", gaps, "wedged_gap up to least_gap, below stand_off [m]")


class AvatarsimEngine:
    """Implements `avatarsim.engine.Engine`. In a scene without simulated bodies nobody asks for velocities: all are zero."""

    name = "avatarsim"
    version = avatarsim.__version__
    presets = PRESETS

    def __init__(self) -> None:
        self._frames: Frames | None = None
        self._settings, self._chosen = Settings(), Chosen()
        self._before: tuple[Array, Array] = NOWHERE, NOWHERE
        self._still: tuple[Array, Array] | None = None

    def cannot_say(self, scene: Scene) -> Mapping[str, str]:
        """What this engine leaves out of `scene`."""
        said: dict[str, str] = {}
        if scene.avatars:
            said["avatar dynamics"] = "avatars are kinematic with a coupled mass, not full articulated dynamics"
        return said

    def settings_as_run(self) -> Mapping[str, object]:
        """Every setting in force: name -> (value, what it means and its unit)."""
        self._running()
        method = self._settings.preset
        in_force: dict[str, object] = {"method": (method, METHODS_SAID[method])}
        for group in METHOD_SETTINGS[method]:
            values = getattr(self._chosen, group)
            said = meanings(type(values))
            in_force |= {name: (value, said.get(name, "")) for name, value in values._asdict().items()}
        return in_force

    def load(self, scene: Scene, settings: Settings, dt: float) -> FrameRecord:
        """Build the world; the first pose must be free of overlap."""
        if settings.preset not in PRESETS:
            raise UnknownName("preset of avatarsim", settings.preset, PRESETS)
        frame_time(dt)
        chosen = choose(settings.preset, settings.options)
        world = build(scene)
        require_within_limits(world)
        require_free(world)
        self._settings, self._chosen = settings, chosen
        self._frames = Frames(
            world, settings.preset, chosen, settings.seed, record=settings.record_inside, time_stages=settings.time_stages
        )
        self._before = shown_poses(world)
        v, moves = world.velocities, world.scene.effects.dynamics or world.scene.effects.coupling
        self._still = None if moves else (at_rest(v.linear), at_rest(v.angular))
        self._rehearse(self._frames, scene.first_sample, dt)
        return self._record({}, {}, ())

    def advance(self, sample: TrackerSample, dt: float) -> FrameRecord:
        """One rendered frame."""
        frames = self._running()
        frame_time(dt)
        # a whole number would compile every kernel again, for integers
        frames.frame(sample, float(dt))
        return self._record(frames.counts(), frames.statuses(), frames.passed)

    def close(self) -> None:
        """Forget the world."""
        self._frames = None

    def stage_calls(self) -> Mapping[str, int]:
        """How often each stage ran since load; a stage that the scene does not call for has zero."""
        return dict(self._running().clock.calls)

    def _rehearse(self, frames: Frames, sample: TrackerSample, dt: float) -> None:
        """Bring what a frame calls into memory: run a frame that leaves no trace, until one finds all of it there."""
        made = -1
        while made < CalledKernel.made:
            made = CalledKernel.made
            # an error belongs to the frame that meets it, and will be met again there
            with undone(frames.parts()), suppress(AvatarsimError):
                self.advance(sample, dt)
            if made < CalledKernel.made and gc.isenabled():
                # a quarter of a million objects came with the kernels: some frame would have to wait until all are gone through
                gc.collect()

    def _running(self) -> Frames:
        if self._frames is None:
            raise AvatarsimError("no scene is loaded: call load(scene, settings, dt) first")
        return self._frames

    def _record(self, counts: Mapping[str, int], statuses: Mapping[str, int], inside: tuple[Snapshot, ...]) -> FrameRecord:
        frames = self._running()
        world = frames.world
        # without simulated bodies only links move, and of velocities there are none
        position, orientation = shown_again(world, self._before, world.skeleton.first if self._still else 0)
        linear, angular = self._still or (world.velocities.linear.copy(), world.velocities.angular.copy())
        shown = Snapshot(frames.time, position, orientation, linear, angular)
        # the state at the end is itself the frame's last sub-step; before it stand the steps and events of the loops
        if inside and inside[-1].event == "step" and same_poses(inside[-1], shown):
            # nothing has moved since the last step
            inside = inside[:-1]
        steps = (*inside, shown) if self._settings.record_inside else ()
        return FrameRecord(shown, world.posture.angle[world.hinges], counts, statuses, frames.clock.ns, steps)
