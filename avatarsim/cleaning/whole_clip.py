"""Cleaning of a recorded motion: tracked with hold-back from where it is free, smoothed by looking ahead, measured as written."""

from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import NDArray

from avatarsim.assets.models.model import Model
from avatarsim.cleaning.chords import Chords, scene_of
from avatarsim.cleaning.foot_contact import planted_feet
from avatarsim.cleaning.lookahead import Smoothing
from avatarsim.cleaning.measures import audited, moved
from avatarsim.cleaning.result import Audit, Cleaned, Flagged, Options
from avatarsim.cleaning.start import approach, free_posture
from avatarsim.cleaning.track import Follower, Judged, Kind, Written, track
from avatarsim.errors import InvalidInput
from avatarsim.scene.body import Body
from avatarsim.scene.carried import Carried, joined, of_avatar
from avatarsim.scene.checks import FARTHEST, instance
from avatarsim.scene.motion import Motion
from avatarsim.scene.scene import Scene
from avatarsim.scene.tracker import checked
from avatarsim.spatial import rotation

UNREACHED = 1.0
"""[s] after which a free input that was not reached again counts as unreachable: catching up takes less."""


def chords_of(
    motion: Motion, model: Model, room: Sequence[Body], options: Options, carried: Sequence[Carried]
) -> tuple[Chords, Motion]:
    """Queries in the scene of a model, a room and what is carried, and the motion of avatar and carried bodies, which fits."""
    scene = scene_of(model, room, options, carried)
    instance("motion to clean", motion, Motion, "a Motion, as a motion file gives", InvalidInput)
    whole = joined(motion, carried)
    require_fit(scene, whole)
    return Chords(scene), whole


def require_fit(scene: Scene, motion: Motion) -> None:
    """Raise InvalidInput for a motion of another avatar, with rotations that are none, or off the world; it names the frame."""
    away = np.abs(motion.positions).reshape(len(motion), -1).max(axis=1, initial=0.0)
    if not (away <= FARTHEST).all():
        frame = int(np.argmax(away))
        raise InvalidInput(f"positions in frame {frame} of the motion [m]", float(away[frame]), f"coordinates up to {FARTHEST:g}")
    for frame in range(len(motion)):
        try:
            checked(motion.sample(frame), scene.avatars)
        except InvalidInput as error:
            raise InvalidInput(f"{error.thing}, in frame {frame} of the motion", error.value, error.valid) from error


def audit_motion(motion: Motion, model: Model, room: Sequence[Body], options: Options, carried: Sequence[Carried]) -> Audit:
    """See `avatarsim.cleaning.audit`."""
    chords, motion = chords_of(motion, model, room, options, carried)
    judged = Judged(chords, motion, options.margin)
    return audited(chords, motion, judged, judged.is_free, planted_feet(chords, motion), options.opinion)


def clean_motion(
    motion: Motion, model: Model, room: Sequence[Body], options: Options, progress: Callable[[float], None] | None,
    carried: Sequence[Carried],
) -> Cleaned:
    """See `avatarsim.cleaning.clean`."""
    tell = progress or (lambda share: None)
    chords, motion = chords_of(motion, model, room, options, carried)
    judged = Judged(chords, motion, options.margin)
    planted = planted_feet(chords, motion)
    before = audited(chords, motion, judged, judged.is_free, planted, options.opinion)
    tell(0.1)
    written = Written(motion)
    follower = tracked(chords, motion, judged, options, written, lambda share: tell(0.1 + 0.4 * share))
    Smoothing(chords, follower, motion, written, judged.is_free, options).improve(lambda share: tell(0.5 + 0.4 * share))
    written.rotations = rotation.with_signs_of(written.rotations, motion.rotations, written.kind == Kind.INPUT)
    done = written.motion
    after = audited(chords, done, Judged(chords, done, options.margin), judged.is_free, planted, options.opinion)
    tell(1.0)
    return Cleaned(
        of_avatar(done, chords.scene.avatars[0]), before, after, moved(chords, motion, done), written.kind != Kind.INPUT,
        ~judged.is_free, flags(motion, judged, written.kind),
    )


def tracked(
    chords: Chords, motion: Motion, judged: Judged, options: Options, written: Written, tell: Callable[[float], None]
) -> Follower:
    """The first pass: from the first free frame forwards, and backwards to frame 0; without a free one from near frame 0."""
    free = np.flatnonzero(judged.is_free)
    if free.size:
        first = int(free[0])
        start = motion.sample(first)
        written.put(first, start, Kind.INPUT)
    else:
        first = 0
        start = free_posture(chords, motion.sample(0), options.margin)
    follower = Follower(chords, options, start, bool(free.size))
    if not free.size:
        start = approach(follower, motion.sample(0))
        written.put(0, start, Kind.TRACKED)
    track(follower, motion, judged.is_free, range(first, len(motion)), written)
    tell(1.0 - first / len(motion))
    if first > 0:
        follower.begin(start, True)
        track(follower, motion, judged.is_free, range(first, -1, -1), written)
    tell(1.0)
    return follower


def flags(motion: Motion, judged: Judged, kind: NDArray[np.int64]) -> tuple[Flagged, ...]:
    """Runs of frames that differ from the input, and why."""
    why = np.full(len(kind), "", dtype=object)
    why[kind == Kind.TRACKED] = "catching up"
    why[kind == Kind.HELD] = "held back"
    why[kind == Kind.BLENDED] = "blend"
    why[kind == Kind.CROSSED] = "pushed"
    why[(kind != Kind.INPUT) & (judged.beyond > 0.0).any(axis=1)] = "limits"
    overlap = (judged.gap < judged.margin) & ((kind == Kind.TRACKED) | (kind == Kind.BLENDED))
    why[overlap] = "overlap"
    found: list[Flagged] = []
    ends = np.flatnonzero(why[1:] != why[:-1]) + 1
    for first, end in zip([0, *ends.tolist()], [*ends.tolist(), len(why)], strict=True):
        if not why[first]:
            continue
        cause = str(why[first])
        if cause in ("catching up", "held back") and motion.times[end - 1] - motion.times[first] > UNREACHED:
            cause = "unreachable"
        nearest = first + int(np.argmin(judged.gap[first:end]))
        found.append(Flagged(first, end - 1, cause, judged.pair[nearest]))
    return tuple(found)
