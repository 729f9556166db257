"""Does the shown avatar shake, jerk, or wait far off without a word? Finite differences of link origins against the target's.

A figure that is no number counts as the worst: comparisons are written so that nan shakes, is off, and is in contact.
"""

import math

import numpy as np
from numpy.typing import NDArray

from avatarsim.scene.scene import Scene
from scenarios.measure.tracker_offset import offsets
from scenarios.measure.value import Missing, Value, Values
from scenarios.record import Recording

Array = NDArray[np.float64]
Flags = NDArray[np.bool_]

NEAR = 5e-3
"""Gap [m] of a link below which it is in contact. It holds the largest distance at which a compared engine keeps links off (a
contact margin of 4 mm); smaller, and an engine whose links hover would seem to be in contact less often than the others."""
SHAKES = 0.18
"""Speed [m/s] from which a displacement that reverses is seen: 3 mm in a frame of 60 Hz. Lower, and a screen does not show it."""
WINDOW, ENOUGH = 4, 3
"""A link shakes in a frame if it reversed in so many (ENOUGH) of the last WINDOW frames: one bounce off a wall is no shaking."""
LEAST_JERK = 20.0
"""Jerk [m/s^3] that stands in for a target that moves more evenly: a third difference of 0.1 mm at 60 Hz. Without it a resting
target would make every motion infinitely jerky."""
CALM = 0.5
"""Time [s] for which the target must have been free before an avatar elsewhere owes a status: a way back takes a while."""
FAR = 0.1
"""Distance [m] of a link origin from its target's from which an avatar is elsewhere."""


def reversals(shown: Array, target: Array) -> Array:
    """(F, L) [m] of link origins (F+1, L, 3): the smaller of the displacements of this frame and the one before where the shown
    ones point against each other and the target's do not; 0 where they do not. nan where something shown is no number."""
    found = np.zeros(shown[1:].shape[:-1])
    step, wanted = np.diff(shown, axis=0), np.diff(target, axis=0)
    back = ~((step[1:] * step[:-1]).sum(axis=-1) >= 0.0) & ~((wanted[1:] * wanted[:-1]).sum(axis=-1) < 0.0)
    length = np.linalg.norm(step, axis=-1)
    found[1:] = np.where(back, np.minimum(length[1:], length[:-1]), 0.0)
    return found


def shaking(reversed_by: Array, dt: float) -> Flags:
    """(F,) True where a link reversed by more than SHAKES times `dt` [s] in ENOUGH of the WINDOW frames that end there, of
    reversals (F, L) [m]."""
    seen = np.concatenate([np.zeros((WINDOW - 1, reversed_by.shape[1]), dtype=np.int64), ~(reversed_by <= SHAKES * dt)])
    often = np.lib.stride_tricks.sliding_window_view(seen, WINDOW, axis=0).sum(axis=-1) >= ENOUGH
    return np.asarray(often.any(axis=1))


def jitter(reversed_by: Array, target: Array, contact: Flags, dt: float) -> float:
    """The largest over links of the root mean square [m] of reversals (F, L) over the frames in `contact` (F,) in which the
    link's own target (F+1, L, 3) rests or slides: moves slower than SHAKES. A reversal that is faster counts as SHAKES times
    `dt`, the rest of it being shaking; no reversal as 0. 0 without such frames, nan where something shown is no number."""
    most = SHAKES * dt
    calm = contact[:, None] & (np.linalg.norm(np.diff(target, axis=0), axis=-1) <= most)
    squares = np.where(calm, np.minimum(reversed_by, most) ** 2, 0.0).sum(axis=0)
    return float(np.sqrt((squares / np.maximum(calm.sum(axis=0), 1)).max(initial=0.0)))


def third_differences(positions: Array) -> Array:
    """(F-2, L) [m] length of the third differences of link origins (F+1, L, 3)."""
    return np.asarray(np.linalg.norm(np.diff(positions, n=3, axis=0), axis=-1))


def free_for(free: Flags, frames: int) -> Flags:
    """(F,) True where state k and the `frames` - 1 before it are all free, of the states after the first in `free` (F+1,)."""
    counted = np.concatenate([[0], np.cumsum(free)])
    k = np.arange(1, len(free))
    return np.asarray((k + 1 >= frames) & (counted[k + 1] - counted[np.maximum(k + 1 - frames, 0)] == frames))


def free_awhile(free: Flags, dt: float) -> Flags:
    """(F,) True where the raw posture has been free, in states `free` (F+1,), for CALM by the end of the frame."""
    return free_for(free, max(1, math.ceil(CALM / dt - 1e-9)))


def silent_frames(recording: Recording, free: Flags) -> Flags:
    """(F,) True where a link is farther than FAR from its target, which has been free for CALM, and no status says why."""
    told = np.zeros(recording.frames + 1, dtype=bool)
    for numbers in recording.statuses.values():
        told |= numbers > 0
    silent = free_awhile(free, recording.dt) & ~told[1:]
    return np.asarray(silent & ~(offsets(recording).max(axis=1) <= FAR))


def smoothness(recording: Recording, scene: Scene, free: Flags, contact: Flags) -> Values:
    """chatter_frames [%], jitter_rms, reversal_p95 and reversal_max [m], jerk_ratio, silent_offset_frames: see
    `scenarios.metrics`.

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
        "jerk_ratio": jerk_ratio(shown, target, recording.dt),
        "silent_offset_frames": float(silent_frames(recording, free).sum()),
    }


def jerk_ratio(shown: Array, target: Array, dt: float) -> Value:
    """95th percentile, over frames and links, of the third differences of link origins (F+1, L, 3) shown, over the target's or
    LEAST_JERK, whichever is larger."""
    if len(shown) < 4:
        return Missing("fewer frames than a third difference needs", "scene")
    least = LEAST_JERK * dt**3
    return float(np.percentile(third_differences(shown), 95.0) / max(np.percentile(third_differences(target), 95.0), least))
