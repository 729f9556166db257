"""Results of cleaning and auditing a motion: measures of overlap, limits, smoothness and displacement, and flagged frames."""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from avatarsim.errors import InvalidInput
from avatarsim.scene.checks import instance, within
from avatarsim.scene.motion import Motion

Array = NDArray[np.float64]
Flags = NDArray[np.bool_]

OVERLAP = 1e-6
"""Depth above which shapes overlap [m]: rounding errors and the query's own tolerance are below."""


@dataclass(frozen=True)
class Options:
    """Options of cleaning a motion.

    margin    gap that is kept between shapes where the input comes nearer [m], above 0
    blend     how long limbs take to give way at either end of a contact [s], 0: none; at least 4 frames are taken
    loose     whether the bodies that the files mark as loose are left out; else they are fixed where they are
    seed      of the engine's random directions
    ground    whether a clip that is in the room in every frame is cleaned higher by a constant lift
    opinion   whether an independent library checks as well, where it is installed: as long again as all else

    Raises InvalidInput for numbers outside these ranges."""

    margin: float = 1e-3
    blend: float = 0.1
    loose: bool = False
    seed: int = 0
    opinion: bool = True
    ground: bool = True

    def __post_init__(self) -> None:
        object.__setattr__(self, "margin", within("margin [m]", self.margin, 1e-5, 0.1, InvalidInput))
        object.__setattr__(self, "blend", within("blend [s]", self.blend, 0.0, 2.0, InvalidInput))
        for name in ("loose", "opinion", "ground"):
            instance(name, getattr(self, name), bool, "True or False", InvalidInput)
        if isinstance(self.seed, bool) or not isinstance(self.seed, int | np.integer):
            raise InvalidInput("seed", self.seed, "a whole number")


DEFAULTS = Options()
"""Default options."""


@dataclass(frozen=True)
class Excluded:
    """A pair that the file or the avatar excludes from contact.
    `depth` is its deepest overlap in any frame [m], 0 for none."""

    a: str
    b: str
    depth: float


@dataclass(frozen=True)
class AtRest:
    """A pair that overlaps at home: how deep [m] it may be, and `depth`, its deepest overlap in any frame [m], 0 for none."""

    a: str
    b: str
    allowed: float
    depth: float


@dataclass(frozen=True)
class Opinion:
    """Result of another library (`by`): the deepest overlap [m] and how many postures are deeper than OVERLAP.
    Counted over `frames` written postures and `between` postures at ten equal steps from each frame to the next."""

    by: str
    frames: int
    frames_overlapping: int
    frames_deepest: float
    between: int
    between_overlapping: int
    between_deepest: float


@dataclass(frozen=True, eq=False)
class Audit:
    """Measures of a motion.

    depths        (F,) deepest overlap of each frame [m], 0 for none, by this project's signed distance; of pairs that overlap at
                  home beyond the depth that they may have
    deepest_pair  the pair of the deepest overlap, None without any
    proven        (F-1,) share of the motion from each frame to the next, from its start, that is proved free of overlap: 1 is all
    limit_excess  largest angle by which a joint is outside its limits [rad]
    slide_excess  largest distance by which a slide is outside its limits [m]
    jerk_free     95th percentile of the jerk of link positions over the frames where the input was free [m/s^3]; nan without any
    jerk_held     that over the other frames
    excluded      the pairs that no measure and no proof includes, since they are excluded
    opinion       of an independent library; None where it is not installed or not used
    said          sentences for the user
    at_rest       the pairs that overlap at home
    foot_slide    mean speed at which soles slide where a foot of the input is planted [m/s]; nan without such a foot
    notes         sentences on the recording: frames that are all in the room, a reference posture in frame 0
    pairs         the deepest pair of each frame, None where nothing overlaps; empty where it is unknown"""

    depths: Array
    deepest_pair: tuple[str, str] | None
    proven: Array
    limit_excess: float
    slide_excess: float
    jerk_free: float
    jerk_held: float
    excluded: tuple[Excluded, ...]
    opinion: Opinion | None
    said: tuple[str, ...]
    at_rest: tuple[AtRest, ...] = ()
    foot_slide: float = math.nan
    notes: tuple[str, ...] = ()
    pairs: tuple[tuple[str, str] | None, ...] = ()

    @property
    def frames(self) -> int:
        """Number of frames of the motion."""
        return len(self.depths)

    @property
    def deepest(self) -> float:
        """Deepest overlap of any frame [m], 0 for none."""
        return float(self.depths.max())

    @property
    def deepest_frame(self) -> int | None:
        """The frame of the deepest overlap, counted from 0; None without any."""
        return int(np.argmax(self.depths)) if self.deepest > 0.0 else None

    @property
    def overlapping(self) -> int:
        """Number of frames in which shapes overlap by more than OVERLAP."""
        return int(np.sum(~(self.depths <= OVERLAP)))

    @property
    def unproven(self) -> int:
        """Number of the F-1 motion segments between frames that are not proved free of overlap to their end."""
        return int(np.sum(~(self.proven >= 1.0)))

    @property
    def is_clean(self) -> bool:
        """Return True if no frame overlaps, every motion segment is proved free, and joints are within limits."""
        return self.overlapping == 0 and self.unproven == 0 and max(self.limit_excess, self.slide_excess) <= 1e-9


@dataclass(frozen=True, eq=False)
class Moved:
    """Distances of the written motion from the input: root mean square, 95th percentile and, of links, maximum over all frames.

    links      names; link_rms, link_p95, link_most (links,) of the distance of their middles [m]
    joints     names; joint_rms, joint_p95 (joints,) of the angle between the rotations, or of the hinge angle [rad]
    slides     names; slide_rms, slide_p95 (slides,) of the slides' displacements [m]"""

    links: tuple[str, ...]
    link_rms: Array
    link_p95: Array
    link_most: Array
    joints: tuple[str, ...]
    joint_rms: Array
    joint_p95: Array
    slides: tuple[str, ...]
    slide_rms: Array
    slide_p95: Array


@dataclass(frozen=True)
class Flagged:
    """A run of frames, `first` to `last`, both included, that differ from the input, and the reason.
    `why`: "overlap" (the input overlaps or comes nearer than the margin), "blend" (giving way before or after contact), "limits"
    (outside joint limits), "held back" (the motion from the frame before was not free), "pushed" (a carried body came into the
    frame before, and no way out was proved), "catching up" (on the way back to the input), "unreachable" (held off for longer
    than a second). `pair` is the nearest pair of the input in that run, where one caused it."""

    first: int
    last: int
    why: str
    pair: tuple[str, str] | None = None


@dataclass(frozen=True, eq=False)
class Cleaned:
    """The cleaned motion at the input's times, measures before and after, its distance from the input, and changed frames.
    changed (F,): which frames differ from the input; held (F,): which frames of the input were not free (they overlap, come
    nearer than the margin, or are beyond limits); and the runs of frames that changed."""

    motion: Motion
    before: Audit
    after: Audit
    moved: Moved
    changed: Flags
    held: Flags
    flagged: tuple[Flagged, ...]
