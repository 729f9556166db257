"""Smoothness: shaking, jerk, and waiting far off without a report. Differences of link origins against the target's.

A figure that is no number counts as the worst: comparisons are written so that nan shakes, is off, and is in contact.

Visible gap in contact: median distance of an avatar's links from the bodies they touch, over the states in which one is near.
"""

import math

import numpy as np
from numpy.typing import NDArray

from avatarsim.scene.scene import Scene
from runfiles.record import Recording
from runfiles.visible_motion import FAR, SHAKES, reversals, shaking
from scenarios.measure.posture.tracker_offset import offsets
from scenarios.measure.value import Missing, Value, Values

Array = NDArray[np.float64]
Flags = NDArray[np.bool_]

NEAR = 5e-3
"""Gap [m] of a link below which it is in contact. It holds the largest distance at which a compared engine keeps links off (a
contact margin of 4 mm); smaller, and an engine whose links hover would seem to be in contact less often than the others."""
HELD_OFF = 1e-3
"""Distance [m] of a link from its target from which on the avatar is held off. Smaller, and rounding and stand-off would count;
larger, and a hand that slides along a table would be free."""
WITHIN = 0.05
"""Time [s] within which a user's motion excuses the avatar's: an engine may follow a few frames late. Longer, and a dash after a
release would be excused by the motion before it."""
DASH = 0.5
"""Speed [m/s] beyond the user's from which a motion is seen as the avatar's own: half a metre a second is a limb that runs."""
RESTS = 0.1
"""Speed [m/s] of a link below which its user holds it still, as the sole of a recorded standing foot is."""
CALM = 0.5
"""Time [s] for which the target must have been free before an avatar elsewhere must report a status: a way back takes a while."""


def jitter(reversed_by: Array, target: Array, contact: Flags, dt: float) -> float:
    """Return the largest over links of the root mean square [m] of reversals (F, L) over the frames in `contact` (F,) in which
    the link's own target (F+1, L, 3) rests or slides: moves slower than SHAKES. A reversal that is faster counts as SHAKES times
    `dt`, the rest of it being shaking; no reversal as 0. 0 without such frames, nan where something shown is no number."""
    most = SHAKES * dt
    calm = contact[:, None] & (np.linalg.norm(np.diff(target, axis=0), axis=-1) <= most)
    squares = np.where(calm, np.minimum(reversed_by, most) ** 2, 0.0).sum(axis=0)
    return float(np.sqrt((squares / np.maximum(calm.sum(axis=0), 1)).max(initial=0.0)))


def largest_within(values: Array, frames: int) -> Array:
    """Return the largest of `values` (F, ...) in so many frames before and after each; no number counts as 0."""
    padded = np.pad(np.nan_to_num(values), ((frames, frames), *((0, 0) for _ in values.shape[1:])))
    return np.asarray(np.lib.stride_tricks.sliding_window_view(padded, 2 * frames + 1, axis=0).max(axis=-1))


def own_acceleration(shown: Array, target: Array, dt: float) -> Value:
    """Return the root mean square [m/s^2] of the acceleration of links beyond their user's, over frames that are held off.

    Of link origins (F+1, L, 3): the acceleration shown less the largest of the same link's target within WITHIN, at least 0, in
    states in which any link is farther than HELD_OFF from its target. An engine that smooths the motion has 0 at best, as one
    that follows exactly does.
    """
    if len(shown) < 3:
        return Missing("fewer frames than an acceleration needs", "scene")
    off = ~(np.linalg.norm(shown - target, axis=-1) <= HELD_OFF).all(axis=1)
    if not off[1:-1].any():
        return Missing("in no frame that was run is the avatar held off", "scene")
    own, user = (np.linalg.norm(np.diff(places, n=2, axis=0), axis=-1) / dt**2 for places in (shown, target))
    beyond = np.maximum(own - largest_within(user, round(WITHIN / dt)), 0.0)[off[1:-1]]
    return float(np.sqrt(np.mean(beyond**2)))


def dashes(shown: Array, target: Array, dt: float) -> int:
    """Return the number of frames in which a link is faster by more than DASH than any link of the user within WITHIN."""
    own, user = (np.linalg.norm(np.diff(places, axis=0), axis=-1) / dt for places in (shown, target))
    most = largest_within(user.max(axis=1, initial=0.0), round(WITHIN / dt))
    return int((~(own <= most[:, None] + DASH)).any(axis=1).sum())


def creep(shown: Array, target: Array, dt: float) -> Value:
    """Return the mean speed [m/s] of links beyond their user's while the user holds them still.

    Of link origins (F+1, L, 3), over links and frames in which the target is slower than RESTS within WITHIN and the link is
    farther than HELD_OFF from it. Feet that skid on the floor and limbs that creep along a wall are seen here.
    """
    own, user = (np.linalg.norm(np.diff(places, axis=0), axis=-1) / dt for places in (shown, target))
    off = ~(np.linalg.norm(shown - target, axis=-1) <= HELD_OFF)[1:]
    still = off & (largest_within(user, round(WITHIN / dt)) <= RESTS)
    if not still.any():
        return Missing("in no frame that was run is a link held off whose user holds it still", "scene")
    return float(np.maximum(own - user, 0.0)[still].mean())


def free_for(free: Flags, frames: int) -> Flags:
    """Return (F,) True where state k and the `frames` - 1 before it are free, of the states after the first in `free` (F+1,)."""
    counted = np.concatenate([[0], np.cumsum(free)])
    k = np.arange(1, len(free))
    return np.asarray((k + 1 >= frames) & (counted[k + 1] - counted[np.maximum(k + 1 - frames, 0)] == frames))


def free_awhile(free: Flags, dt: float) -> Flags:
    """Return (F,) True where the raw posture has been free, in states `free` (F+1,), for CALM by the end of the frame."""
    return free_for(free, max(1, math.ceil(CALM / dt - 1e-9)))


def silent_frames(recording: Recording, free: Flags) -> Flags:
    """Return (F,) True where a link is over FAR from its target, which has been free for CALM, and no status gives a reason."""
    reported = np.zeros(recording.frames + 1, dtype=bool)
    for numbers in recording.statuses.values():
        reported |= numbers > 0
    silent = free_awhile(free, recording.dt) & ~reported[1:]
    return np.asarray(silent & ~(offsets(recording).max(axis=1) <= FAR))


def smoothness(recording: Recording, scene: Scene, free: Flags, contact: Flags) -> Values:
    """Return chatter_frames, jitter_rms, reversal_p95, reversal_max, own_acceleration_rms, dash_frames, creep_mean and
    silent_offset_frames: see `runfiles.metrics`.

    free (F+1,): the raw posture could be shown; contact (F+1,): something holds the avatar, see `Known.contact`. Empty without
    avatars."""
    if not scene.links or recording.frames == 0:
        return {}
    shown, target = recording.positions[:, recording.links], recording.raw_positions
    reversed_by, held = reversals(shown, target), contact[1:]
    none = Missing("in no frame that was run is the avatar in contact", "scene")
    return {
        "chatter_frames": 100.0 * float(np.mean(shaking(reversed_by, recording.dt)[held])) if held.any() else none,
        "jitter_rms": jitter(reversed_by, target, held, recording.dt) if held.any() else none,
        "reversal_max": float(reversed_by.max()),
        "reversal_p95": float(np.percentile(reversed_by.max(axis=1)[held], 95.0)) if held.any() else none,
        "own_acceleration_rms": own_acceleration(shown, target, recording.dt),
        "dash_frames": float(dashes(shown, target, recording.dt)),
        "creep_mean": creep(shown, target, recording.dt),
        "silent_offset_frames": float(silent_frames(recording, free).sum()),
    }


def contact_gap(gaps: Array) -> Values:
    """Return contact_gap_p50 [m] from `gaps` (F+1,) [m], the smallest distance of a link from a body it may not overlap in each
    state shown, negative where it overlaps: the median over states with at most NEAR, where an overlap is a gap of 0. An engine
    that keeps links off by a margin has that margin here. A gap that is no number is in contact and the worst."""
    near = gaps[~(gaps > NEAR)]
    if not near.size:
        return {"contact_gap_p50": Missing("in no state that was shown is a link near anything", "scene")}
    return {"contact_gap_p50": float(np.median(np.maximum(near, 0.0)))}
