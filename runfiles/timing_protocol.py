"""Protocol of a frame time: repeats of its frames, number of frames, and warm-up."""

import re
from dataclasses import dataclass

REPEATS = 3
"""Times that the same frames are run; the least of each frame is its cost without disturbance. With two, one disturbance that
hits the same frame twice would stay."""
WARM_FRAMES = 30
"""Frames run before the timed ones: they load code, fill caches and grow buffers. With fewer, the first
contact of some scenes would come after them, and with it code that runs for the first time."""
TAIL_FRAMES = 200
"""Different frames from which on a 99th percentile and a slowest frame are given: two frames decide them then. With fewer, both
would be one frame, or a number between two."""
RANKED_REPEATS = 2
"""Repeats from which on a time at the slow end ranks engines: a single run has every disturbance of the machine in it."""
TAILS = ("frame_time_p95", "frame_time_p99", "frame_time_max")
"""Metrics of times at the slow end. The 95th percentile of few frames is little but the slowest of them."""
PHASE_FRAMES = 30
"""Frames of either phase, at rest and in motion, from which on each has a median of its own."""


@dataclass(frozen=True)
class Protocol:
    """Measurement of a time: `frames` different frames from frame `first` of the scene on, each `repeats` times, after
    `warm_frames`: of the same load where so many come before `first`, else of one that is thrown away."""

    repeats: int
    frames: int
    warm_frames: int
    first: int = 0

    @property
    def said(self) -> str:
        """Note of every row."""
        frames, warm = (f"{number} {noun}{'s' * (number != 1)}" for number, noun in (
            (self.frames, "frame"), (self.warm_frames, "warm-up frame")))
        return f"{self.repeats} x {frames}{f' from frame {self.first}' if self.first else ''}, {warm}"

    @property
    def has_tail(self) -> bool:
        """True if there are enough repeats and frames for a 99th percentile and a slowest frame."""
        return self.repeats >= REPEATS and self.frames >= TAIL_FRAMES

    @property
    def no_tail(self) -> str:
        """Reason why there is no 99th percentile and no slowest frame."""
        return f"{self.said}: fewer than {REPEATS} x {TAIL_FRAMES}"


def may_rank(metric: str, note: str) -> bool:
    """Return whether a figure ranks engines, by the note of its row.

    A time at the slow end needs RANKED_REPEATS x TAIL_FRAMES frames; a row without a protocol ranks.
    """
    match = re.match(r"(\d+) x (\d+) frame", note) if metric in TAILS else None
    return match is None or (int(match[1]) >= RANKED_REPEATS and int(match[2]) >= TAIL_FRAMES)
