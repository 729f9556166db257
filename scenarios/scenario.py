"""Scenarios: a scene, a motion, a length, and bounds, each with its reason."""

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from fnmatch import fnmatchcase
from typing import Required, TypedDict

from avatarsim.errors import InvalidInput, UnknownName
from avatarsim.scene.checks import Vector, positive
from avatarsim.scene.scene import Scene
from avatarsim.scene.tracker import TrackerSample

INFINITE = math.inf
RENDERED: float = 1.0 / 60.0
"""Length [s] of one rendered frame, and of one step of every stored motion."""

Motion = Callable[[int], TrackerSample]
"""The user's posture at the end of frame k; frame 0 is the first that is advanced. Deterministic."""


@dataclass(frozen=True)
class Bound:
    """Largest value of a metric, in its unit, and the reason. A metric that is missing or not a number breaks its bound."""

    metric: str
    limit: float
    reason: str

    def __post_init__(self) -> None:
        if not math.isfinite(self.limit):
            raise InvalidInput(f"limit of {self.metric}", self.limit, "a finite number")
        if not self.reason:
            raise InvalidInput(f"reason for the bound on {self.metric}", self.reason, "a sentence")

    def holds(self, value: float) -> bool:
        """Return whether a value is within the bound; NaN never is."""
        return value <= self.limit


@dataclass(frozen=True)
class Region:
    """Box from `low` to `high` [m] that frame origins of some bodies may not leave; sides may be infinite.

    `bodies` are names in canonical order or patterns such as "human/*".
    """

    bodies: tuple[str, ...]
    low: Vector
    high: Vector
    reason: str

    def __post_init__(self) -> None:
        for axis, low, high in zip("xyz", self.low, self.high, strict=True):
            if not low < high:
                raise InvalidInput(f"region of {', '.join(self.bodies)} along {axis}", (low, high), "low below high")

    def indices(self, names: tuple[str, ...]) -> tuple[int, ...]:
        """Return the indices of its bodies among `names`, rising. Raises UnknownName for a pattern without a match."""
        for pattern in self.bodies:
            if not any(fnmatchcase(name, pattern) for name in names):
                raise UnknownName("body of a region", pattern, names)
        return tuple(k for k, name in enumerate(names) if any(fnmatchcase(name, one) for one in self.bodies))


@dataclass(frozen=True)
class Drop:
    """A ball that falls straight onto a fixed slab.

    height       from surface to surface at the start [m]
    restitution  e of the pair: apex n is e^(2n) height
    """

    ball: str
    floor: str
    restitution: float
    height: float


REFUSAL = "refusal"
"""Key in a scenario's `expects`: true when the first pose overlaps, so that an engine begins elsewhere or may refuse it."""

EXPECTS: Mapping[str, tuple[str, tuple[str, ...]]] = {
    "drops": ("tuple of `Drop`", ("restitution_error_max", "apex_error_max", "bounce_time_error_max")),
    "zeno": ("True: its drops bounce until they lie", ("zeno_end_error_max",)),
    "courses": ("tuple of `Course`", ("course_error_max", "velocity_error_max", "spin_error_max")),
    "stops": ("tuple of `Stop`", ("stop_distance_error_max", "stop_direction_error_max")),
    "flips": ("tuple of `Flips`", ("flip_time_error_max",)),
    "pivots": ("tuple of `Pivot`", ("pivot_rate_error_max", "pivot_missing")),
    "rests": ("tuple of `Rest`", ("drift_max", "rest_energy_end")),
    "towers": ("tuple of `Tower`", ("towers_fallen", "ratio_standing_max")),
    "travel": ("mapping from a body to its least way [m]", ("travel_missing",)),
    "grasped": ("tuple of names of bodies that are held up", ("grasped_fall_end",)),
    "tops": ("tuple of `Top`", ("axis_spin_error_max", "precession_error_max")),
    "waves": ("tuple of `Wave`", ("wave_speed_error", "wave_missing")),
    "piles": ("tuple of `Pile`", ("pile_height_error_max",)),
    "carried": ("tuple of `Carried`", ("height_missing", "grip_slip_max")),
    "pressed": ("tuple of `Pressed`", ("pressed_sideways_max",)),
    "sags": ("tuple of `Sag`", ("sag_error_max",)),
    "isolated": ("tuple of groups, each a tuple of names: nothing else touches them, and they touch nothing else",
                 ("momentum_drift_max", "angular_momentum_drift_max")),
    "elastic": ("tuple of groups that lose no energy", ("energy_drift_max",)),
    "alone": ("tuple of groups that gain no energy from a user", ("energy_gain_max",)),
    "nothing_touches": ("True: no engine can be caught here by contacts", ()),
    REFUSAL: ("True: the first pose overlaps; an engine begins near it, or refuses it", ("start_moved_max",)),
}
"""Key of a scenario's `expects` -> its value, of a type in `scenarios/building/expected.py`, and the metrics that only scenes
with this key have."""


class Fields(TypedDict, total=False):
    """Fields of a scenario that its builder passes on."""

    frames: Required[int]
    short: int | None
    dt: float
    bounds: tuple[Bound, ...]
    regions: tuple[Region, ...]
    metrics: tuple[str, ...]
    expects: Mapping[str, object]
    everyday: bool
    family: str
    scale: float


@dataclass(frozen=True, eq=False)
class Scenario:
    """One question to every engine.

    title, judged        a sentence each
    build, motion        make the scene, and the tracker's motion in a scene by seed
    frames, short        full length, and that of a quick comparison (None: the full one)
    short_motion         motion of the short length, where it is not the beginning of the full one
    metrics              figures beyond the standard list
    expects              known facts of the motion, by the keys of `EXPECTS`
    everyday             flag: it is in short tables, and timed without a filter
    family               scene that this is a variant of, or a name that several share; by default it is none
    scale                size of its world, where it is a larger or smaller copy
    """

    name: str
    title: str
    judged: str
    build: Callable[[], Scene]
    motion: Callable[[Scene, int], Motion]
    frames: int
    short: int | None = None
    dt: float = RENDERED
    bounds: tuple[Bound, ...] = ()
    regions: tuple[Region, ...] = ()
    metrics: tuple[str, ...] = ()
    expects: Mapping[str, object] = field(default_factory=dict)
    short_motion: Callable[[Scene, int], Motion] | None = None
    everyday: bool = False
    family: str = ""
    scale: float = 1.0

    def __post_init__(self) -> None:
        positive(f"frames of {self.name}", self.frames, InvalidInput)
        positive(f"frame time of {self.name}", self.dt, InvalidInput)
        if self.short is not None and not 0 < self.short <= self.frames:
            raise InvalidInput(f"short length of {self.name}", self.short, f"1 to {self.frames} frames")
        for key in self.expects:
            if key not in EXPECTS:
                raise UnknownName(f"key in `expects` of {self.name}", key, EXPECTS)

    def as_run(self, full: bool) -> "Scenario":
        """Return the scenario with the frames and the motion of one length."""
        if full or self.short is None:
            return replace(self, short=None, short_motion=None)
        return replace(self, frames=self.short, motion=self.short_motion or self.motion, short=None, short_motion=None)
