"""Times of the frames of a motion file: a rate, a step, or an instant a frame, as the file or the user states it."""

import numpy as np

from avatarsim.assets.motions.archive import AnyArray, Archive, narrowed
from avatarsim.errors import InvalidFile, InvalidInput
from avatarsim.scene.checks import within
from avatarsim.scene.motion import Motion
from avatarsim.spatial.rotation import Array

RATES = ("fps", "mocap_framerate", "mocap_frame_rate", "frame_rate", "framerate", "frequency", "rate")
"""Entries with frames a second [1/s]."""

STEPS = ("dt", "timestep")
"""Entries with the time from frame to frame [s]."""

TIMES = ("times", "time", "timestamps", "t")
"""Entries with an instant a frame [s]."""

LOWEST, HIGHEST = 1e-3, 1e5
"""Frames a second that a file may state. Outside, another quantity or another unit was meant."""

EVEN = 1e-6
"""Share of a step by which steps may differ and still be equal."""


def at_rate(rate: float, frames: int, thing: str) -> Array:
    """Return instants (frames,) [s] of a steady rate. Raises InvalidInput for a rate that no recording has."""
    rate = within(f"{thing} [1/s]", rate, LOWEST, HIGHEST, InvalidInput)
    return np.arange(frames) / rate


def times_of(archive: Archive, frames: int, rate: float | None) -> Array:
    """Return instants (frames,) [s] from 0: by `rate` [1/s], else by the file. Raises InvalidFile where neither states them."""
    if rate is not None:
        return at_rate(rate, frames, "rate")
    key = archive.first((*TIMES, *RATES, *STEPS))
    if key is None:
        valid = f"one of {', '.join((*RATES, *STEPS, *TIMES))}; or say it: rate=30"
        raise InvalidFile(f"frames a second of {archive.name}", "not stated", valid)
    # a redundant entry must be valid all the same
    stated = {name: _stated(archive, name) for name in (*RATES, *STEPS) if name == key or _is_one_number(archive, name)}
    if key in TIMES:
        return _instants(archive, key, frames)
    return at_rate(stated[key], frames, key)


def _is_one_number(archive: Archive, key: str) -> bool:
    return key in archive.arrays and archive.arrays[key].size == 1 and archive.arrays[key].dtype.kind in "iuf"


def _stated(archive: Archive, key: str) -> float:
    """Return frames a second [1/s] from the file's rate or step. Raises InvalidFile for a rate that no recording has."""
    value = archive.scalar(key)
    if key in STEPS:
        if not (1.0 / HIGHEST <= value <= 1.0 / LOWEST):
            raise InvalidFile(f"{key} of {archive.name} [s]", value, f"{1.0 / HIGHEST:g} to {1.0 / LOWEST:g}")
        return 1.0 / value
    if not (LOWEST <= value <= HIGHEST):
        raise InvalidFile(f"{key} of {archive.name}, frames a second [1/s]", value, f"{LOWEST:g} to {HIGHEST:g}")
    return value


def _instants(archive: Archive, key: str, frames: int) -> Array:
    times = archive.numbers(key).ravel()
    if len(times) != frames:
        raise InvalidFile(f"instants of {key} in {archive.name}", len(times), f"{frames}, one a frame")
    steps = np.diff(times)
    if not ((steps >= 1.0 / HIGHEST) & (steps <= 1.0 / LOWEST)).all():
        frame = int(np.argmin((steps >= 1.0 / HIGHEST) & (steps <= 1.0 / LOWEST)))
        valid = f"steps of {1.0 / HIGHEST:g} to {1.0 / LOWEST:g} s"
        raise InvalidFile(f"step from frame {frame} to the next by {key} of {archive.name} [s]", float(steps[frame]), valid)
    return np.asarray(times - times[0])


def steady_rate(motion: Motion) -> float:
    """Return frames a second of a motion to be written at a steady rate. Raises InvalidInput for uneven steps."""
    if len(motion) == 1:
        return float("nan")
    steps = np.diff(motion.times)
    if not (np.ptp(steps) <= EVEN * steps.mean() + 1e-9):
        least, most = float(steps.min()), float(steps.max())
        raise InvalidInput("steps of a motion for a file of equal steps [s]", (least, most), "equal ones")
    return motion.rate


def restated(archive: Archive, motion: Motion) -> dict[str, AnyArray]:
    """Return the file's entries on frame times, for a motion with other instants."""
    found: dict[str, AnyArray] = {}
    for key in archive.arrays:
        like = archive.arrays[key]
        if key in TIMES and like.dtype.kind in "iuf":
            start = float(like.ravel()[0]) if like.size else 0.0
            found[key] = narrowed(motion.times + start, like)
        elif key in (*RATES, *STEPS) and len(motion) > 1 and like.dtype.kind in "iuf" and like.size == 1:
            rate = steady_rate(motion)
            value = np.full(like.shape, rate if key in RATES else 1.0 / rate)
            # a whole rate stays a whole number, and others are not cut off to one
            is_whole = like.dtype.kind in "iu" and bool((np.abs(value - np.rint(value)) < 1e-6).all())
            found[key] = np.rint(value).astype(like.dtype) if is_whole else value
    return found
