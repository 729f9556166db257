"""The native engine: a scene in, one record per frame out."""

import gc
from collections.abc import Collection, Iterator, Mapping
from contextlib import contextmanager, suppress
from dataclasses import replace
from math import inf
from threading import Lock
from time import perf_counter
from types import TracebackType
from typing import NoReturn, Self, SupportsIndex

import numpy as np

from avatarsim.attaching import attach, attach_at_start, attached, gripped, release, require_sound
from avatarsim.contact_forces import contacts_with_forces, felt
from avatarsim.engine import FrameRecord, Moved, Settings, Snapshot
from avatarsim.errors import AvatarsimError, EngineInUse, InvalidInput, InvalidSnapshot, NotCopied, UnknownName
from avatarsim.frame import Frames
from avatarsim.free_start import move_apart
from avatarsim.jit.linking import CalledKernel
from avatarsim.lower_loop import IkLoop
from avatarsim.model.world import Array, build, shown_sample
from avatarsim.options import METHOD_SETTINGS, choose
from avatarsim.placing import place_bodies, put_avatars, weigh_links
from avatarsim.pose_queries import Contact, contacts_of, require_free, require_within_limits
from avatarsim.rehearsal import ENOUGH, REHEARSALS, Undo
from avatarsim.scene.checks import as_number
from avatarsim.scene.moving import Pose
from avatarsim.scene.scene import Scene
from avatarsim.scene.tracker import TrackerSample
from avatarsim.settings import Chosen, meanings
from avatarsim.snapshot import Identity, carry_loops, carry_poses, identity, read, retained_fields, shared, written
from avatarsim.tolerances import JUDGED, NOTHING
from avatarsim.version import VERSION

PRESETS = ("default", "paper")
"""`default`: every state certified; `paper`: the paper's equations as printed."""

METHOD_DESCRIPTIONS = {
    "default": "every state is certified; the nearest posture by sequential quadratic programming within a motion budget",
    "paper": "equations 1 to 10 and Algorithm 1 as printed, with what makes them well-defined",
}
"""Description of each preset, shown next to its settings."""

def at_rest(velocities: Array) -> Array:
    """Return velocities of a scene without simulated bodies, all zero: shared by all its records, and therefore read-only."""
    shared = velocities.copy()
    shared.flags.writeable = False
    return shared


def frame_time(dt: float) -> None:
    """Raise InvalidInput for a frame time that no simulation can mean."""
    if not 0.0 < (dt if type(dt) is float else as_number(dt)) <= 1.0:
        raise InvalidInput("frame time [s]", dt, "a number above 0 and at most 1")


def require_scene(thing: str, scene: object) -> None:
    """Raise InvalidInput for an argument that is no scene."""
    if not isinstance(scene, Scene):
        raise InvalidInput(thing, scene, "a Scene(name, bodies, avatars)")


def same_poses(one: Snapshot, other: Snapshot) -> bool:
    """Return True if all bodies are at the same places, to the last bit."""
    return np.array_equal(one.positions, other.positions) and np.array_equal(one.orientations, other.orientations)


class AvatarsimEngine:
    """The engine: `load` a scene, then `advance` frame by frame. Implements `avatarsim.engine.Engine`.

    Beyond that protocol: `with AvatarsimEngine() as engine` closes it at the end; `contacts` returns where bodies touch; `change`
    lets bodies come and go between frames; `reset` begins again, `snapshot` and `restore` keep a state and come back to it,
    `posture` and `put` do so for the avatars alone.

    Presets: `default`, whose states are certified to be free of overlap; `paper`, the equations of Schmidl and Lin as printed. In
    a scene without simulated bodies all velocities are zero. An engine cannot be copied or pickled. It answers one call at a
    time: a second thread that calls it meanwhile gets EngineInUse; give each thread its own engine, or see `advance_many`.
    """

    name = "avatarsim"
    version = VERSION
    presets = PRESETS

    def __init__(self) -> None:
        self._frames: Frames | None = None
        self._settings, self._chosen = Settings(), Chosen()
        self._still: tuple[Array, Array] | None = None
        self._identity: Identity | None = None
        self._dt = 0.0
        self._turn = Lock()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None) -> None:
        self.close()

    def __reduce_ex__(self, protocol: SupportsIndex) -> NoReturn:
        raise NotCopied(type(self).__name__)

    def unsupported(self, scene: Scene) -> Mapping[str, str]:
        """Return the features of `scene` that this engine leaves out."""
        require_scene("scene to describe", scene)
        features: dict[str, str] = {}
        if scene.avatars:
            features["avatar dynamics"] = "avatars are kinematic with a coupled mass, not full articulated dynamics"
        return features

    @property
    def scene(self) -> Scene:
        """Return the scene that is loaded. Raises AvatarsimError before `load`."""
        return self._running().world.scene

    def settings_as_run(self) -> Mapping[str, object]:
        """Return every setting in force: name -> (value, its meaning and unit)."""
        self._running()
        method = self._settings.preset
        in_force: dict[str, object] = {"method": (method, METHOD_DESCRIPTIONS[method])}
        for values in (getattr(self._chosen, group) for group in METHOD_SETTINGS[method]):
            descriptions = meanings(type(values))
            in_force |= {name: (value, descriptions.get(name, "")) for name, value in values._asdict().items()}
        return in_force

    def load(self, scene: Scene, settings: Settings, dt: float) -> FrameRecord:
        """Build the world of `scene` for frames of `dt` [s], above 0 and at most 1; return the first state shown, at time 0.

        Overlapping bodies begin at the nearest free posture or place that is found; `moved` of the record gives how far and why.
        Users are where the scene has them. With `Settings(start="exact")` a start that overlaps is refused.

        The first load on a machine compiles the engine, about a minute; later ones take milliseconds. Raises StartOverlaps where
        nothing free is found nearby, InvalidScene for a start beyond joint limits, UnknownName and InvalidInput for settings. If
        it raises, the engine is unchanged.
        """
        require_scene("scene to load", scene)
        if not isinstance(settings, Settings):
            raise InvalidInput("settings to load a scene with", settings, "Settings(preset, options, ...)")
        with self._alone():
            return self._load(scene, settings, dt)

    def reset(self, start: TrackerSample | None = None) -> FrameRecord:
        """Load the same scene again with the same settings, and return the first state shown.

        Avatars begin at `start`, or near it, as in `load`; without it at the last start. Simulated bodies begin where the scene
        has them. If it raises, the engine is unchanged.
        """
        with self._alone():
            scene = self._running().world.scene
            return self._load(scene if start is None else replace(scene, start=start), self._settings, self._dt)

    def change(self, scene: Scene) -> FrameRecord:
        """Continue in another scene: between two frames bodies come, go, or are put elsewhere. Returns the state shown.

        Simulated bodies that both scenes have, by name, keep poses and velocities; avatars that both have keep their posture and
        the last targets of their users, if their links and joints are alike. All else begins as in `scene`: new bodies, fixed
        ones, avatars that are new at its `start`. Sleeping bodies wake, time and settings stay, and `reset` begins `scene`.

        Costs as much as loading a scene, milliseconds and not microseconds, since all is built and checked anew: not for every
        frame. Snapshots taken before are of the other scene. Raises StartOverlaps where bodies would overlap from now on, and
        InvalidScene for a posture that new limits do not allow; if it raises, the engine is unchanged.
        """
        require_scene("scene to change to", scene)
        with self._alone():
            return self._load(scene, self._settings, self._dt, self._running())

    def contacts(
        self, within: float | None = None, *, forces: bool = False, of: Collection[str] | None = None
    ) -> tuple[Contact, ...]:
        """Return the contacts of the state that is shown, found now: some microseconds for each pair that is near.

        Of pairs whose surfaces are at most `within` [m] apart, 0 to 1; by default twice the setting `stand_off`, so that an
        avatar that leans on something is in contact with it. In the order of `scene.names`, of two convex pieces up to eight
        points. Pairs that the scene does not test are left out. With `of` only contacts in which one of these bodies or links
        takes part, which costs less. With `forces` also the force [N] at each, of pairs of which one moves: a solve of all
        contacts of this instant, in which gravity, the springs of avatars and friction are in balance. It takes milliseconds, of
        a hundred bodies a tenth of a second. Raises InvalidInput for another `within`, and for `forces` in
        scenes without coupling and dynamics.
        """
        with self._alone():
            world, chosen = self._running().world, self._chosen
            if within is None:
                within = 2.0 * (chosen.paper if self._settings.preset == "paper" else chosen.posture).stand_off
            if not forces:
                return contacts_of(world, within, of)
            found = contacts_with_forces(self._with_forces(), within, chosen.posture.stand_off, self._dt)
            return found if of is None else tuple(one for one in found if one.a in of or one.b in of)

    def felt(self, avatar: str) -> Array:
        """Return the force that the user of an avatar feels: of the spring to each of its links (links, 3) [N], world axes.

        The stiffness times the lag, at most the largest force. Raises UnknownName for another avatar, and InvalidInput as
        `contacts` with forces.
        """
        with self._alone():
            frames = self._with_forces()
            known = [one.name for one in frames.world.scene.avatars]
            if avatar not in known:
                raise UnknownName("avatar", avatar, known)
            return felt(frames, known.index(avatar))

    def _with_forces(self) -> Frames:
        """Return the frames, if they have the parts that forces need."""
        frames = self._running()
        if not frames.effects.dynamics or (frames.driven and not isinstance(frames.lower, IkLoop)):
            valid = "one with simulated or moving bodies, loaded with the preset default"
            raise InvalidInput("scene to ask for forces in", frames.world.scene.name, valid)
        return frames

    def attach(self, body: str, link: str) -> None:
        """Attach a simulated body to a link, or to a moving body, at their present places.

        From now on it moves along, and the drive of the avatar bears its weight: the two are one rigid body in the solve of all
        contacts, and an obstacle of the body stops the link. `link` is a name of `scene.names`. Raises UnknownName for other
        names, and InvalidInput for a body that is attached already, in scenes without coupling and for the preset `paper`.
        """
        with self._alone():
            attach(self._running(), body, link)

    def detach(self, body: str) -> None:
        """Detach a body; it keeps its velocity. Raises UnknownName if it is not attached."""
        with self._alone():
            release(self._running().world, body)

    def attached(self) -> Mapping[str, str]:
        """Return attached bodies, and the link that each is attached to."""
        with self._alone():
            return attached(self._running().world)

    def grip(self, avatar: str) -> tuple[str, ...]:
        """Attach the bodies that an avatar grips, those that its links press on from opposite sides; return their names.

        Called in each frame it is the policy that attaches pinched bodies. Raises UnknownName for another name than an avatar's,
        and InvalidInput as `attach`.
        """
        found = gripped(self.contacts(), self._running().world.scene, avatar)
        for body, link in found.items():
            if body not in self.attached():
                self.attach(body, link)
        return tuple(found)

    def posture(self) -> TrackerSample:
        """Return the posture that is shown, as a tracker would report it: a copy, at the engine's time."""
        with self._alone():
            frames = self._running()
            return shown_sample(frames.world, frames.time)

    def put(
        self, sample: TrackerSample, user: TrackerSample | None = None, bodies: Mapping[str, Pose] | None = None
    ) -> FrameRecord:
        """Put the avatars elsewhere between two frames; return the state shown there. Time continues.

        Forward kinematics of `sample`; contacts and paths are forgotten. The users are where `user` has them, by default at
        `sample` as well: their motion from there on is followed at once, and a difference that is left is caught up with. Fixed
        bodies go where `bodies` has them, as in `place`. Takes some tens of microseconds and the check of near pairs, where
        `reset` builds the scene anew.

        Avatars that would overlap there go to the nearest free posture, as in `load`, in some milliseconds.

        Raises InvalidSample for a sample that does not fit the avatars or is farther away than 1e8 m, StartOverlaps where nothing
        free is found, InvalidScene for a posture beyond joint limits, and InvalidInput in scenes with moving bodies and for the
        preset `paper`, whose coupling would take the way for a motion of the users. If it raises, the engine is unchanged.
        """
        with self._alone():
            # an argument that is no sample may count as false
            user = sample if user is None else user
            moved = put_avatars(self._running(), sample, user, bodies or {}, self._settings.start == "exact")
            return self._between(moved)

    def place(self, poses: Mapping[str, Pose]) -> FrameRecord:
        """Put fixed bodies elsewhere between two frames, `{"box": (position, orientation)}`; return the state shown there.

        Avatars stay where they are and keep their contacts: led on by small steps a body pushes them. Loaded again, or by
        `reset`, all bodies begin where the scene has them.

        Raises UnknownName for a name of no fixed body, InvalidSample for a pose that is none, StartOverlaps where an avatar would
        overlap, and InvalidInput as `put`. If it raises, the engine is unchanged.
        """
        with self._alone():
            place_bodies(self._running(), poses)
            return self._between()

    def weigh_links(self, factors: Array) -> None:
        """Multiply weights of link origins (links,) in the objective of the posture from now on, 1 at first; no snapshot has
        them. Raises InvalidInput for another shape, for numbers that are not above 0, and as `put`."""
        with self._alone():
            weigh_links(self._running(), factors)

    def snapshot(self) -> bytes:
        """Return all that the next frames depend on. An engine that has loaded the same scene with the same settings, in this
        process or another, continues from there to the bit, as long as it is the same version on the same kind of processor."""
        with self._alone():
            frames = self._running()
            return written(self._who(), frames.time, retained_fields(frames))

    def restore(self, data: bytes) -> FrameRecord:
        """Go back, or on, to where `snapshot` returned `data`; return the state shown there.

        The scene, but for where it starts, and the options must be those that are loaded, dt and the recorded data need not.
        Bytes need not be trusted: InvalidSnapshot if they are damaged, of something else, or hold a number that no state can.
        With the method `default` that includes links beyond joint limits, and links that overlap each other or fixed bodies. If
        it raises, the engine is unchanged.
        """
        with self._alone():
            frames = self._running()
            retained = retained_fields(frames)
            time, arrays = read(data, self._who(), retained)
            before, now = [field.array.copy() for field in retained], frames.time
            try:
                for field, array in zip(retained, arrays, strict=True):
                    field.array[...] = array
                require_sound(frames.world)
                frames.resume_from(time)
                if frames.driven and isinstance(frames.lower, IkLoop):
                    require_within_limits(frames.world, NOTHING)
                    require_free(frames.world, inf)
                return self._between()
            except AvatarsimError as error:
                for field, array in zip(retained, before, strict=True):
                    field.array[...] = array
                frames.resume_from(now)
                raise InvalidSnapshot("state in the snapshot", str(error), "one that can be shown") from error

    def _load(self, scene: Scene, settings: Settings, dt: float, old: Frames | None = None) -> FrameRecord:
        if settings.preset not in PRESETS:
            raise UnknownName("preset of avatarsim", settings.preset, PRESETS)
        frame_time(dt)
        chosen = choose(settings.preset, settings.options)
        world = build(scene)
        both = shared(old.world, world) if old else None
        if old and both:
            carry_poses(old.world, world, both)
        # the shown posture is within its limits up to rounding
        require_within_limits(world, NOTHING if old else 0.0)
        # and bodies at rest are as deep in their support as frames let them
        if old or settings.start == "exact":
            require_free(world, JUDGED if old else NOTHING)
        moved = move_apart(world) if not old and settings.start == "nearest" else ()
        frames = Frames(
            world, settings.preset, chosen, settings.seed, record=settings.record_inside, time_stages=settings.time_stages
        )
        if old and both:
            carry_loops(old, frames, both)
        if moved and frames.driven and isinstance(frames.lower, IkLoop):
            frames.lower.place_avatars(frames.target)
        attach_at_start(frames, old.world if old else None)
        self._settings, self._chosen, self._frames, self._dt, self._identity = settings, chosen, frames, float(dt), None
        v, moves = world.velocities, world.scene.effects.dynamics or world.scene.effects.coupling
        self._still = None if moves else (at_rest(v.linear), at_rest(v.angular))
        self._rehearse(frames, scene.first_sample, dt)
        return self._between(moved)

    def advance(self, sample: TrackerSample | None, dt: float, moving: Mapping[str, Pose] | None = None) -> FrameRecord:
        """Advance one rendered frame of `dt` [s], above 0 and at most 1: follow `sample`, move loose bodies, return the state.

        `moving` gives poses of moving bodies at the end of the frame, `{"door": (position, orientation)}`, or angles of those
        that turn in hinges; those not given keep their last ones. `sample` is of all avatars, or of all but moving bodies; None
        where tracking is lost: users stay at the last sample, with the status `tracking_lost`. Once there is a sample again, the
        way to it is caught up with, and is no motion of the users.

        Raises InvalidSample for a sample that is not finite or does not fit the scene's avatars, and UnknownName for a pose of
        an unknown moving body. The state is then unchanged.
        """
        # `_alone` written out: a context manager takes half a microsecond more
        if not self._turn.acquire(False):
            raise EngineInUse
        try:
            return self._advance(sample, dt, moving)
        finally:
            self._turn.release()

    def _advance(self, sample: TrackerSample | None, dt: float, moving: Mapping[str, Pose] | None = None) -> FrameRecord:
        frames = self._running()
        frame_time(dt)
        if frames.moves or moving or sample is None or frames.is_lost:
            sample = frames.completed(sample, {} if moving is None else moving)
        # a whole number would compile every kernel again, for integers
        frames.frame(sample, float(dt))
        return self._record(frames.counts(), frames.statuses(), frames.passed)

    def close(self) -> None:
        """Forget the world; `load` begins another one."""
        with self._alone():
            self._frames = None

    @contextmanager
    def _alone(self) -> Iterator[None]:
        """Raise EngineInUse during another call, in another thread or in a signal's handler."""
        if not self._turn.acquire(False):
            raise EngineInUse
        try:
            yield
        finally:
            self._turn.release()

    def _who(self) -> Identity:
        """Return the identity of a snapshot taken now."""
        if self._identity is None:
            frames, method = self._running(), self._settings.preset
            in_force = method, *(getattr(self._chosen, group) for group in METHOD_SETTINGS[method])
            self._identity = identity(frames.world.scene, in_force, retained_fields(frames))
        return self._identity

    def stage_calls(self) -> Mapping[str, int]:
        """Return how often each stage ran since load; zero for a stage that the scene does not need."""
        return dict(self._running().clock.calls)

    def _rehearse(self, frames: Frames, sample: TrackerSample, dt: float) -> None:
        """Bring the code of a frame into memory, and its data into the caches: run frames that leave no trace."""
        made = -1
        while made < CalledKernel.made:
            made = CalledKernel.made
            undo = Undo(frames.parts())
            self._rehearsed(undo, sample, dt, first=True)
            if made < CalledKernel.made and gc.isenabled():
                # a quarter of a million objects came with the kernels: some frame would have to wait until all are gone through
                gc.collect()
        if gc.isenabled():
            # the young objects of this load: looked through now, no collection falls due in the first frame
            gc.collect(1)
        begun = perf_counter()
        for _ in range(REHEARSALS):
            self._rehearsed(undo, sample, dt)
            if perf_counter() - begun >= ENOUGH:
                break

    def _rehearsed(self, undo: Undo, sample: TrackerSample, dt: float, first: bool = False) -> None:
        """Run one frame and undo it, also if it raises."""
        try:
            # an error belongs to the frame that meets it, and will be met again there
            with suppress(AvatarsimError):
                self._advance(sample, dt)
            if first:
                undo.keep_what_changed()
        finally:
            undo()

    def _running(self) -> Frames:
        if self._frames is None:
            raise AvatarsimError("no scene is loaded: call load(scene, settings, dt) first")
        return self._frames

    def _between(self, moved: tuple[Moved, ...] = ()) -> FrameRecord:
        """Return the record of a state that no frame led to."""
        self._running().show_all()
        return self._record({}, {"moved_at_start": len(moved)} if moved else {}, (), moved)

    def _record(
        self, counts: Mapping[str, int], statuses: Mapping[str, int], inside: tuple[Snapshot, ...], moved: tuple[Moved, ...] = (),
    ) -> FrameRecord:
        frames = self._running()
        velocities, written = frames.world.velocities, frames.shown()
        position, orientation, angles = written.positions.copy(), written.orientations.copy(), written.angles.copy()
        linear, angular = self._still or (velocities.linear.copy(), velocities.angular.copy())
        shown = Snapshot(frames.time, position, orientation, linear, angular)
        # the state at the end is itself the frame's last sub-step; before it are the steps and events of the loops
        if inside and inside[-1].event == "step" and same_poses(inside[-1], shown):
            # nothing has moved since the last step
            inside = inside[:-1]
        steps = (*inside, shown) if self._settings.record_inside else ()
        return FrameRecord(shown, angles, counts, statuses, frames.clock.ns, steps, moved)
