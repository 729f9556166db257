"""An avatar that follows postures within limits of speed and acceleration, always with a proved motion to rest."""

import numpy as np
from numpy.typing import NDArray

from avatarsim.cleaning.chords import Chords
from avatarsim.ik.braking import Outcome, brake_once, posture_ahead, rest_at, step_towards
from avatarsim.ik.rate_limits import make_braking
from avatarsim.jit.arena import pack
from avatarsim.model.conversion import write_sample
from avatarsim.model.world import sample_arrays
from avatarsim.scene.tracker import TrackerSample

Array = NDArray[np.float64]

OPENING = 0.05
"""[m/s] at which pairs nearer than the margin open at most. Faster: limbs jump off bodies that are too near; slower: they stay
near it."""


class LimitedFollower:
    """Follower of postures by one step a call.
    `shown` is the posture of the last call, `is_input` whether it equals the requested one."""

    def __init__(self, chords: Chords, speed: Array, acceleration: Array, dt: float, margin: float) -> None:
        self.chords, self._margin, self._opening = chords, margin, OPENING * dt
        self._words, self._parts = pack(make_braking(chords.world, speed, acceleration, dt))
        self.outcome = Outcome.BRAKED
        self.is_input = False

    def begin(self, start: TrackerSample, is_input: bool) -> None:
        """Begin at rest at a free posture."""
        rest_at(self.chords.world.words, self.chords.words, self._words, *sample_arrays(start))
        self.shown, self.is_input, self.outcome = start, is_input, Outcome.ARRIVED

    def follow(self, sample: TrackerSample) -> None:
        """Take one step towards a posture."""
        outcome, is_legal = step_towards(
            self.chords.world.words, self.chords.words, self._words, *sample_arrays(sample), self._margin, self._opening
        )
        self.outcome = Outcome(outcome)
        self.is_input = self.outcome is Outcome.ARRIVED and is_legal
        self.shown = sample if self.is_input else self._posture(sample.time)

    def brake(self, time: float) -> None:
        """Take one step along the proved motion to rest, at `time` [s]."""
        brake_once(self.chords.world.words, self._words)
        self.outcome, self.is_input = Outcome.BRAKED, False
        self.shown = self._posture(time)

    def stops(self) -> list[TrackerSample]:
        """Return the postures of the proved motion to rest from the shown one, call by call; none at rest."""
        return [self._ahead(k) for k in range(1, int(self._parts.calls[0]))]

    def _posture(self, time: float) -> TrackerSample:
        arrays = tuple(np.empty_like(one) for one in sample_arrays(self.shown))
        write_sample(self._parts.shown, self.chords.world.hinges, *arrays)
        return TrackerSample(time, *arrays)

    def _ahead(self, calls: int) -> TrackerSample:
        arrays = tuple(np.empty_like(one) for one in sample_arrays(self.shown))
        posture_ahead(self.chords.world.words, self.chords.words, self._words, calls, *arrays)
        return TrackerSample(self.shown.time, *arrays)
