"""Cleaning of a recorded motion: tracked with hold-back from a free frame, smoothed by look-ahead, measured as written."""

from collections.abc import Callable, Sequence
from functools import partial
from math import inf
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from avatarsim.assets.models.model import Model
from avatarsim.cleaning.chords import Chords, Room, certified, scene_of
from avatarsim.cleaning.foot_contact import planted_feet
from avatarsim.cleaning.ground import Ground, ground_of, raised
from avatarsim.cleaning.lookahead import Smoothing, part_of
from avatarsim.cleaning.measures import audited, farthest, moved
from avatarsim.cleaning.planting import RESPONSES, Planting
from avatarsim.cleaning.reference_frame import audit_with_reference, cleaned_with_reference, note_of, reference_frames
from avatarsim.cleaning.result import OVERLAP, Audit, Cleaned, Flagged, Options
from avatarsim.cleaning.start import approach, free_posture
from avatarsim.cleaning.track import Follower, Judged, Kind, LinkWeights, Written, track
from avatarsim.errors import InvalidInput
from avatarsim.scene.carried import Carried, joined, of_avatar
from avatarsim.scene.checks import FARTHEST, instance
from avatarsim.scene.motion import Motion
from avatarsim.scene.scene import Scene
from avatarsim.scene.tracker import checked
from avatarsim.spatial import rotation

UNREACHED = 1.0
"""[s] after which a free input not reached again counts as unreachable: catching up takes less."""


def chords_of(
    motion: Motion, model: Model, room: Room, options: Options, carried: Sequence[Carried]
) -> tuple[Chords, Motion]:
    """Return queries in the scene of a model, a room and carried bodies, and the fitting motion of avatar and carried bodies."""
    scene = scene_of(model, room, options, carried)
    instance("motion to clean", motion, Motion, "a Motion, as a motion file gives", InvalidInput)
    whole = joined(motion, carried)
    require_fit(scene, whole)
    return Chords(scene), whole


def require_fit(scene: Scene, motion: Motion) -> None:
    """Raise InvalidInput for a motion of another avatar, with invalid rotations, or off the world; it names the frame."""
    away = np.abs(motion.positions).reshape(len(motion), -1).max(axis=1, initial=0.0)
    if not (away <= FARTHEST).all():
        frame = int(np.argmax(away))
        raise InvalidInput(f"positions in frame {frame} of the motion [m]", float(away[frame]), f"coordinates up to {FARTHEST:g}")
    for frame in range(len(motion)):
        try:
            checked(motion.sample(frame), scene.avatars)
        except InvalidInput as error:
            raise InvalidInput(f"{error.thing}, in frame {frame} of the motion", error.value, error.valid) from error


def audit_motion(motion: Motion, model: Model, room: Room, options: Options, carried: Sequence[Carried]) -> Audit:
    """Audit a motion; see `avatarsim.cleaning.audit`."""
    chords, whole = chords_of(motion, model, room, options, carried)
    first = reference_frames(chords, whole)
    found = part_of(whole, slice(first, None))
    judged = Judged(chords, found, options.margin)
    ground = ground_of(chords, found, options.margin)
    notes = (ground.note,) if ground.is_off else ()
    audit = audited(chords, found, judged, judged.is_free, planted_feet(chords, found), options.opinion, notes)
    return audit_with_reference(audit, note_of(chords, whole)) if first else audit


def clean_motion(
    motion: Motion, model: Model, room: Room, options: Options, progress: Callable[[float], None] | None,
    carried: Sequence[Carried],
) -> Cleaned:
    """Clean a motion; see `avatarsim.cleaning.clean`."""
    chords, whole = chords_of(motion, model, room, options, carried)
    first = reference_frames(chords, whole)
    cleaned = clean_recorded(chords, part_of(whole, slice(first, None)), options, progress or (lambda share: None), carried)
    return cleaned_with_reference(cleaned, motion, note_of(chords, whole)) if first else cleaned


def clean_recorded(
    chords: Chords, motion: Motion, options: Options, progress: Callable[[float], None], carried: Sequence[Carried]
) -> Cleaned:
    """Clean a motion of which every frame was recorded."""
    judged = Judged(chords, motion, options.margin)
    ground = ground_of(chords, motion, options.margin)
    notes = (ground.note,) if ground.is_off else ()
    planted = planted_feet(chords, motion)
    before = audited(chords, motion, judged, judged.is_free, planted, options.opinion, notes)
    progress(0.1)
    is_off = ground.is_off and not carried
    heights = [ground.usual, 0.0] if is_off and options.ground else [0.0]
    best = Followed(Written(motion), inf)
    for n, height in enumerate(heights):
        planting = Planting.of(chords, raised(motion, chords, height), judged.is_free, options)
        steps = partial(_part_of_way, progress, n, len(heights))
        best = min(best, best_written(planting, judged, steps), key=lambda one: one.excess)
        if best.excess <= 1.0:
            break
    written = best.written
    if is_off and farthest(chords, motion, written.motion) > ground.free:
        written = constant_lift(chords, motion, ground, options.margin) or written
    written.rotations = rotation.with_signs_of(written.rotations, motion.rotations, written.kind == Kind.INPUT)
    done = written.motion
    after = audited(chords, done, Judged(chords, done, options.margin), judged.is_free, planted, options.opinion)
    progress(1.0)
    return Cleaned(
        of_avatar(done, chords.scene.avatars[0]), before, after, moved(chords, motion, done), written.kind != Kind.INPUT,
        ~judged.is_free, flags(motion, judged, written.kind),
    )


def _part_of_way(progress: Callable[[float], None], n: int, parts: int, share: float) -> None:
    """Report the finished share of the whole, given that of part n of the search for a result."""
    progress(0.1 + 0.8 * (n + share) / parts)


def constant_lift(chords: Chords, motion: Motion, ground: Ground, margin: float) -> Written | None:
    """Return the motion raised by the constant lift that takes it out of the room; None where it is not free then."""
    lifted = raised(motion, chords, ground.free)
    if not Judged(chords, lifted, margin - OVERLAP).is_free.all() or not (certified(chords, lifted).until >= 1.0).all():
        return None
    written = Written(lifted)
    written.kind[:] = Kind.TRACKED
    return written


class Followed(NamedTuple):
    """A result, and its excess over the bounds of foot slide and jerk: at most 1 within them."""

    written: Written
    excess: float


def best_written(planting: Planting, judged: Judged, progress: Callable[[float], None]) -> Followed:
    """Follow each aim in turn until planted feet and jerk are within bounds, and return the result nearest to them."""
    chords, motion, options = planting.chords, planting.motion, planting.options
    best = Followed(Written(motion), inf)
    for n, aim in enumerate(planting.aims()):
        written = Written(motion)
        follower = tracked(chords, aim, judged, options, planting.weights(), written)
        Smoothing(chords, follower, motion, written, judged.is_free, options, planting).improve()
        best = min(best, Followed(written, planting.excess(written.motion)), key=lambda one: one.excess)
        progress((n + 1.0) / len(RESPONSES))
        if best.excess <= 1.0:
            break
    return best


def tracked(
    chords: Chords, motion: Motion, judged: Judged, options: Options, weights: LinkWeights | None, written: Written
) -> Follower:
    """Run the first pass: from the first free frame forwards, and backwards to frame 0; without one from near frame 0."""
    free = np.flatnonzero(judged.is_free)
    if free.size:
        first = int(free[0])
        start = motion.sample(first)
        written.put(first, start, Kind.INPUT)
    else:
        first = 0
        start = free_posture(chords, motion.sample(0), options.margin)
    follower = Follower(chords, options, start, bool(free.size), weights)
    if not free.size:
        start = approach(follower, motion.sample(0))
        written.put(0, start, Kind.TRACKED)
    track(follower, motion, judged.is_free, range(first, len(motion)), written)
    if first > 0:
        follower.begin(start, True)
        track(follower, motion, judged.is_free, range(first, -1, -1), written)
    return follower


def flags(motion: Motion, judged: Judged, kind: NDArray[np.int64]) -> tuple[Flagged, ...]:
    """Return runs of frames that differ from the input, and the reasons."""
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
