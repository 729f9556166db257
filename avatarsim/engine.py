"""Engine protocol: operations and frame records of every engine. Small on purpose: no metrics, no rendering, no scenarios."""

import hashlib
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Final, NamedTuple, Protocol, runtime_checkable

import numpy as np
from numpy.typing import NDArray

from avatarsim.counters import Tally
from avatarsim.errors import InvalidInput, UnsupportedShape
from avatarsim.scene.scene import Scene
from avatarsim.scene.tracker import TrackerSample

Array = NDArray[np.float64]

NOTHING = Tally()
"""Nothing counted, nothing timed."""
STARTS = ("nearest", "exact")
"""Treatment of a start that overlaps; see `Settings.start`."""

ADAPTER = "adapter"
"""Name of the stage in which an engine reports time that is not its own: the Python that wraps another simulator for this
protocol. It is no part of that engine's own time; see `FrameRecord.stage_ns`."""


@dataclass(eq=False, init=False, slots=True)
class Snapshot:
    """The world at one instant: the shown state at a frame's end, or a sub-step or an event inside it.

    `time` [s] since load; positions (n, 3) and orientations (n, 4) of body frames in the scene's canonical order, of avatarsim's
    own engine with a scalar part from 0 on, so that equal states are equal bits; velocities (n, 3) of centres of mass [m/s] and
    angular velocities (n, 3) [rad/s], world axes; read-only where all are zero.
    `event` names what happened: "step", or "impact" for the velocities right after a collision at this instant
    (the velocities right before it are the previous snapshot's, at the same time, named "approach"). An event's time is when the
    surfaces meet, where the engine knows that better than from its last pose. When that pose keeps a gap, this is later by the
    time in which the gap closes, and so may be after the frame's end: nanoseconds at 2 m/s, the longer the slower the impact.
    `bodies` names the two that met, in the order of the scene; empty at a step, and where an engine does not report them.
    Steps of driven bodies take no time: they are where the frame begins, or, after loose bodies have moved on, where it ends.
    """

    time: Final[float]
    positions: Final[Array]
    orientations: Final[Array]
    velocities: Final[Array]
    angular_velocities: Final[Array]
    event: Final[str]
    bodies: Final[tuple[str, ...]]

    def __init__(
        self, time: float, positions: Array, orientations: Array, velocities: Array, angular_velocities: Array,
        event: str = "step", bodies: tuple[str, ...] = (),
    ) -> None:
        self.time, self.event, self.bodies = time, event, bodies
        self.positions, self.orientations = positions, orientations
        self.velocities, self.angular_velocities = velocities, angular_velocities


class Moved(NamedTuple):
    """An avatar or a loose body that begins elsewhere than where it was put, since it overlapped something there.

    name      of the avatar or the body
    distance  [m] of the body's origin, or of the link origin that was moved farthest
    angle     [rad] by which the body, or the link that turned most, was turned
    overlaps  (name, name, depth [m]) of the pairs that overlapped and of which it is one, deepest first; empty for one that made
              way for another
    """

    name: str
    distance: float
    angle: float
    overlaps: tuple[tuple[str, str, float], ...]


@dataclass(eq=False, init=False, slots=True)
class FrameRecord:
    """State that an engine shows at the end of one rendered frame, and its cost. Nothing is assigned to after it is made.

    Kept in thousands, records are few objects and flat ones, for Python's cyclic collector goes through all that it tracks:
    slots instead of a dictionary each, arrays (which it does not track), and one shared mapping where nothing was counted.

    angles       (hinges,) [rad], as in TrackerSample; NaN-free; empty when there are none
    counts       work done in this frame, by name (pairs, queries, iterations, joints, contacts, segments, ...)
    statuses     how often a stage reported something else than success, by name
    stage_ns     nanoseconds per stage, by names of the engine's own; empty unless `Settings.time_stages`. Stages do
                 not overlap, and their sum without `ADAPTER` is the frame time that an engine is compared by; an engine that
                 reports none is charged the whole call of `advance`, Python included
    inside       sub-steps and events inside the frame, in order; empty unless recording
    moved        of a start: avatars and loose bodies that begin elsewhere than they were put, and why (`Settings.start`)
    """

    shown: Final[Snapshot]
    angles: Final[Array]
    counts: Final[Mapping[str, int]]
    statuses: Final[Mapping[str, int]]
    stage_ns: Final[Mapping[str, int]]
    inside: Final[tuple[Snapshot, ...]]
    moved: Final[tuple[Moved, ...]]

    def __init__(
        self, shown: Snapshot, angles: Array, counts: Mapping[str, int] = NOTHING, statuses: Mapping[str, int] = NOTHING,
        stage_ns: Mapping[str, int] = NOTHING, inside: tuple[Snapshot, ...] = (), moved: tuple[Moved, ...] = (),
    ) -> None:
        self.shown, self.angles, self.inside, self.moved = shown, angles, inside, moved
        # an empty dictionary of its own would be one more object in every frame
        self.counts, self.statuses, self.stage_ns = counts, statuses or NOTHING, stage_ns or NOTHING

    def state_hash(self) -> str:
        """Return sixteen hexadecimal digits of all shown numbers; equal bits give equal hashes."""
        digest = hashlib.blake2b(digest_size=8)
        s = self.shown
        for array in (s.positions, s.orientations, s.velocities, s.angular_velocities, self.angles):
            digest.update(np.ascontiguousarray(array).tobytes())
        return digest.hexdigest()


@dataclass(frozen=True)
class Settings:
    """Settings of one run of an engine.

    preset         name of a method, "default" or "paper"
    options        overrides of the preset's settings: `{"stand_off": 1e-4}`; `avatarsim.settings` has all, with their units
    seed           of random numbers: orders of chains, and samples of the search for a path
    record_inside  whether records hold sub-steps and events; costs time
    time_stages    whether records hold nanoseconds per stage; costs time
    start          "nearest": a start that overlaps begins at the nearest free posture, with loose bodies moved apart, and its
                   record gives how far and why (`FrameRecord.moved`); "exact": it is refused (`StartOverlaps`). Other engines
                   begin at the given start

    Raises InvalidInput where one of them is of another type; an engine checks names and values at `load`."""

    preset: str = "default"
    options: Mapping[str, object] = field(default_factory=dict)
    seed: int = 0
    record_inside: bool = False
    time_stages: bool = False
    start: str = "nearest"

    def __post_init__(self) -> None:
        if not isinstance(self.preset, str):
            raise InvalidInput("preset of the settings", self.preset, "a text, the name of a preset")
        if not isinstance(self.options, Mapping) or not all(isinstance(name, str) for name in self.options):
            raise InvalidInput("options of the settings", self.options, "a mapping from names of options to values")
        # a bool is an int to Python, and no seed that was meant
        if isinstance(self.seed, bool) or not isinstance(self.seed, int | np.integer):
            raise InvalidInput("seed of the settings", self.seed, "a whole number")
        # numpy's narrow kinds overflow in numbers computed of a seed
        object.__setattr__(self, "seed", int(self.seed))
        for name, flag in (("record_inside", self.record_inside), ("time_stages", self.time_stages)):
            if not isinstance(flag, bool | np.bool_):
                raise InvalidInput(f"{name} of the settings", flag, "True or False")
        if self.start not in STARTS:
            raise InvalidInput("start of the settings", self.start, f"one of {', '.join(STARTS)}")


@runtime_checkable
class Engine(Protocol):
    """An engine that can be compared. Life of one: construct, load once, advance per frame, close."""

    @property
    def name(self) -> str:
        """Return its name on the command line and in every table."""

    @property
    def version(self) -> str:
        """Return the version of the physics behind it."""

    @property
    def presets(self) -> tuple[str, ...]:
        """Return names of its presets, the default first."""

    def unsupported(self, scene: Scene) -> Mapping[str, str]:
        """Return the features of `scene` that this engine does not support: feature -> consequence. Empty if it supports all.
        Called before `load`, and again after it, when an engine may answer for the preset that was loaded.

        A key "scene" means that it cannot express the scene at all; only the answer before `load` counts for that."""

    def settings_as_run(self) -> Mapping[str, object]:
        """Return every setting in force after `load`, with the reason where one was chosen: name -> value or (value, reason)."""

    def load(self, scene: Scene, settings: Settings, dt: float) -> FrameRecord:
        """Build the world for frames of `dt` seconds and return the first state shown, before any time passes."""

    def advance(self, sample: TrackerSample, dt: float) -> FrameRecord:
        """Advance one rendered frame: follow `sample`, pass `dt` seconds, return the state shown."""

    def close(self) -> None:
        """Free everything."""


def require_shapes(scene: Scene, kinds: tuple[type, ...]) -> None:
    """Raise UnsupportedShape for the first body or link of `scene` with a shape of none of these classes.

    For engines that cannot build every shape; called in `load`, the run's row names the body.
    """
    pieces = [body.pieces for body in scene.bodies] + [link.pieces for link in scene.links]
    for name, of_body in zip(scene.names, pieces, strict=True):
        for piece in of_body:
            if not isinstance(piece.shape, kinds):
                raise UnsupportedShape(name, piece.shape, " or ".join(kind.__name__ for kind in kinds))


def require_record(record: object, names: tuple[str, ...], when: str) -> FrameRecord:
    """Return the record of an engine, of a scene with these names of bodies and links. Raises InvalidInput for wrong types and
    shapes, with `when` the engine returned it; numbers are not checked."""
    for thing, kind in ((record, FrameRecord), (getattr(record, "shown", None), Snapshot)):
        if not isinstance(thing, kind):
            raise InvalidInput(f"type of the record {when}", type(thing).__name__, f"avatarsim.{kind.__name__}")
    assert isinstance(record, FrameRecord)
    for name, width in {"positions": 3, "orientations": 4, "velocities": 3, "angular_velocities": 3}.items():
        array = getattr(record.shown, name)
        if not isinstance(array, np.ndarray) or array.shape != (len(names), width):
            valid = f"an array of shape ({len(names)}, {width}), bodies first, then links"
            raise InvalidInput(f"{name} {when}", getattr(array, "shape", type(array).__name__), valid)
    return record
