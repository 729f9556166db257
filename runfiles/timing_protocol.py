"""The protocol of a frame time: how often its frames were run, how many there were, and after what warm-up."""

import re
from dataclasses import dataclass

REPEATS = 3
"""Times that the same frames are run; the least of each frame is what it costs when nothing disturbs. With two, one disturbance
that hits the same frame twice would stay."""
WARM_FRAMES = 30
"""Frames run on a load of their own that is then thrown away: they load code, fill caches and grow buffers. With fewer, the first
contact of some scenes would come after them, and with it what it needs for the first time."""
TAIL_FRAMES = 200
"""Different frames from which on a 99th percentile and a slowest frame are given: it stands on two frames then. With fewer, both
would be one frame, or a number between two."""
RANKED_REPEATS = 2
"""Repeats from which on a time at the slow end ranks engines: what ran once has every disturbance of the machine in it."""
TAILS = ("frame_time_p95", "frame_time_p99", "frame_time_max")
"""Metrics of times at the slow end. The 95th percentile of few frames is little but the slowest of them."""
PHASE_FRAMES = 30
"""Frames of either phase, at rest and in motion, from which on each has a median of its own."""


def counted(number: int, noun: str) -> str:
    """ "1 frame", "3 frames"."""
    return f"{number} {noun}" if number == 1 else f"{number} {noun}s"


@dataclass(frozen=True)
class Protocol:
    """How a time was taken: `frames` different frames from frame `first` of the scene on, each `repeats` times, after
    `warm_frames` on another load of the scene."""

    repeats: int
    frames: int
    warm_frames: int
    first: int = 0

    @property
    def said(self) -> str:
        """In the words of every row."""
        begins = f" from frame {self.first}" if self.first else ""
        return f"{self.repeats} x {counted(self.frames, 'frame')}{begins}, {counted(self.warm_frames, 'warm-up frame')}"

    @property
    def has_tail(self) -> bool:
        """Whether there are enough repeats and frames for a 99th percentile and a slowest frame."""
        return self.repeats >= REPEATS and self.frames >= TAIL_FRAMES

    @property
    def no_tail(self) -> str:
        """Why there is no 99th percentile and no slowest frame."""
        return f"{self.said}: fewer than {REPEATS} x {TAIL_FRAMES}"


def may_rank(metric: str, note: str) -> bool:
    """Whether a figure ranks engines, by the note of its row: a time at the slow end only from RANKED_REPEATS x TAIL_FRAMES
    frames on. All else does, and so does a row that does not say how it was timed."""
    found = re.match(r"(\d+) x (\d+) frame", note) if metric in TAILS else None
    return found is None or (int(found[1]) >= RANKED_REPEATS and int(found[2]) >= TAIL_FRAMES)
