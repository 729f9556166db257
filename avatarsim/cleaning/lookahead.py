"""Look-ahead smoothing of displacements: an envelope by running maximum and a Hann window, as in a look-ahead limiter.

Where a motion was held off its input the displacement changes with a jerk. The clip is known whole, so the target may give way
before contact: the displacement, raised to its largest value within a window, is low-passed by a finite impulse response of the
same length (zero phase; Oppenheim and Schafer, Discrete-Time Signal Processing), added to the input as in motion warping (Witkin
and Popovic 1995), and tracked again. Its support is compact: towards frames that kept the input it is faded to the first tracked
motion, and those keep the input to the bit. Only where that leaves too much jerk may limbs give way in free frames as well, by at
most the length of the window before and after.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from avatarsim.cleaning.chords import Chords
from avatarsim.cleaning.measures import high, jerk
from avatarsim.cleaning.planting import Planting
from avatarsim.cleaning.result import Options
from avatarsim.cleaning.track import Follower, Judged, Kind, Written, track
from avatarsim.scene.motion import Motion
from avatarsim.spatial import rotation

Array = NDArray[np.float64]

LEAST_FRAMES = 4
"""Least number of frames of a window: fewer cannot be smooth."""

WIDEST = 1.0
"""[rad] largest displacement of a joint that may be scaled and averaged as a small one."""

WORTH = 0.95
"""Largest share of the first tracked motion's jerk that a smoothed episode may have: else frames would change for nothing."""

MOST_JERK = 1.5
"""Jerk up to which free frames keep the input, in multiples of the input's in free frames and elsewhere. Larger: a motion that
gives way within few frames looks abrupt; smaller: more frames change for it."""

TRIES = 2
"""Number of windows that are tried, each twice as long as the one before."""


class Episode(NamedTuple):
    """Frames first .. last, both included, that differ from the input."""

    first: int
    last: int


def episodes(is_input: NDArray[np.bool_], grow: int) -> list[Episode]:
    """Return runs of frames that differ from the input; those whose surroundings of `grow` frames meet are one."""
    away = np.flatnonzero(~is_input)
    if not away.size:
        return []
    parts = np.split(away, np.flatnonzero(np.diff(away) > 2 * grow + 2) + 1)
    return [Episode(int(part[0]), int(part[-1])) for part in parts]


def displacement(chords: Chords, motion: Motion, written: Motion, some: slice) -> Array | None:
    """Return the displacement (n, w) [m, rad] of the written motion from the input in frames `some`.
    Roots in world axes, turns as rotation vectors in the parent's axes, hinges by difference. None for a joint beyond WIDEST."""
    free, turning = chords.free_roots, chords.turning
    before, after = motion.rotations[some][:, turning], written.rotations[:, turning]
    turns = rotation.to_rotation_vector(rotation.multiply(after, rotation.conjugate(before)))
    if turns.size and not float(np.linalg.norm(turns, axis=2).max()) <= WIDEST:
        return None
    moves = written.positions[:, free] - motion.positions[some][:, free]
    count = len(turns)
    hinges = written.angles - motion.angles[some]
    return np.concatenate([moves.reshape(count, -1), turns.reshape(count, -1), hinges], axis=1)


def displaced(chords: Chords, motion: Motion, some: slice, d: Array) -> Motion:
    """Return the motion with a displacement (n, w) added in frames `some`; where that is zero nothing changes, to the bit."""
    free, turning = chords.free_roots, chords.turning
    positions, rotations, angles = motion.positions.copy(), motion.rotations.copy(), motion.angles.copy()
    where = np.arange(some.start, some.stop)[np.any(d != 0.0, axis=1)]
    d = d[np.any(d != 0.0, axis=1)]
    moves, turns = d[:, : 3 * len(free)], d[:, 3 * len(free) : 3 * len(free) + 3 * len(turning)]
    positions[where[:, None], free] += moves.reshape(len(d), len(free), 3)
    steps = rotation.from_rotation_vector(turns.reshape(len(d), len(turning), 3))
    turned = rotation.multiply(steps, rotations[where[:, None], turning])
    rotations[where[:, None], turning] = rotation.normalised(turned)
    angles[where] += d[:, 3 * len(free) + 3 * len(turning) :]
    return Motion(motion.times, positions, rotations, angles)


def smoothed(d: Array, half: int) -> Array:
    """Return a displacement (n, w) raised to its largest size within `half` frames and averaged by a Hann window.
    The window has as many frames on each side; where there is no displacement the nearest one's direction is used."""
    size = np.linalg.norm(d, axis=1)
    moving = np.flatnonzero(size > 0.0)
    if not moving.size:
        return d
    at = moving[np.clip(np.searchsorted(moving, np.arange(len(d))), 0, len(moving) - 1)]
    before = moving[np.clip(np.searchsorted(moving, np.arange(len(d)), side="right") - 1, 0, len(moving) - 1)]
    nearest = np.where(np.abs(at - np.arange(len(d))) < np.abs(np.arange(len(d)) - before), at, before)
    directions = d[nearest] / size[nearest][:, None]
    padded = np.pad(size, half, mode="edge")
    envelope = np.lib.stride_tricks.sliding_window_view(padded, 2 * half + 1).max(axis=1)
    weights = np.hanning(2 * half + 3)[1:-1]
    weights /= weights.sum()
    raised = np.pad(directions * envelope[:, None], ((half, half), (0, 0)), mode="edge")
    return np.stack([np.convolve(column, weights, mode="valid") for column in raised.T], axis=1)


def faded(first: Array, smooth: Array, is_input: NDArray[np.bool_], half: int) -> Array:
    """Return a smoothed displacement (n, w) that is blended into the first one near frames that kept the input.
    The blend is a raised cosine over `half` frames."""
    frames, far = np.arange(len(first)), len(first) + half
    since = frames - np.maximum.accumulate(np.where(is_input, frames, -far))
    until = np.minimum.accumulate(np.where(is_input, frames, len(first) + far)[::-1])[::-1] - frames
    share = 0.5 - 0.5 * np.cos(np.pi * np.minimum(np.minimum(since, until), half + 1) / (half + 1))
    return np.asarray(first + share[:, None] * (smooth - first))


def by_jerk(found: Sequence[Episode], jerks: Array, near: int) -> list[Episode]:
    """Return episodes in order of the largest jerk in them and `near` frames before and after, the largest first."""
    largest = np.nan_to_num(jerks).max(axis=1)
    return sorted(found, key=lambda one: -float(largest[max(0, one.first - near) : one.last + near + 1].max()))


@dataclass(frozen=True)
class Smoothing:
    """Look-ahead smoothing of a tracked motion.
    `written` is changed in place; `is_free` (F,): which frames of the input were free."""

    chords: Chords
    follower: Follower
    motion: Motion
    written: Written
    is_free: NDArray[np.bool_]
    options: Options
    planting: Planting

    def improve(self) -> None:
        """Track each episode again towards a target that gives way early, where the result is valid and smoother."""
        motion, blend = self.motion, self.options.blend
        if blend == 0.0 or len(motion) <= LEAST_FRAMES:
            return
        half = max(LEAST_FRAMES, round(blend * motion.rate)) // 2
        found = episodes(self.written.kind == Kind.INPUT, 2 * half)
        for episode in found:
            self._tried(episode, half, is_compact=True)
        before, jerks = jerk(self.chords, motion), jerk(self.chords, self.written.motion)
        for episode in by_jerk(found, jerks, 2 * half):
            if not any(high(jerks[some]) > MOST_JERK * high(before[some]) for some in (self.is_free, ~self.is_free)):
                break
            if self._tried(episode, half, is_compact=False):
                jerks = jerk(self.chords, self.written.motion)

    def _tried(self, episode: Episode, half: int, is_compact: bool) -> bool:
        """Return True if an episode became smoother with a window, or one twice as long."""
        return any(self._again(episode, half << attempt, is_compact) for attempt in range(TRIES))

    def _again(self, episode: Episode, half: int, is_compact: bool) -> bool:
        """Track an episode again with a window of `half` frames on each side, and keep the result if it is better.
        If compact, frames that kept the input keep it."""
        motion, written = self.motion, self.written
        first, last = max(0, episode.first - 2 * half - 1), min(len(motion) - 1, episode.last + 2 * half + 1)
        some, is_input = slice(first, last + 1), written.kind == Kind.INPUT
        if last - first < LEAST_FRAMES or (first > 0 and not is_input[first]) or (last < len(motion) - 1 and not is_input[last]):
            # a doubled window may overlap the next episode
            return False
        old = part_of(written.motion, some)
        d = displacement(self.chords, motion, old, some)
        if d is None:
            return False
        d[is_input[some]] = 0.0
        smooth = smoothed(d, half)
        d = faded(d, smooth, is_input[some], half) if is_compact else smooth
        trial = self._tracked(part_of(displaced(self.chords, motion, some, d), some), old, bool(is_input[first]))
        unchanged = is_input[some] if is_compact else is_input[some] & (np.arange(len(old)) == len(old) - 1)
        if np.any(trial.kind[unchanged] != Kind.INPUT) or np.any(trial.kind == Kind.CROSSED):
            return False
        # every motion segment between its frames was proved free when it was written
        if not self._is_smoother(trial.motion, old, some, is_compact):
            return False
        trial.kind[0] = written.kind[first]
        trial.kind[(trial.kind == Kind.INPUT) & np.any(d != 0.0, axis=1)] = Kind.BLENDED
        new = trial.motion
        written.positions[some], written.rotations[some], written.angles[some] = new.positions, new.rotations, new.angles
        written.kind[some] = trial.kind
        return True

    def _tracked(self, aim: Motion, old: Motion, is_input: bool) -> Written:
        """Track an aim from the first frame of the old motion, which is a frame of the input or not, and return the result."""
        trial, start = Written(aim), old.sample(0)
        self.follower.begin(start, is_input)
        trial.put(0, start, Kind.INPUT if is_input else Kind.TRACKED)
        track(self.follower, aim, Judged(self.chords, aim, self.options.margin).is_free, range(len(aim)), trial)
        return trial

    def _is_smoother(self, new: Motion, old: Motion, some: slice, is_compact: bool) -> bool:
        """Return True if the jerk is worth a change; if compact, with no more of it in free frames than before or allowed."""
        jerks, before, free = jerk(self.chords, new), jerk(self.chords, old), self.is_free[some]
        if not high(jerks) < WORTH * high(before) or self.planting.slides_more(new, old, some):
            return False
        if not is_compact or not free.any():
            return True
        recorded_jerk = jerk(self.chords, part_of(self.motion, some))
        return not high(jerks[free]) > max(high(before[free]), MOST_JERK * high(recorded_jerk[free]))


def part_of(motion: Motion, some: slice) -> Motion:
    """Return some frames of a motion, at their times."""
    times = motion.times[some]
    return Motion(times, motion.positions[some], motion.rotations[some], motion.angles[some])
