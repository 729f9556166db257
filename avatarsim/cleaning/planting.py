"""Planted feet kept where the recording has them: a target motion whose root is lifted with them, and weights of their links.

A foot in the floor is pushed up by the posture solver, which bends the leg and lets the foot slide. Footskate cleanup (Kovar,
Schreiner and Gleicher 2002) states where planted feet are to be and moves the root smoothly to reach that. Here the root goes up
by the depth of the deepest planted foot, smoothed by penalised least squares (Whittaker 1923; Eilers 2003), and the origins of
planted links weigh more in the objective, so that hips and knees give way for the rest.
"""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import solveh_banded

from avatarsim.cleaning.chords import Chords
from avatarsim.cleaning.foot_contact import foot_slide, lowered_gaps, planted_feet, soles
from avatarsim.cleaning.ground import raised
from avatarsim.cleaning.measures import high, jerk
from avatarsim.cleaning.result import Options
from avatarsim.cleaning.track import LinkWeights
from avatarsim.scene.motion import Motion

Array = NDArray[np.float64]
Flags = NDArray[np.bool_]

PLANTED_WEIGHT = 10.0
"""Weight of the origin of a planted link in the objective, where others have 1. Larger: the body is jerked about to spare the
foot, at 100 getting up has 1.5 times the input's jerk; smaller: feet give way along the floor."""

RESPONSES = (0.02, None, 0.01)
"""[s] time constants of the lift that are tried, None without a lift, until planted feet and jerk are within bounds. Shorter: the
whole body follows each dip of a foot; longer: dips are left to the leg, and the foot slides."""

FLIGHT_WEIGHT = 1e-3
"""Weight of no lift in frames without a planted foot, where those with one have 1. Larger: the body drops between steps; smaller:
in flight it goes higher than any foot needs."""

MOST_SLIDE, SLIDE_FLOOR = 1.1, 0.01
"""Bound on the slide of planted feet: in multiples of the input's foot slide, or [m/s] above it, whichever is more."""

MOST_JERK = 1.1
"""95th percentile of jerk of all links up to which a result is taken at once, in multiples of the input's."""


@dataclass(frozen=True, eq=False)
class Planting:
    """Planted feet of a motion: between which frames (F-1, feet), and which frames (F,) are free."""

    chords: Chords
    motion: Motion
    is_free: Flags
    options: Options
    planted: Flags

    @classmethod
    def of(cls, chords: Chords, motion: Motion, is_free: Flags, options: Options) -> "Planting":
        """Find the planted feet of a motion."""
        return cls(chords, motion, is_free, options, planted_feet(chords, motion))

    @property
    def frames(self) -> Flags:
        """Return in which frames (F, feet) each foot is planted in the step before or after."""
        found = np.zeros((len(self.motion), self.planted.shape[1]), dtype=bool)
        found[:-1] |= self.planted
        found[1:] |= self.planted
        return found

    def weights(self) -> LinkWeights | None:
        """Return the weights of links, which rise and fall by a raised cosine within the blend; None without planted feet."""
        if not self.planted.any():
            return None
        half = max(1, round(self.options.blend * self.motion.rate))
        ramp = 0.5 + 0.5 * np.cos(np.pi * np.arange(-half, half + 1) / (half + 1))
        padded = np.pad(self.frames.astype(np.float64), ((half, half), (0, 0)))
        near = (np.lib.stride_tricks.sliding_window_view(padded, 2 * half + 1, axis=0) * ramp).max(axis=2)
        rows = np.ones((len(self.motion), len(self.chords.scene.links)))
        rows[:, list(soles(self.chords).links)] += (PLANTED_WEIGHT - 1.0) * near
        return LinkWeights(self.motion.times, rows)

    def aims(self) -> Iterator[Motion]:
        """Return the motions to follow, one after the other: frames that are free are the input's to the bit."""
        if not self.planted.any():
            yield self.motion
            return
        feet = self.frames
        gaps = lowered_gaps(self.chords, self.motion, soles(self.chords).links, self.options.margin)
        needed = np.where(feet, np.maximum(0.0, -gaps), 0.0).max(axis=1)
        known: Flags = np.asarray(feet.any(axis=1))
        for response in RESPONSES:
            yield self.motion if response is None else self._lifted(needed, known, response)

    def _lifted(self, needed: Array, known: Flags, response: float) -> Motion:
        """Return the motion with its root raised by `needed` (F,) [m] in frames where that is known, smoothed."""
        return raised(self.motion, self.chords, smooth_lift(needed, known, self.is_free, response * self.motion.rate))

    def slides_more(self, new: Motion, old: Motion, some: slice) -> bool:
        """Return True if planted feet slide farther in some frames than before and than they may."""
        planted, whole = self.planted[some][: len(new) - 1], self.motion
        own = Motion(whole.times[some], whole.positions[some], whole.rotations[some], whole.angles[some])
        slides = [foot_slide(self.chords, one, planted) for one in (new, old, own)]
        return slides[0] > max(slides[1], most_slide(slides[2]))

    def excess(self, motion: Motion) -> float:
        """Return the larger ratio of a result's foot slide and jerk to their bounds: at most 1 where both are within them."""
        before, after = (foot_slide(self.chords, one, self.planted) for one in (self.motion, motion))
        rough, smooth = (high(jerk(self.chords, one)) for one in (motion, self.motion))
        found = [after / most_slide(before), rough / (MOST_JERK * smooth) if smooth > 0.0 else np.nan]
        return float(np.nanmax([0.0, *found]))


def most_slide(before: float) -> float:
    """Return the largest foot slide [m/s] allowed for a result, given an input's."""
    return max(MOST_SLIDE * before, before + SLIDE_FLOOR)


def smooth_lift(needed: Array, known: Flags, is_free: Flags, response: float) -> Array:
    """Return the lift (F,) that is near `needed` where that is known, near 0 elsewhere, and 0 in free frames.

    Minimises the sum of squared errors plus response^6 times that of squared third differences; `response` in frames."""
    frames = len(needed)
    if frames < 4:
        return np.where(is_free, 0.0, needed)
    # upper diagonals of the banded matrix: row 3 is the main one
    banded, third = np.zeros((4, frames)), np.array([-1.0, 3.0, -3.0, 1.0])
    for i in range(4):
        for j in range(i, 4):
            banded[3 - (j - i), j : frames - 3 + j] += response**6 * third[i] * third[j]
    banded[3] += np.where(known, 1.0, FLIGHT_WEIGHT)
    right = np.where(known & ~is_free, needed, 0.0)
    for away in range(1, 4):
        banded[3 - away, away:][is_free[away:] | is_free[:-away]] = 0.0
    banded[3][is_free] = 1.0
    lift = solveh_banded(banded, right)
    lift[is_free] = 0.0
    return np.asarray(lift)
