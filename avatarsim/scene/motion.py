"""A recorded motion of one avatar: postures at known times, interpolated as rigid joints are (slerp, Shoemake 1985)."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from avatarsim.errors import InvalidInput
from avatarsim.scene.checks import real_array
from avatarsim.scene.tracker import TrackerSample, between
from avatarsim.spatial import rotation

Array = NDArray[np.float64]

MOST_FRAMES = 1_000_000
"""Frames of a resampled motion at most, two hours at 120 Hz. More: a human's motion passes 1 GB."""

SAME_INSTANT = 1e-9
"""Share of a step by which an instant may miss a recorded one and still be that one: rounding of sums of steps."""


@dataclass(frozen=True, eq=False)
class Motion:
    """F postures of one avatar.

    times      (F,) [s], ascending from 0
    positions  (F, links, 3) [m], as in TrackerSample: the root's place, used for a `Free` root only
    rotations  (F, links, 4), as in TrackerSample: of a `Free` root in the world, of a `Ball` link against its rest orientation
    angles     (F, hinges) [rad], link by link

    Raises InvalidInput where shapes or lengths differ, a number is not finite or the times do not ascend."""

    times: Array
    positions: Array
    rotations: Array
    angles: Array

    def __post_init__(self) -> None:
        for name in ("times", "positions", "rotations", "angles"):
            array = _real(f"{name} of a motion", getattr(self, name))
            object.__setattr__(self, name, array)
            if len(array) != len(self.times) or len(array) == 0:
                raise InvalidInput(f"frames in the {name} of a motion", len(array), f"{max(1, len(self.times))}, as in its times")
            bad = ~np.isfinite(array.reshape(len(array), -1)).all(axis=1)
            if bad.any():
                frame = int(np.argmax(bad))
                raise InvalidInput(f"{name} of frame {frame} of a motion", array[frame].tolist(), "finite numbers")
        links = self.positions.shape[1] if self.positions.ndim > 1 else 0
        hinges = self.angles.shape[1] if self.angles.ndim > 1 else 0
        for name, array, shape in (
            ("times", self.times, (len(self),)), ("positions", self.positions, (len(self), links, 3)),
            ("rotations", self.rotations, (len(self), links, 4)), ("angles", self.angles, (len(self), hinges)),
        ):
            if array.shape != shape:
                raise InvalidInput(f"shape of the {name} of a motion", array.shape, f"{shape}")
        if not (np.diff(self.times) > 0.0).all():
            raise InvalidInput("times of a motion [s]", "not ascending", "a row of numbers, each above the one before")

    def __len__(self) -> int:
        return len(self.times)

    @property
    def rate(self) -> float:
        """Return the mean number of frames a second [1/s]; nan for a single frame."""
        return (len(self) - 1) / float(self.times[-1] - self.times[0]) if len(self) > 1 else float("nan")

    def sample(self, frame: int) -> TrackerSample:
        """Return the posture of a frame."""
        return TrackerSample(float(self.times[frame]), self.positions[frame], self.rotations[frame], self.angles[frame])

    def between(self, frame: int, share: float) -> TrackerSample:
        """Return the posture at `share` (0 to 1) of the way from a frame to the next, as a player shows it between frames."""
        return between(self.sample(frame), self.sample(min(frame + 1, len(self) - 1)), share)

    def resampled(self, rate: float) -> "Motion":
        """Return the motion at `rate` [1/s]: rotations on the great circle between their neighbours, the rest on a straight line.

        A frame that falls on a recorded one is that one, bit for bit. The last one is at or before the recorded end."""
        if not (np.isfinite(rate) and rate > 0.0):
            raise InvalidInput("frames a second [1/s]", rate, "a finite number above 0")
        if len(self) == 1:
            return self
        duration = float(self.times[-1] - self.times[0])
        if not duration * rate < MOST_FRAMES:
            valid = f"up to {MOST_FRAMES / duration:g} for {duration:g} s, {MOST_FRAMES} frames"
            raise InvalidInput("frames a second of a resampled motion [1/s]", rate, valid)
        instants = self.times[0] + np.arange(int(duration * rate + SAME_INSTANT) + 1) / rate
        after = np.clip(np.searchsorted(self.times, instants, side="right"), 1, len(self) - 1)
        before = after - 1
        share = (instants - self.times[before]) / (self.times[after] - self.times[before])
        share = np.where(share < SAME_INSTANT, 0.0, np.where(share > 1.0 - SAME_INSTANT, 1.0, share))

        def kept(values: Array, blended: Array) -> Array:
            shape = (-1,) + (1,) * (values.ndim - 1)
            at_next = np.where((share == 1.0).reshape(shape), values[after], blended)
            return np.where((share == 0.0).reshape(shape), values[before], at_next)

        def on_line(values: Array) -> Array:
            u = share.reshape((-1,) + (1,) * (values.ndim - 1))
            return kept(values, values[before] + u * (values[after] - values[before]))

        shares = np.repeat(share[:, None], self.rotations.shape[1], axis=1)
        turned = rotation.normalised(rotation.slerp(self.rotations[before], self.rotations[after], shares))
        return Motion(instants, on_line(self.positions), kept(self.rotations, turned), on_line(self.angles))


def _real(thing: str, value: ArrayLike) -> Array:
    """Return `value` as rows of float64. Raises InvalidInput unless it is an array of real numbers."""
    if type(value) is np.ndarray and value.dtype == np.float64:
        # a motion may be large: no copy of an array that is one already
        return np.atleast_1d(np.ascontiguousarray(value))
    try:
        return np.atleast_1d(np.ascontiguousarray(real_array(value)))
    except (TypeError, ValueError, OverflowError) as error:
        raise InvalidInput(thing, str(error), "an array of real numbers") from error
