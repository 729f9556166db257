"""Replay of a recording: the same calls in the same order, with the hash of each state compared with the recorded one.

Deterministic replay (LeBlanc and Mellor-Crummey 1987): an engine is a function of its calls, so a file needs nothing else.
"""

from collections.abc import Callable
from dataclasses import dataclass

from avatarsim.engine import FrameRecord
from avatarsim.errors import InvalidFile
from avatarsim.live.orders import World
from avatarsim.live.recording import VALID, Frame, Recorded


@dataclass(frozen=True)
class Difference:
    """A replayed frame, 0 for the first state, whose state differs from the recorded one."""

    frame: int
    recorded: str
    replayed: str


@dataclass(frozen=True)
class Replayed:
    """Number of frames that ran, and the first difference; None if all frames are equal to the bit."""

    frames: int
    difference: Difference | None


def replay(recorded: Recorded, on_frame: Callable[[int, FrameRecord], None] = lambda frame, record: None) -> Replayed:
    """Run a recording again; `on_frame` is called with each frame's number, from 1, and its record.

    Continues after a difference, so that all frames are shown. Raises InvalidFile for a command or a sample that the engine
    refuses now, since refused ones are not recorded, and the errors of `load`."""
    world = World(recorded.plan)
    difference, frames = None, 0
    if world.shown.state_hash() != recorded.first_hash:
        difference = Difference(0, recorded.first_hash, world.shown.state_hash())
    for number, row in enumerate(recorded.rows):
        if isinstance(row, Frame):
            frames += 1
            found = world.advance(row.sample)
            replayed = found.state_hash()
            if difference is None and replayed != row.state_hash:
                difference = Difference(frames, row.state_hash, replayed)
            on_frame(frames, found)
        elif refused := world.apply(row):
            raise InvalidFile(f"row {number} of the recording", refused, VALID)
    return Replayed(frames, difference)
